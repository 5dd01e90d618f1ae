/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_store.c - "store": how the database is, and what it takes
 */
#include "jobs.h"
#include "verb.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

void verbs_store(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	struct checkpoint_stats place = { .err = -ENOENT };
	struct store_size size;
	char body[1000];

	(void)v;
	if (j->checkpoint)
		checkpoint_stats(j->checkpoint, &place);
	store_measure(j->store, &size);
	/* No name of a machine or folder that is taken needs escaping but these:
	 * a folder with a quote in it is shown without. */
	for (char *at = size.path; *at; at++)
		if (*at == '"' || *at == '\\' || (unsigned char)*at < ' ')
			*at = '?';
	snprintf(body, sizeof(body), "{\"path\":\"%s\",\"bytes\":%lld,"
		 "\"jobs\":%u,\"kept\":%u,\"dropped\":%llu,\"why\":\"%s\","
		 "\"place_writes\":%llu,\"place_bytes\":%llu,"
		 "\"place_slowest_us\":%lld,\"place_why\":\"%s\"}",
		 size.path, (long long)size.bytes, size.jobs, size.kept,
		 (unsigned long long)size.dropped, store_why(j->store),
		 (unsigned long long)place.writes,
		 (unsigned long long)place.bytes, (long long)place.slowest_us,
		 place.err ? strerror(-place.err) : "");
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq,
		.reason = "done", .body = body,
	});
}
