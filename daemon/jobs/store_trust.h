/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_trust.h - keys, and commands handed over, in the store
 *
 * A command is written before it is handed to edmd, so that a service that is
 * killed in between knows afterwards what it may have handed over.  That need
 * not reach the disk: after a power cut there is no edmd that could have done
 * it.
 *
 * Threads: one.  Calls return 0 or -EIO unless they say more.
 */
#ifndef JOBS_STORE_TRUST_H
#define JOBS_STORE_TRUST_H

#include "store.h"
#include "trust.h"

/** store_trust_init() - make the tables.  Startup only. */
int store_trust_init(struct store *s);

/** store_keys_load() - the keys that were added, into @t. */
int store_keys_load(struct store *s, struct trust *t);

/** store_key_add(), store_key_remove() - by name. */
int store_key_add(struct store *s, const struct trust_key *k, int64_t now_us);
int store_key_remove(struct store *s, const char *name);

#endif /* JOBS_STORE_TRUST_H */
