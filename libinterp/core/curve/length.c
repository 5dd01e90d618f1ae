/* SPDX-License-Identifier: Apache-2.0 */
/*
 * length.c - lengths of curves, and tables that lead from length to parameter
 *
 * A length is a Gauss integral of |C'|.  It is halved until both halves
 * together agree with the whole.  A table is halved until its cubic is at the
 * right place at three points between its stops, or until the way between two
 * stops is shorter than the allowed error: at a cusp |C'| passes through zero,
 * and no cubic of s follows u.
 */
#include "interp/nurbs_length.h"

#include "curve/span.h"

#include <math.h>

#define HALVINGS	40
#define ROUNDING	1e-13		/* relative rounding error of a
					 * length */

/* Length per parameter at @u, in the span that was entered. */
static double nurbs_span_speed(const struct interp_nurbs_eval *e, double u)
{
	struct interp_nurbs_point p;

	nurbs_span_at(e, u, 1, &p);
	return sqrt(interp_nurbs_dot(&e->c, p.d[1], p.d[1]));
}

bool nurbs_span_next(struct interp_nurbs_eval *e)
{
	uint32_t span = e->span + 1;

	while (span < e->c.npoints && e->c.knots[span] == e->c.knots[span + 1])
		span++;
	if (span >= e->c.npoints)
		return false;
	nurbs_span_enter(e, span);
	return true;
}

/* Eight points. */
static double gauss(const struct interp_nurbs_eval *e, double from, double to)
{
	static const double at[] = { 0.1834346424956498, 0.5255324099163290,
				     0.7966664774136267, 0.9602898564975363 };
	static const double by[] = { 0.3626837833783620, 0.3137066458778873,
				     0.2223810344533745, 0.1012285362903763 };
	const double middle = (from + to) / 2, half = (to - from) / 2;
	double sum = 0;

	for (int i = 0; i < 4; i++)
		sum += by[i] * (nurbs_span_speed(e, middle - half * at[i]) +
				nurbs_span_speed(e, middle + half * at[i]));
	return sum * half;
}

/* A part of a span, and its length when it is computed in one piece. */
struct part {
	double from, to, whole, error_mm;
};

static double refine(const struct interp_nurbs_eval *e, const struct part *p,
		     int halvings)
{
	const double middle = (p->from + p->to) / 2;
	const struct part a = { p->from, middle, gauss(e, p->from, middle),
				p->error_mm / 2 };
	const struct part b = { middle, p->to, gauss(e, middle, p->to),
				p->error_mm / 2 };

	if (fabs(a.whole + b.whole - p->whole) <=
	    fmax(p->error_mm, ROUNDING * p->whole) ||
	    halvings == 0 || !(middle > p->from && middle < p->to))
		return a.whole + b.whole;
	return refine(e, &a, halvings - 1) + refine(e, &b, halvings - 1);
}

/* Within the present span. */
static double span_length(const struct interp_nurbs_eval *e, double from,
			  double to, double error_mm)
{
	const struct part p = { from, to, gauss(e, from, to), error_mm };

	return refine(e, &p, HALVINGS);
}

double interp_nurbs_length(struct interp_nurbs_eval *e, double from, double to,
			   double error_mm)
{
	double sum = 0;

	nurbs_span_enter(e, interp_nurbs_span(&e->c, from));
	for (;;) {
		const double end = e->to < to ? e->to : to;

		if (end > from)
			sum += span_length(e, from, end, error_mm);
		from = end;
		if (end >= to || !nurbs_span_next(e))
			return sum;
	}
}

/* -- Tables --------------------------------------------------------------- */

/* The slope that a monotone cubic may have at an end, for a chord of slope
 * @secant. */
static double bounded(double slope, double secant)
{
	return slope < 3 * secant ? slope : 3 * secant;
}

