/* SPDX-License-Identifier: Apache-2.0 */
/*
 * words.c - fields, numbers and names of conditions as text
 */
#include "tech/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Enough decimals for any number of 15 digits from 1e-6 on. */
#define DECIMALS_MAX	21

const char *interp_tech_number(double x, char *buf, size_t size)
{
	double back = 0;
	char *p;

	for (int decimals = 0; decimals <= DECIMALS_MAX; decimals++) {
		struct tech_cell c;

		snprintf(buf, size, "%.*f", decimals, x + 0.0);
		c = (struct tech_cell) { buf, strlen(buf) };
		if (tech_number(&c, &back) && back == x)
			return buf;
	}
	/* Fifteen digits, which are read back as they were written. */
	snprintf(buf, size, "%.*f", x < 1 && x > -1 ? 15 :
		 14 - (int)fmin(14, log10(fabs(x))), x);
	if (!strchr(buf, '.'))
		return buf;
	for (p = buf + strlen(buf); p[-1] == '0'; p--)
		;
	p[p[-1] == '.' ? -1 : 0] = '\0';
	if (strcmp(buf, "-0") == 0)
		memmove(buf, "0", 2);
	return buf;
}

const char *interp_tech_name(char letter, uint32_t number, char *buf,
			     size_t size)
{
	snprintf(buf, size, "%c%03u", letter, number);
	return buf;
}

const char *interp_tech_range(enum interp_tech_id id, char *buf, size_t size)
{
	const struct interp_tech_field *f = &interp_tech_field[id];
	char a[32], b[32];

	if (id == INTERP_TECH_POLARITY) {
		snprintf(buf, size, "1 or -1");
		return buf;
	}
	snprintf(buf, size, "a %snumber from %s to %s%s%s",
		 f->whole ? "whole " : "",
		 interp_tech_number(f->min, a, sizeof(a)),
		 interp_tech_number(f->max, b, sizeof(b)),
		 *f->unit ? " " : "", f->unit);
	return buf;
}

/* -- Written as a .tech text
 * -------------------------------------------------- */

#define CELL_MAX	40

static void head_cell(enum interp_tech_id id, char cell[CELL_MAX])
{
	const struct interp_tech_field *f = &interp_tech_field[id];

	snprintf(cell, CELL_MAX, *f->unit ? "%s [%s]" : "%s", f->name,
		 f->unit);
}

static void row_cell(const struct interp_tech_row *r, enum interp_tech_id id,
		     char cell[CELL_MAX])
{
	if (interp_tech_given(&r->tech, id))
		interp_tech_number(r->tech.v[id], cell, CELL_MAX);
	else
		snprintf(cell, CELL_MAX, "-");
}

struct columns {
	uint32_t given;			/* bit per field */
	int width[INTERP_NTECH];
};

static void measure(const struct interp_tech_table *t, struct columns *c)
{
	char cell[CELL_MAX];

	*c = (struct columns) { 0 };
	for (int i = 0; i < INTERP_NTECH; i++) {
		const enum interp_tech_id id = (enum interp_tech_id)i;

		head_cell(id, cell);
		c->width[i] = (int)strlen(cell);
		for (uint32_t k = 0; k < t->nrows; k++) {
			if (interp_tech_given(&t->row[k].tech, id))
				c->given |= 1u << i;
			row_cell(&t->row[k], id, cell);
			if ((int)strlen(cell) > c->width[i])
				c->width[i] = (int)strlen(cell);
		}
	}
	if (!c->given)			/* a head has at least one field */
		c->given = 1;
}

