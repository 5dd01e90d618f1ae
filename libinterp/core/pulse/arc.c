/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arc.c - circular and helical arcs, every axis at once
 *
 * Tick k of N stands at the angle theta + sweep*k/N; the lattice point is the
 * nearest one to the true point there, so each axis is within half a pulse.
 * N is the arc's length in pulses and a little more: two ticks are less than
 * a pulse apart, and no axis moves more than one.  A point is a function of k
 * alone, so there is nothing to undo.  The axes beside the plane run as a
 * line's do.
 */
#include "pulse/pulse.h"

#include <math.h>
#include <string.h>

struct plane {
	int32_t a, b;			/* pulses */
};

/*
 * Ticks are computed in blocks.  sin and cos give the place of the middle of a
 * block once.  From there its ticks are turned by a series: a few products
 * instead of a call of libm.  32 ticks are less than 32 pulses along the arc.
 * So with a radius of 160 pulses the angle is below 0.2, and the first omitted
 * term is below 6e-16.  The middle depends only on the tick, so a point still
 * does, too.  All ticks of a block are computed in loops without a branch,
 * several at a time, and kept with the pulses between them: the walk goes to
 * and fro over them.
 */
#define BLOCK		INTERP_ARC_BLOCK
#define BLOCK_HALF	(BLOCK / 2)
#define BLOCK_ANGLE	0.2

struct turn {
	double cosine, sine;
};

/* The ticks of a block from its middle: the same in every block of an arc. */
static void block_turns(struct interp_cursor *c)
{
	for (int i = 0; i < BLOCK; i++) {
		const double x = c->arc_turn * (i - BLOCK_HALF), x2 = x * x;

		c->arc_sine[i] = x - x * x2 * (1.0 / 6 - x2 * (1.0 / 120 -
				x2 * (1.0 / 5040 - x2 * (1.0 / 362880))));
		c->arc_cosine[i] = 1 - x2 * (1.0 / 2 - x2 * (1.0 / 24 -
				x2 * (1.0 / 720 - x2 * (1.0 / 40320 -
				x2 * (1.0 / 3628800)))));
	}
}

static struct turn arc_direct(const struct interp_cursor *c, double tick)
{
	const double theta = c->arc.theta + c->arc_turn * tick;

	return (struct turn) { cos(theta), sin(theta) };
}

/* At both ends, the pulses of the node itself: they are exact, whatever sin and
 * cos give. */
static struct plane arc_node(const struct interp_cursor *c, bool at_end)
{
	struct plane p = { 0, 0 };

	for (uint32_t j = 0; j < c->p.head->naxes; j++) {
		const int32_t at = interp_round_sub(pulse_node(c, j, at_end));

		if (c->p.head->column[j] == c->arc.axis_a)
			p.a = at;
		if (c->p.head->column[j] == c->arc.axis_b)
			p.b = at;
	}
	return p;
}

/*
 * The integer nearest to @x, one of the two from halfway, without a call or a
 * branch.  A double above 2^52 has no room for a fraction: what is added to it
 * is rounded, and is in its low bits.
 */
static inline int32_t nearest(double x)
{
	const double rounded = x + 0x1.8p52;
	uint64_t bits;

	memcpy(&bits, &rounded, sizeof(bits));
	return (int32_t)(uint32_t)bits;
}

/* One axis of a block, in pulses: the centre, and what the cosine and the sine
 * of the turn from the middle add; of a spiral for 1 mm of radius. */
struct side {
	double centre, cosine, sine;
};

/* The lattice points of one axis.  The radius of a spiral is @r_mm in the
 * middle, and @grow_mm more with each tick; that of an arc is in @k. */
INLINE void block_side(const struct interp_cursor *c, struct side k,
		       double r_mm, double grow_mm, int32_t *ret)
{
	for (int i = 0; i < BLOCK; i++) {
		const double of = k.cosine * c->arc_cosine[i] +
				  k.sine * c->arc_sine[i];
		const double r = r_mm + grow_mm * (i - BLOCK_HALF);

		ret[i] = nearest(k.centre + (grow_mm == 0 ? of : r * of));
	}
}

