/* SPDX-License-Identifier: Apache-2.0 */
/*
 * read.c - a .tech text into a table
 *
 *	key = value		electrode, workpiece, note, sequence, inline
 *	condition, field, ...	the head, once, before the rows
 *	C120, value, ...	a row for each condition
 */
#include "tech/text.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

struct reading {
	struct tech_text text;
	struct interp_tech_table *table;
	uint32_t head_line;		/* 0: there was none yet */
	int column[INTERP_NTECH];	/* field of each column of a row */
	uint32_t ncolumns;
	const char *value;		/* behind the = of the present line */
};

#define THE_KEYS	"electrode, workpiece, note, sequence Q1 or inline E"

/* -- key = value ---------------------------------------------------------- */

static int take_text(struct reading *r, struct tech_cell value, char *to)
{
	if (value.n >= INTERP_TECH_TEXT_MAX)
		return tech_refuse(&r->text, value.at, "up to 127 bytes",
				   "a text of %zu bytes", value.n);
	memcpy(to, value.at, value.n);
	to[value.n] = '\0';
	return 0;
}

static int take_once(struct reading *r, const char *key,
		     struct tech_cell value, char *to)
{
	if (*to)
		return tech_refuse(&r->text, r->text.line_at, "each key once",
				   "%s again", key);
	return take_text(r, value, to);
}

static int take_note(struct reading *r, struct tech_cell value)
{
	struct interp_tech_table *t = r->table;

	if (t->nnotes == INTERP_TECH_NOTES_MAX)
		return tech_refuse(&r->text, r->text.line_at,
				   "at most 16 notes; # begins a comment",
				   "one note too many");
	return take_text(r, value, t->note[t->nnotes++]);
}

static int add_step(struct reading *r, struct interp_tech_sequence *s,
		    const struct tech_cell *word)
{
	struct interp_tech_step *step = &s->step[s->nsteps];

	if (s->nsteps == INTERP_TECH_STEPS_MAX)
		return tech_refuse(&r->text, word->at, "at most 16 conditions",
				   "one condition too many");
	if (!tech_condition(word, &step->letter, &step->number))
		return tech_refuse(&r->text, word->at, "conditions, as in "
				   "C120 C110 C100", "'%s' in a sequence",
				   tech_quote(word).s);
	s->nsteps++;
	return 0;
}

/* Whether the conditions exist is checked at the end. */
static int take_sequence(struct reading *r, const struct tech_cell *name)
{
	struct interp_tech_table *t = r->table;
	const struct tech_cell digits = { name->at + 1, name->n - 1 };
	struct interp_tech_sequence s = { .line = r->text.line };
	const char *at = r->value;
	struct tech_cell word;
	double n;
	int err = 0;

	if (name->n < 2 || (name->at[0] | 0x20) != 'q' ||
	    !tech_number(&digits, &n) || !(n >= 1 && n <= 9999) ||
	    n != (double)(uint32_t)n)
		return tech_refuse(&r->text, name->at, "Q1 to Q9999",
				   "a sequence called '%s'",
				   tech_quote(name).s);
	s.number = (uint32_t)n;
	if (interp_tech_sequence(t, s.number))
		return tech_refuse(&r->text, name->at, "each sequence once",
				   "Q%u again", s.number);
	if (t->nsequences == INTERP_TECH_SEQUENCES_MAX)
		return tech_refuse(&r->text, name->at, "at most 64 sequences",
				   "one sequence too many");
	while (!err && tech_word(&r->text, &at, &word))
		err = add_step(r, &s, &word);
	if (!err && s.nsteps == 0)
		return tech_refuse(&r->text, name->at, "its conditions, rough "
				   "to fine", "an empty sequence");
	if (!err)
		t->sequence[t->nsequences++] = s;
	return err;
}

/* "-", "on_us" or "on_us*0.5". */
static int add_inline(struct reading *r, struct interp_tech_inline *in,
		      const struct tech_cell *word)
{
	const char *star = memchr(word->at, '*', word->n);
	const size_t n = star ? (size_t)(star - word->at) : word->n;
	struct tech_cell factor = { star ? star + 1 : NULL,
				    star ? word->n - n - 1 : 0 };
	char name[32] = "";
	double x = 1;
	int id = -1;

	if (in->ncolumns == INTERP_TECH_INLINE_MAX)
		return tech_refuse(&r->text, word->at, "at most 16 columns",
				   "one column too many");
	if (n < sizeof(name))
		memcpy(name, word->at, n);
	if (strcmp(name, "-") != 0) {
		id = interp_tech_find(name);
		if (id < 0)
			return tech_refuse(&r->text, word->at, "a field, or - "
					   "for a column that is not taken",
					   "unknown field '%s'",
					   tech_quote(word).s);
	}
	if (star && (id < 0 || !tech_number(&factor, &x) || x <= 0))
		return tech_refuse(&r->text, word->at, "a factor above 0, as "
				   "in on_us*0.5", "'%s'",
				   tech_quote(word).s);
	in->column[in->ncolumns].id = id;
	in->column[in->ncolumns++].factor = x;
	return 0;
}

