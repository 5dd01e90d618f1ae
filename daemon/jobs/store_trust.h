/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_trust.h - keys, and commands that were handed over, in the store
 *
 * A command is written before it is handed to edmd. So a service that was
 * killed in between knows afterwards what it may have handed over. This need
 * not reach the disk: after a power cut there is no edmd that could have done
 * it.
 *
 * Threads: one. Calls return the same values as those of store.h.
 */
#ifndef JOBS_STORE_TRUST_H
#define JOBS_STORE_TRUST_H

#include "store.h"
#include "trust.h"

/** store_keys_load() - the keys that were added, into @t. */
int store_keys_load(struct store *s, struct trust *t);

/** store_key_add(), store_key_remove() - by name. */
int store_key_add(struct store *s, const struct trust_key *k, int64_t now_us);
int store_key_remove(struct store *s, const char *name);

/* A command of a client that does something. */
struct store_act {
	uint64_t id;
	uint32_t instance;		/* of the edmd it is meant for */
	uint64_t born;			/* of that one's status */
	const char *verb, *by;		/* for people; not read back */
	int64_t now_us;
	/* Read back: */
	bool answered;
	int code;
	char reason[640];		/* as long as one may be: verbs.c */
};

/** store_act_find() - Return: 0 or -ENOENT. */
int store_act_find(struct store *s, uint64_t id, struct store_act *ret);

/** store_act_begin() - the act is about to be done. */
int store_act_begin(struct store *s, const struct store_act *a);

/** store_act_end() - what was answered to it. */
int store_act_end(struct store *s, uint64_t id, int code, const char *reason);

#endif /* JOBS_STORE_TRUST_H */
