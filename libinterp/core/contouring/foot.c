/* SPDX-License-Identifier: Apache-2.0 */
/*
 * foot.c - the foot of a place on a path, from the last one on
 *
 * With q the actual place and C the path, the foot is where
 *
 *	g(u) = (q - C(u)) . C'(u)
 *
 * changes from "farther on" to "behind".  g / |C'|^2 is a step that stops
 * short on the inside of a bend; a secant through the last two looks goes most
 * of the rest.  A step beyond the foot brackets it, and the bracket is closed
 * by false position with the Illinois rule.
 *
 * At a tip that is cut off the foot comes to a stand before the tip, while the
 * place goes over to the branch beyond it.  So a foot that is far off is
 * compared with points up to where the set values are.
 */
#include "interp/foot.h"

#include <math.h>
#include <stddef.h>

#define CLOSE_MM	1e-8		/* nearer than any sensor can see */
#define BACK_MM		0.005		/* this is encoder noise, not a
					 * branch */

/* One evaluation of the path. */
struct look {
	double u, g, speed;		/* speed: |C'|, mm per u */
	double mm;			/* distance from q */
};

static struct look look_at(const struct interp_contour_path *p, double u,
			   const double *q)
{
	struct interp_contour_point c;
	struct look l = { .u = u };
	double square = 0, off = 0;

	p->at(p->arg, u, &c);
	for (int i = 0; i < p->naxes; i++) {
		const double d = q[i] - c.mm[i];

		l.g += d * c.per_u[i];
		off += d * d;
		square += c.per_u[i] * c.per_u[i];
	}
	l.speed = sqrt(square);
	l.mm = sqrt(off);
	return l;
}

/* Close in on the foot between @a, which is short of it, and @b, which is
 * not. */
static struct look close_in(const struct interp_contour_path *p,
			    const double *q, struct look a, struct look b)
{
	double ga = a.g, gb = b.g;

	for (int i = 0; i < INTERP_CONTOUR_TRIES; i++) {
		struct look m;

		if (fabs(b.u - a.u) * a.speed < CLOSE_MM || ga == gb)
			break;
		m = look_at(p, a.u + (b.u - a.u) * (ga / (ga - gb)), q);
		if ((m.g > 0) == (a.g > 0)) {
			a = m;
			ga = m.g;
			gb /= 2;
		} else {
			b = m;
			gb = m.g;
			ga /= 2;
		}
	}
	return fabs(a.g) < fabs(b.g) ? a : b;
}

/* How far from @l the next look is; the look before was @before. */
static double stride(const struct interp_contour *c, const struct look *l,
		     const struct look *before)
{
	const double longest = c->look_mm / l->speed;
	double du = fabs(l->g) / (l->speed * l->speed);

	if (before && fabs(before->g) > fabs(l->g))
		du = fmax(du, fabs(l->g * (l->u - before->u) /
				   (before->g - l->g)));
	return fmin(du, longest);
}

/* The first foot from @l on, in the direction of its g, but not beyond
 * @end_u. */
static struct look search(const struct interp_contour *c, const double *q,
			  struct look l, double end_u)
{
	const int way = l.g > 0 ? 1 : -1;
	struct look before = l;

	for (int i = 0; i < INTERP_CONTOUR_LOOKS; i++) {
		const double du = stride(c, &l, i ? &before : NULL);
		double u = l.u + way * du;
		struct look next;

		if (du * l.speed < CLOSE_MM)
			break;
		if (way * (u - end_u) >= 0)
			u = end_u;
		next = look_at(c->path, u, q);
		if ((next.g > 0) != (way > 0))
			return close_in(c->path, q, l, next);
		before = l;
		l = next;
		if (u == end_u)
			break;
	}
	return l;
}

/* How far the foot may go in the direction of @l->g. */
static double bound(const struct interp_contour *c, const struct look *l)
{
	const struct interp_contour_path *p = c->path;
	const int way = l->g > 0 ? 1 : -1;
	const double end = way > 0 ? p->u_max : p->u_min;
	double back;

	if (way == c->way)
		return end;
	back = c->far_u + way * c->back_mm / l->speed;
	if (way * (back - l->u) < 0)
		back = l->u;
	return way * (back - end) > 0 ? end : back;
}

/* A point between @foot and the targets that is nearer than @foot, if there is
 * one. */
static struct look leap(const struct interp_contour *c, const double *q,
			struct look foot, double set_u)
{
	const double du = (set_u - foot.u) / INTERP_CONTOUR_LOOKS;
	struct look best = foot;

	for (int i = 1; i <= INTERP_CONTOUR_LOOKS; i++) {
		const struct look l = look_at(c->path, foot.u + i * du, q);

		if (l.mm < best.mm)
			best = l;
	}
	if (best.u == foot.u)
		return foot;
	return search(c, q, best, best.g * c->way > 0 ? set_u : foot.u);
}

void interp_contour_begin(struct interp_contour *c,
			  const struct interp_contour_path *path, double u,
			  double look_mm)
{
	*c = (struct interp_contour) {
		.path = path, .look_mm = look_mm, .back_mm = BACK_MM,
		.u = u, .far_u = u, .set_u = u, .way = 1,
	};
}

static void set_way(struct interp_contour *c, double set_u)
{
	const int way = set_u > c->set_u ? 1 : set_u < c->set_u ? -1 : c->way;

	if (way != c->way)
		c->far_u = c->u;
	c->way = way;
	c->set_u = set_u;
}

void interp_contour_step(struct interp_contour *c, const double *actual_mm,
			 double set_u, struct interp_contour_error *ret)
{
	struct look l = look_at(c->path, c->u, actual_mm);
	struct interp_contour_point p;

	set_way(c, set_u);
	l = search(c, actual_mm, l, bound(c, &l));
	if (c->way * (set_u - l.u) > 0 && l.mm > c->look_mm / 2)
		l = leap(c, actual_mm, l, set_u);
	c->u = l.u;
	if (c->way * (c->u - c->far_u) > 0)
		c->far_u = c->u;
	c->path->at(c->path->arg, c->u, &p);
	ret->u = c->u;
	ret->mm = l.mm;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->vector_mm[i] = i < c->path->naxes ?
				    p.mm[i] - actual_mm[i] : 0;
}
