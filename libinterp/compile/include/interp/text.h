/* SPDX-License-Identifier: Apache-2.0 */
/* text.h - the text of a program, and the dialect it is written in */
#ifndef INTERP_TEXT_H
#define INTERP_TEXT_H

#include <stddef.h>

struct interp_dialect;

struct interp_text {
	const char *at;			/* need not be NUL-terminated */
	size_t bytes;
	const struct interp_dialect *dialect;	/* NULL: generic */
};

#endif /* INTERP_TEXT_H */