void interp_nurbs_between(const struct interp_nurbs_stop *stop,
			  struct interp_nurbs_between *ret)
{
	const double h = stop[1].s_mm - stop[0].s_mm;
	const double du = stop[1].u - stop[0].u;
	const double secant = h > 0 ? du / h : 0, by = h > 0 ? 1 / h : 0;
	const double m0 = bounded(stop[0].slope, secant);
	const double m1 = bounded(stop[1].slope, secant);

	*ret = (struct interp_nurbs_between) {
		.from_mm = stop[0].s_mm, .to_mm = stop[1].s_mm,
		.a = { stop[0].u, m0, (3 * secant - 2 * m0 - m1) * by,
		       (m0 + m1 - 2 * secant) * by * by },
	};
}

size_t interp_nurbs_stop_of(const struct interp_nurbs_stop *stop, size_t n,
			    double s_mm)
{
	size_t low = 0, high = n - 1;

	while (high - low > 1) {
		const size_t middle = low + (high - low) / 2;

		if (stop[middle].s_mm <= s_mm)
			low = middle;
		else
			high = middle;
	}
	return low;
}

struct table {
	const struct interp_nurbs_eval *e;
	double error_mm;
	struct interp_nurbs_stop *stops;
	size_t n, room;
	struct interp_nurbs_stop last;	/* the stop that was added last */
};

static void add(struct table *t, struct interp_nurbs_stop stop)
{
	if (t->n < t->room)
		t->stops[t->n] = stop;
	t->n++;
	t->last = stop;
}

static double slope_at(const struct table *t, double u)
{
	const double speed = nurbs_span_speed(t->e, u);

	return speed > 0 ? 1 / speed : HUGE_VAL;
}

/* Is the cubic from @a to @b where it should be? */
static bool fits(const struct table *t, const struct interp_nurbs_stop ab[2])
{
	const double h = ab[1].s_mm - ab[0].s_mm;
	struct interp_nurbs_between b;

	if (h <= t->error_mm)
		return true;
	interp_nurbs_between(ab, &b);
	for (int i = 1; i < 4; i++) {
		const double s = h * i / 4;
		const double u = interp_nurbs_between_at(&b, ab[0].s_mm + s);

		if (fabs(span_length(t->e, ab[0].u, u, t->error_mm / 16) - s) >
		    t->error_mm)
			return false;
	}
	return true;
}

static void divide(struct table *t, double to, double length_mm, int halvings)
{
	const struct interp_nurbs_stop ab[2] = {
		t->last, { t->last.s_mm + length_mm, to, slope_at(t, to) }
	};
	const double middle = (t->last.u + to) / 2;
	double first;

	if (halvings == 0 || !(middle > t->last.u && middle < to) ||
	    fits(t, ab)) {
		add(t, ab[1]);
		return;
	}
	first = span_length(t->e, t->last.u, middle, t->error_mm / 16);
	divide(t, middle, first, halvings - 1);
	divide(t, to, ab[1].s_mm - t->last.s_mm, halvings - 1);
}

/* Where |C'| jumps at a knot there are two stops, each with its own slope. */
size_t interp_nurbs_stops(struct interp_nurbs_eval *e,
			  const struct interp_nurbs_range *r,
			  struct interp_nurbs_stop *ret, size_t room)
{
	struct table t = { .e = e, .error_mm = r->error_mm, .stops = ret,
			   .room = room };

	nurbs_span_enter(e, interp_nurbs_span(&e->c, r->from));
	add(&t, (struct interp_nurbs_stop) { 0, r->from,
					     slope_at(&t, r->from) });
	for (;;) {
		const double end = e->to < r->to ? e->to : r->to;
		double slope;

		divide(&t, end, span_length(e, t.last.u, end, r->error_mm / 16),
		       HALVINGS);
		if (end >= r->to || !nurbs_span_next(e))
			return t.n;
		slope = slope_at(&t, end);
		if (fabs(slope - t.last.slope) > 1e-9 * slope)
			add(&t, (struct interp_nurbs_stop) { t.last.s_mm, end,
							     slope });
	}
}
