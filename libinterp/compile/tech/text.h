/* SPDX-License-Identifier: Apache-2.0 */
/*
 * text.h - the text of a table, line by line and cell by cell
 *
 * Private to libinterp/compile/tech.  A comment, from # to the end of its line,
 * is removed.
 */
#ifndef TECH_TEXT_H
#define TECH_TEXT_H

#include "interp/tech_table.h"

#include <stdbool.h>

#define TECH_LINE_MAX	4096		/* bytes */

struct tech_text {
	const char *next, *end;		/* the rest of the text */
	const char *line_at, *line_end;	/* the present line */
	uint32_t line;			/* its number, from 1 */
	struct interp_diag *diag;
};

/* A part of the line; n is 0 for an empty one. */
struct tech_cell {
	const char *at;
	size_t n;
};

/** tech_open() - begin with @text; a byte order mark is skipped. */
void tech_open(struct tech_text *t, const char *text, size_t bytes,
	       struct interp_diag *diag);

/**
 * tech_line() - the next line that is not empty.
 * Return: 1; 0 at the end; -EINVAL with the diag filled.
 */
int tech_line(struct tech_text *t);

/**
 * tech_unpad() - remove the blanks and separators that spreadsheets add to
 * short lines.
 */
void tech_unpad(struct tech_text *t);

/**
 * tech_cell() - the next cell at *@at, up to a comma, semicolon or tab; false
 * if the line is at its end.
 */
bool tech_cell(const struct tech_text *t, const char **at,
	       struct tech_cell *ret);

/** tech_word() - the same, up to a blank. */
bool tech_word(const struct tech_text *t, const char **at,
	       struct tech_cell *ret);

/** tech_is() - is the cell @word? */
bool tech_is(const struct tech_cell *c, const char *word);

/** tech_number() - the whole cell as a decimal without exponent. */
bool tech_number(const struct tech_cell *c, double *ret);

/** tech_condition() - the whole cell as C120, E001, S100. */
bool tech_condition(const struct tech_cell *c, char *ret_letter,
		    uint32_t *ret_number);

/** tech_refuse() - refuse the cell at @at.  Return: -EINVAL. */
int tech_refuse(struct tech_text *t, const char *at, const char *wanted,
		const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/* A cell that can be quoted. */
struct tech_quote {
	char s[32];
};

struct tech_quote tech_quote(const struct tech_cell *c);

/** tech_value() - a cell as field @id, or a refusal. */
int tech_value(struct tech_text *t, const struct tech_cell *c,
	       enum interp_tech_id id, double *ret);

/** tech_row_add() - add an empty row for the present line; NULL: no memory. */
struct interp_tech_row *tech_row_add(struct tech_text *t,
				     struct interp_tech_table *table);

/**
 * tech_finish() - sort the rows; refuse a condition that is there twice, and
 * values in the wrong order.
 */
int tech_finish(struct tech_text *t, struct interp_tech_table *table);

/** tech_table_new() - an empty table; NULL: no memory. */
struct interp_tech_table *tech_table_new(void);

#endif /* TECH_TEXT_H */
