/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scurve.c - plans of constant jerk, phase by phase
 *
 * To a speed v1.  Letting go of the acceleration a at full jerk leads to the
 * speed vz = v + a*|a|/(2*j).  If v1 is above it, the acceleration goes up to a
 * peak p and down to 0, else the mirror of it, and by the areas under it
 *
 *	p*p = j*(v1 - v) + a*a/2
 *
 * A peak above the limit is cut off, and the limit held for
 * (p*p - limit*limit)/(j*limit).
 *
 * To a place.  Stopping at once leads to some place; the other one lies beyond
 * it, or short of it.  Toward it goes the ramp to full speed.  Left at a time
 * tau, to stop at once from there, it leads to
 *
 *	D(tau) = x(tau) + way from v(tau), a(tau) to a stand
 *
 * which only grows with tau, because more acceleration at the same speed is
 * more way.  So one root of one equation is the plan, whatever it begins with;
 * beyond the ramp it is a cruise.  Braking, turning back and easing off a brake
 * are no cases of their own.  To pass a place at a speed is the same with that
 * speed for a stand, if the place can still be met so.
 */
#include "interp/scurve.h"

#include <math.h>

/* For a root between two ends; bisection alone would need about 50. */
#define TRIES	100

/*
 * How near to a root it must be, relative to the way and to the error of
 * leaving at once.  Rounding errors are 1e-13 of these: where they alone are
 * left, no further try would come nearer.  The error of leaving last does not
 * count, because it may be a thousand times the whole plan.
 */
#define ENOUGH	1e-12

struct ramp {
	double dt[INTERP_SCURVE_RAMP], j[INTERP_SCURVE_RAMP];
};

static struct interp_scurve_state go(struct interp_scurve_state s, double j,
				     double t)
{
	return (struct interp_scurve_state) {
		s.x_mm + t * (s.v_mm_s + t * (s.a_mm_s2 / 2 + t * j / 6)),
		s.v_mm_s + t * (s.a_mm_s2 + t * j / 2),
		s.a_mm_s2 + t * j,
	};
}

/* Phase 0: an acceleration above its limit comes down to the limit. */
static struct interp_scurve_state ease(struct ramp *r,
				       const struct interp_scurve_limits *l,
				       struct interp_scurve_state s)
{
	const double j = l->j_max_mm_s3;
	const double over = s.a_mm_s2 - l->a_up_mm_s2;
	const double under = -l->a_down_mm_s2 - s.a_mm_s2;

	r->dt[0] = fmax(0, fmax(over, under)) / j;
	r->j[0] = over > 0 ? -j : j;
	return r->dt[0] > 0 ? go(s, r->j[0], r->dt[0]) : s;
}

static struct ramp ramp_to(const struct interp_scurve_limits *l,
			   struct interp_scurve_state s, double v1)
{
	const double j = l->j_max_mm_s3;
	double dv, a, sign, limit, p, pp;
	struct ramp r;

	s = ease(&r, l, s);
	dv = v1 - s.v_mm_s;
	a = s.a_mm_s2;
	sign = dv * 2 * j >= a * fabs(a) ? 1 : -1;
	limit = sign > 0 ? l->a_up_mm_s2 : l->a_down_mm_s2;
	pp = fmax(0, sign * j * dv + a * a / 2);
	p = fmin(sqrt(pp), limit);
	r.dt[1] = fmax(0, (p - sign * a) / j);
	r.j[1] = sign * j;
	r.dt[2] = fmax(0, pp - limit * limit) / (j * limit);
	r.j[2] = 0;
	r.dt[3] = p / j;
	r.j[3] = -sign * j;
	return r;
}

/* The last phase ends exactly with the speed for which it was made. */
static struct interp_scurve_state after(const struct ramp *r,
					struct interp_scurve_state s, double v1)
{
	for (int i = 0; i < INTERP_SCURVE_RAMP; i++)
		s = go(s, r->j[i], r->dt[i]);
	s.v_mm_s = v1;
	s.a_mm_s2 = 0;
	return s;
}

static double place_at(const struct interp_scurve_limits *l,
		       struct interp_scurve_state s, double v1)
{
	const struct ramp r = ramp_to(l, s, v1);

	return after(&r, s, v1).x_mm;
}

double interp_scurve_way_mm(const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double to_mm_s)
{
	const struct interp_scurve_state s = { 0, v_mm_s, a_mm_s2 };

	return place_at(l, s, to_mm_s);
}

/* -- A plan, phase by phase ----------------------------------------------- */

static void begin(struct interp_scurve *c, double v, double a)
{
	c->n = 0;
	c->end_s = 0;
	c->end = (struct interp_scurve_state) { 0, v, a };
}

static void add(struct interp_scurve *c, double j, double dt)
{
	if (!(dt > 0))
		return;
	c->t_s[c->n] = c->end_s;
	c->j_mm_s3[c->n] = j;
	c->from[c->n] = c->end;
	c->n++;
	c->end = go(c->end, j, dt);
	c->end_s += dt;
}

static void add_ramp(struct interp_scurve *c,
		     const struct interp_scurve_limits *l, double v1)
{
	const struct ramp r = ramp_to(l, c->end, v1);

	for (int i = 0; i < INTERP_SCURVE_RAMP; i++)
		add(c, r.j[i], r.dt[i]);
	c->end.v_mm_s = v1;
	c->end.a_mm_s2 = 0;
}

void interp_scurve_to_speed(struct interp_scurve *c,
			    const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double to_mm_s)
{
	begin(c, v_mm_s, a_mm_s2);
	add_ramp(c, l, to_mm_s);
}