/* The lattice points of the block that begins at tick @first. */
static void block_points(struct interp_cursor *c, uint32_t first)
{
	const struct interp_arc *arc = &c->arc;
	const double middle = (double)first + BLOCK_HALF;
	const double grow_mm = c->arc_grow_mm;
	const double r_mm = arc->r_mm + grow_mm * middle;
	const double a_pulses_mm = c->pulses_mm[arc->axis_a];
	const double b_pulses_mm = c->pulses_mm[arc->axis_b];
	const double a_by = a_pulses_mm * (grow_mm == 0 ? r_mm : 1);
	const double b_by = b_pulses_mm * (grow_mm == 0 ? r_mm : 1);
	const struct turn to = arc_direct(c, middle);
	const struct side a = {
		arc->a_mm * a_pulses_mm, a_by * to.cosine, -a_by * to.sine
	};
	const struct side b = {
		arc->b_mm * b_pulses_mm, b_by * to.sine, b_by * to.cosine
	};

	if (grow_mm == 0) {
		block_side(c, a, r_mm, 0, c->arc_at[0]);
		block_side(c, b, r_mm, 0, c->arc_at[1]);
	} else {
		block_side(c, a, r_mm, grow_mm, c->arc_at[0]);
		block_side(c, b, r_mm, grow_mm, c->arc_at[1]);
	}
}

/* Does the plane move by more than one pulse from tick @i to the next? */
static bool jumps(const struct interp_cursor *c, uint32_t i)
{
	const int32_t *a = c->arc_at[0] + i, *b = c->arc_at[1] + i;

	return (uint32_t)a[1] - (uint32_t)a[0] + 1 > 2 ||
	       (uint32_t)b[1] - (uint32_t)b[0] + 1 > 2;
}

/* Nodes are where they are, and beyond the last one nothing moves. */
static void block_ends(struct interp_cursor *c, uint32_t first)
{
	const struct plane from = arc_node(c, false), to = arc_node(c, true);
	const uint32_t last = c->seg.ticks - first;

	if (first == 0) {
		c->arc_at[0][0] = from.a;
		c->arc_at[1][0] = from.b;
	}
	for (uint32_t i = last; i < BLOCK; i++) {
		c->arc_at[0][i] = to.a;
		c->arc_at[1][i] = to.b;
	}
	c->arc_broken = (first == 0 && jumps(c, 0)) ||
			(last > 0 && last < BLOCK && jumps(c, last - 1));
}

/* From each of its ticks to the next, the pulses.  There is none behind the
 * last: as many as there are ticks are faster, several at a time. */
static void block_pulses(struct interp_cursor *c)
{
	const uint32_t axis_a = c->arc.axis_a, axis_b = c->arc.axis_b;
	int32_t *a = c->arc_at[0], *b = c->arc_at[1];

	a[BLOCK] = a[BLOCK - 1];
	b[BLOCK] = b[BLOCK - 1];
	for (int i = 0; i < BLOCK; i++) {
		const uint32_t da = (uint32_t)a[i + 1] - (uint32_t)a[i];
		const uint32_t db = (uint32_t)b[i + 1] - (uint32_t)b[i];

		c->arc_pulse[i] = (uint16_t)(pulse_step(da, axis_a) |
					     pulse_step(db, axis_b));
	}
}

static void block_enter(struct interp_cursor *c, uint32_t block)
{
	const uint32_t first = block * BLOCK;

	if (c->arc_block == UINT32_MAX)
		block_turns(c);
	block_points(c, first);
	c->arc_broken = false;
	if (first == 0 || c->seg.ticks - first < BLOCK)
		block_ends(c, first);
	block_pulses(c);
	c->arc_block = block;
}

/* The lattice point of @x, and a point in range where there is none. */
static int32_t in_range(double x)
{
	return (int32_t)fmin(fmax(floor(x + 0.5), INT32_MIN), INT32_MAX);
}

