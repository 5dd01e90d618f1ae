/* SPDX-License-Identifier: Apache-2.0 */
/* store_tech.c - the versions of the technology table, in the store */
#include "store_tech.h"

#include "jobs.h"
#include "store_sql.h"

#include <string.h>

int store_tech_add(struct store *s, const char *text, const char *by,
		   const char *what)
{
	return store_do(s, STORE_MUST, "INSERT INTO tech(utime, by, what, text)"
			" SELECT ?, ?, ?, ? WHERE ? IS NOT (SELECT text FROM "
			"tech ORDER BY n DESC LIMIT 1)", "issss",
			jobs_utime(), by, what, text, text);
}

char *store_tech_text(struct store *s, uint32_t n)
{
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT text FROM tech WHERE n=?",
				    "i", (int64_t)n);
	char *text = q ? strdup((const char *)sqlite3_column_text(q, 0)) : NULL;

	sqlite3_finalize(q);
	return text;
}

char *store_tech_json(struct store *s)
{
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT json_group_array(json(r)) "
		"FROM (SELECT json_object('n', n, 'utime', utime, 'by', by, "
		"'what', substr(what, 1, 120)) AS r FROM tech ORDER BY n DESC "
		"LIMIT 100)", "");
	char *text = q ? strdup((const char *)sqlite3_column_text(q, 0)) : NULL;

	sqlite3_finalize(q);
	return text;
}
