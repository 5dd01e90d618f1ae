/* SPDX-License-Identifier: Apache-2.0 */
/* heading.c - the direction in which a segment begins, and in which it ends */
#include "speed/heading.h"

#include "interp/smaller.h"

#include <math.h>

static uint32_t columns_of(const struct interp_program *p, uint32_t axes)
{
	uint32_t columns = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++)
		columns |= (axes >> p->head->column[j] & 1) << j;
	return columns;
}

void heading_ways_init(struct ways *w, const struct interp_program *p)
{
	*w = (struct ways) {
		.p = p,
		.xyz = columns_of(p, 1u << INTERP_X | 1u << INTERP_Y |
				     1u << INTERP_Z),
		.uv = columns_of(p, 1u << INTERP_U | 1u << INTERP_V),
	};
	for (uint32_t j = 0; j < p->head->naxes; j++)
		w->sub_mm[j] = p->head->pulse_mm[p->head->column[j]] /
			       INTERP_SUB;
}

/* HEADING_COUNTS of what is no line: round an arc it is as the radius is
 * there. */
#define COUNTS_ROUND	1e-6

/* The axes that make the length of a path, as program.h says. */
static uint32_t along_of(const struct ways *w, uint32_t moving)
{
	return moving & w->xyz ? w->xyz :
	       moving & w->uv ? w->uv : ~(w->xyz | w->uv);
}

/* Those of @columns that do not make the length, because what moves beside them
 * goes much farther. */
static uint32_t idle(const struct ways *w, uint32_t columns,
		     const struct heading *h, double counts)
{
	double sum = 0;

	for (uint32_t j = 0; j < w->p->head->naxes && sum < counts; j++)
		if (columns >> j & 1)
			sum += h->rate[j] * h->rate[j];
	return sum < counts ? columns : 0;
}

/* The same, if some move so little beside others that these make it. */
static uint32_t along_by(const struct ways *w, uint32_t moving,
			 const struct heading *h, double counts)
{
	if (moving & w->xyz && moving & ~w->xyz)
		moving &= ~idle(w, w->xyz, h, counts);
	if (moving & w->uv && moving & ~(w->xyz | w->uv))
		moving &= ~idle(w, w->uv, h, counts);
	return along_of(w, moving);
}

/* The way from node to node.  Return: the columns that move. */
COLUMNS_INLINE uint32_t straight(const struct ways *w, uint32_t i,
				 struct heading *h, uint32_t n)
{
	int64_t sub[INTERP_NAXES];
	uint32_t moving = 0;

	heading_straight(w, i, h, sub, n);
	for (uint32_t j = 0; j < n; j++)
		moving |= (uint32_t)(sub[j] != 0) << j;
	return moving;
}

uint32_t heading_column(const struct interp_program *p, uint32_t axis)
{
	uint32_t j = 0;

	while (j + 1 < p->head->naxes && p->head->column[j] != axis)
		j++;
	return j;
}

/* The direction at the angle @turned: along the circle, and outward if the
 * radius grows. */
static void tangent(const struct interp_program *p,
		    const struct interp_arc *arc, double turned,
		    double length_mm, struct heading *h)
{
	const double r = arc->r_mm + arc->dr_mm * turned / arc->sweep;
	const double angle = arc->theta + turned;
	const double round = arc->sweep * r / length_mm;
	const double out = arc->dr_mm / length_mm;

	h->rate[heading_column(p, arc->axis_a)] =
		out * cos(angle) - round * sin(angle);
	h->rate[heading_column(p, arc->axis_b)] =
		out * sin(angle) + round * cos(angle);
}

/*
 * Of two bends, one that takes as much as either: from r at a share to another
 * share takes r times that ratio squared for the acceleration v*v*share^2/r,
 * and to the power of 3/2 for the jerk v^3*share^3/r^2, which is less.
 */
static void bend(struct headings *h, const struct interp_arc *arc,
		 double length_mm)
{
	double r = smaller(arc->r_mm, arc->r_mm + arc->dr_mm);
	double share = fabs(arc->sweep) *
		       larger(arc->r_mm, arc->r_mm + arc->dr_mm) / length_mm;

	if (h->bend_mm > 0) {
		const double most = larger(share, h->share);

		r = smaller(r * pow(most / share, 1.5),
			    h->bend_mm * pow(most / h->share, 1.5));
		share = most;
	}
	h->bend_mm = r;
	h->share = share;
}

