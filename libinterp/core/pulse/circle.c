/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circle.c - circles by point-by-point comparison, one axis at a time
 *
 * In each quadrant one coordinate shrinks (the inward pulse) and the other
 * grows (the outward pulse).  With F = x*x + y*y - R*R:
 *
 *	F >= 0:  inward,   F - 2*in  + 1
 *	F <  0:  outward,  F + 2*out + 1
 *
 * and the radius is kept within a pulse.  When the shrinking coordinate is 0
 * the next quadrant begins; the quadrant of the start is that of departure,
 * the quadrant of the end that of arrival.
 *
 * Back: on each anti-diagonal the walk takes the lattice point one past the
 * last with F >= 0, so both predecessors look possible; which one it was tells
 * the point before both, (in + 1, out - 1): inside the circle, the last pulse
 * was inward.  That is F <= 2*out - 2*in - 3.  On an axis (out = 0) it was
 * inward too, in this quadrant or, if the walk stands where the circle meets
 * the axis, in the one before; it meets it at the smallest n with
 * n*n >= R*R - 1.
 *
 * In the last quadrant an axis that is home is not pulsed any more: from there
 * the way to the end is straight, along a and then b, and is called the tail.
 * The builder walks the arc once to learn where it begins.
 *
 * Centre, start and end are lattice points; R is the start's distance.
 *
 * An arc of min-switch has its runs planned by the builder (circle_runs.c) and
 * stored; it walks along them either way.
 */
#include "pulse/pulse.h"

#include <math.h>
#include <stdlib.h>

#define CIRCLE_R_MAX	(INT64_C(1) << 28)	/* keeps the swept area in
						 * range */
#define CIRCLE_TURNS_MAX	8

/* What the inward and the outward pulse are, for a quadrant and a direction. */
struct circle_way {
	int8_t in_x, in_y;		/* the pulse of the shrinking
					 * coordinate */
	int8_t out_x, out_y;
};

static const struct circle_way ways[2][4] = {
	{	/* clockwise */
		{  0, -1,  1,  0 }, {  1,  0,  0,  1 },
		{  0,  1, -1,  0 }, { -1,  0,  0, -1 },
	}, {	/* counter-clockwise */
		{ -1,  0,  0,  1 }, {  0, -1, -1,  0 },
		{  1,  0,  0, -1 }, {  0,  1,  1,  0 },
	},
};

static const struct circle_way *way(const struct interp_circle *k)
{
	return &ways[k->ccw > 0][k->quad];
}

static void pulse_of_way(const struct circle_way *w, bool inward, int8_t ret[2])
{
	ret[0] = inward ? w->in_x : w->out_x;
	ret[1] = inward ? w->in_y : w->out_y;
}

int64_t circle_in(const struct interp_circle *k)
{
	return llabs(way(k)->in_x ? k->x : k->y);
}

int64_t circle_out(const struct interp_circle *k)
{
	return llabs(way(k)->in_x ? k->y : k->x);
}

int8_t circle_inward_axis(const struct interp_circle *k)
{
	return way(k)->in_x ? 0 : 1;
}

void circle_toward(const struct interp_circle *k, bool inward, int8_t ret[2])
{
	pulse_of_way(way(k), inward, ret);
}

/* The quadrant in which counter-clockwise motion is when it leaves (x, y). */
static int8_t quadrant_leaving(int64_t x, int64_t y)
{
	if (x > 0 && y >= 0)
		return 0;
	if (x <= 0 && y > 0)
		return 1;
	return x < 0 ? 2 : 3;
}

/* The same when it arrives there.  For clockwise motion, the two are
 * exchanged. */
static int8_t quadrant_arriving(int64_t x, int64_t y)
{
	if (x >= 0 && y > 0)
		return 0;
	if (x < 0 && y >= 0)
		return 1;
	return x <= 0 ? 2 : 3;
}

static void circle_pulse(struct interp_circle *k, int8_t dx, int8_t dy)
{
	k->dev += 2 * (k->x * dx + k->y * dy) + 1;
	k->x += dx;
	k->y += dy;
}

void circle_move(struct interp_circle *k, const int8_t pulse[2])
{
	circle_pulse(k, pulse[0], pulse[1]);
	k->tick++;
}

void circle_cross(struct interp_circle *k)
{
	if (k->left > 0 && circle_in(k) == 0) {
		k->left--;
		k->quad = (int8_t)((k->quad + k->ccw) & 3);
	}
}

static int8_t toward(int64_t from, int64_t to)
{
	return (int8_t)((to > from) - (to < from));
}

