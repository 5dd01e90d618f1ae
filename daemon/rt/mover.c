/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.c - a trapezoidal move along the path, cycle by cycle
 *
 * From speed v, braking by a*T each cycle T, a walk still goes
 *
 *	v*T + (v - a*T)*T + ... = v*v/(2*a) + v*T/2
 *
 * so the fastest speed that still stops within d is the positive root of
 * v*v + v*a*T = 2*a*d.
 */
#include "mover.h"

#include <math.h>

/* Nearer than this is there. */
#define THERE_MM	1e-9

static double braking_speed(const struct mover_limits *l, double left_mm)
{
	const double at = l->a_max_mm_s2 * l->period_s;

	return (sqrt(at * at + 8 * l->a_max_mm_s2 * left_mm) - at) / 2;
}

static double limit(double v, double max)
{
	return v > max ? max : v < -max ? -max : v;
}

double mover_step(struct mover *m, const struct mover_limits *l,
		  double left_mm)
{
	const double at = l->a_max_mm_s2 * l->period_s;
	const double far = fabs(left_mm);
	double want, ds;

	if (far < THERE_MM && fabs(m->v_mm_s) <= at) {
		m->v_mm_s = 0;
		return left_mm;
	}
	want = copysign(fmin(l->v_max_mm_s, braking_speed(l, far)), left_mm);
	m->v_mm_s += limit(want - m->v_mm_s, at);
	ds = m->v_mm_s * l->period_s;
	/* The last bit: slower than one step of braking, land on the place. */
	if (far <= at * l->period_s && fabs(m->v_mm_s) <= at) {
		m->v_mm_s = 0;
		return left_mm;
	}
	if (ds * left_mm > 0 && fabs(ds) > far)
		ds = left_mm;
	return ds;
}

double mover_stop(struct mover *m, const struct mover_limits *l)
{
	const double at = l->a_max_mm_s2 * l->period_s;

	m->v_mm_s -= limit(m->v_mm_s, at);
	return m->v_mm_s * l->period_s;
}
