/* SPDX-License-Identifier: Apache-2.0 */
/*
 * speeds.h - how fast a way from stand to stand is passed, as a table
 *
 * A knot says when a place is passed, and with which speed and acceleration.
 * Between two knots the place is the polynomial of degree 5 by time that has
 * all three at both: a piece of constant jerk is met exactly, and nothing adds
 * up from knot to knot.  Where a corner is passed there may be two knots of one
 * place, which differ in their acceleration.
 *
 * The same table is good for the way back: there its time goes back.
 *
 * Units: in every name.
 * Threads: RT-safe.
 */
#ifndef INTERP_SPEEDS_H
#define INTERP_SPEEDS_H

#include "interp/scurve.h"

#include <stddef.h>

struct interp_speed_knot {
	double s_mm, t_s;		/* neither ever goes down */
	float v_mm_s, a_mm_s2;
};

struct interp_speeds {
	const struct interp_speed_knot *at;
	size_t n;			/* 2 or more */
};

/** interp_speeds_at() - the state at the time @t_s, which is cut to the
 *  table's.  Its place is that along the path. */
struct interp_scurve_state interp_speeds_at(const struct interp_speeds *k,
					    double t_s);

/** interp_speeds_s() - when the place @s_mm is passed; it is cut, too. */
double interp_speeds_s(const struct interp_speeds *k, double s_mm);

#endif /* INTERP_SPEEDS_H */
