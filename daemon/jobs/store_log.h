/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_log.h - is the log of the database as long as it was?
 *
 * Private to the files store*.c.
 */
#ifndef JOBS_STORE_LOG_H
#define JOBS_STORE_LOG_H

#include <sqlite3.h>
#include <stdint.h>

struct store_log {
	uint32_t frames;		/* that must be there; 0: it is not
					 * known, or all are in the database */
};

/** store_log_look() - before SQLite opens @database. */
void store_log_look(struct store_log *l, const char *database);

/**
 * store_log_check() - is all there of what was written?  To be asked before
 * anything is written; what is there of the log is moved to the database.
 * Return: 0, or -EILSEQ; then the log stays as it is, to be set aside.
 */
int store_log_check(const struct store_log *l, sqlite3 *db);

#endif /* JOBS_STORE_LOG_H */
