/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tech.h - one technology condition: what the generator and the gap servo do
 *
 * A row of numbers, one for each field.  NAN is "not given": the machine
 * file's value stands.  interp_tech_field[] has every field's name, unit and
 * range; the table reader, the program's check, `set` and the documentation
 * come from it.
 *
 * Units: in every name; voltages are of the gap, polarity is that of the
 * electrode.
 * Threads: any.
 */
#ifndef INTERP_TECH_H
#define INTERP_TECH_H

#include <stdbool.h>

enum interp_tech_id {
	/* The generator. */
	INTERP_TECH_PEAK_A,
	INTERP_TECH_ON_US,
	INTERP_TECH_OFF_US,
	INTERP_TECH_POLARITY,		/* +1 or -1 */
	INTERP_TECH_IGNITION_V,		/* open-circuit voltage */
	INTERP_TECH_ISO,		/* 1: pulses of equal energy */
	/* The gap servo. */
	INTERP_TECH_SERVO_V,
	INTERP_TECH_WINDOW_LOW_V,	/* between them: stand */
	INTERP_TECH_WINDOW_HIGH_V,
	INTERP_TECH_SHORT_V,
	INTERP_TECH_OPEN_V,
	INTERP_TECH_GAIN_MM_S_V,	/* proportional */
	INTERP_TECH_INTEGRAL_S,		/* reset time; 0: none */
	INTERP_TECH_FEED_MAX_MM_S,
	INTERP_TECH_RETRACT_MM_S,
	INTERP_TECH_ABORT_COUNT,	/* retracts in a row, then a fault */
	/* The jump. */
	INTERP_TECH_JUMP_MM,
	INTERP_TECH_JUMP_EVERY_S,	/* of erosion */
	INTERP_TECH_JUMP_DEPTH_MM,	/* of erosion; 0: by time */
	INTERP_TECH_JUMP_SHORT_OF_MM,
	/* Where it is used: sequences and orbits. */
	INTERP_TECH_GAP_MM,		/* spark gap, per side */
	INTERP_TECH_ALLOWANCE_MM,	/* left for the conditions after it */
	INTERP_TECH_ORBIT_MM,		/* radius, per side */
	INTERP_TECH_ORBIT_STEP_DEG,	/* of a spherical orbit */
	/* What it yields, for the table's reader. */
	INTERP_TECH_REMOVAL_MM3_MIN,
	INTERP_TECH_WEAR,		/* electrode lost per part removed */
	INTERP_TECH_ROUGHNESS_UM,	/* Ra */
	INTERP_NTECH
};

struct interp_tech {
	double v[INTERP_NTECH];		/* NAN: not given */
};

struct interp_tech_field {
	const char *name;		/* as in a table's head: "servo_v" */
	const char *unit;		/* "" if it has none */
	double min, max;
	bool whole;			/* no fraction */
	const char *help;
};

extern const struct interp_tech_field interp_tech_field[INTERP_NTECH];

/** interp_tech_clear() - nothing given. RT-safe. */
void interp_tech_clear(struct interp_tech *t);

/** interp_tech_given() - is field @id given? RT-safe. */
static inline bool interp_tech_given(const struct interp_tech *t,
				     enum interp_tech_id id)
{
	return t->v[id] == t->v[id];
}

/** interp_tech_ok() - is every field given within its range? RT-safe. */
bool interp_tech_ok(const struct interp_tech *t);

/** interp_tech_value_ok() - may field @id be @value? RT-safe. */
bool interp_tech_value_ok(enum interp_tech_id id, double value);

/** interp_tech_over() - what @over gives goes into @t. RT-safe. */
void interp_tech_over(struct interp_tech *t, const struct interp_tech *over);

/* A field that stays below another, or at most at it. */
struct interp_tech_order {
	enum interp_tech_id low, high;
	bool or_equal;
};

/**
 * interp_tech_order() - the first order that @t breaks, or NULL.
 *
 * short_v < window_low_v <= servo_v <= window_high_v < open_v < ignition_v,
 * and short_v < servo_v < open_v; a field that is not given, and a window limit of 0, break none.
 * RT-safe.
 */
const struct interp_tech_order *interp_tech_order(const struct interp_tech *t);

/** interp_tech_is_live() - does the cycle go by field @id, so that it may be
 *  set while it cuts?  The others are for sequences, orbits and readers. */
static inline bool interp_tech_is_live(enum interp_tech_id id)
{
	return id < INTERP_TECH_GAP_MM;
}

/** interp_tech_find() - the field called @name, or -ENOENT. */
int interp_tech_find(const char *name);

/**
 * interp_tech_short_of_mm() - how far in front of the end a condition of a
 * sequence stops, whose last condition is @last.
 *
 * Its allowance, and what its spark gap is wider than the last one's: the end
 * is where the electrode stands when the last condition is done.  Never
 * negative; what is not given counts as 0, a gap only if both are given.
 */
double interp_tech_short_of_mm(const struct interp_tech *t,
			       const struct interp_tech *last);

/**
 * interp_tech_orbit_mm() - radius of an orbit with an electrode that is
 * @undersize_mm smaller per side than the cavity.
 *
 * undersize - gap_mm - allowance_mm, so that the condition leaves its
 * allowance at the walls.  Never negative; what is not given counts as 0.
 */
double interp_tech_orbit_mm(const struct interp_tech *t, double undersize_mm);

#endif /* INTERP_TECH_H */
