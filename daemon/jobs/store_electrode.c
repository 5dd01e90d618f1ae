/* SPDX-License-Identifier: Apache-2.0 */
/* store_electrode.c - the table of electrodes, in the store */
#include "store_electrode.h"
#include "store_sql.h"

#include "plain.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const state_names[ELECTRODE_NSTATES] = {
	[ELECTRODE_THERE]	= "there",
	[ELECTRODE_WORN]	= "worn",
	[ELECTRODE_ABSENT]	= "absent",
};

const char *store_electrode_state_name(enum store_electrode_state s)
{
	return state_names[s];
}

bool store_electrode_ok(double n)
{
	return n == floor(n) && n >= 1 && n <= STORE_ELECTRODE_NUMBER_MAX &&
	       !(n >= STORE_ELECTRODE_PUMPS_MIN &&
		 n <= STORE_ELECTRODE_PUMPS_MAX);
}

#define COLUMNS	"n, name, material, note, undersize_mm, length_mm, wear_mm, " \
		"spark_s, life_mm, life_s, state, x_mm, y_mm, c_deg"

static void copy(sqlite3_stmt *q, int i, char *to, size_t size)
{
	const unsigned char *from = sqlite3_column_text(q, i);

	plain_copy(to, size, from ? (const char *)from : "");
}

static enum store_electrode_state state_of(const unsigned char *name)
{
	for (int i = 0; i < ELECTRODE_NSTATES; i++)
		if (name && strcmp((const char *)name, state_names[i]) == 0)
			return (enum store_electrode_state)i;
	/* Of a state that nobody knows, nothing good is assumed. */
	return ELECTRODE_ABSENT;
}

static void get(sqlite3_stmt *q, struct store_electrode *ret)
{
	ret->n = (uint32_t)sqlite3_column_int64(q, 0);
	copy(q, 1, ret->name, sizeof(ret->name));
	copy(q, 2, ret->material, sizeof(ret->material));
	copy(q, 3, ret->note, sizeof(ret->note));
	ret->undersize_mm = sqlite3_column_double(q, 4);
	ret->length_mm = sqlite3_column_double(q, 5);
	ret->wear_mm = sqlite3_column_double(q, 6);
	ret->spark_s = sqlite3_column_double(q, 7);
	ret->life_mm = sqlite3_column_double(q, 8);
	ret->life_s = sqlite3_column_double(q, 9);
	ret->state = state_of(sqlite3_column_text(q, 10));
	ret->x_mm = sqlite3_column_double(q, 11);
	ret->y_mm = sqlite3_column_double(q, 12);
	ret->c_deg = sqlite3_column_double(q, 13);
}

int store_electrode_find(struct store *s, uint32_t n,
			 struct store_electrode *ret)
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT " COLUMNS " FROM "
				    "electrode WHERE n=?", "i", (int64_t)n);

	if (!q)
		return err;
	get(q, ret);
	sqlite3_finalize(q);
	return 0;
}

int store_electrode_put(struct store *s, const struct store_electrode *e)
{
	return store_do(s, STORE_KEEP, "INSERT OR REPLACE INTO electrode("
			COLUMNS ") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
			"?, ?)", "Isssddddddsddd", (int64_t)e->n, e->name,
			e->material, e->note, e->undersize_mm, e->length_mm,
			e->wear_mm,
			e->spark_s, e->life_mm, e->life_s,
			state_names[e->state], e->x_mm, e->y_mm, e->c_deg);
}

void store_electrode_by(const struct store_electrode *e,
			double ret[INTERP_NAXES])
{
	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	ret[INTERP_X] = e->x_mm;
	ret[INTERP_Y] = e->y_mm;
	ret[INTERP_Z] = e->length_mm - e->wear_mm;
	ret[INTERP_C] = e->c_deg;
}

int store_electrode_remove(struct store *s, uint32_t n)
{
	return store_do(s, STORE_KEEP, "DELETE FROM electrode WHERE n=?", "I",
			(int64_t)n);
}

size_t store_electrodes(struct store *s, struct store_electrode *to,
			size_t room)
{
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT " COLUMNS " FROM "
				    "electrode ORDER BY n", "");
	size_t n = 0;

	if (!q)
		return 0;
	do
		get(q, &to[n++]);
	while (n < room && sqlite3_step(q) == SQLITE_ROW);
	sqlite3_finalize(q);
	return n;
}

