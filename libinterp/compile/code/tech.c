/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech.c - conditions: called by C120 E001 S100, defined by E001= and SC0100=,
 * and called one after the other by G120
 */
#include "code/number.h"
#include "code/reader.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -- Called --------------------------------------------------------------- */

static struct nc_defined *defined_of(const struct nc_reader *r, char letter,
				     uint32_t number)
{
	struct nc_defined *d = r->defined;

	while (d && !(d->letter == letter && d->number == number))
		d = d->next;
	return d;
}

static int refuse_unknown(struct nc_reader *r, char letter, uint32_t number,
			  const uint8_t *at)
{
	char name[16], near[64], wanted[128];

	snprintf(wanted, sizeof(wanted), "a condition of the technology table; "
		 "the nearest are %s", interp_tech_near(r->o->tech, letter,
		 number, near, sizeof(near)));
	return nc_refuse(r, at, wanted, "%s, which is not in the technology "
			 "table", interp_tech_name(letter, number, name,
						   sizeof(name)));
}

/* It would cut with the values of another condition. */
static int refuse_empty(struct nc_reader *r, const struct nc_defined *d,
			const uint8_t *at)
{
	char name[16], wanted[160];

	interp_tech_name(d->letter, d->number, name, sizeof(name));
	snprintf(wanted, sizeof(wanted), "a technology table with a line "
		 "inline %c, which says what each of them means, or with a row "
		 "%s", d->letter, name);
	return nc_refuse(r, at, wanted, "%s, which the program defines by "
			 "numbers that mean nothing here", name);
}

int nc_call_condition(struct nc_reader *r, char letter, uint32_t number,
		      const uint8_t *at)
{
	const struct nc_defined *d = defined_of(r, letter, number);
	const struct interp_tech_row *row = NULL;

	if (d && d->empty)
		return refuse_empty(r, d, at);
	if (!d && r->o->tech) {
		row = interp_tech_row(r->o->tech, letter, number);
		if (!row)
			return refuse_unknown(r, letter, number, at);
	}
	r->word.cond_letter = letter;
	r->word.cond_number = number;
	r->word.tech = d ? &d->tech : row ? &row->tech : NULL;
	return 0;
}

/* -- Defined -------------------------------------------------------------- */

static bool has_columns(const struct nc_reader *r, char letter)
{
	return r->o->tech && interp_tech_inline(r->o->tech, letter)->ncolumns;
}

/* Begin with what the table has of it; the definition replaces values of
 * that. */
static void begin_definition(const struct nc_reader *r, struct nc_defined *d)
{
	const struct interp_tech_row *row = r->o->tech ?
		interp_tech_row(r->o->tech, d->letter, d->number) : NULL;

	interp_tech_clear(&d->tech);
	d->empty = !row && !has_columns(r, d->letter);
	if (row)
		d->tech = row->tech;
}

static int take_column(struct nc_reader *r, struct nc_defined *d,
		       uint32_t column, double value, const uint8_t *at)
{
	const struct interp_tech_inline *in;
	char wanted[128];
	int id;

	if (!r->o->tech)
		return 0;
	in = interp_tech_inline(r->o->tech, d->letter);
	if (column >= in->ncolumns || in->column[column].id < 0)
		return 0;
	id = in->column[column].id;
	value *= in->column[column].factor;
	if (interp_tech_value_ok((enum interp_tech_id)id, value)) {
		d->tech.v[id] = value;
		return 0;
	}
	interp_tech_range((enum interp_tech_id)id, wanted, sizeof(wanted));
	return nc_refuse(r, at, wanted, "column %u of a definition, %s %g",
			 column + 1, interp_tech_field[id].name, value);
}

int nc_refuse_undelivered(struct nc_reader *r, const struct interp_tech *t,
			  const char *who, const uint8_t *at)
{
	const struct interp_delivery *d = r->o->delivery;
	struct interp_diag why;

	if (!d || d->takes(d->arg, t, who, &why) == 0)
		return 0;
	return nc_refuse(r, at, why.wanted, "%s", why.found);
}

static int check_definition(struct nc_reader *r, const struct nc_defined *d,
			    uint32_t columns, const uint8_t *at)
{
	const struct interp_tech_inline *in;
	struct interp_diag why;
	char name[16];

	if (columns == 0)
		return nc_refuse(r, at, "numbers behind the =, as in "
				 "E001= 60 10 25",
				 "a definition without a number");
	if (!r->o->tech)
		return 0;
	in = interp_tech_inline(r->o->tech, d->letter);
	if (in->ncolumns && in->ncolumns != columns)
		return nc_refuse(r, at, "as many numbers as the technology "
				 "table's inline line has columns",
				 "a definition of %u numbers, not %u", columns,
				 in->ncolumns);
	if (r->o->machine_tech &&
	    interp_tech_fits(&d->tech, r->o->machine_tech,
			     interp_tech_name(d->letter, d->number, name,
					      sizeof(name)), &why))
		return nc_refuse(r, at, why.wanted, "%s", why.found);
	return nc_refuse_undelivered(r, &d->tech,
				     interp_tech_name(d->letter, d->number,
						      name, sizeof(name)), at);
}

/* Conditions that were called before keep the values with which they were
 * called. */
