/* SPDX-License-Identifier: Apache-2.0 */
/* diag.c - a refusal, said in one sentence */
#include "interp/diag.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SENTENCE_MAX	1024
#define BETWEEN		"; "

/*
 * The arguments belong to the whole sentence.  So the sentence is printed as a
 * whole, and then once more without the part that says what is wanted.  The
 * length of the second says where to cut.
 */
int interp_diag_say(struct interp_diag *d, const char *format, ...)
{
	const char *cut = strstr(format, BETWEEN);
	char found[SENTENCE_MAX], all[SENTENCE_MAX];
	size_t n;
	va_list ap;

	snprintf(found, sizeof(found), "%.*s",
		 cut ? (int)(cut - format) : (int)strlen(format), format);
	va_start(ap, format);
	/* The compiler has checked the arguments against the whole format. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
	vsnprintf(all, sizeof(all), found, ap);
#pragma GCC diagnostic pop
	va_end(ap);
	snprintf(d->found, sizeof(d->found), "%.*s",
		 (int)sizeof(d->found) - 1, all);
	n = strlen(all);
	va_start(ap, format);
	vsnprintf(all, sizeof(all), format, ap);
	va_end(ap);
	n += cut ? sizeof(BETWEEN) - 1 : 0;
	snprintf(d->wanted, sizeof(d->wanted), "%.*s",
		 (int)sizeof(d->wanted) - 1, n < strlen(all) ? all + n : "");
	return -EINVAL;
}
