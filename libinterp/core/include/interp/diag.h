/* SPDX-License-Identifier: Apache-2.0 */
/*
 * diag.h - why an input was refused, and where
 *
 * Printed by the programs (interp_diag_tell()) as
 *	FILE:LINE:COLUMN: error: FOUND; WANTED
 * Both texts are one sentence without a full stop; WANTED says what would
 * have been accepted.
 */
#ifndef INTERP_DIAG_H
#define INTERP_DIAG_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

struct interp_diag {
	uint32_t line;			/* from 1; 0: the whole input */
	uint32_t column;		/* from 1, in bytes; 0: the whole
					 * line */
	char found[160];
	char wanted[240];		/* a list of words is long */
};

/**
 * interp_diag_say() - fill found and wanted by one sentence, "FOUND; WANTED".
 *
 * It is cut at the first "; " of @format; line and column stay as they are.
 * Return: -EINVAL, for the caller to return.  Prints into memory: not for the
 * cycle.
 */
int interp_diag_say(struct interp_diag *d, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/**
 * interp_diag_full() - the refusal as it is printed, with no newline.
 *
 * FILE alone is the place of the whole input, and FILE:LINE that of a whole
 * line.  What does not fit into @size bytes is left out.
 */
void interp_diag_full(const struct interp_diag *d, const char *file, char *to,
		      size_t size);

/** interp_diag_tell() - the same on stderr, whole, and a newline. */
void interp_diag_tell(const struct interp_diag *d, const char *file);

/**
 * interp_diag_print() - vsnprintf() for refusals: %g has up to 15 digits.
 *
 * With six of them 89.0000001 would be refused as 89, and 1000000.4 as 1e+06.
 */
void interp_diag_print(char *to, size_t size, const char *format, va_list ap)
	__attribute__((format(printf, 3, 0)));

#endif /* INTERP_DIAG_H */
