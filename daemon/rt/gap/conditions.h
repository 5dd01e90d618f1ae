/* SPDX-License-Identifier: Apache-2.0 */
/*
 * conditions.h - the values in force: machine file, condition, `set`
 *
 * A condition belongs to a part of the path.  Where the cursor stands, the
 * values of the condition there replace those of the machine file; on the way
 * back too.  What is `set` while a condition is in force belongs to that
 * condition until the job ends, and replaces both.
 *
 * Polarity: a `set` counts most, then the last M3 or M4 of the program before
 * the place, then the condition.  Without any of them the electrode is
 * positive.
 *
 * Threads: RT-safe.
 */
#ifndef RT_CONDITIONS_H
#define RT_CONDITIONS_H

#include "interp/tech.h"

#include <stdint.h>

/* Values set in one job; one more is refused. */
#define CONDITIONS_SETS_MAX	64

struct cycle;

struct conditions_set {
	double value;
	uint16_t cond;			/* index, as in struct interp_seg */
	uint8_t field;			/* enum interp_tech_id */
};

/* Private to conditions.c. */
struct conditions {
	uint16_t cond;			/* whose values are in force */
	uint32_t at;			/* the segment up to which it knows
					 * ... */
	uint32_t said;			/* ... the last M3 or M4, enum
					 * interp_aux; 0: none */
	uint16_t of_cut;		/* of where it last was at the farthest
					 * place, ... */
	uint32_t said_of_cut;		/* ... and what was said there */
	uint32_t nsets;
	struct conditions_set set[CONDITIONS_SETS_MAX];
};

enum conditions_result {
	CONDITIONS_DONE,
	CONDITIONS_BAD,			/* no such field, or out of range, or
					 * upside down with the others */
	CONDITIONS_FULL,			/* a value too many */
};

/** conditions_begin() - a program is loaded: nothing set, nothing said.
 *  Return: false if its condition is not fit to be used. */
bool conditions_begin(struct cycle *c);

/** conditions_follow() - the cursor may have come to another condition.
 *  Return: as conditions_begin(). */
bool conditions_follow(struct cycle *c);

/**
 * conditions_set() - in the condition at the farthest place: what is set in a
 * jump, or while it is held in one, is for the cut.  @value NAN takes a set
 * back.
 */
enum conditions_result conditions_set(struct cycle *c, uint32_t field,
				      double value);

/**
 * conditions_restore() - all that was set in the job that is loaded, before a
 * crash.  Return: false, and nothing is set, if it cannot be in force here.
 */
bool conditions_restore(struct cycle *c, const struct conditions_set *sets,
		     uint32_t n);

/**
 * conditions_value() - in force where a set would be.  NAN: the generator's
 * own, or not a field that the cycle goes by.
 */
double conditions_value(const struct cycle *c, uint32_t field);

#endif /* RT_CONDITIONS_H */
