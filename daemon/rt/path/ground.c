/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.c - does the electrode stand on ground that was cut already?
 */
#include "path/ground.h"
#include "path/laws.h"

#include "interp/angle.h"

#include <math.h>

#define NEAR_PULSES	2.0
#define TURNS_MAX	16

/* The place of a node in column @j, in pulses. */
static double node_at(const struct interp_program *p, uint32_t i, uint32_t j)
{
	return (double)p->nodes[(uint64_t)i * p->head->naxes + j] / INTERP_SUB;
}

/* Does the machine stand at the share @t of segment @i, on every axis but those
 * in @except? */
static bool is_at(const struct interp_cursor *at, uint32_t i, double t,
		  uint32_t except)
{
	for (uint32_t j = 0; j < at->p.head->naxes; j++) {
		const uint8_t axis = at->p.head->column[j];
		const double a = node_at(&at->p, i, j);
		const double b = node_at(&at->p, i + 1, j);

		if (!(except >> axis & 1) &&
		    !(fabs(at->pos[axis] - (a + t * (b - a))) <= NEAR_PULSES))
			return false;
	}
	return true;
}

/* The share is found by the axis that goes farthest. */
static bool is_on_line(const struct interp_cursor *at, uint32_t i)
{
	double most = 0, t = 0;

	for (uint32_t j = 0; j < at->p.head->naxes; j++) {
		const double a = node_at(&at->p, i, j);
		const double d = node_at(&at->p, i + 1, j) - a;

		if (fabs(d) <= most)
			continue;
		most = fabs(d);
		t = (at->pos[at->p.head->column[j]] - a) / d;
	}
	return is_at(at, i, fmin(fmax(t, 0), 1), 0);
}

/* The share is found by the angle, in any of the turns. */
static bool is_on_arc(const struct interp_cursor *at, uint32_t i,
		      const struct interp_arc *k)
{
	const double *pulse = at->p.head->pulse_mm;
	const double x = at->pos[k->axis_a] * pulse[k->axis_a] - k->a_mm;
	const double y = at->pos[k->axis_b] * pulse[k->axis_b] - k->b_mm;
	const double near = NEAR_PULSES * fmax(pulse[k->axis_a],
					       pulse[k->axis_b]);
	const double slack = k->r_mm > near ? near / k->r_mm : ANGLE_TURN;
	const int sense = k->sweep < 0 ? -1 : 1;
	double turned = sense * (atan2(y, x) - k->theta);

	turned -= ANGLE_TURN * floor((turned + slack) / ANGLE_TURN);
	for (int n = 0; n < TURNS_MAX && turned <= fabs(k->sweep) + slack;
	     n++, turned += ANGLE_TURN) {
		const double t = fmin(fmax(turned / fabs(k->sweep), 0), 1);

		if (fabs(hypot(x, y) - (k->r_mm + t * k->dr_mm)) <= near &&
		    is_at(at, i, t, 1u << k->axis_a | 1u << k->axis_b))
			return true;
	}
	return false;
}

static bool is_on(const struct interp_cursor *at, uint32_t i)
{
	const struct interp_seg *s = &at->p.segs[i];

	if (!interp_program_seg_ok(&at->p, i, s) ||
	    s->flags & (INTERP_SEG_RAPID | INTERP_SEG_SENSED))
		return false;
	if (s->kind == INTERP_LINE)
		return is_on_line(at, i);
	return s->kind == INTERP_ARC &&
	       at->p.arcs[s->arg].axis_a < INTERP_NAXES &&
	       at->p.arcs[s->arg].axis_b < INTERP_NAXES &&
	       is_on_arc(at, i, &at->p.arcs[s->arg]);
}

bool ground_is_cut(const struct cycle *c)
{
	const struct interp_cursor *at = &c->cursor;
	uint32_t i = at->index;

	for (int n = 0; n < GROUND_SEGMENTS_MAX && i > 0; n++) {
		if (is_on(at, --i))
			return true;
	}
	return false;
}
