/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dialect.h - the dialects there are
 */
#ifndef CODE_DIALECT_H
#define CODE_DIALECT_H

#include "code/words.h"
#include "interp/compile.h"

struct interp_dialect {
	const char *name;
	const char *suffix;		/* of file names; NULL: none */
	const struct nc_dialect *nc;	/* NULL: records */
	bool fourb;
};

#endif /* CODE_DIALECT_H */
