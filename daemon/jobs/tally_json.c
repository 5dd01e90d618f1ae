/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tally_json.c - sums and trail of a job as JSON, for the store and for clients
 *
 * In a trail lengths are whole micrometres, because that is short: a point is
 * [x, y, z, place, 1 if it was under power], a spot is [place, line, retracts].
 */
#include "tally.h"
#include "jobs.h"
#include "store_tally.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static json_int_t um(double mm)
{
	return isfinite(mm) && fabs(mm) < 1e9 ? llround(mm * 1e3) : 0;
}

static double mm_of(json_t *row, size_t i)
{
	return (double)json_integer_value(json_array_get(row, i)) / 1e3;
}

/* -- Sums by condition ----------------------------------------------------- */

static json_t *energy_put(double j)
{
	return isfinite(j) ? json_real(j) : json_null();
}

static json_t *row_put(const struct tally_row *r)
{
	const struct tally_sums *s = &r->sums;

	return json_pack("{s:s,s:f,s:f,s:o,s:I,s:I,s:I,s:I}",
			 "condition", r->condition, "job_s", s->job_s,
			 "erode_s", s->erode_s,
			 "energy_j", energy_put(s->energy_j),
			 "jumps", (json_int_t)s->jumps,
			 "retracts", (json_int_t)s->retracts,
			 "shorts", (json_int_t)s->shorts,
			 "arcs", (json_int_t)s->arcs);
}

void tally_write_used(struct jobs *j, const struct tally *t)
{
	json_t *rows = json_array();
	char *text;

	for (uint32_t i = 0; i < t->nrows; i++)
		json_array_append_new(rows, row_put(&t->row[i]));
	text = json_dumps(rows, JSON_COMPACT | JSON_REAL_PRECISION(12));
	if (text)
		store_used_write(j->store, t->n, text);
	free(text);
	json_decref(rows);
}

static uint32_t count_of(json_t *row, const char *key)
{
	return (uint32_t)json_integer_value(json_object_get(row, key));
}

static double real_of(json_t *row, const char *key)
{
	json_t *v = json_object_get(row, key);

	return json_is_number(v) ? json_number_value(v) : NAN;
}

static void row_get(struct tally *t, json_t *row)
{
	const char *name = json_string_value(json_object_get(row, "condition"));
	struct tally_row *r = &t->row[t->nrows++];

	snprintf(r->condition, sizeof(r->condition), "%s", name ? name : "");
	r->sums = (struct tally_sums) {
		.job_s = real_of(row, "job_s"),
		.erode_s = real_of(row, "erode_s"),
		.energy_j = real_of(row, "energy_j"),
		.jumps = count_of(row, "jumps"),
		.retracts = count_of(row, "retracts"),
		.shorts = count_of(row, "shorts"),
		.arcs = count_of(row, "arcs"),
	};
	t->seen.job_s += r->sums.job_s;
	t->seen.erode_s += r->sums.erode_s;
	t->seen.energy_j += r->sums.energy_j;
	t->seen.jumps += r->sums.jumps;
	t->seen.retracts += r->sums.retracts;
	t->seen.shorts += r->sums.shorts;
	t->seen.arcs += r->sums.arcs;
}

static void used_read(struct jobs *j, struct tally *t)
{
	char *text = store_used(j->store, t->n);
	json_t *rows = text ? json_loads(text, 0, NULL) : NULL;
	json_t *row;
	size_t i;

	json_array_foreach(rows, i, row)
		if (i < TALLY_CONDITIONS)
			row_get(t, row);
	json_decref(rows);
	free(text);
}

/* -- Trail ----------------------------------------------------------------- */

static json_t *points_put(const struct tally *t)
{
	json_t *rows = json_array();

	for (uint32_t i = 0; i < t->npoints; i++) {
		const struct tally_point *p = &t->point[i];

		json_array_append_new(rows, json_pack("[I,I,I,I,i]",
			um(p->mm[0]), um(p->mm[1]), um(p->mm[2]),
			um(p->place_mm), p->cut));
	}
	return rows;
}

static json_t *spots_put(const struct tally *t)
{
	json_t *rows = json_array();

	for (int i = 0; i < TALLY_SPOTS; i++) {
		const struct tally_spot *s = &t->spot[i];

		if (s->retracts)
			json_array_append_new(rows, json_pack("[I,I,I]",
				um(s->place_mm), (json_int_t)s->line,
				(json_int_t)s->retracts));
	}
	return rows;
}

void tally_write_trail(struct jobs *j, const struct tally *t)
{
	json_t *all = json_pack("{s:I,s:f,s:f,s:o,s:o}",
				"retracted_ns", (json_int_t)t->retracted_ns,
				"length_mm", t->length_mm,
				"step_mm", t->step_mm,
				"retracts_um", spots_put(t),
				"points_um", points_put(t));
	char *text = all ? json_dumps(all, JSON_COMPACT |
				      JSON_REAL_PRECISION(12)) : NULL;

	if (text)
		store_trail_write(j->store, t->n, text);
	free(text);
	json_decref(all);
}

static void point_get(struct tally *t, json_t *row)
{
	struct tally_point *p = &t->point[t->npoints++];

	for (size_t i = 0; i < 3; i++)
		p->mm[i] = mm_of(row, i);
	p->place_mm = mm_of(row, 3);
	p->cut = json_integer_value(json_array_get(row, 4)) != 0;
}

static void spot_get(struct tally *t, json_t *row)
{
	const double at = mm_of(row, 0) / t->length_mm * TALLY_SPOTS;
	struct tally_spot *s;

	if (!(at >= 0))
		return;
	s = &t->spot[at < TALLY_SPOTS ? (int)at : TALLY_SPOTS - 1];
	s->place_mm = mm_of(row, 0);
	s->line = (uint32_t)json_integer_value(json_array_get(row, 1));
	s->retracts += (uint32_t)json_integer_value(json_array_get(row, 2));
}

static void trail_read(struct jobs *j, struct tally *t)
{
	char *text = store_trail(j->store, t->n);
	json_t *all = text ? json_loads(text, 0, NULL) : NULL, *row;
	size_t i;

	t->retracted_ns = json_integer_value(json_object_get(all,
							     "retracted_ns"));
	t->length_mm = json_number_value(json_object_get(all, "length_mm"));
	t->step_mm = json_number_value(json_object_get(all, "step_mm"));
	json_array_foreach(json_object_get(all, "points_um"), i, row)
		if (i < TALLY_POINTS)
			point_get(t, row);
	json_array_foreach(json_object_get(all, "retracts_um"), i, row)
		spot_get(t, row);
	json_decref(all);
	free(text);
}

void tally_read(struct jobs *j, struct tally *t)
{
	used_read(j, t);
	trail_read(j, t);
}