/* What is left: the smaller share of the two limits, as a number 0 ... 1. */
#define LEFT	"max(0, min(iif(life_mm>0, 1 - wear_mm/life_mm, 1), " \
		"iif(life_s>0, 1 - spark_s/life_s, 1)))"

char *store_electrodes_json(struct store *s, uint32_t after)
{
	/* A name of 31 bytes may be 186 as JSON: 60 rows always fit. */
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT json_group_array(json(r)) "
		"FROM (SELECT json_object('n', n, 'name', name, 'material', "
		"material, 'undersize_mm', undersize_mm, 'length_mm', "
		"length_mm, 'wear_mm', wear_mm, 'x_mm', x_mm, 'y_mm', y_mm, "
		"'c_deg', c_deg, 'spark_s', spark_s, 'life_mm', "
		"life_mm, 'life_s', life_s, 'left', " LEFT ", 'state', state, "
		"'held', json(iif(n=(SELECT value FROM number WHERE "
		"key='electrode'), 'true', 'false')), 'note', note) AS r FROM "
		"electrode WHERE n>? ORDER BY n LIMIT 60)", "i",
		(int64_t)after);
	char *text = q ? strdup((const char *)sqlite3_column_text(q, 0)) : NULL;

	sqlite3_finalize(q);
	return text;
}

/* -- How jobs used them ---------------------------------------------------- */

#define WORN_COLUMNS	"job, part, electrode, offset_mm, before_mm, " \
			"after_mm, before_s, after_s, known, x_mm, y_mm, c_deg"

static int worn_put(struct store *s, const struct store_worn *w,
		    enum store_keep keep)
{
	return store_do(s, keep, "INSERT OR REPLACE INTO worn(" WORN_COLUMNS
			") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
			"iiidddddiddd",
			(int64_t)w->job, (int64_t)w->part,
			(int64_t)w->electrode, w->by[INTERP_Z], w->before_mm,
			w->after_mm, w->before_s, w->after_s,
			(int64_t)w->known, w->by[INTERP_X], w->by[INTERP_Y],
			w->by[INTERP_C]);
}

int store_worn_add(struct store *s, const struct store_worn *w)
{
	return worn_put(s, w, STORE_MUST);
}

int store_worn_put(struct store *s, const struct store_worn *w)
{
	return worn_put(s, w, STORE_KEEP);
}

static void worn_get(sqlite3_stmt *q, struct store_worn *ret)
{
	ret->job = (uint32_t)sqlite3_column_int64(q, 0);
	ret->part = (uint32_t)sqlite3_column_int64(q, 1);
	ret->electrode = (uint32_t)sqlite3_column_int64(q, 2);
	memset(ret->by, 0, sizeof(ret->by));
	ret->by[INTERP_Z] = sqlite3_column_double(q, 3);
	ret->before_mm = sqlite3_column_double(q, 4);
	ret->after_mm = sqlite3_column_double(q, 5);
	ret->before_s = sqlite3_column_double(q, 6);
	ret->after_s = sqlite3_column_double(q, 7);
	ret->known = sqlite3_column_int(q, 8) != 0;
	ret->by[INTERP_X] = sqlite3_column_double(q, 9);
	ret->by[INTERP_Y] = sqlite3_column_double(q, 10);
	ret->by[INTERP_C] = sqlite3_column_double(q, 11);
}

uint32_t store_worn_next(struct store *s, uint32_t n)
{
	return (uint32_t)store_number_of(s, 0,
					 "SELECT ifnull(max(part) + 1, 0) "
					 "FROM worn WHERE job=?",
					 "i", (int64_t)n);
}

int store_worn_drop(struct store *s, uint32_t n)
{
	return store_do(s, STORE_KEEP, "DELETE FROM worn WHERE job=? AND "
			"after_s<0", "i", (int64_t)n);
}

size_t store_worn_list(struct store *s, uint32_t n, uint32_t from,
		       struct store_worn *to, size_t room)
{
	sqlite3_stmt *q = store_ask(s, NULL, "SELECT " WORN_COLUMNS " FROM "
				    "worn WHERE job=? AND part>=? ORDER BY "
				    "part", "ii", (int64_t)n, (int64_t)from);
	size_t k = 0;

	if (!q)
		return 0;
	do
		worn_get(q, &to[k++]);
	while (k < room && sqlite3_step(q) == SQLITE_ROW);
	sqlite3_finalize(q);
	return k;
}
