/* SPDX-License-Identifier: Apache-2.0 */
/* dialect.h - the dialects that exist */
#ifndef CODE_DIALECT_H
#define CODE_DIALECT_H

#include "code/words.h"
#include "interp/compile.h"

enum dialect_reader { DIALECT_NC, DIALECT_3B, DIALECT_4B };

struct interp_dialect {
	char name[128];
	char also[32];			/* another name; empty: none */
	char suffix[32];		/* end of file names; empty: none */
	enum dialect_reader reads;
	struct nc_dialect *nc;
};

/* The built-in files of dialects/; the last has no name.  A base comes before
 * the dialects that are based on it. */
struct dialect_file {
	const char *name, *text;
};

extern const struct dialect_file nc_dialect_files[];

/**
 * nc_dialect_read() - read the tables of @text into @d, which has its name and
 * a zeroed nc.  Return: 0, or -EINVAL with @diag filled.
 */
int nc_dialect_read(struct interp_dialect *d, const char *text, size_t bytes,
		 struct interp_diag *diag);

/**
 * interp_dialect_base() - a dialect that is already built; NULL: there is none.
 */
const struct interp_dialect *interp_dialect_base(const char *name);

/**
 * nc_dialect_place() - the whole line is refused at its first column, the whole
 * text at 1:1: who reads a refusal of a text can go to a byte of it.
 */
void nc_dialect_place(struct interp_diag *d);

#endif /* CODE_DIALECT_H */