static int take_inline(struct reading *r, const struct tech_cell *name)
{
	const char *at = r->value;
	struct interp_tech_inline in = { 0 };
	struct interp_tech_inline *to;
	struct tech_cell word;
	int err = 0;

	if (name->n != 1 || !strchr("CES", name->at[0]))
		return tech_refuse(&r->text, name->at, "inline C, E or S",
				   "inline '%s'", tech_quote(name).s);
	to = &r->table->inlined[strchr("CES", name->at[0]) - "CES"];
	if (to->ncolumns)
		return tech_refuse(&r->text, name->at, "each letter once",
				   "inline %c again", name->at[0]);
	while (!err && tech_word(&r->text, &at, &word))
		err = add_inline(r, &in, &word);
	if (!err && in.ncolumns == 0)
		return tech_refuse(&r->text, name->at, "a field or - for each "
				   "column", "inline without columns");
	if (!err)
		*to = in;
	return err;
}

static int take_key(struct reading *r, const char *equals)
{
	const char *at = r->text.line_at, *value = equals + 1;
	struct tech_cell key, name, rest;

	tech_unpad(&r->text);
	r->value = value;
	while (value < r->text.line_end && (*value == ' ' || *value == '\t'))
		value++;
	rest = (struct tech_cell) { value, (size_t)(r->text.line_end - value) };
	tech_word(&r->text, &at, &key);
	/* The = may follow the key directly, or be a word of its own. */
	if (key.at + key.n > equals)
		key.n = (size_t)(equals - key.at);
	while (at < equals && *at == ' ')
		at++;
	name = (struct tech_cell) { at, at < equals ?
				    (size_t)(equals - at) : 0 };
	while (name.n && (name.at[name.n - 1] == ' ' ||
			  name.at[name.n - 1] == '\t'))
		name.n--;
	if (tech_is(&key, "sequence"))
		return take_sequence(r, &name);
	if (tech_is(&key, "inline"))
		return take_inline(r, &name);
	if (name.n == 0 && tech_is(&key, "electrode"))
		return take_once(r, "electrode", rest, r->table->electrode);
	if (name.n == 0 && tech_is(&key, "workpiece"))
		return take_once(r, "workpiece", rest, r->table->workpiece);
	if (name.n == 0 && tech_is(&key, "note"))
		return take_note(r, rest);
	return tech_refuse(&r->text, key.at, "one of " THE_KEYS,
			   "unknown key '%s'", tech_quote(&key).s);
}

/* -- Head and rows -------------------------------------------------------- */

static int check_unit(struct reading *r, const struct tech_cell *cell,
		      const char *bracket, int id)
{
	const struct interp_tech_field *f = &interp_tech_field[id];
	const struct tech_cell unit = {
		bracket + 1, (size_t)(cell->at + cell->n - bracket - 1)
	};
	char want[32];

	snprintf(want, sizeof(want), "%s]", f->unit);
	if (tech_is(&unit, want))
		return 0;
	snprintf(want, sizeof(want), "%s [%s]", f->name, f->unit);
	return tech_refuse(&r->text, bracket, *f->unit ? want :
			   "no unit: this field has none",
			   "%s in the unit %s", f->name,
			   tech_quote(&(struct tech_cell) {
				bracket, (size_t)(cell->at + cell->n -
						  bracket) }).s);
}

/* "on_us" or "on_us [us]". */
static int take_column(struct reading *r, const struct tech_cell *cell)
{
	const char *bracket = memchr(cell->at, '[', cell->n);
	size_t n = bracket ? (size_t)(bracket - cell->at) : cell->n;
	char name[32] = "";
	int id;

	while (n && (cell->at[n - 1] == ' ' || cell->at[n - 1] == '\t'))
		n--;
	if (n < sizeof(name))
		memcpy(name, cell->at, n);
	id = interp_tech_find(name);
	if (id < 0)
		return tech_refuse(&r->text, cell->at, "a field of "
				   "docs/technology.md, as servo_v or on_us",
				   "unknown column '%s'", tech_quote(cell).s);
	for (uint32_t i = 0; i < r->ncolumns; i++) {
		if (r->column[i] == id)
			return tech_refuse(&r->text, cell->at,
					   "each column once", "%s again",
					   name);
	}
	r->column[r->ncolumns++] = id;
	return bracket ? check_unit(r, cell, bracket, id) : 0;
}

static int take_head(struct reading *r)
{
	const char *at = r->text.line_at;
	struct tech_cell cell;
	int err = 0;

	tech_unpad(&r->text);
	tech_cell(&r->text, &at, &cell);
	if (!tech_is(&cell, "condition"))
		return tech_refuse(&r->text, cell.at, "a head before the rows: "
				   "condition, servo_v, ..., with commas; or a "
				   "key and =",
				   "'%s'", tech_quote(&cell).s);
	r->head_line = r->text.line;
	while (!err && tech_cell(&r->text, &at, &cell))
		err = take_column(r, &cell);
	if (!err && r->ncolumns == 0)
		return tech_refuse(&r->text, NULL, "at least one field behind "
				   "condition", "a head without fields");
	return err;
}

