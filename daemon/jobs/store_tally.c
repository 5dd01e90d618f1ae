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
	return store_do(s, STORE_MAY_MISS, "INSERT OR IGNORE INTO fault VALUES"
			"(?, ?, ?, ?, ?)", "iisid", (int64_t)n, f->time_ns,
			f->fault, (int64_t)f->line, f->place_mm);
}

/* edmd tells its events again after a restart; their time shows that they are
 * the same. */
int store_calls(struct store *s, uint32_t n, const char *json)
{
	return store_do(s, STORE_MAY_MISS, "INSERT OR IGNORE INTO change "
			"SELECT ?1, value->>0, 'condition', "
			"coalesce(lag(value->>1) OVER (ORDER BY key), "
			"(SELECT now FROM change WHERE n=?1 AND "
			"what='condition' AND time_ns<value->>0 "
			"ORDER BY time_ns DESC LIMIT 1)), value->>1, "
			"value->>2 FROM json_each(?2)", "is", (int64_t)n, json);
}
