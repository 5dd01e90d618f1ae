/* SPDX-License-Identifier: Apache-2.0 */
/*
 * compile.h - a job's text into a program, in the dialect it is written in
 *
 * This is the one entry.  Whoever has a job to compile finds its dialect by
 * name, or by the name of the file, and calls interp_compile().
 *
 * The dialects are files of dialects/, which are built in; users copy one and
 * change it.  docs/nc-code.md tells what they say, docs/3b.md has the records
 * of 3B and 4B.
 *
 * Threads: allocates through the builder; any thread.  Never in the cycle.
 */
#ifndef INTERP_COMPILE_H
#define INTERP_COMPILE_H

#include "interp/nc.h"
#include "interp/threeb.h"

/**
 * interp_dialect_by_name() - the dialect called @name; NULL if there is none.
 */
const struct interp_dialect *interp_dialect_by_name(const char *name);

/**
 * interp_dialect_by_suffix() - by the end of the file's name (.3b, .4b, in
 * upper or lower case); else NULL.
 */
const struct interp_dialect *interp_dialect_by_suffix(const char *path);

/** interp_dialect_is_nc() - NC code, not records of 3B or 4B? */
bool interp_dialect_is_nc(const struct interp_dialect *d);

/** interp_dialect_word() - the name of dialect @i; NULL past the last. */
const char *interp_dialect_word(int i);

/**
 * interp_dialect_read() - a dialect of the user's own, from a file's text.
 *
 * Return: 0 with @ret to be handed to interp_dialect_free(); -EINVAL with @diag
 * filled; -ENOMEM.
 */
int interp_dialect_read(struct interp_dialect **ret, const char *name,
			const struct interp_text *text,
			struct interp_diag *diag);
void interp_dialect_free(struct interp_dialect *d);

/** interp_dialect_meaning() - what words can mean, by number; NULL past the
 *  last. */
const char *interp_dialect_meaning(int i);

struct interp_compile_options {
	struct interp_nc_options nc;	/* machine, feed and limits: every
					 * dialect's */
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