static int keep_definition(struct nc_reader *r, const struct nc_defined *d,
			   const uint8_t *at)
{
	const struct nc_defined *was = defined_of(r, d->letter, d->number);
	struct nc_defined *one;

	if (was && memcmp(&was->tech, &d->tech, sizeof(d->tech)) == 0)
		return 0;
	if (r->ndefined == NC_NDEFINED_MAX)
		return nc_refuse(r, at, "at most 256 of them", "a definition "
				 "too many");
	one = malloc(sizeof(*one));
	if (!one)
		return nc_refuse(r, at, "more memory", "no memory for a "
				 "definition");
	*one = *d;
	one->next = r->defined;
	r->defined = one;
	r->ndefined++;
	return 0;
}

const uint8_t *nc_define_condition(struct nc_reader *r, const uint8_t *at,
				   const uint8_t *p, uint32_t number)
{
	struct nc_defined d = { .letter = (char)(*at & 0xdf),
				.number = number };
	const uint8_t *next;
	uint32_t n = 0;
	double v;

	begin_definition(r, &d);
	for (; (next = nc_number(p, r->stop, &v)); n++) {
		if (take_column(r, &d, n, v, nc_skip_blanks(p, r->stop)))
			return NULL;
		p = next;
	}
	if (check_definition(r, &d, n, at) || keep_definition(r, &d, at))
		return NULL;
	if (!has_columns(r, d.letter))
		nc_note_columns(r, d.letter, d.number);
	r->word_at = at;
	return p;
}

void nc_forget_conditions(struct nc_reader *r)
{
	while (r->defined) {
		struct nc_defined *next = r->defined->next;

		free(r->defined);
		r->defined = next;
	}
}

/* -- One after the other
 * ---------------------------------------------------- */

/* The sequence that P names, or NULL. */
static const struct interp_tech_sequence *
sequence_of(struct nc_reader *r, const uint8_t *at)
{
	const struct interp_tech_table *t = r->o->tech;
	const struct interp_tech_sequence *s = NULL;
	const double p = nc_has(r, NC_P) ? r->block.value[NC_P] : 0;

	if (!t) {
		nc_refuse(r, at, "a technology table: [tech] table in the "
			  "machine file, or edmsim --tech",
			  "G120 without a technology table");
		return NULL;
	}
	if (p >= 0 && p == floor(p))
		s = interp_tech_sequence(t, (uint32_t)p);
	if (!s)
		nc_refuse(r, nc_has(r, NC_P) ? r->block.at[NC_P] : at,
			  t->nsequences ? "P with the number of a sequence of "
			  "the technology table, as P1 for Q1" :
			  "a sequence line in the technology table",
			  nc_has(r, NC_P) ? "G120 with P%g" :
			  "G120 without P", p);
	return s;
}

/* Straight on, up to @short_mm in front of the end. */
static int sink_to(struct nc_reader *r, const double from_mm[INTERP_NAXES],
		   const double end_mm[INTERP_NAXES], double share)
{
	double to_mm[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		to_mm[i] = from_mm[i] + share * (end_mm[i] - from_mm[i]);
	return nc_line_to(r, share < 1 ? to_mm : end_mm, false);
}

/* A condition whose allowance is longer than the way has nothing to do. */
static int sink_by(struct nc_reader *r, const struct interp_tech_sequence *s,
		   const double end_mm[INTERP_NAXES], double way_mm)
{
	const uint8_t *at = r->block.code_at[NC_ONE_SHOT];
	const struct interp_tech_step *last = &s->step[s->nsteps - 1];
	const struct interp_tech *fine =
		&interp_tech_row(r->o->tech, last->letter, last->number)->tech;
	double from_mm[INTERP_NAXES];
	int err = 0;

	memcpy(from_mm, nc_here(r), sizeof(from_mm));
	for (uint32_t i = 0; !err && i < s->nsteps; i++) {
		const struct interp_tech_step *step = &s->step[i];
		const struct interp_tech_row *row =
			interp_tech_row(r->o->tech, step->letter,
					step->number);
		const double short_mm = step == last ? 0 :
			interp_tech_short_of_mm(&row->tech, fine);

		if (short_mm >= way_mm)
			continue;
		err = nc_call_condition(r, step->letter, step->number, at);
		if (!err)
			err = sink_to(r, from_mm, end_mm,
				     1 - short_mm / way_mm);
	}
	return err;
}

int nc_sink(struct nc_reader *r)
{
	const uint8_t *at = r->block.code_at[NC_ONE_SHOT];
	const struct interp_tech_sequence *s = sequence_of(r, at);
	const double *here = nc_here(r);
	double end_mm[INTERP_NAXES], way_mm;

	if (!s)
		return -EINVAL;
	nc_target(r, end_mm);
	way_mm = hypot(hypot(end_mm[INTERP_X] - here[INTERP_X],
			     end_mm[INTERP_Y] - here[INTERP_Y]),
		       end_mm[INTERP_Z] - here[INTERP_Z]);
	if (!(way_mm > 0))
		return nc_refuse(r, at, "the place to sink to, as in "
				 "G120 P1 Z-10", "G120 without a way along X Y "
				 "Z");
	return sink_by(r, s, end_mm, way_mm);
}
