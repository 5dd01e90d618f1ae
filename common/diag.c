/* SPDX-License-Identifier: Apache-2.0 */
/* diag.c - a refusal, said in one sentence */
#include "interp/diag.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SENTENCE_MAX	1024
#define BETWEEN		"; "

/* The same format, with all digits of a double that a text can hold. */
static void all_digits(char to[SENTENCE_MAX], const char *format)
{
	size_t n = 0;

	for (; *format && n < SENTENCE_MAX - 8; format++) {
		to[n++] = *format;
		if (format[0] == '%' && format[1] == 'g') {
			memcpy(to + n, ".15", 3);
			n += 3;
		} else if (format[0] == '%' && format[1] == '%') {
			to[n++] = *++format;
		}
	}
	to[n] = '\0';
}

/* The compiler has checked the arguments against the format as it was. */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
void interp_diag_print(char *to, size_t size, const char *format, va_list ap)
{
	char digits[SENTENCE_MAX];

	all_digits(digits, format);
	vsnprintf(to, size, digits, ap);
}
#pragma GCC diagnostic pop

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
	interp_diag_print(all, sizeof(all), found, ap);
	va_end(ap);
	snprintf(d->found, sizeof(d->found), "%.*s",
		 (int)sizeof(d->found) - 1, all);
	n = strlen(all);
	va_start(ap, format);
	interp_diag_print(all, sizeof(all), format, ap);
	va_end(ap);
	n += cut ? sizeof(BETWEEN) - 1 : 0;
	snprintf(d->wanted, sizeof(d->wanted), "%.*s",
		 (int)sizeof(d->wanted) - 1, n < strlen(all) ? all + n : "");
	return -EINVAL;
}

void interp_diag_full(const struct interp_diag *d, const char *file, char *to,
		      size_t size)
{
	char at[32] = "";

	if (d->line > 0 && d->column > 0)
		snprintf(at, sizeof(at), ":%u:%u", d->line, d->column);
	else if (d->line > 0)
		snprintf(at, sizeof(at), ":%u", d->line);
	snprintf(to, size, "%s%s: error: %s; %s", file, at, d->found,
		 d->wanted);
}

void interp_diag_tell(const struct interp_diag *d, const char *file)
{
	char text[PATH_MAX + SENTENCE_MAX];

	interp_diag_full(d, file, text, sizeof(text));
	fprintf(stderr, "%s\n", text);
}
