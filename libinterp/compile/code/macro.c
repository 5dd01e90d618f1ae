/* SPDX-License-Identifier: Apache-2.0 */
/* macro.c - converts a line with variables into a line without */
#include "code/macro.h"
#include "code/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ASSIGNED_MAX	32

/* An assignment takes effect after the end of its line. */
struct assigned {
	const uint8_t *at;
	char name[MACRO_NAME_MAX];	/* empty: the variable has a number */
	double number, value;
};

int macro_refuse(struct macro_line *l, const uint8_t *at, const char *wanted,
		 const char *found, ...)
{
	char text[160];
	va_list ap;

	va_start(ap, found);
	interp_diag_print(text, sizeof(text), found, ap);
	va_end(ap);
	return nc_refuse(l->r, at, wanted, "%s", text);
}

bool macro_word(struct macro_line *l, const char *word)
{
	const uint8_t *p;

	macro_blanks(l);
	for (p = l->p; *word; p++, word++) {
		if (p == l->end || toupper(*p) != *word)
			return false;
	}
	l->p = p;
	return true;
}

/* -- Has the line anything to expand?
 * --------------------------------------- */

static const uint8_t *skip_comment(const uint8_t *p, const uint8_t *end)
{
	while (p < end && *p != ')')
		p++;
	return p < end ? p + 1 : end;
}

/* IF GOTO WHILE DO END have letters side by side, which no other word has. */
static bool is_keyword(const uint8_t *p, const uint8_t *end)
{
	return isalpha(*p) && p + 1 < end && isalpha(p[1]);
}

static bool is_g65(const uint8_t *p, const uint8_t *end)
{
	uint64_t n = 0;

	if ((*p | 0x20) != 'g')
		return false;
	nc_digits(nc_skip_blanks(p + 1, end), end, &n);
	return n == 65;
}

bool nc_macro_wanted(const struct nc_reader *r, const uint8_t *p,
		     const uint8_t *end)
{
	const bool fanuc = r->d->macros == MACRO_FANUC;

	p = nc_skip_blanks(p, end);
	if (p < end && *p == '/')
		return false;
	while (p < end && *p != ';') {
		if (*p == '(') {
			p = skip_comment(p, end);
			continue;
		}
		if (*p == '#' || *p == '[' ||
		    (fanuc ? is_keyword(p, end) || is_g65(p, end) :
			     (*p | 0x20) == 'o'))
			return true;
		p++;
	}
	return false;
}

/* -- The buffer ----------------------------------------------------------- */

static int put(struct macro_line *l, const uint8_t *at, const char *text,
	       size_t n, unsigned int computed)
{
	struct nc_macro *m = l->m;
	const size_t column = ((size_t)(at - l->r->line_at) + 1) | computed;

	if (m->used + n > MACRO_BUFFER)
		return macro_refuse(l, at, "a shorter line", "a line of more "
				    "than %d bytes when expanded",
				    MACRO_BUFFER);
	memcpy(m->text + m->used, text, n);
	for (; n; n--)
		m->column[m->used++] = (uint16_t)column;
	return 0;
}

/* For letters whose numbers are lengths, angles or feeds, a point is written:
 * the value of an expression is never a length without a point. */
static int put_number(struct macro_line *l, const uint8_t *at, uint8_t letter,
		      double v)
{
	char text[48];
	size_t n;

	if (!(fabs(v) < 1e15))
		return macro_refuse(l, at, "a number that a word can have",
				    "%c with %g", letter, v);
	n = (size_t)snprintf(text, sizeof(text), "%.10f", v);
	while (text[n - 1] == '0')
		n--;
	if (text[n - 1] == '.' && !strchr("XYZABCUVIJKRF=", letter))
		n--;
	return put(l, at, text, n, MACRO_COMPUTED);
}

/* -- The line ------------------------------------------------------------- */

/* ROUND in a word of Fanuc's goes to the last decimal of the word: 0.001 mm or
 * degrees, 0.0001 inches. */
static double parts_of(const struct nc_reader *r, uint8_t letter)
{
	if (r->d->macros != MACRO_FANUC)
		return 0;
	if (strchr("ABC", letter))
		return 1000;
	if (!strchr("XYZUVIJKR", letter))
		return 0;
	return r->unit_mm > 1 ? 10000 : 1000;
}

/* An expression stands behind the letter @letter.  Write its value in its
 * place. */
static int expand_value(struct macro_line *l, uint8_t letter)
{
	const uint8_t *at = l->p - 1;
	double v;
	int err;

	l->parts = parts_of(l->r, letter);
	err = macro_value(l, &v);
	l->parts = 0;
	if (err)
		return err;
	/* If a variable is vacant, its letter is left out too. */
	if (isnan(v)) {
		l->m->used--;
		return 0;
	}
	return put_number(l, at, letter, v);
}