/* @r NULL: the head. */
static int put_row(const struct interp_sink *to, const struct columns *c,
		   const struct interp_tech_row *r)
{
	char line[INTERP_NTECH * (CELL_MAX + 2) + 32], cell[CELL_MAX];
	int n;

	snprintf(cell, sizeof(cell), "condition");
	if (r)
		interp_tech_name(r->letter, r->number, cell, sizeof(cell));
	n = snprintf(line, sizeof(line), "%-9s", cell);
	for (int i = 0; i < INTERP_NTECH; i++) {
		if (!(c->given & 1u << i))
			continue;
		if (r)
			row_cell(r, (enum interp_tech_id)i, cell);
		else
			head_cell((enum interp_tech_id)i, cell);
		n += snprintf(line + n, sizeof(line) - (size_t)n, ", %*s",
			      c->width[i], cell);
	}
	line[n++] = '\n';
	return to->put(to->arg, line, (size_t)n);
}

static int put_key(const struct interp_sink *to, const char *key,
		   const char *text)
{
	char line[INTERP_TECH_TEXT_MAX + 32];
	const int n = snprintf(line, sizeof(line), "%s = %s\n", key, text);

	return *text ? to->put(to->arg, line, (size_t)n) : 0;
}

static int put_sequence(const struct interp_sink *to,
			const struct interp_tech_sequence *s)
{
	char line[INTERP_TECH_STEPS_MAX * 16 + 32], name[16];
	int n = snprintf(line, sizeof(line), "sequence Q%u =", s->number);

	for (uint32_t i = 0; i < s->nsteps; i++)
		n += snprintf(line + n, sizeof(line) - (size_t)n, " %s",
			      interp_tech_name(s->step[i].letter,
					       s->step[i].number, name,
					       sizeof(name)));
	line[n++] = '\n';
	return to->put(to->arg, line, (size_t)n);
}

static int put_inline(const struct interp_sink *to, char letter,
		      const struct interp_tech_inline *in)
{
	char line[INTERP_TECH_INLINE_MAX * 64 + 32], factor[CELL_MAX];
	int n = snprintf(line, sizeof(line), "inline %c =", letter);

	if (in->ncolumns == 0)
		return 0;
	for (uint32_t i = 0; i < in->ncolumns; i++) {
		const int id = in->column[i].id;

		n += snprintf(line + n, sizeof(line) - (size_t)n, " %s",
			      id < 0 ? "-" : interp_tech_field[id].name);
		if (id >= 0 && in->column[i].factor != 1)
			n += snprintf(line + n, sizeof(line) - (size_t)n,
				      "*%s", interp_tech_number(
				      in->column[i].factor, factor,
				      sizeof(factor)));
	}
	line[n++] = '\n';
	return to->put(to->arg, line, (size_t)n);
}

int interp_tech_write(const struct interp_tech_table *t,
		      const struct interp_sink *to)
{
	struct columns c;
	int err = put_key(to, "electrode", t->electrode);

	if (!err)
		err = put_key(to, "workpiece", t->workpiece);
	for (uint32_t i = 0; !err && i < t->nnotes; i++)
		err = put_key(to, "note", t->note[i]);
	measure(t, &c);
	if (!err)
		err = put_row(to, &c, NULL);
	for (uint32_t i = 0; !err && i < t->nrows; i++)
		err = put_row(to, &c, &t->row[i]);
	for (uint32_t i = 0; !err && i < t->nsequences; i++)
		err = put_sequence(to, &t->sequence[i]);
	for (int i = 0; !err && i < 3; i++)
		err = put_inline(to, "CES"[i], &t->inlined[i]);
	return err;
}

int interp_tech_document(const struct interp_sink *to)
{
	static const char head[] = "| field | unit | accepted | means |\n"
				   "|---|---|---|---|\n";
	int err = to->put(to->arg, head, sizeof(head) - 1);

	for (int i = 0; !err && i < INTERP_NTECH; i++) {
		const struct interp_tech_field *f = &interp_tech_field[i];
		char line[256], range[96];
		int n;

		interp_tech_range((enum interp_tech_id)i, range,
				  sizeof(range));
		n = snprintf(line, sizeof(line), "| `%s` | %s | %s | %s |\n",
			     f->name, f->unit, range, f->help);
		err = to->put(to->arg, line, (size_t)n);
	}
	return err;
}
