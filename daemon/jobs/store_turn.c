/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_turn.c - whose turn it is in the queue, and lines of a job's text
 */
#include "store_turn.h"
#include "plain.h"
#include "store.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX	256		/* of a line, with its end */
#define TEXT_MAX	12000

static int set_turn(struct store *s, uint32_t n, int64_t turn)
{
	char key[32];

	snprintf(key, sizeof(key), "turn %u", n);
	return store_set_number(s, key, turn);
}

int store_move(struct store *s, uint32_t n, bool ahead)
{
	static const char *const ask[2] = {
		"SELECT n, " STORE_TURN " AS t, (SELECT " STORE_TURN " FROM "
		"job WHERE n=?1) AS mine FROM job WHERE state='queued' AND "
		"loaded=0 AND t > mine ORDER BY t LIMIT 1",
		"SELECT n, " STORE_TURN " AS t, (SELECT " STORE_TURN " FROM "
		"job WHERE n=?1) AS mine FROM job WHERE state='queued' AND "
		"loaded=0 AND t < mine ORDER BY t DESC LIMIT 1",
	};
	sqlite3_stmt *q = NULL;
	int64_t theirs, mine;
	uint32_t other;
	int err = -EIO;

	if (sqlite3_prepare_v2(store_db(s), ask[ahead], -1, &q, NULL) !=
	    SQLITE_OK)
		return -EIO;
	sqlite3_bind_int64(q, 1, n);
	if (sqlite3_step(q) == SQLITE_ROW) {
		other = (uint32_t)sqlite3_column_int64(q, 0);
		theirs = sqlite3_column_int64(q, 1);
		mine = sqlite3_column_int64(q, 2);
		err = set_turn(s, n, theirs);
		if (err == 0)
			err = set_turn(s, other, mine);
	} else {
		err = -ENOENT;
	}
	sqlite3_finalize(q);
	return err;
}

static const char *next_line(const char *at, const char *end)
{
	const char *newline = memchr(at, '\n', (size_t)(end - at));

	return newline ? newline + 1 : end;
}

/* One line as it may be shown.  Return: its bytes. */
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

static char *as_json(struct store *s, uint32_t first, const char *text, int n)
{
	sqlite3_stmt *q = NULL;
	char *json = NULL;

	if (sqlite3_prepare_v2(store_db(s), "SELECT json_object('first', ?, "
			       "'text', ?)", -1, &q, NULL) == SQLITE_OK) {
		sqlite3_bind_int64(q, 1, first);
		sqlite3_bind_text(q, 2, text, n, SQLITE_STATIC);
		if (sqlite3_step(q) == SQLITE_ROW)
			json = strdup((const char *)sqlite3_column_text(q, 0));
	}
	sqlite3_finalize(q);
	return json;
}

char *store_lines(struct store *s, uint32_t n, uint32_t first)
{
	char out[TEXT_MAX + LINE_MAX], *text;
	const char *at, *end;
	size_t bytes, put = 0;
	char *json = NULL;

	if (store_text(s, n, &text, &bytes) < 0)
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
	if (put > 0)
		json = as_json(s, first, out, (int)put);
	free(text);
	return json;
}
