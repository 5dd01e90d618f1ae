/* SPDX-License-Identifier: Apache-2.0 */
/* store_tally.c - what a job came to, in the store */
#include "store_tally.h"
#include "store_sql.h"

#include <string.h>

static char *text_of(struct store *s, const char *sql, uint32_t n)
{
	sqlite3_stmt *q = store_ask(s, NULL, sql, "i", (int64_t)n);
	char *text = NULL;

	if (q && sqlite3_column_text(q, 0))
		text = strdup((const char *)sqlite3_column_text(q, 0));
	sqlite3_finalize(q);
	return text;
}

int store_used_write(struct store *s, uint32_t n, const char *json)
{
	return store_do(s, STORE_KEEP, "INSERT OR REPLACE INTO used VALUES"
			"(?, ?)", "Is", (int64_t)n, json);
}

char *store_used(struct store *s, uint32_t n)
{
	return text_of(s, "SELECT conditions FROM used WHERE n=?", n);
}

int store_trail_write(struct store *s, uint32_t n, const char *json)
{
	return store_do(s, STORE_MAY_GO, "INSERT OR REPLACE INTO trail VALUES"
			"(?, ?)", "Is", (int64_t)n, json);
}

char *store_trail(struct store *s, uint32_t n)
{
	return text_of(s, "SELECT trail FROM trail WHERE n=?", n);
}

int store_fault(struct store *s, uint32_t n, const struct store_fault *f)
{
	return store_do(s, STORE_MAY_GO, "INSERT OR IGNORE INTO fault VALUES"
			"(?, ?, ?, ?, ?)", "iisid", (int64_t)n, f->time_ns,
			f->fault, (int64_t)f->line, f->place_mm);
}
