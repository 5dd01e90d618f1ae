/* SPDX-License-Identifier: Apache-2.0 */
/* refuse.c - says what was found and what would be accepted */
#include "code/macro.h"
#include "code/number.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void fill(struct interp_diag *d, const char *wanted, const char *found,
		 va_list ap)
{
	snprintf(d->wanted, sizeof(d->wanted), "%s", wanted);
	interp_diag_print(d->found, sizeof(d->found), found, ap);
}

uint32_t nc_column(const struct nc_reader *r, const uint8_t *at)
{
	return r->mapped ? r->macro->column[at - r->line_at] & ~MACRO_COMPUTED :
			   (uint32_t)(at - r->line_at) + 1;
}

bool nc_is_computed(const struct nc_reader *r, const uint8_t *at)
{
	return r->mapped && r->macro->column[at - r->line_at] & MACRO_COMPUTED;
}

void nc_go_behind(struct nc_reader *r, struct nc_place to)
{
	nc_go(r, to);
	r->at = nc_line_next(nc_line_end(r->at, r->end), r->end);
	r->line++;
}

struct nc_place nc_this(const struct nc_reader *r)
{
	return r->mapped ? r->macro->place : (struct nc_place) {
		(size_t)(r->line_at - r->text), r->line };
}

int nc_refuse(struct nc_reader *r, const uint8_t *at, const char *wanted,
	      const char *found, ...)
{
	va_list ap;

	r->diag->line = r->line;
	r->diag->column = nc_column(r, at);
	va_start(ap, found);
	fill(r->diag, wanted, found, ap);
	va_end(ap);
	return -EINVAL;
}

int nc_refuse_at(struct nc_reader *r, uint32_t line, const char *wanted,
		 const char *found, ...)
{
	va_list ap;

	r->diag->line = line;
	r->diag->column = 0;
	va_start(ap, found);
	fill(r->diag, wanted, found, ap);
	va_end(ap);
	return -EINVAL;
}

static bool is_number(uint8_t c)
{
	return nc_classes[c] == NC_NUMERIC;
}

static bool is_visible(uint8_t c)
{
	return c > ' ' && c < 0x7f;
}

static struct nc_quote quote(const struct nc_reader *r, const uint8_t *at,
			     bool (*belongs)(uint8_t))
{
	struct nc_quote q = { "" };
	size_t n = 0;

	q.s[n++] = (char)*at++;
	if (belongs == is_number)	/* X 1 */
		at = nc_skip_blanks(at, r->stop);
	while (at < r->stop && n < sizeof(q.s) - 1 && belongs(*at))
		q.s[n++] = (char)*at++;
	return q;
}

static bool is_named(uint8_t c)
{
	return c >= ' ' && c < 0x7f && c != '>';
}

struct nc_quote nc_quote_word(const struct nc_reader *r, const uint8_t *at)
{
	struct nc_quote q = quote(r, at, *at == '<' ? is_named : is_number);

	if (*at == '<')
		strncat(q.s, ">", sizeof(q.s) - strlen(q.s) - 1);
	return q;
}

struct nc_quote nc_quote_run(const struct nc_reader *r, const uint8_t *at)
{
	return quote(r, at, is_visible);
}

/* -- What may follow a letter
 * ----------------------------------------------- */

static uint32_t next_code(const struct nc_letter *l, uint32_t i)
{
	while (i < l->ncodes && (l->codes[i].group == NC_UNKNOWN ||
				 l->codes[i].group == NC_REFUSED))
		i++;
	return i;
}

static int put_code(char *buf, size_t size, char letter, uint32_t scale,
		    uint32_t i)
{
	return i % scale ? snprintf(buf, size, "%c%u.%u", letter, i / scale,
				    i % scale) :
			   snprintf(buf, size, "%c%u", letter, i / scale);
}

const char *nc_codes_known(const struct nc_letter *l, char letter, char *buf,
			   size_t size)
{
	size_t n = (size_t)snprintf(buf, size, "one of");
	uint32_t i = next_code(l, 0);

	/* Numbers that follow each other, also G5 and G5.1, are one range. */
	while (i < l->ncodes && n < size) {
		uint32_t last = i, next = next_code(l, i + 1), many = 1;

		for (; next < l->ncodes && next - last <= l->scale;
		     next = next_code(l, next + 1), many++)
			last = next;
		n += (size_t)snprintf(buf + n, size - n, " ");
		if (n < size)
			n += (size_t)put_code(buf + n, size - n, letter,
					      l->scale, i);
		if (many > 1 && n < size)
			n += (size_t)snprintf(buf + n, size - n,
					      many > 2 ? " ... " : " ");
		if (many > 1 && n < size)
			n += (size_t)put_code(buf + n, size - n, letter,
					      l->scale, last);
		i = next;
	}
	if (letter == 'M' && n < size)
		snprintf(buf + n, size - n, ", or one of the machine's own, "
			 "[plc] m_before m_after m_free");
	return buf;
}

const char *nc_letters_known(const struct nc_dialect *d, char *buf, size_t size)
{
	size_t n = (size_t)snprintf(buf, size, "one of");

	for (char c = 'A'; c <= 'Z' && n < size; c++) {
		if (d->classes[(uint8_t)c] != NC_BAD)
			n += (size_t)snprintf(buf + n, size - n, " %c", c);
	}
	if (d->classes[':'] == NC_COLON && n < size)
		snprintf(buf + n, size - n, " :");
	return buf;
}
