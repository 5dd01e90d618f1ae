/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech_table.h - a technology table: conditions, sequences, and what the
 * inline definitions of wire dialects mean
 *
 * Two kinds of text are read: the project's own .tech (docs/technology.md), and
 * the .enc of SEDM's erosion tables.  A refusal says the line, the column, what
 * was found and what would be accepted.
 *
 * Units: as interp/tech.h.
 * Threads: reading and writing allocate; a table that is read may be looked at
 * by any thread.  Never in the cycle.
 */
#ifndef INTERP_TECH_TABLE_H
#define INTERP_TECH_TABLE_H

#include "interp/diag.h"
#include "interp/emit.h"
#include "interp/tech.h"

#include <stddef.h>
#include <stdint.h>

#define INTERP_TECH_ROWS_MAX		4096
#define INTERP_TECH_SEQUENCES_MAX	64
#define INTERP_TECH_STEPS_MAX		16	/* of a sequence */
#define INTERP_TECH_INLINE_MAX		16	/* columns of a definition */
#define INTERP_TECH_NOTES_MAX		16
#define INTERP_TECH_TEXT_MAX		128	/* with its NUL */

struct interp_tech_row {
	char letter;			/* 'C', 'E' or 'S' */
	uint32_t number;
	uint32_t line;			/* of its text */
	struct interp_tech tech;
};

struct interp_tech_step {
	char letter;
	uint32_t number;
};

/* Conditions from rough to fine, all of them rows of the table. */
struct interp_tech_sequence {
	uint32_t number;		/* Q1 is 1 */
	uint32_t line;
	uint32_t nsteps;
	struct interp_tech_step step[INTERP_TECH_STEPS_MAX];
};

/* What each column of a line such as E001= 60 6 20 ... means. */
struct interp_tech_inline {
	uint32_t ncolumns;		/* 0: not known */
	struct {
		int id;			/* enum interp_tech_id, or -1 */
		double factor;		/* field = factor * column */
	} column[INTERP_TECH_INLINE_MAX];
};

struct interp_tech_table {
	char electrode[INTERP_TECH_TEXT_MAX];	/* material; "": not said */
	char workpiece[INTERP_TECH_TEXT_MAX];
	char note[INTERP_TECH_NOTES_MAX][INTERP_TECH_TEXT_MAX];
	uint32_t nnotes;
	struct interp_tech_row *row;	/* by letter, then number */
	uint32_t nrows;
	size_t room;			/* of rows */
	struct interp_tech_sequence sequence[INTERP_TECH_SEQUENCES_MAX];
	uint32_t nsequences;
	struct interp_tech_inline inlined[3];	/* C, E, S */
};

/**
 * interp_tech_read() - a .tech text; need not be NUL-terminated.
 *
 * Return: 0 and @ret, to be destroyed; -EINVAL with all of @diag filled;
 * -ENOMEM.
 */
int interp_tech_read(struct interp_tech_table **ret, const char *text,
		     size_t bytes, struct interp_diag *diag);

/** interp_tech_read_enc() - the same for an .enc text. */
int interp_tech_read_enc(struct interp_tech_table **ret, const char *text,
			 size_t bytes, struct interp_diag *diag);

/** interp_tech_table_destroy() - NULL is fine. */
void interp_tech_table_destroy(struct interp_tech_table *t);

/**
 * interp_tech_write() - the table as a .tech text: rows in order, columns that
 * no row gives left out.
 *
 * Read again it is the same table, and written again the same text.
 * Return: 0, or what the sink returned.
 */
int interp_tech_write(const struct interp_tech_table *t,
		      const struct interp_sink *to);

/** interp_tech_row() - the row of a condition, or NULL. */
const struct interp_tech_row *
interp_tech_row(const struct interp_tech_table *t, char letter,
		uint32_t number);

/** interp_tech_sequence() - by its number, or NULL. */
const struct interp_tech_sequence *
interp_tech_sequence(const struct interp_tech_table *t, uint32_t number);

/** interp_tech_inline() - of a letter C, E or S. */
const struct interp_tech_inline *
interp_tech_inline(const struct interp_tech_table *t, char letter);

/** interp_tech_near() - "C110, C120": the rows nearest to one that is not
 *  there, or "none"; into @buf, returned. */
const char *interp_tech_near(const struct interp_tech_table *t, char letter,
			     uint32_t number, char *buf, size_t size);

/**
 * interp_tech_fits() - may @tech go over a machine's own values @base?
 *
 * Return: 0, or -EINVAL with @diag's found and wanted: which two fields would
 * be upside down.  @name is the condition's.
 */
int interp_tech_fits(const struct interp_tech *tech,
		     const struct interp_tech *base, const char *name,
		     struct interp_diag *diag);

/** interp_tech_table_fits() - the same for every row, with its line. */
int interp_tech_table_fits(const struct interp_tech_table *t,
			   const struct interp_tech *base,
			   struct interp_diag *diag);

/** interp_tech_range() - what field @id accepts, in words, into @buf. */
const char *interp_tech_range(enum interp_tech_id id, char *buf, size_t size);

/** interp_tech_name() - "C120", "E001": of three digits at least. */
const char *interp_tech_name(char letter, uint32_t number, char *buf,
			     size_t size);

/** interp_tech_number() - shortest decimal that reads back, into @buf. */
const char *interp_tech_number(double x, char *buf, size_t size);

/** interp_tech_document() - the fields as a table in Markdown. */
int interp_tech_document(const struct interp_sink *to);

#endif /* INTERP_TECH_TABLE_H */
