/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cmdline.h - the command line of a program as one table: parsed, checked,
 * printed
 *
 * --help, --version and --list-options, from which the completion of shells is
 * made, need no row. A refusal is printed on stderr as
 *
 * 	PROGRAM: error: OPTION VALUE; WHAT WOULD BE ACCEPTED
 *
 * Threads: one, at the start of the program.
 */
#ifndef COMMON_CMDLINE_H
#define COMMON_CMDLINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CMDLINE_MAX	64		/* rows of a table */

enum cmdline_kind {
	CMDLINE_FLAG,			/* bool: it was given */
	CMDLINE_WORD,			/* const char *: what follows it */
	CMDLINE_NUMBER,			/* double, from min to max */
	CMDLINE_WHOLE,			/* uint64_t */
	CMDLINE_CALL,			/* take() decides */
};

struct cmdline_row {
	const char *name;		/* without its -- */
	const char *arg;		/* its value's name; NULL: it has
					 * none */
	enum cmdline_kind kind;
	size_t at;			/* of its value in the program's
					 * struct */
	double min, max;		/* numbers only */
	/* Calls only: @text is NULL for an option without a value.  Return:
	 * -1 to go on, or the program's exit code. */
	int (*take)(void *to, const char *text);
	const char *help;		/* its lines, divided by \n */
};

struct cmdline {
	const char *program;
	const char *head, *tail;	/* of --help, before and after the
					 * rows */
	void (*more)(void);		/* prints after the head; NULL */
	void (*list)(void);		/* prints more rows of
					 * --list-options; NULL */
	const struct cmdline_row *row;
	size_t nrows;
	int args_max;			/* arguments that are no options */
	int column;			/* of --help, where the texts begin */
};

struct cmdline_given {
	int first;			/* argument of argv that is no option */
	uint64_t rows;			/* a bit for each row that was given */
};

/**
 * cmdline_take() - guard what standard.h guards, and read @argv into the struct
 * at @to.
 *
 * Return: -1 to go on with what @ret says, or the program's exit code: help or
 * version was asked for, or something was refused.
 */
int cmdline_take(const struct cmdline *o, void *to, int argc, char **argv,
		 struct cmdline_given *ret);

/** cmdline_has() - was the option @name given? */
bool cmdline_has(const struct cmdline *o, const struct cmdline_given *g,
		 const char *name);

/**
 * cmdline_pairs() - "NAME=VALUE" of those options @name(0), @name(1), ... that
 * have a @value, a blank between.
 *
 * Return: @buf, or NULL: they do not fit.
 */
const char *cmdline_pairs(const char *(*name)(int i),
			  const char *const value[], char *buf, size_t size);

/**
 * cmdline_refuse() - print a refusal. Return: the exit code for wrong usage.
 */
int cmdline_refuse(const char *program, const char *what, const char *value,
		   const char *wanted);

#endif /* COMMON_CMDLINE_H */
