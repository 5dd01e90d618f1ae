/* SPDX-License-Identifier: Apache-2.0 */
/* reply.c - a repeated command gets the same answer and is not done again */
#include "reply.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void reply_asker_keep(struct asker *a, const struct jobs_lcm_command *c)
{
	*a = (struct asker) { .seq = c->seq, .act = c->act };
	memcpy(a->key, c->key, sizeof(a->key));
	snprintf(a->client, sizeof(a->client), "%s", c->client);
}

struct jobs_lcm_command reply_asker_command(const struct asker *a)
{
	return (struct jobs_lcm_command) {
		.key = a->key, .client = a->client, .seq = a->seq,
		.act = a->act,
	};
}

bool reply_asker_is(const struct asker *a, const struct jobs_lcm_command *c)
{
	return a->seq == c->seq && strcmp(a->client, c->client) == 0 &&
	       memcmp(a->key, c->key, sizeof(a->key)) == 0;
}

const struct reply *reply_find(const struct replies *r, const uint8_t *key,
			       const char *client, int64_t seq)
{
	for (int i = 0; i < REPLY_SLOTS; i++)
		if (r->slot[i].seq == seq && r->slot[i].client[0] &&
		    strcmp(r->slot[i].client, client) == 0 &&
		    memcmp(r->slot[i].key, key, SEAL_KEY_BYTES) == 0)
			return &r->slot[i];
	return NULL;
}

static void reply_clear(struct reply *one)
{
	free(one->reason);
	free(one->body);
	*one = (struct reply) { .seq = 0 };
}

void reply_expect(struct replies *r, const struct jobs_lcm_command *c)
{
	struct reply *one = &r->slot[r->next];

	r->next = (r->next + 1) % REPLY_SLOTS;
	reply_clear(one);
	snprintf(one->client, sizeof(one->client), "%s", c->client);
	memcpy(one->key, c->key, sizeof(one->key));
	one->seq = c->seq;
}

void reply_keep(struct replies *r, const struct jobs_lcm_ack *a)
{
	const struct reply *found = reply_find(r, a->key, a->client,
						a->seq);
	struct reply *one;

	if (!found)
		return;
	one = &r->slot[found - r->slot];
	one->done = true;
	one->code = a->code;
	free(one->reason);
	free(one->body);
	one->reason = strdup(a->reason ? a->reason : "");
	one->body = strdup(a->body ? a->body : "");
}

void reply_forget(struct replies *r, const struct jobs_lcm_command *c)
{
	const struct reply *found = reply_find(r, c->key, c->client, c->seq);

	if (found)
		reply_clear(&r->slot[found - r->slot]);
}

void reply_fini(struct replies *r)
{
	for (int i = 0; i < REPLY_SLOTS; i++)
		reply_clear(&r->slot[i]);
}
