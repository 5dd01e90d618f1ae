/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compile.h - a job's text into a program, in the dialect it is written in
 *
 * The one way in: whoever has a job to compile picks its dialect by name or
 * by the file's name and calls interp_compile().
 *
 *	generic				NC code, docs/nc-code.md
 *	robofil skd2 sodick chmer	NC code of wire machines, there too
 *	3b 4b				records, docs/3b.md
 *
 * Threads: allocates through the builder; any thread.  Never in the cycle.
 */
#ifndef INTERP_COMPILE_H
#define INTERP_COMPILE_H

#include "interp/nc.h"
#include "interp/threeb.h"

struct interp_dialect;

/** interp_dialect_by_name() - NULL if there is none of that name. */
const struct interp_dialect *interp_dialect_by_name(const char *name);

/** interp_dialect_by_file() - by .3b or .4b, in either case; else generic. */
const struct interp_dialect *interp_dialect_by_file(const char *path);

/** interp_dialect_name() - as interp_dialect_by_name() knows it. */
const char *interp_dialect_name(const struct interp_dialect *d);

/** interp_dialect_word() - the name of dialect @i; NULL past the last. */
const char *interp_dialect_word(int i);

struct interp_text {
	const char *at;			/* need not be NUL-terminated */
	size_t bytes;
	const struct interp_dialect *dialect;	/* NULL: generic */
};

struct interp_compile_options {
	struct interp_nc_options nc;	/* machine, feed and limits: every
					 * dialect's; its dialect is ignored */
	struct interp_threeb_options threeb;	/* but fourb, which is `4b` */
};

/**
 * interp_compile() - read @text into @b.
 *
 * Return: 0 and @ret_lines, the lines of the text; -EINVAL with @diag filled;
 * -ENOMEM.
 */
int interp_compile(const struct interp_text *text,
		   const struct interp_compile_options *o,
		   struct interp_build *b, uint32_t *ret_lines,
		   struct interp_diag *diag);

#endif /* INTERP_COMPILE_H */
