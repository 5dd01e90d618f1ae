/* SPDX-License-Identifier: Apache-2.0 */
/*
 * refuse.c - say what was found and what would be accepted
 */
#include "code/reader.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

static void fill(struct interp_diag *d, const char *wanted, const char *found,
		 va_list ap)
{
	snprintf(d->wanted, sizeof(d->wanted), "%s", wanted);
	vsnprintf(d->found, sizeof(d->found), found, ap);
}

int nc_refuse(struct nc_reader *r, const uint8_t *at, const char *wanted,
	      const char *found, ...)
{
	va_list ap;

	r->diag->line = r->line;
	r->diag->column = (uint32_t)(at - r->line_at) + 1;
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

	do
		q.s[n++] = (char)*at++;
	while (at < r->stop && n < sizeof(q.s) - 1 && belongs(*at));
	return q;
}

struct nc_quote nc_quote_word(const struct nc_reader *r, const uint8_t *at)
{
	return quote(r, at, is_number);
}

struct nc_quote nc_quote_run(const struct nc_reader *r, const uint8_t *at)
{
	return quote(r, at, is_visible);
}
