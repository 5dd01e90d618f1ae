/* SPDX-License-Identifier: Apache-2.0 */
/* store_turn.c - the order of the queue, and lines of a job's text */
#include "store_turn.h"
#include "plain.h"
#include "store_sql.h"
#include "store_text.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define LINE_MAX	256		/* of a line that is shown, with its
					 * NUL */
#define TEXT_MAX	12000
#define SHORT_MAX	(4 << 20)	/* longer texts are not shown */

static int set_turn(struct store *s, uint32_t n, int64_t turn)
{
	const int err = store_do(s, STORE_KEEP, "UPDATE job SET turn=? WHERE "
				 "n=?", "iI", turn, (int64_t)n);

	return err < 0 ? err : 0;
}

/* By the index of the order, which has those that were interrupted, too. */
#define NEIGHBOUR(THAN, ORDER) \
	"SELECT n, " STORE_TURN ", (SELECT " STORE_TURN " FROM job WHERE n=?1) " \
	"FROM job INDEXED BY job_by_turn WHERE state IN ('queued', " \
	"'interrupted') AND +state='queued' AND loaded=0 AND " STORE_IN_QUEUE \
	THAN "(SELECT " STORE_IN_QUEUE " FROM job WHERE n=?1) " \
	"ORDER BY " STORE_IN_QUEUE ORDER " LIMIT 1"

int store_move(struct store *s, uint32_t n, bool ahead)
{
	int64_t theirs, mine;
	uint32_t other;
	int err;
	sqlite3_stmt *q = ahead ?
		store_ask(s, &err, NEIGHBOUR(" < ", " DESC"), "i", (int64_t)n) :
		store_ask(s, &err, NEIGHBOUR(" > ", ""), "i", (int64_t)n);

	if (!q)
		return err;
	other = (uint32_t)sqlite3_column_int64(q, 0);
	theirs = sqlite3_column_int64(q, 1);
	mine = sqlite3_column_int64(q, 2);
	sqlite3_finalize(q);
	err = set_turn(s, n, theirs);
	return err ? err : set_turn(s, other, mine);
}

static const char *next_line(const char *at, const char *end)
{
	const char *newline = memchr(at, '\n', (size_t)(end - at));

	return newline ? newline + 1 : end;
}

/* Write one line as it may be shown.  Return: its bytes. */
static size_t put_line(char *to, const char *at, const char *next)
{
	char line[LINE_MAX];
	size_t n = 0;

	for (; at < next && *at != '\n' && *at != '\r' && n + 1 < LINE_MAX;
	     at++)
		line[n++] = (char)(*at == '\t' || *at == '\0' ? ' ' : *at);
	line[n] = '\0';
	plain_copy(to, LINE_MAX, line);
	n = strlen(to);
	to[n] = '\n';
	return n + 1;
}

static char *as_json(struct store *s, uint32_t first, const char *text)
{
	char *json = NULL;
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT json_object('first', ?, "
				    "'text', ?)", "is", (int64_t)first, text);

	if (q)
		json = strdup((const char *)sqlite3_column_text(q, 0));
	sqlite3_finalize(q);
	return json;
}

/* A long text would be read as a whole; that would take too long. */
static bool is_short(struct store *s, uint32_t n)
{
	char path[STORE_TEXT_PATH_MAX];
	struct stat st;

	if (store_text_file(s, n, path) == 0)
		return stat(path, &st) == 0 && st.st_size <= SHORT_MAX;
	return store_number_of(s, INT64_MAX, "SELECT length(text) FROM text "
			       "WHERE n=?", "i", (int64_t)n) <= SHORT_MAX;
}

char *store_lines(struct store *s, uint32_t n, uint32_t first)
{
	char out[TEXT_MAX + LINE_MAX + 1], *text;
	const char *at, *end;
	size_t bytes, put = 0;
	char *json = NULL;

	if (!is_short(s, n) || store_text(s, n, &text, &bytes) < 0)
		return NULL;
	at = text;
	end = text + bytes;
	for (uint32_t i = 1; i < first && at < end; i++)
		at = next_line(at, end);
	for (int i = 0; i < STORE_LINES && at < end && put < TEXT_MAX; i++) {
		const char *next = next_line(at, end);

		put += put_line(out + put, at, next);
		at = next;
	}
	out[put] = '\0';
	if (put > 0)
		json = as_json(s, first, out);
	free(text);
	return json;
}
