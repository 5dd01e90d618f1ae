/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_store.c - "store": how the database is, and what it takes
 */
#include "jobs.h"
#include "verb.h"

#include <stdio.h>

void verbs_store(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	struct store_size size;
	char body[800];

	(void)v;
	store_measure(j->store, &size);
	/* No name of a machine or folder that is taken needs escaping but these:
	 * a folder with a quote in it is shown without. */
	for (char *at = size.path; *at; at++)
		if (*at == '"' || *at == '\\' || (unsigned char)*at < ' ')
			*at = '?';
	snprintf(body, sizeof(body), "{\"path\":\"%s\",\"bytes\":%lld,"
		 "\"jobs\":%u,\"kept\":%u,\"dropped\":%llu,\"why\":\"%s\"}",
		 size.path, (long long)size.bytes, size.jobs, size.kept,
		 (unsigned long long)size.dropped, store_why(j->store));
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq,
		.reason = "done", .body = body,
	});
}
