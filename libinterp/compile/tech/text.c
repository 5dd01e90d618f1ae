/* SPDX-License-Identifier: Apache-2.0 */
/* text.c - the text of a table, line by line and cell by cell */
#include "tech/text.h"

#include "code/number.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void tech_open(struct tech_text *t, const char *text, size_t bytes,
	       struct interp_diag *diag)
{
	const bool bom = bytes >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0;

	*t = (struct tech_text) {
		.next = text + (bom ? 3 : 0), .end = text + bytes,
		.diag = diag,
	};
	diag->line = diag->column = 0;
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t';
}

static bool is_separator(char c)
{
	return c == ',' || c == ';' || c == '\t';
}

static bool is_break(char c)
{
	return c == '\n' || c == '\r';
}

/* Take the text from the start of the line to its break; the rest begins behind
 * the break. */
static void cut_line(struct tech_text *t)
{
	const char *p = t->next;

	t->line++;
	t->line_at = p;
	while (p < t->end && !is_break(*p))
		p++;
	t->line_end = p;
	if (p < t->end && *p == '\r' && p + 1 < t->end && p[1] == '\n')
		p++;
	t->next = p < t->end ? p + 1 : p;
}

static int check_line(struct tech_text *t)
{
	for (const char *p = t->line_at; p < t->line_end; p++) {
		if (p - t->line_at >= TECH_LINE_MAX)
			return tech_refuse(t, p, "lines of up to 4096 bytes",
					   "a longer line");
		if ((unsigned char)*p < ' ' && *p != '\t')
			return tech_refuse(t, p, "text, tabs and line breaks",
					   "byte 0x%02x", (unsigned char)*p);
	}
	return 0;
}

/* Remove the comment, and blanks at the end. */
static void cut_comment(struct tech_text *t)
{
	const char *p = t->line_at;

	while (p < t->line_end && *p != '#')
		p++;
	while (p > t->line_at && p[-1] == ' ')
		p--;
	t->line_end = p;
}

void tech_unpad(struct tech_text *t)
{
	while (t->line_end > t->line_at && (is_blank(t->line_end[-1]) ||
					    is_separator(t->line_end[-1])))
		t->line_end--;
}

static bool is_empty(const struct tech_text *t)
{
	struct tech_text bare = *t;

	tech_unpad(&bare);
	return bare.line_end == bare.line_at;
}

int tech_line(struct tech_text *t)
{
	while (t->next < t->end) {
		int err;

		cut_line(t);
		err = check_line(t);
		if (err)
			return err;
		cut_comment(t);
		if (!is_empty(t))
			return 1;
	}
	return 0;
}

static struct tech_cell trimmed(const char *at, const char *end)
{
	while (at < end && is_blank(*at))
		at++;
	while (end > at && is_blank(end[-1]))
		end--;
	return (struct tech_cell) { at, (size_t)(end - at) };
}

bool tech_cell(const struct tech_text *t, const char **at,
	       struct tech_cell *ret)
{
	const char *p = *at;

	if (p > t->line_end)
		return false;
	while (p < t->line_end && !is_separator(*p))
		p++;
	*ret = trimmed(*at, p);
	*at = p + 1;
	return true;
}

bool tech_word(const struct tech_text *t, const char **at,
	       struct tech_cell *ret)
{
	const char *p = *at;

	while (p < t->line_end && is_blank(*p))
		p++;
	*ret = (struct tech_cell) { p, 0 };
	while (p < t->line_end && !is_blank(*p))
		p++;
	ret->n = (size_t)(p - ret->at);
	*at = p;
	return ret->n > 0;
}

bool tech_is(const struct tech_cell *c, const char *word)
{
	return strlen(word) == c->n && memcmp(word, c->at, c->n) == 0;
}

bool tech_number(const struct tech_cell *c, double *ret)
{
	const uint8_t *p = (const uint8_t *)c->at;
	const uint8_t *end = p + c->n;

	/* No blank may be inside, though the reader of NC code allows some. */
	return c->n && !memchr(p, ' ', c->n) && nc_number(p, end, ret) == end;
}

bool tech_condition(const struct tech_cell *c, char *ret_letter,
		    uint32_t *ret_number)
{
	const char letter = (char)(c->n ? c->at[0] & ~0x20 : 0);
	uint32_t n = 0;

	if (c->n < 2 || c->n > 10 || !strchr("CES", letter))
		return false;
	for (size_t i = 1; i < c->n; i++) {
		if (c->at[i] < '0' || c->at[i] > '9')
			return false;
		n = n * 10 + (uint32_t)(c->at[i] - '0');
	}
	*ret_letter = letter;
	*ret_number = n;
	return true;
}

int tech_refuse(struct tech_text *t, const char *at, const char *wanted,
		const char *found, ...)
{
	struct interp_diag *d = t->diag;
	va_list ap;

	d->line = t->line ? t->line : 1;
	d->column = at ? (uint32_t)(at - t->line_at) + 1 : 1;
	va_start(ap, found);
	interp_diag_print(d->found, sizeof(d->found), found, ap);
	va_end(ap);
	snprintf(d->wanted, sizeof(d->wanted), "%s", wanted);
	return -EINVAL;
}

struct tech_quote tech_quote(const struct tech_cell *c)
{
	struct tech_quote q = { "" };
	size_t i;

	for (i = 0; i < c->n && i < sizeof(q.s) - 1; i++)
		q.s[i] = c->at[i] >= ' ' && c->at[i] < 0x7f ? c->at[i] : '?';
	return q;
}

int tech_value(struct tech_text *t, const struct tech_cell *c,
	       enum interp_tech_id id, double *ret)
{
	char wanted[96];
	double v;

	if (tech_number(c, &v) && interp_tech_value_ok(id, v)) {
		*ret = v;
		return 0;
	}
	interp_tech_range(id, wanted, sizeof(wanted));
	return tech_refuse(t, c->at, wanted, "%s '%s' is %s",
			   interp_tech_field[id].name, tech_quote(c).s,
			   tech_number(c, &v) ? "out of range" :
			   "not a decimal number");
}
