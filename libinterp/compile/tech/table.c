/* SPDX-License-Identifier: Apache-2.0 */
/* table.c - the rows of a table: added, sorted, found */
#include "tech/text.h"
#include "grow.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct interp_tech_table *tech_table_new(void)
{
	return calloc(1, sizeof(struct interp_tech_table));
}

void interp_tech_table_destroy(struct interp_tech_table *t)
{
	if (t)
		free(t->row);
	free(t);
}

struct interp_tech_row *tech_row_add(struct tech_text *t,
				     struct interp_tech_table *table)
{
	struct interp_tech_row *r;

	if (table->nrows == table->room &&
	    grow_array(&table->row, &table->room, sizeof(*table->row)))
		return NULL;
	r = &table->row[table->nrows++];
	*r = (struct interp_tech_row) { .line = t->line };
	interp_tech_clear(&r->tech);
	return r;
}

static int compare(char la, uint32_t na, char lb, uint32_t nb)
{
	if (la != lb)
		return la < lb ? -1 : 1;
	return (na > nb) - (na < nb);
}

static int by_name(const void *a, const void *b)
{
	const struct interp_tech_row *x = a, *y = b;
	const int c = compare(x->letter, x->number, y->letter, y->number);

	return c ? c : (x->line > y->line) - (x->line < y->line);
}

static int refuse_double(struct tech_text *t, const struct interp_tech_row *a,
			 const struct interp_tech_row *b)
{
	char name[16];

	t->line = b->line;
	return tech_refuse(t, NULL, "each condition once",
			   "%s again, first in line %u",
			   interp_tech_name(b->letter, b->number, name,
					    sizeof(name)), a->line);
}

int tech_finish(struct tech_text *t, struct interp_tech_table *table)
{
	struct interp_tech nothing;

	if (table->nrows == 0)
		return tech_refuse(t, NULL,
				   "at least one condition, as in C120, 30, 40",
				   "a table without conditions");
	qsort(table->row, table->nrows, sizeof(*table->row), by_name);
	for (uint32_t i = 1; i < table->nrows; i++) {
		if (compare(table->row[i - 1].letter, table->row[i - 1].number,
			    table->row[i].letter, table->row[i].number) == 0)
			return refuse_double(t, &table->row[i - 1],
					     &table->row[i]);
	}
	interp_tech_clear(&nothing);
	return interp_tech_table_fits(table, &nothing, t->diag);
}

/* The first row that does not come before the condition. */
static uint32_t place_of(const struct interp_tech_table *t, char letter,
			 uint32_t number)
{
	uint32_t from = 0, to = t->nrows;

	while (from < to) {
		const uint32_t mid = from + (to - from) / 2;
		const struct interp_tech_row *r = &t->row[mid];

		if (compare(r->letter, r->number, letter, number) < 0)
			from = mid + 1;
		else
			to = mid;
	}
	return from;
}

const struct interp_tech_row *
interp_tech_row(const struct interp_tech_table *t, char letter,
		uint32_t number)
{
	const uint32_t i = place_of(t, letter, number);

	if (i == t->nrows || t->row[i].letter != letter ||
	    t->row[i].number != number)
		return NULL;
	return &t->row[i];
}

const char *interp_tech_near(const struct interp_tech_table *t, char letter,
			     uint32_t number, char *buf, size_t size)
{
	const uint32_t at = place_of(t, letter, number);
	const uint32_t from = at > 2 ? at - 2 : 0;
	const uint32_t to = t->nrows - at > 2 ? at + 2 : t->nrows;
	size_t n = 0;

	snprintf(buf, size, "none");
	for (uint32_t i = from; i < to && n < size; i++) {
		char name[16];

		n += (size_t)snprintf(buf + n, size - n, "%s%s",
				      i > from ? ", " : "",
				      interp_tech_name(t->row[i].letter,
						       t->row[i].number, name,
						       sizeof(name)));
	}
	return buf;
}

const struct interp_tech_sequence *
interp_tech_sequence(const struct interp_tech_table *t, uint32_t number)
{
	for (uint32_t i = 0; i < t->nsequences; i++) {
		if (t->sequence[i].number == number)
			return &t->sequence[i];
	}
	return NULL;
}

const struct interp_tech_inline *
interp_tech_inline(const struct interp_tech_table *t, char letter)
{
	return &t->inlined[letter == 'C' ? 0 : letter == 'E' ? 1 : 2];
}

static const char *whose(const struct interp_tech *tech, uint32_t field)
{
	return interp_tech_given(tech, field) ? "" : " of the machine";
}

int interp_tech_fits(const struct interp_tech *tech,
		     const struct interp_tech *base, const char *name,
		     struct interp_diag *diag)
{
	struct interp_tech sum = *base;
	const struct interp_tech_order *o;
	const struct interp_tech_field *low, *high;

	interp_tech_over(&sum, tech);
	o = interp_tech_order(&sum);
	if (!o)
		return 0;
	low = &interp_tech_field[o->low];
	high = &interp_tech_field[o->high];
	return interp_diag_say(diag, "%s: %s %g %s%s is not %s %s %g %s%s; %s "
			       "%s %s", name, low->name, sum.v[o->low],
			       low->unit, whose(tech, o->low),
			       o->or_equal ? "at most" : "below", high->name,
			       sum.v[o->high], high->unit,
			       whose(tech, o->high), low->name,
			       o->or_equal ? "at most" : "below", high->name);
}

int interp_tech_table_fits(const struct interp_tech_table *t,
			   const struct interp_tech *base,
			   struct interp_diag *diag)
{
	for (uint32_t i = 0; i < t->nrows; i++) {
		const struct interp_tech_row *r = &t->row[i];
		char name[16];

		interp_tech_name(r->letter, r->number, name, sizeof(name));
		if (interp_tech_fits(&r->tech, base, name, diag)) {
			diag->line = r->line;
			diag->column = 1;
			return -EINVAL;
		}
	}
	return 0;
}
