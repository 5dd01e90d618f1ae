/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hole.c - back from a wire's break to the hole it was threaded in
 */
#include "path/hole.h"
#include "path/place.h"

#include <math.h>

/* Go into the positioning before the hole. */
#define PAST_PULSES	1.5

static double past_mm(const struct cycle *c, const struct interp_seg *rapid)
{
	const struct interp_program *p = &c->cursor.p;
	double most = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++)
		most = fmax(most, p->head->pulse_mm[p->head->column[j]]);
	return fmin(PAST_PULSES * most, rapid->length_mm / 2);
}

void hole_begin(struct cycle *c)
{
	c->hold.to_mm = place_outer_mm(c);
	c->hold.seek = c->cursor.index;
	hole_follow(c);
}

void hole_follow(struct cycle *c)
{
	for (int n = 0; n < HOLE_SEGMENTS_MAX && c->hold.seek > 0; n++) {
		const struct interp_seg *s =
			&c->cursor.p.segs[--c->hold.seek];
		const double end_mm = s->s_mm + s->length_mm;

		if (!(s->flags & INTERP_SEG_RAPID) || !(s->length_mm > 0))
			continue;
		c->hold.seek = 0;
		c->hold.to_mm = fmax(c->hold.to_mm, end_mm - past_mm(c, s));
	}
}
