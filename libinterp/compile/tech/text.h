/* SPDX-License-Identifier: Apache-2.0 */
/*
 * text.h - a table's text, line by line and cell by cell
 *
 * Private to libinterp/compile/tech.  A line loses its comment, # to its end.
 */
#ifndef TECH_TEXT_H
#define TECH_TEXT_H

#include "interp/tech_table.h"

#include <stdbool.h>

#define TECH_LINE_MAX	4096		/* bytes */

struct tech_text {
	const char *next, *end;		/* the text that is left */
	const char *line_at, *line_end;	/* the line in hand */
	uint32_t line;			/* its number, from 1 */
	struct interp_diag *diag;
};

/* A piece of the line; n is 0 for an empty one. */
struct tech_cell {
	const char *at;
	size_t n;
};

/** tech_open() - @text, behind a byte order mark if it has one. */
void tech_open(struct tech_text *t, const char *text, size_t bytes,
	       struct interp_diag *diag);

/**
 * tech_line() - the next line that is not empty.
 * Return: 1; 0 at the end; -EINVAL with the diag filled.
 */
int tech_line(struct tech_text *t);

/** tech_unpad() - drop the blanks and separators that spreadsheets pad short
 *  lines with. */
void tech_unpad(struct tech_text *t);

/** tech_cell() - the next at *@at, cut at a comma, semicolon or tab; false if
 *  the line is over. */
bool tech_cell(const struct tech_text *t, const char **at,
	       struct tech_cell *ret);

/** tech_word() - the same, cut at blanks. */
bool tech_word(const struct tech_text *t, const char **at,
	       struct tech_cell *ret);

/** tech_is() - is the cell @word? */
bool tech_is(const struct tech_cell *c, const char *word);

/** tech_number() - all of the cell as a decimal without exponent. */
bool tech_number(const struct tech_cell *c, double *ret);

/** tech_condition() - all of the cell as C120, E001, S100. */
bool tech_condition(const struct tech_cell *c, char *ret_letter,
		    uint32_t *ret_number);

/** tech_refuse() - the cell at @at. Return: -EINVAL. */
int tech_refuse(struct tech_text *t, const char *at, const char *wanted,
		const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/* A cell, fit to be quoted. */
struct tech_quote {
	char s[32];
};

struct tech_quote tech_quote(const struct tech_cell *c);

/** tech_value() - a cell as field @id, or a refusal. */
int tech_value(struct tech_text *t, const struct tech_cell *c,
	       enum interp_tech_id id, double *ret);

/** tech_row_add() - an empty row in the line in hand; NULL: no memory. */
struct interp_tech_row *tech_row_add(struct tech_text *t,
				     struct interp_tech_table *table);

/** tech_finish() - rows into order; refuses a condition that is there twice,
 *  and what is upside down. */
int tech_finish(struct tech_text *t, struct interp_tech_table *table);

/** tech_table_new() - empty; NULL: no memory. */
struct interp_tech_table *tech_table_new(void);

#endif /* TECH_TEXT_H */
