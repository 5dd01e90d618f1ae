/* SPDX-License-Identifier: Apache-2.0 */
/* turn.c - a work system that is turned about Z */
#include "interp/turn.h"

#include "interp/angle.h"

#include <math.h>
#include <string.h>

struct interp_turn interp_turn_of(double deg)
{
	struct interp_turn t = { .deg = deg };

	if (deg == 0)
		return t;
	t.cos = cos(deg * ANGLE_DEGREE);
	t.sin = sin(deg * ANGLE_DEGREE);
	return t;
}

/* Two numbers, from X (U) toward Y (V). */
static void rotate(double c, double s, const double from[2], double to[2])
{
	const double x = from[0], y = from[1];

	to[0] = c * x - s * y;
	to[1] = s * x + c * y;
}

static void rotate_axes(double c, double s, const double from[INTERP_NAXES],
			double to[INTERP_NAXES])
{
	if (to != from)
		memcpy(to, from, INTERP_NAXES * sizeof(*to));
	rotate(c, s, from + INTERP_X, to + INTERP_X);
	rotate(c, s, from + INTERP_U, to + INTERP_U);
}

void interp_turn_to(const struct interp_turn *t,
		    const double q_mm[INTERP_NAXES],
		    double ret_mm[INTERP_NAXES])
{
	if (t->deg != 0)
		rotate_axes(t->cos, t->sin, q_mm, ret_mm);
	else if (ret_mm != q_mm)
		memcpy(ret_mm, q_mm, INTERP_NAXES * sizeof(*ret_mm));
}

void interp_turn_back(const struct interp_turn *t,
		      const double mm[INTERP_NAXES],
		      double ret_q_mm[INTERP_NAXES])
{
	if (t->deg != 0)
		rotate_axes(t->cos, -t->sin, mm, ret_q_mm);
	else if (ret_q_mm != mm)
		memcpy(ret_q_mm, mm, INTERP_NAXES * sizeof(*ret_q_mm));
}
