/* SPDX-License-Identifier: Apache-2.0 */
/*
 * support.h - what goes into a support archive
 *
 * Threads: one.
 */
#ifndef CTL_SUPPORT_H
#define CTL_SUPPORT_H

#include "ctl.h"

#define SUPPORT_FILE_MAX	(8 << 20)	/* bytes of one file */

/* A text that grows. */
struct support_text {
	char *at;
	size_t bytes, room;
};

/** support_add() - up to SUPPORT_FILE_MAX bytes; what is more is dropped. */
void support_add(struct support_text *t, const char *from, size_t bytes);
/** support_say() - as printf. */
void support_say(struct support_text *t, const char *text, ...)
	__attribute__((format(printf, 2, 3)));

struct support {
	struct ctl *ctl;
	json_t *store;			/* answer of "store"; NULL: no answer */
	struct support_text secrets;	/* words, each with a NUL behind it */
};

/** support_ready() - ask the service once, and learn the secrets. */
void support_ready(struct support *s);
void support_fini(struct support *s);

/** A file of the archive. */
struct support_file {
	const char *name, *what;
	/* Fill @to; a thing that cannot be had is said in it. */
	void (*fill)(struct support *s, struct support_text *to);
};

extern const struct support_file support_files[];
extern const int support_nfiles;

/* -- support_run.c -------------------------------------------------------- */

/** support_run() - what a program prints, for at most 30 s. */
void support_run(struct support_text *to, char *const argv[]);

/* -- support_secrets.c ---------------------------------------------------- */

/** support_learn() - all words of files that hold secrets. */
void support_learn(struct support *s);
/** support_scrub() - no such word stays in @t. */
void support_scrub(const struct support *s, struct support_text *t);
/** support_scrub_lines() - nothing stays in @t of a line that names a
 *  password. */
void support_scrub_lines(struct support_text *t);

#endif /* CTL_SUPPORT_H */