static void round_arc(const struct interp_program *p,
		      const struct interp_arc *arc, double length_mm,
		      struct headings *h)
{
	if (!(arc->r_mm > 0) || arc->sweep == 0)
		return;
	tangent(p, arc, 0, length_mm, &h->first);
	tangent(p, arc, arc->sweep, length_mm, &h->last);
	h->round |= 1u << heading_column(p, arc->axis_a) |
		    1u << heading_column(p, arc->axis_b);
	bend(h, arc, length_mm);
}

/* A curve has directions of its own at both ends; its feed takes its bends into
 * account. */
static void round_curve(const struct ways *w, const struct interp_seg *s,
			struct headings *h)
{
	const struct interp_program *p = w->p;
	const struct interp_curve *c = &p->curves[p->pieces[s->arg].curve];
	uint32_t axes = 0;

	for (uint32_t k = 0; k < c->naxes && k < INTERP_NAXES; k++)
		axes |= 1u << (c->axis[k] % INTERP_NAXES);
	h->first.along = h->last.along = along_of(w, columns_of(p, axes));
	interp_program_curve_rate(p, s, false, h->first.rate);
	interp_program_curve_rate(p, s, true, h->last.rate);
}

void heading_of(const struct ways *w, uint32_t i, struct headings *ret)
{
	const struct interp_program *p = w->p;
	const struct interp_seg *s = &p->segs[i];
	uint32_t moving = BY_COLUMNS(p->head->naxes, straight, w, i,
				     &ret->first);

	ret->bend_mm = 0;
	ret->share = 1;
	ret->round = 0;
	if (s->kind == INTERP_ARC)
		moving |= columns_of(p, 1u << p->arcs[s->arg].axis_a |
					1u << p->arcs[s->arg].axis_b);
	if (s->kind == INTERP_PAIR && p->couples[s->arg].side[0].r_mm > 0)
		moving |= columns_of(p, 1u << INTERP_X);
	ret->last = ret->first;
	if (s->kind == INTERP_CURVE) {
		round_curve(w, s, ret);
		return;
	}
	if (s->kind == INTERP_ARC)
		round_arc(p, &p->arcs[s->arg], s->length_mm, ret);
	for (int k = 0; k < 2 && s->kind == INTERP_PAIR; k++)
		round_arc(p, &p->couples[s->arg].side[k], s->length_mm, ret);
	ret->first.along = s->kind == INTERP_ARC ?
			   along_of(w, moving) :
			   along_by(w, moving, &ret->first,
				    s->kind == INTERP_LINE ? HEADING_COUNTS :
							     COUNTS_ROUND);
	ret->last.along = ret->first.along;
}

/* Which columns make the length of a line; 0: it is none. */
static uint32_t line_along(const struct ways *w, uint32_t i)
{
	const uint32_t n = w->p->head->naxes;
	const int64_t *a = w->p->nodes + (uint64_t)i * n, *b = a + n;
	const double half = w->p->segs[i].length_mm / 2;
	struct heading h;
	uint32_t moving;

	if (w->p->segs[i].kind != INTERP_LINE)
		return 0;
	/* Mostly one of X Y Z goes half of the length, and more. */
	for (uint32_t j = 0; j < n; j++)
		if (w->xyz >> j & 1 &&
		    fabs((double)(b[j] - a[j])) * w->sub_mm[j] >= half)
			return w->xyz;
	moving = BY_COLUMNS(n, straight, w, i, &h);
	return along_by(w, moving, &h, HEADING_COUNTS);
}

/* Every line's length is in X Y Z. */
static bool is_usual(const struct ways *w)
{
	return w->xyz == (1u << w->p->head->naxes) - 1;
}

struct heading_run heading_run(const struct ways *w, uint32_t i)
{
	return (struct heading_run) { i + 1, is_usual(w) ? 0 :
							   line_along(w, i) };
}

bool heading_run_on(const struct ways *w, struct heading_run *run, uint32_t to)
{
	if (is_usual(w))
		run->at = run->at < to ? to : run->at;
	for (; run->at < to; run->at++) {
		const uint32_t next = line_along(w, run->at);

		if (run->along && next && next != run->along)
			return true;
		run->along = next ? next : run->along;
	}
	return false;
}