static struct plane arc_alone(const struct interp_cursor *c, uint32_t tick)
{
	const struct interp_arc *arc = &c->arc;
	const struct turn at = arc_direct(c, tick);
	const double r = arc->r_mm + c->arc_grow_mm * tick;

	if (tick == 0 || tick == c->seg.ticks)
		return arc_node(c, tick != 0);
	return (struct plane) {
		in_range((arc->a_mm + r * at.cosine) *
			 c->pulses_mm[arc->axis_a]),
		in_range((arc->b_mm + r * at.sine) *
			 c->pulses_mm[arc->axis_b]),
	};
}

static struct plane arc_at(struct interp_cursor *c, uint32_t tick)
{
	const uint32_t i = tick % BLOCK;

	if (c->arc_alone)
		return arc_alone(c, tick);
	if (tick / BLOCK != c->arc_block)
		block_enter(c, tick / BLOCK);
	return (struct plane) { c->arc_at[0][i], c->arc_at[1][i] };
}

/* The plane goes to the lattice point of @tick.  Return: the pulses of it. */
static uint32_t arc_settle(struct interp_cursor *c, uint32_t tick)
{
	const struct plane p = arc_at(c, tick);
	int32_t *a = &c->pos[c->arc.axis_a], *b = &c->pos[c->arc.axis_b];
	const int64_t da = (int64_t)p.a - *a, db = (int64_t)p.b - *b;

	if (da > 1 || da < -1 || db > 1 || db < -1)
		return PULSE_BAD;
	*a = p.a;
	*b = p.b;
	return pulse_plane_move(c, (int32_t)da, (int32_t)db);
}

static bool near(double mm, double pulses_mm)
{
	return fabs(mm) * pulses_mm < INTERP_PULSES_MAX;
}

bool pulse_arc_near(const struct interp_arc *arc, double a_pulses_mm,
		    double b_pulses_mm)
{
	return near(arc->a_mm, a_pulses_mm) && near(arc->b_mm, b_pulses_mm) &&
	       near(arc->r_mm, a_pulses_mm) && near(arc->r_mm, b_pulses_mm);
}

bool pulse_plane_ok(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;

	return arc->axis_a < INTERP_NAXES && arc->axis_b < INTERP_NAXES &&
	       arc->axis_a != arc->axis_b &&
	       pulse_arc_near(arc, c->pulses_mm[arc->axis_a],
			      c->pulses_mm[arc->axis_b]) &&
	       fabs(arc->dr_mm) <= fabs(arc->r_mm) && isfinite(arc->theta) &&
	       isfinite(arc->sweep);
}

/* Not more ticks than the builder gives: otherwise it would walk on the
 * spot. */
