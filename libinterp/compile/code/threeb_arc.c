/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb_arc.c - the counting length of an arc, and its end from it
 *
 * Call g the coordinate that is counted and h the other, both from the
 * centre.  Along the arc g rises and falls between -R and R and turns where
 * h = 0.  J is the sum of |dg| over these parts, so a whole turn is 4R.  With
 * t growing counter-clockwise dx/dt = -y and dy/dt = x, so g rises where
 *
 *	h > 0 for GY and h < 0 for GX, counter-clockwise; else the reverse.
 *
 * R is the length of (X, Y), both rounded to units, and J is rounded as well.
 * The end therefore is known to a unit along g; h follows from the circle.
 * By the rule for G, |g| <= |h| at the end, where h is no worse than g.
 */
#include "code/threeb_reader.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* If the radius is off by a unit, J of a whole turn is off by four. */
#define FULL_UNITS	4.0

/* J is rounded.  If the end is this near to the place where g turns, it is that
 * place. */
#define TURN_UNITS	0.5

/* The same arc in g and h. */
struct course {
	double g, h, r;
	int sense;			/* g rises where sense * h > 0 */
};

static int sign_of(double v)
{
	return (v > 0) - (v < 0);
}

static struct course course_of(const struct threeb_arc *a)
{
	const double x = (double)a->x, y = (double)a->y;

	return (struct course) {
		.g = a->count_y ? y : x, .h = a->count_y ? x : y,
		.r = hypot(x, y),
		.sense = a->count_y != a->clockwise ? 1 : -1,
	};
}

/* Does g rise (1) or fall (-1) when it leaves the start? */
static int leaving(const struct course *c)
{
	const int s = c->sense * sign_of(c->h);

	return s ? s : -sign_of(c->g);
}

/* The same, when it comes to the end. */
static int arriving(const struct course *c, double g, double h)
{
	const int s = c->sense * sign_of(h);

	return s ? s : sign_of(g);
}

/* h on the part of the circle where g moves in the direction @up. */
static double other(const struct course *c, double g, int up)
{
	const double h2 = (c->r - g) * (c->r + g);

	return h2 > 0 ? up * c->sense * sqrt(h2) : 0;
}

int threeb_arc_end(const struct threeb_arc *a, int64_t j,
		   struct threeb_end *ret)
{
	const struct course c = course_of(a);
	int up = leaving(&c);
	double g = c.g, left = (double)j, way = 0;

	*ret = (struct threeb_end) { a->x, a->y, true };
	if (left > 4 * c.r + FULL_UNITS)
		return -ERANGE;
	if (4 * c.r - left <= fmin(FULL_UNITS, c.r / 4))
		return 0;
	ret->full = false;
	for (int part = 0; part < 5; part++) {
		way = c.r - up * g;
		if (left <= way + TURN_UNITS)
			break;
		left -= way;
		g = up * c.r;
		up = -up;
	}
	g += up * left;
	if (fabs(left - way) <= TURN_UNITS)
		g = up * c.r;
	g = round(g);
	ret->x = llround(a->count_y ? other(&c, g, up) : g);
	ret->y = llround(a->count_y ? g : other(&c, g, up));
	return 0;
}

int64_t threeb_arc_j(const struct threeb_arc *a, const struct threeb_end *e,
		     bool far)
{
	const struct course c = course_of(a);
	const double ge = (double)(a->count_y ? e->y : e->x);
	const double he = (double)(a->count_y ? e->x : e->y);
	const int end_up = arriving(&c, ge, he);
	int up = leaving(&c);
	double g = c.g, j = 0;

	if (e->full)
		return llround(4 * c.r);
	if (up != end_up || up * (ge - g) < 0 || far) {
		do {
			j += c.r - up * g;
			g = up * c.r;
			up = -up;
		} while (up != end_up);
	}
	return llround(j + up * (ge - g));
}

bool threeb_count_y(int64_t x, int64_t y)
{
	if (llabs(x) != llabs(y))
		return llabs(x) > llabs(y);
	return (x < 0) != (y < 0);	/* 45 degrees: GX in 1 and 3 */
}

uint8_t threeb_quadrant(enum threeb_kind kind, int64_t x, int64_t y)
{
	/* Clockwise is the mirror image of counter-clockwise. */
	if (kind == THREEB_CW)
		return (uint8_t)(5 - threeb_quadrant(THREEB_CCW, x, -y));
	if (x > 0 && y >= 0)
		return 1;
	if (x <= 0 && y > 0)
		return 2;
	return x < 0 && y <= 0 ? 3 : 4;
}