static int take_cells(struct reading *r, struct interp_tech_row *row,
		      const char *at)
{
	struct tech_cell cell;
	uint32_t n = 0;

	for (; tech_cell(&r->text, &at, &cell); n++) {
		int err;

		if (cell.n == 0 || tech_is(&cell, "-"))
			continue;
		if (n >= r->ncolumns)
			return tech_refuse(&r->text, cell.at, "a value for "
					   "each column of the head, no more",
					   "a value too many, '%s'",
					   tech_quote(&cell).s);
		err = tech_value(&r->text, &cell,
				(enum interp_tech_id)r->column[n],
				&row->tech.v[r->column[n]]);
		if (err)
			return err;
	}
	if (n >= r->ncolumns)
		return 0;
	return tech_refuse(&r->text, r->text.line_end, "a value or - for each "
			   "column of the head", "a row of %u values under a "
			   "head of %u, %s is missing", n, r->ncolumns,
			   interp_tech_field[r->column[n]].name);
}

static int take_row(struct reading *r)
{
	const char *at = r->text.line_at;
	struct interp_tech_row *row;
	struct tech_cell cell;

	tech_cell(&r->text, &at, &cell);
	if (tech_is(&cell, "condition"))
		return tech_refuse(&r->text, cell.at, "one head",
				   "a second head, the first is in line %u",
				   r->head_line);
	if (r->table->nrows == INTERP_TECH_ROWS_MAX)
		return tech_refuse(&r->text, cell.at, "at most 4096 rows",
				   "one row too many");
	row = tech_row_add(&r->text, r->table);
	if (!row)
		return -ENOMEM;
	if (!tech_condition(&cell, &row->letter, &row->number))
		return tech_refuse(&r->text, cell.at,
				   "C, E or S and up to nine digits, as C120; "
				   "or a key and =",
				   "'%s' is no condition", tech_quote(&cell).s);
	return take_cells(r, row, at);
}

static int take_line(struct reading *r)
{
	const char *p = r->text.line_at;

	/* A line with a key has its = before any separator. */
	while (p < r->text.line_end && *p != '=' && *p != ',' && *p != ';')
		p++;
	if (p < r->text.line_end && *p == '=')
		return take_key(r, p);
	return r->head_line ? take_row(r) : take_head(r);
}

/* -- The whole ------------------------------------------------------------ */

static int refuse_step(struct reading *r, const struct interp_tech_sequence *s,
		       uint32_t i)
{
	char name[16], near[64], wanted[96];

	r->text.line = s->line;
	snprintf(wanted, sizeof(wanted), "conditions of this table, as %s",
		 interp_tech_near(r->table, s->step[i].letter,
				  s->step[i].number, near, sizeof(near)));
	return tech_refuse(&r->text, NULL, wanted,
			   "Q%u: %s, which is not in the table", s->number,
			   interp_tech_name(s->step[i].letter,
					    s->step[i].number, name,
					    sizeof(name)));
}

/* From rough to fine, each condition leaves less than the previous one. */
static int check_sequence(struct reading *r,
			  const struct interp_tech_sequence *s)
{
	const struct interp_tech_row *last = NULL;
	double before = 0;

	for (uint32_t i = 0; i < s->nsteps; i++) {
		last = interp_tech_row(r->table, s->step[i].letter,
				       s->step[i].number);
		if (!last)
			return refuse_step(r, s, i);
	}
	for (uint32_t i = 0; i + 1 < s->nsteps; i++) {
		const struct interp_tech_row *row =
			interp_tech_row(r->table, s->step[i].letter,
					s->step[i].number);
		const double mm = interp_tech_short_of_mm(&row->tech,
							  &last->tech);

		if (i == 0 || mm <= before) {
			before = mm;
			continue;
		}
		r->text.line = s->line;
		return tech_refuse(&r->text, NULL, "allowance_mm and gap_mm "
				   "that fall along the sequence", "Q%u: its "
				   "step %u stops %g mm before the end, the "
				   "one before it %g mm", s->number, i + 1, mm,
				   before);
	}
	return 0;
}

static int read_all(struct reading *r)
{
	int err;

	while ((err = tech_line(&r->text)) > 0) {
		err = take_line(r);
		if (err)
			return err;
	}
	if (!err)
		err = tech_finish(&r->text, r->table);
	for (uint32_t i = 0; !err && i < r->table->nsequences; i++)
		err = check_sequence(r, &r->table->sequence[i]);
	return err;
}

int interp_tech_read(struct interp_tech_table **ret, const char *text,
		     size_t bytes, struct interp_diag *diag)
{
	struct reading r = { .table = tech_table_new() };
	int err;

	if (!r.table)
		return -ENOMEM;
	tech_open(&r.text, bytes ? text : "", bytes, diag);
	err = read_all(&r);
	if (err)
		interp_tech_table_destroy(r.table);
	else
		*ret = r.table;
	return err;
}
