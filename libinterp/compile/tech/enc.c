/* SPDX-License-Identifier: Apache-2.0 */
/*
 * enc.c - an .enc text, the erosion tables of SEDM, into a table
 *
 * A row of numbers for each stage, 25 rough to 10 fine, which becomes the
 * condition C of its number:
 *
 *	NR IP P HV GVHI GVLO TON TOF ISO AJD ET CB RAD SPA [VDI VE VW]
 *
 * servo_v is midway between GVLO and GVHI: that is the window to stand in.
 *
 * Not taken: P, for which sign is which electrode is not said; VDI VE VW,
 * which are placeholders there.  HV 0 is "no ignition voltage of its own", ET
 * 0 "no jumps by time".
 */
#include "tech/text.h"

#include <errno.h>
#include <string.h>

#define NOT_TAKEN	(-1)
#define STAGE		(-2)
#define COLUMNS_MIN	14		/* without VDI VE VW */

static const struct {
	const char *name;
	int id;
	bool zero_is_none;
} columns[] = {
	{ "NR", STAGE, false },
	{ "IP", INTERP_TECH_PEAK_A, false },
	{ "P", NOT_TAKEN, false },
	{ "HV", INTERP_TECH_IGNITION_V, true },
	{ "GVHI", INTERP_TECH_WINDOW_HIGH_V, false },
	{ "GVLO", INTERP_TECH_WINDOW_LOW_V, false },
	{ "TON", INTERP_TECH_ON_US, false },
	{ "TOF", INTERP_TECH_OFF_US, false },
	{ "ISO", INTERP_TECH_ISO, false },
	{ "AJD", INTERP_TECH_JUMP_MM, false },
	{ "ET", INTERP_TECH_JUMP_EVERY_S, true },
	{ "CB", INTERP_TECH_ABORT_COUNT, false },
	{ "RAD", INTERP_TECH_ORBIT_MM, false },
	{ "SPA", INTERP_TECH_ORBIT_STEP_DEG, false },
	{ "VDI", NOT_TAKEN, false },
	{ "VE", NOT_TAKEN, false },
	{ "VW", NOT_TAKEN, false },
};

#define NCOLUMNS	(sizeof(columns) / sizeof(columns[0]))

static int take_stage(struct tech_text *t, const struct tech_cell *c,
		      struct interp_tech_row *row)
{
	double n;

	if (!tech_number(c, &n) || !(n >= 0 && n <= 999) ||
	    n != (double)(uint32_t)n)
		return tech_refuse(t, c->at, "a whole number from 0 to 999",
				   "stage '%s'", tech_quote(c).s);
	row->letter = 'C';
	row->number = (uint32_t)n;
	return 0;
}

static int take_cell(struct tech_text *t, const struct tech_cell *c, size_t i,
		     struct interp_tech_row *row)
{
	const int id = columns[i].id;
	double v;

	if (id == STAGE)
		return take_stage(t, c, row);
	if (!tech_number(c, &v))
		return tech_refuse(t, c->at, "a decimal number", "%s '%s'",
				   columns[i].name, tech_quote(c).s);
	if (id == NOT_TAKEN || (columns[i].zero_is_none && v == 0))
		return 0;
	return tech_value(t, c, (enum interp_tech_id)id, &row->tech.v[id]);
}

/* servo_v is the middle of the window. */
static int find_servo_v(struct tech_text *t, struct interp_tech *tech)
{
	const double v = (tech->v[INTERP_TECH_WINDOW_LOW_V] +
			  tech->v[INTERP_TECH_WINDOW_HIGH_V]) / 2;
	char wanted[80];

	tech->v[INTERP_TECH_SERVO_V] = v;
	if (interp_tech_value_ok(INTERP_TECH_SERVO_V, v))
		return 0;
	interp_tech_range(INTERP_TECH_SERVO_V, wanted, sizeof(wanted));
	return tech_refuse(t, t->line_at, wanted,
			   "a servo voltage, midway from GVLO to GVHI, of %g V",
			   v);
}

/* Take a row, unless the line has the names of the columns. */
static int take_line(struct tech_text *t, struct interp_tech_table *table)
{
	struct interp_tech_row *row;
	const char *at = t->line_at;
	struct tech_cell c;
	size_t n = 0;
	int err = 0;

	tech_unpad(t);
	if (!tech_word(t, &at, &c) || tech_is(&c, "NR"))
		return 0;
	if (table->nrows == INTERP_TECH_ROWS_MAX)
		return tech_refuse(t, c.at, "at most 4096 rows",
				   "one row too many");
	row = tech_row_add(t, table);
	if (!row)
		return -ENOMEM;
	at = t->line_at;
	for (; !err && tech_word(t, &at, &c); n++) {
		if (n == NCOLUMNS)
			return tech_refuse(t, c.at, "14 to 17 numbers",
					   "a number too many, '%s'",
					   tech_quote(&c).s);
		err = take_cell(t, &c, n, row);
	}
	if (err)
		return err;
	if (n >= COLUMNS_MIN)
		return find_servo_v(t, &row->tech);
	return tech_refuse(t, t->line_end, "14 to 17 numbers",
			   "a row of %zu numbers, %s is missing", n,
			   columns[n].name);
}

static int read_all(struct tech_text *t, struct interp_tech_table *table)
{
	int err;

	while ((err = tech_line(t)) > 0) {
		err = take_line(t, table);
		if (err)
			return err;
	}
	return err ? err : tech_finish(t, table);
}

int interp_tech_read_enc(struct interp_tech_table **ret, const char *text,
			 size_t bytes, struct interp_diag *diag)
{
	struct interp_tech_table *table = tech_table_new();
	struct tech_text t;
	int err;

	if (!table)
		return -ENOMEM;
	strcpy(table->note[table->nnotes++],
	       "from an .enc table; its columns P VDI VE VW are not taken");
	tech_open(&t, bytes ? text : "", bytes, diag);
	err = read_all(&t, table);
	if (err)
		interp_tech_table_destroy(table);
	else
		*ret = table;
	return err;
}
