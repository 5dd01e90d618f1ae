/* SPDX-License-Identifier: Apache-2.0 */
/* speeds.c - looks a time or a place up in a table of speeds */
#include "interp/speeds.h"

#include "interp/smaller.h"

#include <math.h>

#define TERMS		6
#define ROOT_STEPS	8		/* of Newton, or a halving each */

/* Between two knots: the place by the share of the time. */
struct piece {
	const struct interp_speed_knot *from;
	double t_s;
	double c[TERMS];
};

static void piece_of(const struct interp_speed_knot *k, struct piece *ret)
{
	const double t = k[1].t_s - k[0].t_s;
	const double mm = k[1].s_mm - k[0].s_mm;
	const double v0 = (double)k[0].v_mm_s * t;
	const double v1 = (double)k[1].v_mm_s * t;
	const double a0 = (double)k[0].a_mm_s2 * t * t;
	const double a1 = (double)k[1].a_mm_s2 * t * t;

	*ret = (struct piece) { k, t, {
		k[0].s_mm, v0, a0 / 2,
		10 * mm - 6 * v0 - 4 * v1 - 1.5 * a0 + a1 / 2,
		-15 * mm + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
		6 * mm - 3 * (v0 + v1) - (a0 - a1) / 2,
	} };
}

/* At the share @u of it. */
static struct interp_scurve_state piece_at(const struct piece *p, double u)
{
	double x = 0, v = 0, a = 0;

	for (int e = TERMS - 1; e >= 0; e--) {
		a = a * u + 2 * v;
		v = v * u + x;
		x = x * u + p->c[e];
	}
	return (struct interp_scurve_state) {
		x, v / p->t_s, a / (p->t_s * p->t_s)
	};
}

/* The piece before whose end @is lies, of those that take time. */
static size_t find(const struct interp_speeds *k, double is, double
		   (*of)(const struct interp_speed_knot *k))
{
	size_t from = 0, to = k->n - 1;

	while (to - from > 1) {
		const size_t i = (from + to) / 2;

		if (of(&k->at[i]) <= is)
			from = i;
		else
			to = i;
	}
	return from;
}

static double time_of(const struct interp_speed_knot *k)
{
	return k->t_s;
}

static double place_of(const struct interp_speed_knot *k)
{
	return k->s_mm;
}

static struct interp_scurve_state state_of(const struct interp_speed_knot *k)
{
	return (struct interp_scurve_state) { k->s_mm, (double)k->v_mm_s,
					      (double)k->a_mm_s2 };
}

struct interp_scurve_state interp_speeds_at(const struct interp_speeds *k,
					    double t_s)
{
	const struct interp_speed_knot *last = &k->at[k->n - 1];
	struct piece p;

	if (t_s <= k->at[0].t_s)
		return state_of(&k->at[0]);
	if (t_s >= last->t_s)
		return state_of(last);
	piece_of(&k->at[find(k, t_s, time_of)], &p);
	return piece_at(&p, (t_s - p.from->t_s) / p.t_s);
}

/* The place rises all the way. */
double interp_speeds_s(const struct interp_speeds *k, double s_mm)
{
	const struct interp_speed_knot *last = &k->at[k->n - 1];
	double from = 0, to = 1, u = 0.5;
	struct piece p;

	if (s_mm <= k->at[0].s_mm)
		return k->at[0].t_s;
	if (s_mm >= last->s_mm)
		return last->t_s;
	piece_of(&k->at[find(k, s_mm, place_of)], &p);
	for (int i = 0; i < 4 * ROOT_STEPS; i++) {
		const struct interp_scurve_state s = piece_at(&p, u);
		const double off = s.x_mm - s_mm;
		double next;

		from = off > 0 ? from : u;
		to = off > 0 ? u : to;
		next = u - off / (s.v_mm_s * p.t_s);
		if (!(next > from && next < to))
			next = (from + to) / 2;
		if (fabs(next - u) < 1e-12)
			break;
		u = next;
	}
	return p.from->t_s + u * p.t_s;
}
