/* SPDX-License-Identifier: Apache-2.0 */
/* verbs_store.c - verb "store": the state of the database, and its size */
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
	/* Names of machines and folders need no other escapes.  A folder with a
	 * quote in its name is shown without the quote. */
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