static void tail_forward(struct interp_circle *k, int8_t ret[2])
{
	ret[0] = toward(k->x, k->xe);
	ret[1] = ret[0] ? 0 : toward(k->y, k->ye);
}

/* -- Along stored runs ---------------------------------------------------- */

static void run_pulse(const struct interp_circle *k, int8_t ret[2])
{
	const int axis = (int)((k->run + k->run_first) & 1);

	ret[axis] = k->runs[k->run] > 0 ? 1 : -1;
	ret[!axis] = 0;
}

/* In a damaged block the runs may end too early: then there is no pulse. */
static void runs_forward(struct interp_circle *k, int8_t ret[2])
{
	ret[0] = ret[1] = 0;
	if (k->sent == llabs((int64_t)k->runs[k->run])) {
		if (k->run + 1 >= k->nruns || k->runs[k->run + 1] == 0)
			return;
		k->run++;
		k->sent = 0;
	}
	k->sent++;
	run_pulse(k, ret);
	circle_move(k, ret);
}

static void runs_last(const struct interp_circle *k, int8_t ret[2])
{
	ret[0] = ret[1] = 0;
	if (k->sent > 0)
		run_pulse(k, ret);
}

static void runs_back(struct interp_circle *k, int8_t ret[2])
{
	int8_t was[2];

	runs_last(k, was);
	ret[0] = (int8_t)-was[0];
	ret[1] = (int8_t)-was[1];
	circle_pulse(k, ret[0], ret[1]);
	k->tick--;
	if (k->sent > 0)
		k->sent--;
	if (k->sent == 0 && k->run > 0) {
		k->run--;
		k->sent = llabs((int64_t)k->runs[k->run]);
	}
}

/* -- By comparison -------------------------------------------------------- */

void circle_forward(struct interp_circle *k, int8_t ret[2])
{
	if (k->runs) {
		runs_forward(k, ret);
		return;
	}
	if (k->tick >= k->tail)
		tail_forward(k, ret);
	else
		circle_toward(k, k->dev >= 0, ret);
	circle_move(k, ret);
	if (k->tick <= k->tail)
		circle_cross(k);
}

/* The direction of the last pulse, and whether it ended in a crossing. */
static bool last_pulse(const struct interp_circle *k, int8_t ret[2])
{
	const struct circle_way *w = way(k);
	int64_t in, out;

	if (k->runs) {
		runs_last(k, ret);
		return false;
	}
	if (k->tick > k->tail) {
		ret[1] = toward(k->yt, k->y);
		ret[0] = ret[1] ? 0 : toward(k->xt, k->x);
		return false;
	}
	in = llabs(w->in_x ? k->x : k->y);
	out = llabs(w->in_x ? k->y : k->x);
	if (out == 0 && in == k->meet && k->left < k->crossings) {
		pulse_of_way(&ways[k->ccw > 0][(k->quad - k->ccw) & 3], true,
			     ret);
		return true;
	}
	pulse_of_way(w, out == 0 || k->dev <= 2 * out - 2 * in - 3, ret);
	return false;
}

/* Undo the pulse that last_pulse() found. */
static void undo(struct interp_circle *k, const int8_t was[2], bool crossed,
		 int8_t ret[2])
{
	if (k->runs) {
		runs_back(k, ret);
		return;
	}
	if (crossed) {
		k->left++;
		k->quad = (int8_t)((k->quad - k->ccw) & 3);
	}
	ret[0] = (int8_t)-was[0];
	ret[1] = (int8_t)-was[1];
	circle_pulse(k, ret[0], ret[1]);
	k->tick--;
}

void circle_back(struct interp_circle *k, int8_t ret[2])
{
	int8_t was[2];
	const bool crossed = last_pulse(k, was);

	undo(k, was, crossed, ret);
}

/* Twice the area that is swept by a pulse that ended at (x, y), plus one for
 * the pulse itself. */
int64_t circle_measure_of(const struct interp_circle *k, const int8_t was[2])
{
	const int64_t area = k->ccw * (k->x * was[1] - k->y * was[0]);

	return (area > 0 ? area : 0) + 1;
}

int64_t circle_last(const struct interp_circle *k)
{
	int8_t was[2];

	last_pulse(k, was);
	return circle_measure_of(k, was);
}

/* The smallest n with n*n >= r2 - 1. */
static int64_t circle_meet(int64_t r2)
{
	int64_t n = (int64_t)sqrt((double)r2);

	while (n > 0 && (n - 1) * (n - 1) >= r2 - 1)
		n--;
	while (n * n < r2 - 1)
		n++;
	return n;
}

