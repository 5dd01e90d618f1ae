/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reply.h - a repeated command gets the same answer and is not done again
 *
 * The last commands are remembered by key, client and seq, with their answers.
 *
 * Threads: one object belongs to one thread.
 */
#ifndef JOBS_REPLY_H
#define JOBS_REPLY_H

#include "lcm.h"

#define REPLY_SLOTS	128

struct reply {
	uint8_t key[SEAL_KEY_BYTES];
	char client[JOBS_LCM_CLIENT_MAX];	/* "": free */
	int64_t seq;
	bool done;
	int code;
	char *reason, *body;
};

struct replies {
	struct reply slot[REPLY_SLOTS];
	unsigned int next;
};

/* Who asked, until the answer is known. */
struct asker {
	uint8_t key[SEAL_KEY_BYTES];
	char client[JOBS_LCM_CLIENT_MAX];
	int64_t seq;
	uint64_t act;
};

/** reply_asker_keep() - remember the sender of @c. */
void reply_asker_keep(struct asker *a, const struct jobs_lcm_command *c);

/** reply_asker_command() - as much of the command as an answer needs; it
 *  points into @a. */
struct jobs_lcm_command reply_asker_command(const struct asker *a);

/** reply_asker_is() - is @c this command, or a repeat of it? */
bool reply_asker_is(const struct asker *a, const struct jobs_lcm_command *c);

/** reply_find() - what is remembered of this command; NULL if it is new. */
const struct reply *reply_find(const struct replies *r, const uint8_t *key,
			       const char *client, int64_t seq);

/** reply_expect() - this command is under way. */
void reply_expect(struct replies *r, const struct jobs_lcm_command *c);

/** reply_keep() - this command has been answered. */
void reply_keep(struct replies *r, const struct jobs_lcm_ack *a);

/** reply_forget() - take its next repeat as a new command. */
void reply_forget(struct replies *r, const struct jobs_lcm_command *c);

/** reply_fini() - free everything. */
void reply_fini(struct replies *r);

#endif /* JOBS_REPLY_H */