static bool ticks_ok(const struct interp_cursor *c, uint32_t plane)
{
	const struct interp_arc *arc = &c->arc;
	const double pulses_mm = fmax(c->pulses_mm[arc->axis_a],
				      c->pulses_mm[arc->axis_b]);
	const double r = fmax(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double n = fmax((fabs(arc->sweep) * r + fabs(arc->dr_mm)) *
			      pulses_mm, (double)pulse_longest(c, plane));

	return c->seg.ticks > 0 && c->seg.ticks <= n * 1.00001 + 3;
}

/* Are there places that no int32_t holds, or ticks that are a pulse apart?  Not
 * in a sound program; the builder has a margin of 1e-6. */
static bool is_odd(const struct interp_cursor *c)
{
	const struct interp_arc *arc = &c->arc;
	const double r_mm = fabs(arc->r_mm) + fabs(arc->dr_mm);
	const double a = c->pulses_mm[arc->axis_a];
	const double b = c->pulses_mm[arc->axis_b];
	const double most_mm = fmax(fabs(arc->r_mm),
				    fabs(arc->r_mm + arc->dr_mm));
	const double tick_mm = fabs(c->arc_turn) * most_mm +
			       fabs(c->arc_grow_mm);

	return (fabs(arc->a_mm) + r_mm) * a >= INT32_MAX ||
	       (fabs(arc->b_mm) + r_mm) * b >= INT32_MAX ||
	       !(tick_mm * fmax(a, b) < 1 - 5e-7);
}

static bool arc_enter(struct interp_cursor *c, bool at_end)
{
	uint32_t plane;

	if (!pulse_plane_ok(c))
		return false;
	plane = 1u << c->arc.axis_a | 1u << c->arc.axis_b;
	if (!pulse_dda_enter(c, at_end, plane) || !ticks_ok(c, plane))
		return false;
	c->arc_turn = c->arc.sweep / c->seg.ticks;
	c->arc_grow_mm = c->arc.dr_mm / c->seg.ticks;
	c->arc_alone = fabs(c->arc_turn) * BLOCK_HALF > BLOCK_ANGLE ||
		       is_odd(c);
	c->arc_block = UINT32_MAX;
	return true;
}

/* So many of @most ticks from here need only what is known of this block. */
static uint32_t ticks_known(const struct interp_cursor *c, uint32_t tick,
			    uint32_t most, bool back)
{
	const uint32_t i = tick % BLOCK, n = back ? i : BLOCK - 1 - i;

	if (tick / BLOCK != c->arc_block || c->arc_broken)
		return 0;
	return pulse_fewer(n, most);
}

/* Add the pulses of @n known ticks, @pulse and on, to those of the other axes
 * in @ret, and keep the points of them at @to.  Return: their number. */
INLINE uint32_t points_known(const uint16_t *pulse, uint32_t n,
			     const uint16_t *ret, uint16_t *to, bool back)
{
	size_t points = 0;

	for (size_t k = 0; k < n; k++) {
		const uint16_t plane = back ? pulse_turned(*pulse--) :
					      *pulse++;

		to[points] = ret[k] | plane;
		points += to[points] != 0;
	}
	return (uint32_t)points;
}

static void plane_stand(struct interp_cursor *c, uint32_t tick)
{
	c->pos[c->arc.axis_a] = c->arc_at[0][tick % BLOCK];
	c->pos[c->arc.axis_b] = c->arc_at[1][tick % BLOCK];
}

/* The other axes first, then the plane beside them. */
INLINE uint32_t arc_run(struct interp_cursor *c, uint32_t ticks, uint16_t *ret,
			bool back)
{
	const uint32_t one = back ? UINT32_MAX : 1;
	uint32_t tick = c->tick, points = 0, n;

	(back ? pulse_dda_all_back : pulse_dda_all_forward)(c, ticks, ret);
	for (uint32_t k = 0; k < ticks; k += n) {
		n = ticks_known(c, tick, ticks - k, back);
		if (n > 0) {
			points += points_known(c->arc_pulse + tick % BLOCK -
					       back, n, ret + k, ret + points,
					       back);
			tick += n * one;
			plane_stand(c, tick);
		} else {
			uint32_t plane;

			n = 1;
			tick += one;
			plane = arc_settle(c, tick);
			if (plane == PULSE_BAD)
				return PULSE_BAD;
			ret[points] = (uint16_t)(ret[k] | plane);
			points += ret[points] != 0;
		}
	}
	return points;
}

static uint32_t arc_forward(struct interp_cursor *c, uint32_t ticks,
			    uint16_t *ret)
{
	return arc_run(c, ticks, ret, false);
}

static uint32_t arc_back(struct interp_cursor *c, uint32_t ticks,
			 uint16_t *ret)
{
	return arc_run(c, ticks, ret, true);
}

static bool arc_seek(struct interp_cursor *c, uint32_t tick)
{
	struct plane p;

	pulse_dda_seek(c, tick);
	p = arc_at(c, tick);
	c->pos[c->arc.axis_a] = p.a;
	c->pos[c->arc.axis_b] = p.b;
	return true;
}

const struct interp_walk pulse_arc = {
	.enter = arc_enter,
	.forward = arc_forward,
	.back = arc_back,
	.seek = arc_seek,
};