static bool is_value(const struct macro_line *l)
{
	const uint8_t *p = nc_skip_blanks(l->p, l->end);

	if (p < l->end && (*p == '-' || *p == '+'))
		p = nc_skip_blanks(p + 1, l->end);
	if (p == l->end)
		return false;
	if (*p == '#' || *p == '[')
		return true;
	return l->r->d->macros == MACRO_LINUXCNC && isalpha(*p) &&
	       p + 2 < l->end && isalpha(p[1]) && isalpha(p[2]);
}

static int take_assigned(struct macro_line *l, struct assigned *a)
{
	a->at = l->p++;
	macro_blanks(l);
	a->name[0] = '\0';
	if (l->r->d->macros == MACRO_LINUXCNC && l->p < l->end && *l->p == '<')
		return macro_name(l, a->name);
	return macro_value(l, &a->number);
}

static int read_assigned(struct macro_line *l, struct assigned *a)
{
	int err = take_assigned(l, a);

	macro_blanks(l);
	if (!err && (l->p == l->end || *l->p++ != '='))
		err = macro_refuse(l, a->at, "#1 = ...", "a variable that is "
				  "neither a value nor given one");
	return err ? err : macro_expression(l, &a->value);
}

static int do_assign(struct macro_line *l, const struct assigned *a)
{
	if (a->name[0])
		return macro_set_named(l, a->at, a->name, a->value);
	return macro_set(l, a->at, isnan(a->number) ? 0 : a->number, a->value);
}

int macro_assign(struct macro_line *l)
{
	struct assigned a;
	int err;

	macro_blanks(l);
	if (l->p == l->end || *l->p != '#')
		return macro_refuse(l, l->p, "#1 = ... behind THEN",
				    "THEN without an assignment");
	err = read_assigned(l, &a);
	return err || l->idle ? err : do_assign(l, &a);
}

static int copy_through(struct macro_line *l, const uint8_t *to)
{
	int err = 0;

	for (; !err && l->p < to; l->p++)
		err = put(l, l->p, (const char *)l->p, 1, 0);
	return err;
}

static int expand_one(struct macro_line *l, struct assigned *a, uint32_t *n)
{
	const uint8_t c = *l->p;
	int err;

	if (c == '(')
		return copy_through(l, skip_comment(l->p, l->end));
	if (c == ';')
		return copy_through(l, l->end);
	if (c == '#') {
		if (*n == ASSIGNED_MAX)
			return macro_refuse(l, l->p, "32 of them on a line",
					    "an assignment too many");
		err = read_assigned(l, &a[*n]);
		++*n;
		return err;
	}
	err = copy_through(l, l->p + 1);
	if (!err && (isalpha(c) || c == '=') && is_value(l))
		err = expand_value(l, (uint8_t)toupper(c));
	return err;
}

static int expand(struct macro_line *l)
{
	struct assigned a[ASSIGNED_MAX];
	uint32_t n = 0;
	int err = 0;

	while (!err && l->p < l->end)
		err = expand_one(l, a, &n);
	for (uint32_t i = 0; !err && i < n; i++)
		err = do_assign(l, &a[i]);
	return err;
}

struct nc_macro *nc_macro_make(struct nc_reader *r)
{
	const bool fanuc = r->d->macros == MACRO_FANUC;
	struct nc_macro *m = r->macro ? r->macro : calloc(1, sizeof(*m));

	if (!m || r->macro)
		return m;
	for (int i = 0; fanuc && i < MACRO_VARIABLES; i++)
		m->variable[i] = NAN;
	for (int i = 0; fanuc && i < MACRO_LOCALS; i++)
		m->local[0][i] = NAN;
	r->macro = m;
	return m;
}

int nc_macro_line(struct nc_reader *r, const uint8_t *at, const uint8_t *end)
{
	struct macro_line l = { .r = r, .p = at, .end = end };
	int err;

	if (!nc_macro_wanted(r, at, end))
		return 0;
	l.m = nc_macro_make(r);
	if (!l.m)
		return -ENOMEM;
	l.m->used = 0;
	err = r->d->macros == MACRO_FANUC ? macro_flow(&l) : macro_oword(&l);
	if (err == 0) {
		l.p = at;
		err = expand(&l);
	}
	if (err < 0)
		return err;
	err = put(&l, end, "\n", 1, 0);
	return err ? err : 1;
}

void nc_macro_leave(struct nc_reader *r)
{
	struct nc_macro *m = r->macro;

	if (!m)
		return;
	while (m->nloops && m->loop[m->nloops - 1].depth >= r->depth)
		m->nloops--;
	if (!m->own_level[r->depth])
		return;
	m->own_level[r->depth] = false;
	while (m->nnamed && m->named[m->nnamed - 1].level == m->level + 1)
		m->nnamed--;
	for (uint32_t i = 0; i < m->nnamed; i++) {
		if (m->named[i].level == m->level + 1)
			m->named[i--] = m->named[--m->nnamed];
	}
	m->level--;
}

void nc_macro_free(struct nc_reader *r)
{
	if (r->macro)
		free(r->macro->oword);
	free(r->macro);
}
