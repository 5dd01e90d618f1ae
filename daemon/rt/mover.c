/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.c - a trapezoidal move along the path, cycle by cycle
 *
 * A walk that brakes to a stand in n cycles T, by a*T in each, goes
 *
 *	d = v*T + (v - a*T)*T + ... + (v - (n - 1)*a*T)*T
 *
 * with 0 <= v - (n - 1)*a*T <= a*T.  So d alone tells n, the least whole
 * number with n*(n + 1)/2 * a*T*T >= d, and the fastest v that still stops
 * there,
 *
 *	v = d/(n*T) + (n - 1)/2 * a*T
 *
 * Walked for a cycle and asked again, it says v - a*T: the way is met exactly.
 */
#include "mover.h"

#include <math.h>

/* Nearer than this is there. */
#define THERE_MM	1e-9

static double braking_speed(const struct mover_limits *l, double left_mm)
{
	const double at = l->a_max_mm_s2 * l->period_s;
	const double steps = left_mm / (at * l->period_s);
	const double n = floor((sqrt(1 + 8 * steps) + 1) / 2);

	return left_mm / (n * l->period_s) + (n - 1) / 2 * at;
}

/*
 * Far off the answer is v_max, and no root need be drawn: braking from v goes
 * less than v*v/(2*a) + v*T + a*T*T.
 */
static bool far_off(const struct mover_limits *l, double left_mm)
{
	const double at = l->a_max_mm_s2 * l->period_s;
	const double v = l->v_max_mm_s;

	return 2 * l->a_max_mm_s2 * left_mm > v * v + 2 * (v + at) * at;
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
	double want;

	if (far < THERE_MM && fabs(m->v_mm_s) <= at) {
		m->v_mm_s = 0;
		return left_mm;
	}
	want = far_off(l, far) ? l->v_max_mm_s :
				 fmin(l->v_max_mm_s, braking_speed(l, far));
	want = copysign(want, left_mm);
	m->v_mm_s += limit(want - m->v_mm_s, at);
	return m->v_mm_s * l->period_s;
}

double mover_stop(struct mover *m, const struct mover_limits *l)
{
	const double at = l->a_max_mm_s2 * l->period_s;

	m->v_mm_s -= limit(m->v_mm_s, at);
	return m->v_mm_s * l->period_s;
}
