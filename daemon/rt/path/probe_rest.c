/* SPDX-License-Identifier: Apache-2.0 */
/* probe_rest.c - the rest of a program, looked through after a contact */
#include "path/probe_rest.h"
#include "cycle.h"
#include "path/laws.h"

#include <math.h>

/* In a second, so that a short period is not filled by it. */
#define SEGMENTS_S	500000.0

/* By so many pulses more than its tolerance an arc by one axis at a time may be
 * beside its circle, when its places are rounded. */
#define ARC_OFF		1

struct rest {
	const struct interp_program *p;
	int axis;
	double low, high;		/* of the travel, pulses of the
					 * program */
	double off;			/* of the points of an arc, outward */
};

static bool is_outside(const struct rest *k, double pulses)
{
	return pulses < k->low || pulses > k->high;
}

/* How far it is turned when it comes to @angle first, in the direction of its
 * sweep. */
static double turned_to(const struct interp_arc *a, double angle)
{
	double by = (angle - a->theta) / (2 * M_PI);

	by -= floor(by);
	return (a->sweep < 0 && by > 0 ? by - 1 : by) * 2 * M_PI;
}

/* With all axes in a point, less than half a pulse beyond is still inside. */
static double off_of(const struct interp_program *p)
{
	return p->head->strategy == INTERP_SIMULTANEOUS ? -0.5 :
	       ARC_OFF + p->head->tolerance_milli / 1000.0;
}

/* Where it is farthest along the axis. */
static bool arc_leaves(const struct rest *k, const struct interp_arc *a)
{
	const bool first = k->axis == a->axis_a;
	const double centre = first ? a->a_mm : a->b_mm;
	const double pulse_mm = k->p->head->pulse_mm[k->axis];

	if ((!first && k->axis != a->axis_b) || !(a->r_mm > 0))
		return false;
	for (int side = 1; side >= -1; side -= 2) {
		const double angle = (first ? 0 : M_PI / 2) +
				     (side < 0 ? M_PI : 0);
		const double turned = turned_to(a, angle);
		const double r = a->r_mm + a->dr_mm * turned / a->sweep;
		const double at = (centre + side * r) / pulse_mm;

		if (fabs(turned) <= fabs(a->sweep) &&
		    is_outside(k, at + side * k->off))
			return true;
	}
	return false;
}

static bool leaves(const struct rest *k, uint32_t i, uint32_t column)
{
	const struct interp_program *p = k->p;
	const struct interp_seg *s = &p->segs[i];
	const int64_t end = p->nodes[(uint64_t)(i + 1) * p->head->naxes +
				     column];

	if (is_outside(k, interp_round_sub(end)))
		return true;
	if (s->kind == INTERP_ARC)
		return arc_leaves(k, &p->arcs[s->arg]);
	return s->kind == INTERP_PAIR &&
	       (arc_leaves(k, &p->couples[s->arg].side[0]) ||
		arc_leaves(k, &p->couples[s->arg].side[1]));
}

static uint32_t column_of(const struct interp_program *p, int axis)
{
	uint32_t j = 0;

	while (j + 1 < p->head->naxes && p->head->column[j] != axis)
		j++;
	return j;
}

bool probe_rest_look(struct cycle *c, int axis, uint32_t sensed)
{
	const struct interp_program *p = &c->cursor.p;
	const uint32_t n = p->head->naxes, column = column_of(p, axis);
	const int64_t *node = p->nodes + column;
	struct probe *t = &c->probe;
	const int64_t end = node[(sensed + 1) * (uint64_t)n];
	const int64_t shift = (int64_t)t->shift[axis] + c->cursor.pos[axis] -
			      interp_round_sub(end);
	const struct rest k = {
		.p = p, .axis = axis, .off = off_of(p),
		.low = (double)(c->config.travel_min[axis] - shift),
		.high = (double)(c->config.travel_max[axis] - shift),
	};
	double left = ceil(SEGMENTS_S * law_period_s(c));

	t->beyond = 0;
	for (; left > 0; left--, t->rest++) {
		const uint32_t i = t->rest;
		const int64_t *from = node + (uint64_t)i * n;

		if (i + 1 >= p->head->nsegs ||
		    (p->segs[i].flags & INTERP_SEG_SENSED &&
		     from[0] != from[n]))
			return true;
		if (leaves(&k, i, column)) {
			t->beyond = i;
			return true;
		}
	}
	return false;
}

const struct interp_seg *probe_rest_beyond(const struct cycle *c)
{
	return c->fault.first == FAULT_SOFT_LIMIT && c->probe.beyond ?
	       &c->cursor.p.segs[c->probe.beyond] : NULL;
}
