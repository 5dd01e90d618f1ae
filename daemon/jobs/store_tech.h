/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_tech.h - the versions of the technology table, in the store
 *
 * Each text that was saved, and the one that was there before the first, has a
 * number, from 1.  Nothing is ever changed in it.
 *
 * Threads: one.  Calls return the same values as those of store.h.
 */
#ifndef JOBS_STORE_TECH_H
#define JOBS_STORE_TECH_H

#include "store.h"

/** store_tech_add() - keep @text, if it is not the last version; on the disk,
 *  or refused.  @by: who saved it; @what: what was changed. */
int store_tech_add(struct store *s, const char *text, const char *by,
		   const char *what);

/** store_tech_text() - version @n; to be freed.  NULL: there is none. */
char *store_tech_text(struct store *s, uint32_t n);

/** store_tech_json() - an array of the last hundred, the newest first; to be
 *  freed.  NULL: the store failed. */
char *store_tech_json(struct store *s);

#endif /* JOBS_STORE_TECH_H */
