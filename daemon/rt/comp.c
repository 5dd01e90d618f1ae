/* SPDX-License-Identifier: Apache-2.0 */
/*
 * comp.c - backlash and pitch error, taken up at a pace
 */
#include "comp.h"

#include <math.h>

/* The last point at or before @place; there is one. */
static uint32_t point_before(const struct comp_config *k, int32_t place)
{
	uint32_t low = 0, high = k->n;

	while (high - low > 1) {
		const uint32_t middle = low + (high - low) / 2;

		if (k->at[middle] <= place)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static double pitch(const struct comp_config *k, int32_t place)
{
	uint32_t i;
	double share;

	if (k->n == 0)
		return 0;
	if (place <= k->at[0])
		return k->add[0];
	i = point_before(k, place);
	if (i + 1 == k->n)
		return k->add[i];
	share = ((double)place - k->at[i]) / ((double)k->at[i + 1] - k->at[i]);
	return k->add[i] + (k->add[i + 1] - k->add[i]) * share;
}

int32_t comp_wanted(const struct comp_config *k, int32_t place, int toward)
{
	return (int32_t)llround(pitch(k, place)) -
	       (toward < 0 ? k->backlash : 0);
}

static int32_t within(int64_t x, int64_t low, int64_t high)
{
	return (int32_t)(x < low ? low : x > high ? high : x);
}

/* What may be added in this period, of what is wanted. */
static int32_t part(struct comp_axis *a, const struct comp_config *k,
		    int32_t path, uint32_t edges)
{
	const int32_t wanted = comp_wanted(k, a->place, a->toward) - a->added;
	int64_t low, high;

	a->room = fmin(a->room + k->take_up, fmax(k->take_up, 1));
	if (wanted == 0)
		return 0;
	high = (int64_t)a->room;
	low = -high;
	if (edges > 0) {
		low = low > -(int64_t)edges - path ? low :
						     -(int64_t)edges - path;
		high = high < (int64_t)edges - path ? high :
						      (int64_t)edges - path;
	}
	return within(wanted, low < 0 ? low : 0, high > 0 ? high : 0);
}

static void take_up(struct comp_axis *a, const struct comp_config *k,
		   int32_t path, uint32_t edges)
{
	int32_t more;

	if (k->n == 0 && k->backlash == 0)
		return;
	more = part(a, k, path, edges);
	a->added += more;
	a->room -= more < 0 ? -more : more;
}

void comp_apply(struct comp *c, const struct comp_config k[INTERP_NAXES],
		const int32_t place[INTERP_NAXES], bool frozen, uint32_t edges,
		int32_t ret[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		struct comp_axis *a = &c->axis[i];
		const int32_t path = c->begun ? place[i] - a->place : 0;

		a->place = place[i];
		if (path != 0)
			a->toward = path < 0 ? -1 : 1;
		if (!frozen)
			take_up(a, &k[i], path, edges);
		ret[i] = comp_pulses(a);
	}
	c->begun = true;
}

void comp_settle(struct comp_axis *a, const struct comp_config *k,
		 int32_t place, int32_t pulses)
{
	a->place = place;
	a->added = comp_wanted(k, place, a->toward);
	a->shift = (int32_t)((uint32_t)pulses - (uint32_t)place -
			     (uint32_t)a->added);
}