/* A circle of one pulse is treated as if its radius were a little larger;
 * otherwise its first pulse would lead to its centre. */
static int64_t circle_r2(const int64_t start[2])
{
	const int64_t r2 = start[0] * start[0] + start[1] * start[1];

	return r2 == 1 ? 2 : r2;
}

bool circle_enter(struct interp_circle *k, const struct interp_arc *arc,
		  const int64_t start[2], const int64_t end[2], bool at_end)
{
	const int64_t r2 = circle_r2(start);
	const int64_t *at = at_end ? end : start;

	if (r2 >= CIRCLE_R_MAX * CIRCLE_R_MAX ||
	    llabs(end[0]) >= CIRCLE_R_MAX || llabs(end[1]) >= CIRCLE_R_MAX ||
	    arc->tail > arc->circle_ticks || arc->measure < 0)
		return false;
	*k = (struct interp_circle) {
		.x = at[0], .y = at[1], .xe = end[0], .ye = end[1],
		.xt = end[0] - arc->tail_a, .yt = end[1] - arc->tail_b,
		.dev = at[0] * at[0] + at[1] * at[1] - r2,
		.meet = circle_meet(r2),
		.tick = at_end ? arc->circle_ticks : 0,
		.ticks = arc->circle_ticks, .tail = arc->tail,
		.left = at_end ? 0 : arc->crossings,
		.crossings = arc->crossings,
		.ccw = arc->sweep > 0 ? 1 : -1,
	};
	if (at_end == (k->ccw > 0))
		k->quad = quadrant_arriving(at[0], at[1]);
	else
		k->quad = quadrant_leaving(at[0], at[1]);
	return true;
}

/* How many times the arc crosses an axis through its centre. */
static int64_t circle_crossings(const struct interp_arc *arc,
				const int64_t start[2], const int64_t end[2])
{
	const double turn = 2 * M_PI;
	const bool ccw = arc->sweep > 0;
	const int from = ccw ? quadrant_leaving(start[0], start[1]) :
			       quadrant_arriving(start[0], start[1]);
	const int to = ccw ? quadrant_arriving(end[0], end[1]) :
			     quadrant_leaving(end[0], end[1]);
	const double cross = (double)start[0] * (double)end[1] -
			     (double)start[1] * (double)end[0];
	const double dot = (double)start[0] * (double)end[0] +
			   (double)start[1] * (double)end[1];
	double ahead = ccw ? atan2(cross, dot) : atan2(-cross, dot);
	const int quads = (ccw ? to - from : from - to) & 3;

	if (ahead < 0)
		ahead += turn;
	/* If start and end are at the same place on an axis, their quadrants
	 * still differ. */
	if (ahead < (quads - 1) * (turn / 4))
		ahead += turn;
	/* The same quadrant, but the end lies behind the start: once around. */
	return quads + 4 * llround((fabs(arc->sweep) - ahead) / turn) +
	       (quads == 0 && ahead > turn / 2 ? 4 : 0);
}

/* In the last quadrant: is an axis at its end, or past it? */
bool circle_home(const struct interp_circle *k)
{
	const struct circle_way *w = way(k);
	const int64_t in_e = llabs(w->in_x ? k->xe : k->ye);
	const int64_t out_e = llabs(w->in_x ? k->ye : k->xe);

	return k->left == 0 && (circle_in(k) <= in_e || circle_out(k) >= out_e);
}

bool circle_measure(struct interp_arc *arc, const int64_t start[2],
		    const int64_t end[2])
{
	const int64_t crossings = circle_crossings(arc, start, end);
	struct interp_circle k;
	int8_t was[2];

	if (crossings < 0 || crossings > 4 * CIRCLE_TURNS_MAX)
		return false;
	arc->crossings = (uint32_t)crossings;
	arc->circle_ticks = arc->tail = UINT32_MAX;
	arc->measure = 0;
	if (!circle_enter(&k, arc, start, end, false))
		return false;
	while (!circle_home(&k)) {
		circle_forward(&k, was);
		arc->measure += circle_measure_of(&k, was);
	}
	arc->tail = k.tail = k.tick;
	arc->tail_a = (int32_t)(k.xe - k.x);
	arc->tail_b = (int32_t)(k.ye - k.y);
	while (k.x != k.xe || k.y != k.ye) {
		circle_forward(&k, was);
		arc->measure += circle_measure_of(&k, was);
	}
	arc->circle_ticks = k.tick;
	return true;
}
