/* SPDX-License-Identifier: Apache-2.0 */
/*
 * process_text.c - fields and their values in words
 *
 * This is a file of its own because the cycle must not be able to print.
 */
#include "process.h"

#include <math.h>
#include <stdio.h>

const char *process_told_text(const double told[PROCESS_NTOLD], char *buf,
			      size_t size)
{
	size_t n = 0;

	buf[0] = '\0';
	for (int i = 0; i < PROCESS_NTOLD && n < size; i++) {
		const char *unit = process_unit(i);

		if (!isnan(told[i]))
			n += (size_t)snprintf(buf + n, size - n,
					      "%s%s %.10g%s%s", n ? ", " : "",
					      process_name(i), told[i],
					      *unit ? " " : "", unit);
	}
	return buf;
}

static int order(const struct process_delivers *d, double after)
{
	int best = -1;

	for (uint32_t i = 0; i < d->n; i++)
		if (d->value[i] > after &&
		    (best < 0 || d->value[i] < d->value[best]))
			best = (int)i;
	return best;
}

void process_range_text(const struct process_delivers *d, int field, char *buf,
			size_t size)
{
	const char *unit = process_unit(field);
	double last = -INFINITY;
	size_t at = 0;
	int i;

	buf[0] = '\0';
	if (!d->n) {
		snprintf(buf, size, "%g to %g%s%s", d->min, d->max,
			 *unit ? " " : "", unit);
		return;
	}
	while ((i = order(d, last)) >= 0 && at + 16 < size) {
		at += (size_t)snprintf(buf + at, size - at, "%s%g",
				       at ? " " : "", d->value[i]);
		last = d->value[i];
	}
	snprintf(buf + at, size - at, "%s%s", *unit ? " " : "", unit);
}
