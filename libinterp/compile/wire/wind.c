/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wind.c - how often closed curves go round a place
 */
#include "wire/wind.h"

#include "interp/angle.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define ROWS_MAX	(1u << 20)

int wind_add(struct wind *w, const struct curve *c)
{
	if (w->n == w->room && grow_array(&w->c, &w->room, sizeof(*w->c)))
		return -ENOMEM;
	w->c[w->n] = *c;
	/* A ray must not slip through between two curves. */
	if (w->n)
		w->c[w->n].from = w->c[w->n - 1].to;
	w->n++;
	return 0;
}

void wind_free(struct wind *w)
{
	for (int axis = 0; axis < 2; axis++) {
		free(w->rows[axis].start);
		free(w->rows[axis].id);
	}
	free(w->c);
	*w = (struct wind) { .n = 0 };
}

/* -- Rows ----------------------------------------------------------------- */

/* Along a ray to +X and across it; the same for one to +Y. */
static struct vec turned(struct vec at, int axis)
{
	return axis ? (struct vec) { at.y, -at.x } : at;
}

static void span_of(const struct curve *c, int axis, double ret[2])
{
	const struct curve_box b = curve_bounds(c);
	const double lo = turned(b.lo, axis).y, hi = turned(b.hi, axis).y;

	ret[0] = curve_min(lo, hi);
	ret[1] = curve_max(lo, hi);
}

static uint32_t row_of(const struct wind_rows *r, double across)
{
	const double i = floor((across - r->low) / r->size);

	return (uint32_t)curve_min(curve_max(i, 0), r->n - 1);
}

/* Rows as high as the curves are on average. */
static void rows_size(const struct wind *w, int axis, struct wind_rows *r)
{
	double low = INFINITY, high = -INFINITY, sum = 0;

	for (uint32_t i = 0; i < w->n; i++) {
		double span[2];

		span_of(&w->c[i], axis, span);
		low = curve_min(low, span[0]);
		high = curve_max(high, span[1]);
		sum += span[1] - span[0];
	}
	r->low = low;
	r->size = curve_max(curve_max(sum / w->n,
				      (high - low) / curve_min(w->n, ROWS_MAX)),
			    1e-6);
	r->n = (uint32_t)curve_min((high - low) / r->size, ROWS_MAX) + 1;
}

/* Call it twice: to count (id is NULL), and to enter. */
static void rows_enter(const struct wind *w, int axis, struct wind_rows *r)
{
	for (uint32_t i = 0; i < w->n; i++) {
		double span[2];
		uint32_t last;

		span_of(&w->c[i], axis, span);
		last = row_of(r, span[1]);
		for (uint32_t k = row_of(r, span[0]); k <= last; k++) {
			if (r->id)
				r->id[r->start[k + 1]++] = i;
			else
				r->start[k + 2]++;
		}
	}
}

int wind_ready(struct wind *w)
{
	for (int axis = 0; axis < 2; axis++) {
		struct wind_rows *r = &w->rows[axis];

		rows_size(w, axis, r);
		r->start = calloc(r->n + 2, sizeof(*r->start));
		if (!r->start)
			return -ENOMEM;
		rows_enter(w, axis, r);
		for (uint32_t k = 0; k < r->n; k++)
			r->start[k + 2] += r->start[k + 1];
		r->id = malloc((r->start[r->n + 1] + 1) * sizeof(*r->id));
		if (!r->id)
			return -ENOMEM;
		rows_enter(w, axis, r);
	}
	return 0;
}

/* -- Rays ----------------------------------------------------------------- */

struct ray {
	struct vec at;			/* turned: the ray goes to +X */
	int axis;
	bool own;			/* the place is on the curve asked */
};

/* Does a piece that only rises, or only falls, from @a to @b pass the ray's
 * height?  +1: it rises. */
static int passes(const struct ray *k, struct vec a, struct vec b)
{
	if ((a.y <= k->at.y) == (b.y <= k->at.y))
		return 0;
	return b.y > a.y ? 1 : -1;
}

static int count_line(const struct ray *k, struct vec a, struct vec b)
{
	const int sign = passes(k, a, b);

	if (!sign || k->own)
		return 0;
	return (b.x - a.x) * (k->at.y - a.y) / (b.y - a.y) + a.x > k->at.x ?
	       sign : 0;
}

/* The arc is taken apart at its highest and lowest places. */
static int count_arc(const struct ray *k, const struct curve *c)
{
	const struct vec o = turned(c->centre, k->axis);
	const double theta = c->theta - k->axis * ANGLE_RIGHT;
	const double step = c->sweep < 0 ? -1 : 1;
	/* Quarters of a turn, odd ones highest or lowest. */
	double next = step * floor(step * theta / ANGLE_RIGHT) + step;
	const double end = theta + c->sweep;
	struct vec a = turned(c->from, k->axis), b;
	double from = theta;
	int n = 0;

	for (bool last = false; !last;
	     from = next * ANGLE_RIGHT, next += step) {
		const double past = step * (next * ANGLE_RIGHT - end);
		const double to = past >= 0 ? end : next * ANGLE_RIGHT;
		const double h2 = c->r * c->r -
				  (k->at.y - o.y) * (k->at.y - o.y);
		const double h = h2 > 0 ? sqrt(h2) : 0;
		double x;
		int sign;

		last = past >= 0;
		b = last ? turned(c->to, k->axis) :
			   (struct vec) { o.x + c->r * cos(to),
					  o.y + c->r * sin(to) };
		sign = passes(k, a, b);
		x = cos((from + to) / 2) > 0 ? o.x + h : o.x - h;
		if (k->own ? x > k->at.x + CURVE_SAME_MM : x > k->at.x)
			n += sign;
		a = b;
	}
	return n;
}

/* What the ray's curves count; curve @id is the place's own. */
static int count(const struct wind *w, struct ray *k, uint32_t id)
{
	const struct wind_rows *r = &w->rows[k->axis];
	const uint32_t row = row_of(r, k->at.y);
	int n = 0;

	for (uint32_t i = r->start[row]; i < r->start[row + 1]; i++) {
		const struct curve *q = &w->c[r->id[i]];

		k->own = r->id[i] == id;
		n += q->arc ? count_arc(k, q) :
			      count_line(k, turned(q->from, k->axis),
					 turned(q->to, k->axis));
	}
	return n;
}

int wind_at(const struct wind *w, struct vec at)
{
	struct ray k = { .at = at };

	return count(w, &k, WIND_NO_CURVE);
}

int wind_left(const struct wind *w, const struct curve *c, double t,
	      uint32_t id)
{
	const struct curve part = curve_part(c, t, 1);
	const struct vec way = curve_way(t > 0 ? &part : c, false);
	const int axis = fabs(way.x) > fabs(way.y);
	struct ray k = { .at = turned(curve_at(c, t), axis), .axis = axis };

	return count(w, &k, id) + (turned(way, axis).y > 0);
}
