/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lead.c - the way of the wire over a lead
 *
 * An arc keeps its centre and its sense.  Its radius is that of its end on the
 * outline all along, because an arc that comes nearer to its centre on the way
 * would cut into the outline that it touches.  So the whole change of the
 * radius is a straight step at the far end, away from the outline.
 */
#include "wire/track.h"

uint32_t lead_size(const struct track_lead *l)
{
	return !l->there ? 0 : l->round ? LEAD_PARTS : 1;
}

static struct curve dot(struct vec at)
{
	return (struct curve) { .arc = true, .from = at, .to = at,
				.centre = at };
}

/* Are @at and @was seen from @centre on the same side? */
static bool is_same_side(struct vec centre, struct vec at, struct vec was)
{
	return (at.x - centre.x) * (was.x - centre.x) +
	       (at.y - centre.y) * (was.y - centre.y) > 0;
}

/* @c, round its centre from beside @far to @at. */
static bool move_arc(struct curve *c, struct vec far, struct vec at)
{
	const double r = curve_distance(c->centre, at);
	const struct vec from = vec_add(c->centre,
					r / curve_distance(c->centre, far),
					vec_add(far, -1, c->centre));

	if (!is_same_side(c->centre, at, c->to) ||
	    !is_same_side(c->centre, far, c->from) || r < CURVE_SAME_MM)
		return false;
	c->r = r;
	return curve_trim(c, from, at);
}

static bool lay_in(const struct track_lead *l, struct curve c, struct vec at,
		   struct curve ret[LEAD_PARTS])
{
	if (!c.arc)
		c = curve_line(l->far, at);
	else if (!move_arc(&c, l->far, at))
		return false;
	ret[0] = c;
	if (!l->round)
		return true;
	ret[0] = curve_distance(l->far, c.from) < CURVE_SAME_MM ?
		 dot(c.from) : curve_line(l->far, c.from);
	ret[1] = c;
	return true;
}

bool lead_lay(const struct track_lead *l, struct vec at, bool out,
	      struct curve ret[LEAD_PARTS])
{
	const uint32_t n = lead_size(l);
	struct curve way[LEAD_PARTS];

	if (!lay_in(l, out ? curve_reversed(&l->c) : l->c, at, way))
		return false;
	for (uint32_t i = 0; i < n; i++)
		ret[i] = out ? curve_reversed(&way[n - 1 - i]) : way[i];
	return true;
}
