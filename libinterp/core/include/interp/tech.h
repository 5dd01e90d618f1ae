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

/*
 * T(id, name, unit, min, max, whole, help): one field a row.  Where the machine
 * file has the same value, its range is the same.  The rows that may go to the
 * generator come first, then the others that the cycle goes by.
 */
/* clang-format off */
#define INTERP_TECH_ROWS(T) \
/* The generator: process.h of the daemon says how it is reached. */ \
T(PEAK_A, "peak_a", "A", 0, 1000, false, \
  "peak current of a pulse") \
T(ON_US, "on_us", "us", 0.1, 100000, false, \
  "length of a pulse") \
T(OFF_US, "off_us", "us", 0.1, 100000, false, \
  "pause after a pulse") \
T(POLARITY, "polarity", "", -1, 1, true, \
  "of the electrode: 1 positive, -1 negative") \
T(IGNITION_V, "ignition_v", "V", 10, 1000, false, \
  "open-circuit voltage") \
T(ISO, "iso", "", 0, 1, true, \
  "1: the pulse is timed from its ignition") \
/* The gap servo; some generators take its reference too. */ \
T(SERVO_V, "servo_v", "V", 0.1, 500, false, \
  "mean gap voltage to hold") \
T(WINDOW_LOW_V, "window_low_v", "V", 0, 500, false, \
  "lower end of the window in which the servo stands") \
T(WINDOW_HIGH_V, "window_high_v", "V", 0, 500, false, \
  "upper end of the window in which the servo stands") \
T(SHORT_V, "short_v", "V", 0, 500, false, \
  "below: a short circuit") \
T(OPEN_V, "open_v", "V", 0.1, 500, false, \
  "above: no sparks yet") \
T(GAIN_MM_S_V, "gain_mm_s_v", "mm/s/V", 1e-6, 10, false, \
  "feed per volt outside the window") \
T(INTEGRAL_S, "integral_s", "s", 0, 1000, false, \
  "reset time of the integral; 0: none") \
T(FEED_MAX_MM_S, "feed_max_mm_s", "mm/s", 1e-6, 100, false, \
  "fastest feed while eroding") \
T(RETRACT_MM_S, "retract_mm_s", "mm/s", 0.001, 1000, false, \
  "back along the path on a short") \
T(ABORT_COUNT, "abort_count", "", 0, 1e9, true, \
  "retracts without erosion between, then a fault; 0: never") \
/* The jump. */ \
T(JUMP_MM, "jump_mm", "mm", 0, 500, false, \
  "height of a jump; 0: none") \
T(JUMP_EVERY_S, "jump_every_s", "s", 0.01, 86400, false, \
  "erosion between two jumps") \
T(JUMP_DEPTH_MM, "jump_depth_mm", "mm", 0, 1000, false, \
  "depth eroded between two jumps; 0: by time") \
T(JUMP_SHORT_OF_MM, "jump_short_of_mm", "mm", 0, 10, false, \
  "a jump comes back to this far above the cut") \
/* Where it is used: sequences and orbits. */ \
T(GAP_MM, "gap_mm", "mm", 0, 10, false, \
  "spark gap, per side") \
T(ALLOWANCE_MM, "allowance_mm", "mm", 0, 100, false, \
  "left for the conditions after it, per side") \
T(ORBIT_MM, "orbit_mm", "mm", 0, 100, false, \
  "radius of the orbit, per side") \
T(ORBIT_STEP_DEG, "orbit_step_deg", "deg", 0, 90, false, \
  "step of a spherical orbit") \
/* What it yields, for the table's reader. */ \
T(REMOVAL_MM3_MIN, "removal_mm3_min", "mm3/min", 0, 1e6, false, \
  "removal to expect") \
T(WEAR, "wear", "", 0, 10, false, \
  "electrode lost per part removed") \
T(ROUGHNESS_UM, "roughness_um", "um Ra", 0, 1000, false, \
  "surface to expect")
/* clang-format on */

#define INTERP_TECH_ID(id, ...)	INTERP_TECH_##id,

enum interp_tech_id {
	INTERP_TECH_ROWS(INTERP_TECH_ID)
	INTERP_NTECH,
	INTERP_NGENERATOR = INTERP_TECH_WINDOW_LOW_V	/* those that may go to
							 * the generator */
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
 * short_v < window_low_v <= servo_v <= window_high_v < open_v < ignition_v, and
 * short_v < servo_v < open_v; a field that is not given, and a window limit of
 * 0, break none.  RT-safe.
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

#endif /* INTERP_TECH_H */
