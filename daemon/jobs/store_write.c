/* SPDX-License-Identifier: Apache-2.0 */
/* store_write.c - statements with their values, and lists of them */
#include "store_sql.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define KEPT_MAX	4096

struct store_write *store_write_new(const char *sql, enum store_keep keep,
				     const char *kinds, va_list ap)
{
	struct store_write *w = calloc(1, sizeof(*w));
	const char *text;

	/* If there is no memory for a row, there is none for the service. */
	if (!w)
		abort();
	w->sql = sql;
	w->keep = keep;
	w->key = -1;
	for (; *kinds; kinds++, w->n++) {
		struct store_value *v = &w->v[w->n];

		v->kind = (char)tolower((unsigned char)*kinds);
		if (v->kind != *kinds)
			w->key = w->n;
		if (v->kind == 'i') {
			v->i = va_arg(ap, int64_t);
		} else if (v->kind == 'd') {
			v->d = va_arg(ap, double);
		} else {
			text = va_arg(ap, const char *);
			v->s = text ? strdup(text) : NULL;
		}
	}
	return w;
}

void store_write_free(struct store_write *w)
{
	for (int i = 0; i < w->n; i++)
		if (w->v[i].kind == 's')
			free(w->v[i].s);
	free(w);
}

struct store_write *store_writes_pop(struct store_writes *l)
{
	struct store_write *w = l->first;

	if (!w)
		return NULL;
	l->first = w->next;
	if (!l->first)
		l->last = &l->first;
	l->n--;
	return w;
}

void store_writes_free(struct store_writes *l)
{
	struct store_write *w;

	while ((w = store_writes_pop(l)))
		store_write_free(w);
}

void store_writes_add(struct store_writes *l, struct store_write *w)
{
	if (!l->last)
		l->last = &l->first;
	w->next = NULL;
	*l->last = w;
	l->last = &w->next;
	l->n++;
}

void store_writes_move(struct store_writes *to, struct store_writes *from)
{
	struct store_write *w;

	while ((w = store_writes_pop(from)))
		store_writes_add(to, w);
}

static void writes_take_out(struct store_writes *l, struct store_write **at)
{
	struct store_write *w = *at;

	*at = w->next;
	if (l->last == &w->next)
		l->last = at;
	l->n--;
	store_write_free(w);
}

static bool same_row(const struct store_write *a, const struct store_write *b)
{
	const struct store_value *x, *y;

	if (a->sql != b->sql || a->key < 0)
		return false;
	x = &a->v[a->key];
	y = &b->v[b->key];
	return x->kind == 'i' ? x->i == y->i :
	       x->s && y->s && strcmp(x->s, y->s) == 0;
}

/* The oldest entry that may be dropped makes room. */
static void keep_room(struct store *s)
{
	struct store_write **at = &s->kept.first;

	while (*at && (*at)->keep < STORE_MAY_GO)
		at = &(*at)->next;
	if (!*at)
		return;
	writes_take_out(&s->kept, at);
	s->spared += s->over;
	s->dropped += !s->over;
}

void store_write_keep(struct store *s, struct store_write *w)
{
	for (struct store_write **at = &s->kept.first; *at;) {
		if (same_row(*at, w))
			writes_take_out(&s->kept, at);
		else
			at = &(*at)->next;
	}
	if (s->kept.n + s->brought.n >= KEPT_MAX)
		keep_room(s);
	store_writes_add(&s->kept, w);
}

static void bind_all(sqlite3_stmt *q, const struct store_write *w)
{
	for (int i = 0; i < w->n; i++) {
		const struct store_value *v = &w->v[i];

		if (v->kind == 'i')
			sqlite3_bind_int64(q, i + 1, v->i);
		else if (v->kind == 'd')
			sqlite3_bind_double(q, i + 1, v->d);
		else
			sqlite3_bind_text(q, i + 1, v->s, -1, SQLITE_TRANSIENT);
	}
}

int store_write_begin(sqlite3 *db, const struct store_write *w,
		      sqlite3_stmt **ret)
{
	int rc = sqlite3_prepare_v2(db, w->sql, -1, ret, NULL);

	if (rc != SQLITE_OK)
		return rc;
	bind_all(*ret, w);
	return sqlite3_step(*ret);
}

int store_write_do(sqlite3 *db, const struct store_write *w)
{
	sqlite3_stmt *q = NULL;
	int rc = store_write_begin(db, w, &q);

	sqlite3_finalize(q);
	return rc == SQLITE_ROW || rc == SQLITE_DONE ? SQLITE_OK : rc;
}
