/* SPDX-License-Identifier: Apache-2.0 */
/* depth.c - how deep the cut is */
#include "path/depth.h"

#include "cycle.h"
#include "path/place.h"

#include <math.h>

void depth_load(struct cycle *c)
{
	const struct interp_depth *was = &c->cursor.p.head->depth;

	c->depth = (struct depth) { .cut = *was, .met = was->counts };
}

/* A node of the program in X Y Z, mm. */
static void node_mm(const struct interp_program *p, uint32_t i, double ret[3])
{
	const struct interp_program_head *h = p->head;

	for (int k = 0; k < 3; k++)
		ret[k] = h->start_pulses[k] * h->pulse_mm[k];
	for (uint32_t j = 0; j < h->naxes; j++) {
		const uint8_t axis = h->column[j];

		if (axis < 3)
			ret[axis] = (double)p->nodes[(size_t)i * h->naxes + j] /
				    INTERP_SUB * h->pulse_mm[axis];
	}
}

/* Return: false if the segment goes nowhere but round. */
static bool way_of(const struct interp_cursor *at, double ret[3])
{
	const struct interp_program *p = &at->p;
	double from[3], length = 0;

	node_mm(p, at->index, from);
	node_mm(p, at->index + 1, ret);
	for (int k = 0; k < 3; k++) {
		const bool round = at->seg.kind == INTERP_ARC &&
				   (p->arcs[at->seg.arg].axis_a == k ||
				    p->arcs[at->seg.arg].axis_b == k);

		ret[k] = round ? 0 : ret[k] - from[k];
		length = hypot(length, ret[k]);
	}
	for (int k = 0; k < 3 && length > 0; k++)
		ret[k] /= length;
	return length > 0;
}

static double depth_of(const struct cycle *c)
{
	const struct interp_depth *d = &c->depth.cut;
	const double *pulse_mm = c->cursor.p.head->pulse_mm;
	const int32_t *pos = place_pos(c);
	double mm = 0;

	for (int k = 0; k < 3; k++)
		mm += (pos[k] + c->probe.shift[k] - d->from[k]) * d->way[k] *
		      pulse_mm[k];
	return mm;
}

/* Is it still the line of the cut that began before, to a pulse? */
static bool is_same_line(const struct cycle *c, const double way[3])
{
	const struct interp_depth *d = &c->depth.cut;
	const double *pulse_mm = c->cursor.p.head->pulse_mm;
	const double mm = depth_of(c);
	const double length = c->cursor.seg.length_mm;

	for (int k = 0; k < 3; k++) {
		const double beside = (place_axis(c, k) - d->from[k]) *
				      pulse_mm[k] - mm * d->way[k];
		const double turned = (way[k] - d->way[k]) * length;

		if (fabs(beside) > pulse_mm[k] || fabs(turned) > pulse_mm[k])
			return false;
	}
	return true;
}

static void begin(struct cycle *c)
{
	struct interp_depth *d = &c->depth.cut;
	double way[3];

	if (!way_of(&c->cursor, way))
		return;
	c->depth.met = true;
	if (d->counts && is_same_line(c, way))
		return;
	*d = (struct interp_depth) { .counts = 1 };
	for (int k = 0; k < 3; k++) {
		d->way[k] = way[k];
		d->from[k] = place_axis(c, k);
	}
}

/* A jump may go back over what was positioned before. */
static bool positions_anew(const struct cycle *c)
{
	return c->cursor.seg.flags & INTERP_SEG_UNCUT &&
	       place_mm(c) >= c->far_mm &&
	       place_mm(c) > c->depth.cut.known_mm;
}

void depth_watch(struct cycle *c)
{
	struct depth *t = &c->depth;

	if (!c->loaded || c->gap.process != PROCESS_SINK)
		return;
	if (positions_anew(c))
		t->met = false;
	else if (!t->met && c->state == STATE_ERODE &&
		 !escape_is_out(&c->escape))
		begin(c);
	if (!t->cut.counts || c->state == STATE_JUMP ||
	    c->state == STATE_APPROACH)
		return;
	t->now_mm = depth_of(c);
	if (c->state == STATE_ERODE && t->now_mm > t->cut.far_mm)
		t->cut.far_mm = t->now_mm;
}
