/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb_reader.h - records of 3B and 4B: text, geometry
 *
 *	threeb_text.c	text into records
 *	threeb_arc.c	the counting length of an arc, and its end from it
 *	threeb.c	records to the builder
 *	threeb_write.c	a program to records
 */
#ifndef CODE_THREEB_H
#define CODE_THREEB_H

#include "interp/threeb.h"

enum threeb_kind {
	THREEB_LINE,			/* L */
	THREEB_CCW,			/* NR */
	THREEB_CW,			/* SR */
	THREEB_END,			/* an end code; from here on: not a
					 * record */
	THREEB_PAUSE,
	THREEB_OVER,			/* the text is at its end */
};

struct threeb_record {
	enum threeb_kind kind;
	int64_t x, y, j, r;		/* units; 0 if blank */
	bool count_y;			/* GY */
	uint8_t quadrant;		/* 1 ... 4 */
	bool minus;			/* 4B: sign in front */
	uint8_t shape;			/* 4B: 1 D convex, 2 DD concave */
	const uint8_t *at, *j_at, *r_at, *z_at;
};

struct threeb_text {
	const uint8_t *p, *end;		/* the next byte; the end of the text */
	const uint8_t *line_at;
	uint32_t line;			/* from 1 */
	bool tail;			/* there was a record on this line */
	bool begun, over;		/* the first record was read; an end
					 * code was read */
	const struct interp_threeb_options *o;
	struct interp_diag *diag;
};

/** threeb_open() - before the first byte. Return: 0 or -EINVAL. */
int threeb_open(struct threeb_text *t, const char *text, size_t bytes);

/** threeb_next() - the next record, or the reason why there is none. */
int threeb_next(struct threeb_text *t, struct threeb_record *ret);

/** threeb_refuse() - fill the diag for the byte at @at. Return: -EINVAL. */
int threeb_refuse(struct threeb_text *t, const uint8_t *at, const char *wanted,
		  const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/* -- Geometry, in units -------------------------------------------------- */

/* An arc from (x, y), seen from its centre. */
struct threeb_arc {
	int64_t x, y;
	bool clockwise, count_y;
};

struct threeb_end {
	int64_t x, y;			/* from the centre */
	bool full;			/* a full circle: the start again */
};

/**
 * threeb_arc_end() - the end to which J leads.  Return: 0, or -ERANGE if it
 * goes past the start.
 */
int threeb_arc_end(const struct threeb_arc *a, int64_t j,
		   struct threeb_end *ret);

/**
 * threeb_arc_j() - the counting length to @e, which is not the centre, rounded.
 * @far: more than half a turn.
 */
int64_t threeb_arc_j(const struct threeb_arc *a, const struct threeb_end *e,
		     bool far);

/** threeb_count_y() - is it GY, by the rule for an arc that ends at (x, y)? */
bool threeb_count_y(int64_t x, int64_t y);

/**
 * threeb_quadrant() - of the direction of a line, or of the start of an arc
 * with its sense.
 */
uint8_t threeb_quadrant(enum threeb_kind kind, int64_t x, int64_t y);

#endif /* CODE_THREEB_H */
