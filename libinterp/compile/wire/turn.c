/* SPDX-License-Identifier: Apache-2.0 */
/* turn.c - a work system, or a figure, that is turned about Z or mirrored */
#include "interp/turn.h"

#include "interp/angle.h"

#include <math.h>
#include <string.h>

struct interp_turn interp_turn_of(double deg, bool mirrored)
{
	static const double quarter[4] = { 1, 0, -1, 0 };
	struct interp_turn t = { .deg = deg, .mirrored = mirrored };
	const double n = deg / 90;

	if (!interp_turn_is_on(&t))
		return t;
	if (n == floor(n)) {
		const int k = (int)(n - 4 * floor(n / 4));

		t.cos = quarter[k];
		t.sin = quarter[(k + 3) % 4];
	} else {
		t.cos = cos(deg * ANGLE_DEGREE);
		t.sin = sin(deg * ANGLE_DEGREE);
	}
	return t;
}

struct interp_turn interp_turn_image(double deg, bool x, bool y,
				     bool exchanged)
{
	const double image = exchanged ? 90 : x ? 180 : 0;

	return interp_turn_of(remainder(deg + image, 360),
			      exchanged || x != y);
}

void interp_turn_plane(const struct interp_turn *t, const double from[2],
		       double to[2])
{
	const double x = from[0], y = t->mirrored ? -from[1] : from[1];

	to[0] = t->cos * x - t->sin * y;
	to[1] = t->sin * x + t->cos * y;
}

void interp_turn_plane_back(const struct interp_turn *t, const double from[2],
			    double to[2])
{
	const double x = from[0], y = from[1];
	const double q = t->cos * y - t->sin * x;

	to[0] = t->cos * x + t->sin * y;
	to[1] = t->mirrored ? -q : q;
}

static void turn_axes(const struct interp_turn *t,
		      void (*plane)(const struct interp_turn *, const double[2],
				    double[2]),
		      const double from[INTERP_NAXES], double to[INTERP_NAXES])
{
	if (to != from)
		memcpy(to, from, INTERP_NAXES * sizeof(*to));
	if (!interp_turn_is_on(t))
		return;
	plane(t, from + INTERP_X, to + INTERP_X);
	plane(t, from + INTERP_U, to + INTERP_U);
}

void interp_turn_to(const struct interp_turn *t,
		    const double q_mm[INTERP_NAXES],
		    double ret_mm[INTERP_NAXES])
{
	turn_axes(t, interp_turn_plane, q_mm, ret_mm);
}

void interp_turn_back(const struct interp_turn *t,
		      const double mm[INTERP_NAXES],
		      double ret_q_mm[INTERP_NAXES])
{
	turn_axes(t, interp_turn_plane_back, mm, ret_q_mm);
}
