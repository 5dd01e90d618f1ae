/* SPDX-License-Identifier: Apache-2.0 */
/*
 * macro.h - variables, expressions and jumps in NC code
 *
 * Two languages use this: Custom Macro B in Fanuc's form, and the parameters
 * and O words of LinuxCNC.  Both work in front of the scanner.  A line with
 * variables is written again into a buffer, with numbers in the place of
 * expressions, and the scanner reads it there.  A map leads from the buffer
 * back to the columns of the text.  So the scanner and everything behind it
 * need to know nothing of macros.
 *
 *	macro.c		a line into the buffer; assignments
 *	macro_expr.c	values of expressions
 *	macro_var.c	variables
 *	macro_flow.c	IF GOTO WHILE DO END, G65, M99 P
 *	oword.c		o100 sub, call, if, while, repeat, ...
 *
 * Everything is bounded: the number of variables, the depth of calls and of
 * brackets, and the rounds of loops.  Every line that is read counts as a line
 * carried out.
 */
#ifndef CODE_MACRO_H
#define CODE_MACRO_H

#include "code/reader.h"

#define MACRO_LOCALS	34		/* #1 ... #33, or #1 ... #30 */
#define MACRO_VARIABLES	5700
#define MACRO_NAMED_MAX	256
#define MACRO_NAME_MAX	32
#define MACRO_BUFFER	8192
#define MACRO_COMPUTED	0x8000u		/* a column where a value was written */
#define MACRO_BRACKETS	32
#define MACRO_LOOPS	16
#define MACRO_OWORDS_MAX 100000
#define MACRO_ROUNDS_MAX 1000000u	/* jumps back, in all */

/* A loop that is being carried out. */
struct macro_loop {
	uint32_t id;			/* number of DO, or index of its o
					 * word */
	uint32_t depth;			/* frame it is in */
	uint32_t left;			/* rounds of a repeat */
	struct nc_place place;
};

struct macro_named {
	char name[MACRO_NAME_MAX];
	uint32_t level;			/* 0: global */
	double value;
};

enum oword_kind {
	OWORD_SUB, OWORD_ENDSUB, OWORD_CALL, OWORD_RETURN,
	OWORD_IF, OWORD_ELSEIF, OWORD_ELSE, OWORD_ENDIF,
	OWORD_WHILE, OWORD_ENDWHILE, OWORD_DO, OWORD_REPEAT, OWORD_ENDREPEAT,
	OWORD_BREAK, OWORD_CONTINUE, OWORD_NKINDS
};

/* The place of an o word. */
struct oword {
	char name[MACRO_NAME_MAX];
	struct nc_place place;
	uint32_t behind;		/* where its keyword ends in its line */
	uint8_t kind;			/* enum oword_kind */
};

struct nc_macro {
	double variable[MACRO_VARIABLES];	/* NAN: vacant */
	double local[INTERP_NC_DEPTH_MAX + 1][MACRO_LOCALS];
	uint32_t level;			/* of local in use */
	struct macro_named named[MACRO_NAMED_MAX];
	uint32_t nnamed;
	struct macro_loop loop[MACRO_LOOPS];
	uint32_t nloops;
	uint32_t rounds;
	/* For each frame, whether its call made local variables. */
	bool own_level[INTERP_NC_DEPTH_MAX + 1];	/* with locals */
	struct oword *oword;		/* NULL: they were not searched for
					 * yet */
	uint32_t nowords;

	struct nc_place place;		/* of the line in the buffer */
	uint8_t text[MACRO_BUFFER];
	uint16_t column[MACRO_BUFFER + 1];	/* column of each byte, from 1;
						 * with MACRO_COMPUTED */
	size_t used;
};

/* The source line that is being expanded. */
struct macro_line {
	struct nc_reader *r;
	struct nc_macro *m;
	const uint8_t *p, *end;		/* its rest */
	int brackets;
	bool idle;			/* what is read is not done, and its
					 * values are not known */
	double parts;			/* ROUND rounds to 1 / parts; 0: to
					 * whole numbers */
};

/* All of these return -EINVAL, with the diag filled, if they refuse. */

/**
 * nc_macro_line() - expand the line from @at to @end, if it has anything to
 * expand.  Return: 1 if it was written to r->macro->text; 0 if there was
 * nothing to do.
 */
int nc_macro_line(struct nc_reader *r, const uint8_t *at, const uint8_t *end);

/** nc_macro_wanted() - has the line from @p to @end anything to expand? */
bool nc_macro_wanted(const struct nc_reader *r, const uint8_t *p,
		     const uint8_t *end);

/** nc_macro_make() - r->macro; NULL: no memory */
struct nc_macro *nc_macro_make(struct nc_reader *r);

void nc_macro_free(struct nc_reader *r);

/**
 * nc_macro_jump() - go on at line N@n of the program of frame r->depth.  @at:
 * the word that asks for it, M99 P.
 */
int nc_macro_jump(struct nc_reader *r, const uint8_t *at, double n);

/**
 * nc_macro_leave() - the frame r->depth ends, and its local variables with it.
 */
void nc_macro_leave(struct nc_reader *r);

/* macro_expr.c */
int macro_expression(struct macro_line *l, double *ret);	/* to its end */
int macro_bracket(struct macro_line *l, double *ret);	/* at the [ */
int macro_value(struct macro_line *l, double *ret);	/* # [ number SIN[ */
int macro_truth(struct macro_line *l, bool *ret);	/* a bracket */

/* macro_var.c */
int macro_get(struct macro_line *l, const uint8_t *at, double number,
	      double *ret);
int macro_set(struct macro_line *l, const uint8_t *at, double number, double v);
int macro_get_named(struct macro_line *l, const uint8_t *at, const char *name,
		    double *ret);
struct macro_named *macro_find(struct nc_macro *m, const char *name);
int macro_name(struct macro_line *l, char name[MACRO_NAME_MAX]); /* at the < */
int macro_set_named(struct macro_line *l, const uint8_t *at, const char *name,
		    double v);

/* macro_flow.c: 1 if the line was one of these, 0 if not. */
int macro_flow(struct macro_line *l);
int macro_round(struct macro_line *l, const uint8_t *at);

/* Refuse what stands at @behind, up to the end of the line, if it is more than
 * comments: it would not be carried out.  @line: that line.  Return: 1. */
int macro_ends(struct macro_line *l, const uint8_t *behind, uint32_t line);
int macro_assign(struct macro_line *l);	/* one #.. = .., at the # */

/* oword.c: the same. */
int macro_oword(struct macro_line *l);

/* A comment may stand wherever a blank may. */
static inline void macro_blanks(struct macro_line *l)
{
	l->p = nc_skip_void(l->p, l->end);
}

/**
 * macro_word() - is the next word @word, in upper or lower case?  If so, go
 * behind it.
 */
bool macro_word(struct macro_line *l, const char *word);

/** macro_refuse() - refuse what is at @at, in columns of the text. */
int macro_refuse(struct macro_line *l, const uint8_t *at, const char *wanted,
		 const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

#endif /* CODE_MACRO_H */
