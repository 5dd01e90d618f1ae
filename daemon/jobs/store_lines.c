/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_lines.c - lines of a job's text
 *
 * A long text is a file.  Where its lines are is found once, when it is first
 * asked for, and kept for the next question; then only the part with the lines
 * that are wanted is read.
 */
#include "store_turn.h"
#include "grow.h"
#include "plain.h"
#include "regular.h"
#include "store_sql.h"
#include "store_text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINE_MAX	256		/* of a line that is shown, with its
					 * NUL */
#define TEXT_MAX	12000
#define EVERY		64u		/* lines between two places that are
					 * kept */
#define PIECE		(256u << 10)	/* that is read at once */

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

/* A part of a text, of which so many lines are to be left out. */
struct part {
	char *text;
	size_t bytes;
	uint32_t skip;
};

/* Return: 0; -errno.  Where line 1, 1 + EVERY, ... begin. */
static int find_lines(struct store_lines *l, int fd)
{
	char *piece = malloc(PIECE), *at, *end;
	uint32_t line = 0;
	int64_t from = 0;
	int err = piece && grow_to(&l->at, &l->room, 1, sizeof(*l->at)) == 0 ?
		  0 : -ENOMEM;
	ssize_t n;

	l->n = 0;
	if (err == 0)
		l->at[l->n++] = 0;
	while (err == 0 && (n = pread(fd, piece, PIECE, from)) > 0) {
		for (at = piece, end = at + n; err == 0 &&
		     (at = memchr(at, '\n', (size_t)(end - at))); at++) {
			if (++line % EVERY)
				continue;
			err = grow_to(&l->at, &l->room, l->n + 1,
				      sizeof(*l->at));
			if (err == 0)
				l->at[l->n++] = from + (at + 1 - piece);
		}
		from += n;
	}
	free(piece);
	return err;
}

/* The part of a file that begins with line @first - @ret_skip. */
static int read_part(struct store_lines *l, const char *path, uint32_t first,
		     struct part *ret)
{
	const int fd = regular_open(path, O_RDONLY, 0);
	const uint32_t i = (first - 1) / EVERY;
	ssize_t n = -1;
	int err = fd < 0 ? fd : 0;

	if (err == 0 && strcmp(l->path, path) != 0) {
		*l->path = '\0';
		err = find_lines(l, fd);
		if (err == 0)
			snprintf(l->path, sizeof(l->path), "%s", path);
	}
	ret->skip = (first - 1) % EVERY;
	ret->text = malloc(PIECE);
	if (err == 0 && i < l->n && ret->text)
		n = pread(fd, ret->text, PIECE, l->at[i]);
	ret->bytes = n > 0 ? (size_t)n : 0;
	if (fd >= 0)
		close(fd);
	return err ? err : n > 0 ? 0 : -ENOENT;
}

static int find_part(struct store *s, uint32_t n, uint32_t first,
		     struct part *ret)
{
	char path[STORE_TEXT_PATH_MAX];

	*ret = (struct part) { .skip = first - 1 };
	return store_text_file(s, n, path) == 0 ?
	       read_part(&s->lines, path, first, ret) :
	       store_text(s, n, &ret->text, &ret->bytes);
}

char *store_lines(struct store *s, uint32_t n, uint32_t first)
{
	char out[TEXT_MAX + LINE_MAX + 1];
	const char *at, *end;
	char *json = NULL;
	size_t put = 0;
	struct part p;

	if (find_part(s, n, first, &p) < 0) {
		free(p.text);
		return NULL;
	}
	at = p.text;
	end = p.text + p.bytes;
	for (uint32_t i = 0; i < p.skip && at < end; i++)
		at = next_line(at, end);
	for (int i = 0; i < STORE_LINES && at < end && put < TEXT_MAX; i++) {
		const char *next = next_line(at, end);

		put += put_line(out + put, at, next);
		at = next;
	}
	out[put] = '\0';
	if (put > 0)
		json = as_json(s, first, out);
	free(p.text);
	return json;
}

void store_lines_fini(struct store_lines *l)
{
	free(l->at);
	*l = (struct store_lines) { .n = 0 };
}