struct interp_scurve_state interp_scurve_at(const struct interp_scurve *c,
					    double t_s)
{
	int i = c->n - 1;

	if (t_s >= c->end_s)
		return go(c->end, 0, t_s - c->end_s);
	while (i > 0 && t_s < c->t_s[i])
		i--;
	return go(c->from[i], c->j_mm_s3[i], t_s - c->t_s[i]);
}

/*
 * From @s at constant jerk, the later time at which the speed is v1.  If the
 * motion has a peak, a falling speed is past it.
 */
static double falls_s(const struct interp_scurve_state *s, double j, double v1)
{
	const double a = s->a_mm_s2, dv = s->v_mm_s - v1;
	const double root = sqrt(fmax(0, a * a - 2 * j * dv));

	if (a > 0)
		return (a + root) / -j;
	return root > a ? 2 * dv / (root - a) : 0;
}

double interp_scurve_falls_mm(const struct interp_scurve *c, double v_mm_s)
{
	double after = c->end.v_mm_s;

	for (int i = c->n - 1; i >= 0; i--) {
		const struct interp_scurve_state *s = &c->from[i];
		const double j = c->j_mm_s3[i], a = s->a_mm_s2;
		const double top = a > 0 && j < 0 ?
					   s->v_mm_s - a * a / (2 * j) :
					   s->v_mm_s;

		if (after <= v_mm_s && top >= v_mm_s)
			return go(*s, j, falls_s(s, j, v_mm_s)).x_mm;
		after = s->v_mm_s;
	}
	return 0;
}

/* -- To a place ----------------------------------------------------------- */

struct leave {
	const struct interp_scurve_limits *l;
	struct interp_scurve_state from;
	double j;			/* of the phase in which it is left */
	double way, toward;		/* the place; the direction, +1 or -1 */
	double v1;			/* the speed at the place */
};

/* If it is left at @t and then slowed: how far it ends beyond the place, in its
 * direction. */
static double beyond(const struct leave *k, double t)
{
	return k->toward * (place_at(k->l, go(k->from, k->j, t), k->v1) -
			    k->way);
}

/* A time that was tried, and its result. */
struct tried {
	double t, f;
};

/*
 * Where between @a and @b to look next, as a share of the way: by inverse
 * quadratic interpolation through all three points where the result is
 * certainly between them, otherwise the middle.
 */
static double share(const struct tried *a, const struct tried *b,
		    const struct tried *c)
{
	const double xi = (a->t - b->t) / (c->t - b->t);
	const double phi = (a->f - b->f) / (c->f - b->f);

	if (!(phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi))
		return 0.5;
	return a->f / (b->f - a->f) * c->f / (b->f - c->f) +
	       (c->t - a->t) / (b->t - a->t) * a->f / (c->f - a->f) *
	       b->f / (c->f - b->f);
}

/*
 * The root between 0 and @hi, by Chandrupatla's method ("A new hybrid
 * quadratic/bisection algorithm for finding the zero of a nonlinear function",
 * 1997): some eight tries, and never more than bisection would need by much.
 */
static double leave_at(const struct leave *k, double hi, double f_hi)
{
	struct tried a = { 0, beyond(k, 0) }, b = { hi, f_hi }, c, x;
	const double enough = ENOUGH * (fabs(a.f) + fabs(k->way));
	double part = a.f / (a.f - b.f);

	if (a.f >= -enough)
		return 0;
	for (int i = 0; i < TRIES; i++) {
		x.t = a.t + part * (b.t - a.t);
		x.f = beyond(k, x.t);
		if (fabs(x.f) <= enough || x.t == a.t || x.t == b.t)
			return x.t;
		if ((x.f < 0) == (a.f < 0)) {
			c = a;
		} else {
			c = b;
			b = a;
		}
		a = x;
		part = share(&a, &b, &c);
	}
	return a.f < 0 ? a.t : b.t;
}

/* Add the ramp, as far as it goes before it must slow down. */
static void go_toward(struct interp_scurve *c,
		      const struct interp_scurve_limits *l, struct leave *k)
{
	const double full = k->toward * l->v_max_mm_s;
	const struct ramp r = ramp_to(l, c->end, full);

	for (int i = 0; i < INTERP_SCURVE_RAMP; i++) {
		double f;

		k->from = c->end;
		k->j = r.j[i];
		f = beyond(k, r.dt[i]);
		if (f >= 0) {
			add(c, r.j[i], leave_at(k, r.dt[i], f));
			return;
		}
		add(c, r.j[i], r.dt[i]);
	}
	c->end.v_mm_s = full;
	c->end.a_mm_s2 = 0;
	add(c, 0, (k->way - place_at(l, c->end, k->v1)) / full);
}

void interp_scurve_to_pass(struct interp_scurve *c,
			   const struct interp_scurve_limits *l,
			   const struct interp_scurve_state *from,
			   double way_mm, double pass_mm_s)
{
	const double at_once = interp_scurve_way_mm(l, from->v_mm_s,
						    from->a_mm_s2, pass_mm_s);
	struct leave k = { .l = l, .way = way_mm, .v1 = pass_mm_s,
			   .toward = way_mm > at_once ? 1 : -1 };

	begin(c, from->v_mm_s, from->a_mm_s2);
	if (way_mm != at_once)
		go_toward(c, l, &k);
	add_ramp(c, l, pass_mm_s);
	c->end.x_mm = way_mm;
}

void interp_scurve_to_place(struct interp_scurve *c,
			    const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double way_mm)
{
	const struct interp_scurve_state from = { 0, v_mm_s, a_mm_s2 };

	interp_scurve_to_pass(c, l, &from, way_mm, 0);
}
