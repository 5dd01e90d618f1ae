/* SPDX-License-Identifier: Apache-2.0 */
/*
 * comp.c - backlash and geometric errors, added a few pulses a period
 */
#include "axes/comp.h"

#include <math.h>
#include <string.h>

void comp_map(const struct comp_config *k, const int32_t place[INTERP_NAXES],
	      int32_t ret[INTERP_NAXES])
{
	double mm[INTERP_NAXES], add[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		mm[i] = place[i] * k->axis[i].pulse_mm;
	interp_errormap_apply(&k->maps, mm, add);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = (int32_t)llround(add[i] / k->axis[i].pulse_mm);
}

static int32_t wanted(const struct comp_config *k, const struct comp_axis *a,
		      int axis)
{
	return a->map - (a->toward < 0 ? k->axis[axis].backlash : 0);
}

static int32_t within(int64_t x, int64_t low, int64_t high)
{
	return (int32_t)(x < low ? low : x > high ? high : x);
}

/* How much of @want may be added in this period. */
static int32_t part(const struct comp_axis *a, int32_t want, int32_t path,
		    uint32_t edges)
{
	int64_t high = (int64_t)a->room;
	int64_t low = -high;

	if (edges > 0) {
		low = low > -(int64_t)edges - path ? low :
						     -(int64_t)edges - path;
		high = high < (int64_t)edges - path ? high :
						      (int64_t)edges - path;
	}
	return within(want, low < 0 ? low : 0, high > 0 ? high : 0);
}

static void take_up(struct comp_axis *a, const struct comp_config *k, int axis,
		    int32_t path, uint32_t edges)
{
	const double pace = k->axis[axis].take_up;
	const int32_t want = wanted(k, a, axis) - a->added;
	int32_t more;

	a->room = fmin(a->room + pace, fmax(pace, 1));
	if (want == 0)
		return;
	more = part(a, want, path, edges);
	a->added += more;
	a->room -= more < 0 ? -more : more;
}

/* An axis that stands costs nothing. */
static void look_up(struct comp *c, const struct comp_config *k,
		    const int32_t *place)
{
	bool same = c->begun && !c->stale;
	int32_t map[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES && same; i++)
		same = place[i] == c->axis[i].place;
	if (same)
		return;
	comp_map(k, place, map);
	for (int i = 0; i < INTERP_NAXES; i++)
		c->axis[i].map = map[i];
	c->stale = false;
}

void comp_apply(struct comp *c, const struct comp_config *k,
		const struct comp_period *p, int32_t ret[INTERP_NAXES])
{
	const int32_t *place = p->place;
	const bool frozen = p->frozen || c->resting;
	bool adds = k->mapped;

	if (c->idle && memcmp(place, c->place, sizeof(c->place)) == 0) {
		memcpy(ret, c->sent, sizeof(c->sent));
		return;
	}
	if (k->mapped)
		look_up(c, k, place);
	for (int i = 0; i < INTERP_NAXES; i++) {
		struct comp_axis *a = &c->axis[i];
		int32_t path = 0;

		if (place[i] != a->place) {
			path = c->begun ? place[i] - a->place : 0;
			a->place = place[i];
		}
		if (path != 0)
			a->toward = path < 0 ? -1 : 1;
		/* An earlier edmd may have added something that now has to be
		 * taken off. */
		if ((k->axis[i].backlash | a->added | k->mapped) != 0) {
			adds = true;
			if (!frozen)
				take_up(a, k, i, path, p->edges);
		}
		ret[i] = comp_pulses(a);
	}
	c->begun = true;
	c->idle = !adds;
	memcpy(c->place, place, sizeof(c->place));
	memcpy(c->sent, ret, sizeof(c->sent));
}

void comp_settle(struct comp *c, const struct comp_config *k, uint32_t axis,
		 const int32_t place[INTERP_NAXES], int32_t pulses)
{
	struct comp_axis *a = &c->axis[axis];
	int32_t map[INTERP_NAXES] = { 0 };

	if (k->mapped)
		comp_map(k, place, map);
	c->stale = true;
	c->idle = false;
	a->place = place[axis];
	a->map = map[axis];
	a->added = wanted(k, a, (int)axis);
	a->shift = (int32_t)((uint32_t)pulses - (uint32_t)a->place -
			     (uint32_t)a->added);
}

void comp_warm(struct comp *c, struct comp_config *k, double told_c)
{
	const double k_now = fmin(fmax(told_c - k->maps_c, -COMP_OVER_K_MAX),
				  COMP_OVER_K_MAX);

	for (int i = 0; i < INTERP_NAXES; i++)
		k->maps.growth[i].over_k = k_now;
	c->told_c = told_c;
	c->stale = true;
}

void comp_left(const struct comp *c, const struct comp_config *k,
	       int32_t ret[INTERP_NAXES])
{
	int32_t place[INTERP_NAXES], map[INTERP_NAXES] = { 0 };

	for (int i = 0; i < INTERP_NAXES; i++)
		place[i] = c->axis[i].place;
	if (k->mapped)
		comp_map(k, place, map);
	for (int i = 0; i < INTERP_NAXES; i++) {
		struct comp_axis a = c->axis[i];

		a.map = map[i];
		ret[i] = wanted(k, &a, i) - a.added;
	}
}
