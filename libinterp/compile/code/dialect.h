/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dialect.h - the dialects there are
 */
#ifndef CODE_DIALECT_H
#define CODE_DIALECT_H

#include "code/words.h"
#include "interp/compile.h"

enum dialect_reader { DIALECT_NC, DIALECT_3B, DIALECT_4B };

struct interp_dialect {
	char name[128];
	char also[32];			/* another name; empty: none */
	char suffix[32];		/* of file names; empty: none */
	enum dialect_reader reads;
	struct nc_dialect *nc;
};

/* The files of dialects/, as they are built in; the last has no name.  A base
 * stands in front of those that begin from it. */
struct dialect_file {
	const char *name, *text;
};

extern const struct dialect_file nc_dialect_files[];

/** nc_dialect_read() - the tables of @text into @d, whose name and whose zeroed
 *  nc are there.  Return: 0, or -EINVAL with @diag filled. */
int nc_dialect_read(struct interp_dialect *d, const char *text, size_t bytes,
		 struct interp_diag *diag);

/** interp_dialect_base() - one that is built in already; NULL: none. */
const struct interp_dialect *interp_dialect_base(const char *name);

#endif /* CODE_DIALECT_H */
