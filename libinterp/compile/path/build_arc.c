/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_arc.c - from the words of a G2 or G3 to an arc segment
 */
#include "path/build_arc.h"
#include "path/builder.h"
#include "pulse/strategy.h"

#include "interp/angle.h"
#include "interp/smaller.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Radii that differ by less are walked as they are: a spiral within so many
 * pulses stays between its circles.  More would leave what a walk looks at. */
#define SPIRAL_PULSES	2.0
#define SPIRAL_OF_R	0.001
#define SPIRAL_MOST	5.0

/* If an arc of more than half a turn has a shorter chord, in radii, or a centre
 * that moves farther, its far side would move with it. */
#define NEARLY_CLOSED	0.5
#define CENTRE_SHARE	0.25

/* What differs by so much of the smaller radius is no circle any more. */
#define SPIRAL_SHARE	0.5

/* A line that is so near to an arc may stand for it. */
#define STRAIGHT_PULSES	2.0

/* Places that are nearer to each other, in pulses, are one. */
#define SAME_PLACE	1e-5

/* No text names two places that are nearer. */
#define SAME_TEXT_MM	1e-6

/* A full circle, and what rounding adds to it. */
#define WHOLE_TURN	(ANGLE_TURN * (1 + 1e-9))

/* A lattice point of an arc is no farther beside it, beside the tolerance: the
 * radii may differ, and so may a centre and the nearest lattice point. */
#define BESIDE_PULSES	(SPIRAL_MOST + 5)

static const struct interp_axis_limits *limits(const struct build_arc *p,
					       uint32_t a)
{
	return &p->o->machine->axis[a];
}

double interp_build_sweep(const double from_mm[2], const double to_mm[2],
			  const double centre_mm[2], bool clockwise)
{
	const double a0 = from_mm[0] - centre_mm[0];
	const double b0 = from_mm[1] - centre_mm[1];
	const double a1 = to_mm[0] - centre_mm[0];
	const double b1 = to_mm[1] - centre_mm[1];
	const double by = atan2(b1, a1) - atan2(b0, a0);
	const double sweep = angle_ahead(clockwise ? -by : by);
	const bool whole = fabs(angle_nearest(by, 0)) * hypot(a0, b0) <
			   SAME_TEXT_MM;

	return (clockwise ? -1 : 1) * (whole ? ANGLE_TURN : sweep);
}

void build_arc_shape(struct build_arc *p)
{
	const struct interp_build_arc *w = p->word;
	const double a0 = p->from_mm[w->axis_a] - w->centre_a_mm;
	const double b0 = p->from_mm[w->axis_b] - w->centre_b_mm;
	const double a1 = p->to_mm[w->axis_a] - w->centre_a_mm;
	const double b1 = p->to_mm[w->axis_b] - w->centre_b_mm;
	const double r0 = hypot(a0, b0), r1 = hypot(a1, b1);

	p->arc = (struct interp_arc) {
		.a_mm = w->centre_a_mm, .b_mm = w->centre_b_mm,
		.r_mm = r0, .dr_mm = r1 - r0, .theta = atan2(b0, a0),
		.axis_a = (uint8_t)w->axis_a, .axis_b = (uint8_t)w->axis_b,
	};
	p->arc.sweep = angle_nearest(atan2(b1, a1) - p->arc.theta, w->sweep);
}

/* Does the arc pass the angle @quarter * 90 degrees? */
static bool passes(const struct interp_arc *arc, int quarter)
{
	double ahead = quarter * (ANGLE_TURN / 4) - arc->theta;

	ahead -= ANGLE_TURN * floor(ahead / ANGLE_TURN);
	return arc->sweep > 0 ? ahead < arc->sweep :
				ahead - ANGLE_TURN > arc->sweep || ahead == 0;
}

/* Is it so near to the end of the axis's travel that a lattice point beside the
 * arc may lie beyond? */
static bool is_near(const struct build_arc *p, uint32_t axis, double at_mm)
{
	const struct interp_axis_limits *l = limits(p, axis);
	const double off = (BESIDE_PULSES + p->o->tolerance_milli / 1000.0) *
			   l->pulse_mm;

	return !(p->loose & 1u << axis) &&
	       (at_mm > l->travel_max_mm - off ||
		at_mm < l->travel_min_mm + off);
}

/* The place that lies farthest out at the angle @quarter * 90 degrees. */
static double farthest(const struct interp_arc *arc, int quarter, double r_mm)
{
	return (quarter % 2 ? arc->b_mm : arc->a_mm) +
	       (quarter < 2 ? r_mm : -r_mm);
}

/* Between the ends there is no node.  What lies beyond the travel by more than
 * a rounding is refused; what is near its end is walked when it is added.  The
 * cycle checks an axis that counts from a contact. */
static int arc_travel(struct build_arc *p, struct interp_diag *diag)
{
	const struct interp_arc *arc = &p->arc;
	const double r[2] = { arc->r_mm, arc->r_mm + arc->dr_mm };
	const uint32_t plane[2] = { arc->axis_a, arc->axis_b };

	for (int j = 0; j < 2; j++)
		p->near_edge |= is_near(p, plane[j], p->from_mm[plane[j]]) ||
				is_near(p, plane[j], p->to_mm[plane[j]]);
	for (int q = 0; q < 4; q++) {
		const uint32_t axis = plane[q % 2];
		const struct interp_axis_limits *l = limits(p, axis);
		const double most = farthest(arc, q, larger(r[0], r[1]));
		const double at = farthest(arc, q, smaller(r[0], r[1]));

		if (!is_near(p, axis, most) || !passes(arc, q))
			continue;
		p->near_edge = true;
		if (at > l->travel_max_mm + l->pulse_mm ||
		    at < l->travel_min_mm - l->pulse_mm)
			return build_refuse_travel(p->walks, (int)axis, at,
						   diag);
	}
	return 0;
}

static void arc_length(struct build_arc *p)
{
	const struct interp_arc *arc = &p->arc;
	const double plane = fabs(arc->sweep) * (arc->r_mm + arc->dr_mm / 2);
	double l2 = plane * plane;
	double seconds = plane / smaller(limits(p, arc->axis_a)->v_max_mm_s,
					 limits(p, arc->axis_b)->v_max_mm_s);

	for (uint32_t i = 0; i < INTERP_NAXES; i++) {
		const double d = p->to_mm[i] - p->from_mm[i];

		if (d == 0 || i == arc->axis_a || i == arc->axis_b)
			continue;
		seconds = larger(seconds, fabs(d) / limits(p, i)->v_max_mm_s);
		if (i <= INTERP_Z)
			l2 += d * d;
	}
	p->length_mm = sqrt(l2);
	p->feed_max_mm_s = p->length_mm / seconds;
}

static int refuse_ticks(struct interp_diag *diag)
{
	return interp_diag_say(diag, "the arc has too many pulses for one "
			       "segment; a smaller radius, or fewer turns");
}

/* Ticks are closer than a pulse, with a margin that no rounding error can use
 * up. */
static int ticks_simultaneous(struct build_arc *p, struct interp_diag *diag)
{
	const struct interp_arc *arc = &p->arc;
	const double pulse = smaller(limits(p, arc->axis_a)->pulse_mm,
				     limits(p, arc->axis_b)->pulse_mm);
	const double r = larger(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double plane = (fabs(arc->sweep) * r + fabs(arc->dr_mm)) / pulse;
	const double other = (double)p->way.longest_sub / INTERP_SUB;
	const double ticks = ceil(larger(plane, other) * (1 + 1e-6)) + 1;

	if (ticks > INTERP_PULSES_MAX)
		return refuse_ticks(diag);
	p->ticks = (uint32_t)ticks;
	return 0;
}

/* Both ends in the plane, from the centre, on the lattice. */
static void arc_ends(const struct build_arc *p, int64_t start[2],
		     int64_t end[2])
{
	const struct interp_arc *arc = &p->arc;
	const double pulse = limits(p, arc->axis_a)->pulse_mm;
	const int64_t a = llround(arc->a_mm / pulse);
	const int64_t b = llround(arc->b_mm / pulse);

	start[0] = p->way.from[arc->axis_a] - a;
	start[1] = p->way.from[arc->axis_b] - b;
	end[0] = p->way.to[arc->axis_a] - a;
	end[1] = p->way.to[arc->axis_b] - b;
}

/* With fewer changes of axis, if tolerance and radius allow it. */
static int measure_runs(struct build_arc *p, struct interp_diag *diag)
{
	const int64_t *s = p->runs.start;
	const int64_t r2 = s[0] * s[0] + s[1] * s[1];
	const uint32_t milli = p->o->tolerance_milli;
	const uint32_t least = circle_smallest_milli(r2, milli);
	struct interp_arc arc = p->arc, other = p->arc;

	p->runs.milli = milli;
	/* On a circle of a few pulses, comparison is within one pulse of it. */
	if (milli >= 1000 && least > milli)
		return 0;
	if (least > milli)
		return build_refuse_tolerance(p->o, "this arc",
					      least < 1000 ? least : 1000,
					      diag);
	p->runs.first = 1;
	if (!circle_plan_runs(&other, &p->runs, NULL, 0))
		return 0;
	p->runs.first = 0;
	if (!circle_plan_runs(&arc, &p->runs, NULL, 0))
		return 0;
	p->runs.first = other.nruns < arc.nruns;
	p->arc = other.nruns < arc.nruns ? other : arc;
	return 0;
}

static const struct pulse_strategy *strategy(const struct build_arc *p)
{
	return pulse_strategy(p->o->strategy);
}

void build_arc_runs(const struct build_arc *p, struct interp_arc *arc,
		    int32_t *runs)
{
	struct interp_circle k;

	if (arc->nruns == 0) {
		circle_keep_places(arc, p->runs.start, p->runs.end, runs);
		return;
	}
	circle_plan_runs(arc, &p->runs, runs, arc->nruns);
	circle_enter(&k, arc, p->runs.start, p->runs.end, false);
	k.runs = runs;
	k.nruns = arc->nruns;
	k.run_first = arc->run_first;
	circle_marks(&k, runs + arc->nruns);
}

uint64_t build_arc_kept(const struct build_arc *p)
{
	return p->arc.nruns ? circle_kept(p->arc.nruns) :
	       (uint64_t)circle_places(&p->arc) * CIRCLE_PLACE;
}

/* Around a single pulse only comparison finds a way, whatever the strategy
 * is. */
static bool is_tiny(const int64_t start[2])
{
	return start[0] * start[0] + start[1] * start[1] == 1;
}

/* Pulses of the other axes come one at a time. */
static int count_ticks(struct build_arc *p, struct interp_diag *diag)
{
	const uint64_t ticks = p->arc.circle_ticks + build_rule_pulses(&p->way);
	const int err = build_rule_check(p->o, &p->way, diag);

	if (err < 0)
		return err;
	if (ticks > INTERP_PULSES_MAX)
		return refuse_ticks(diag);
	p->ticks = (uint32_t)ticks;
	return 0;
}

/* Each of them is walked to plan the arc.  One axis at a time, no way is
 * shorter than the arc; its ends may be two pulses nearer to each other. */
static int check_pulses(struct build_arc *p, double pulse,
			struct interp_diag *diag)
{
	const double r_mm = smaller(p->arc.r_mm, p->arc.r_mm + p->arc.dr_mm);
	const double least = fabs(p->arc.sweep) * r_mm / pulse;

	if (least > INTERP_PULSES_MAX / 2.0)
		return refuse_ticks(diag);
	/* For who only counts; one of a few pulses may become a line. */
	if (r_mm > 2 * pulse)
		p->ticks = (uint32_t)larger(least * 0.99 - 4, 0);
	return build_walk_may(p->walks, least * 0.99 - 2, diag);
}

static int ticks_of_pulses(struct build_arc *p, struct interp_diag *diag)
{
	struct interp_arc *arc = &p->arc;
	const double pulse = limits(p, arc->axis_a)->pulse_mm;
	int64_t start[2], end[2];
	int err = 0;

	if (limits(p, arc->axis_b)->pulse_mm != pulse) {
		return interp_diag_say(diag, "a %s arc over axes of unequal "
				       "pulses; strategy simultaneous, or "
				       "equal pulses",
				       interp_strategy_name(p->o->strategy));
	}
	err = check_pulses(p, pulse, diag);
	if (err < 0 || p->walks->again.counts)
		return err;
	arc_ends(p, start, end);
	/* There is nothing to go around, or it goes nowhere. */
	if ((start[0] == 0 && start[1] == 0) ||
	    (start[0] == end[0] && start[1] == end[1] &&
	     fabs(arc->sweep) < ANGLE_TURN / 2)) {
		p->straight = true;
		return 0;
	}
	if (!circle_measure(&p->arc, start, end)) {
		/* An arc of a pulse or two may have no way around. */
		p->straight = fabs(arc->sweep) * arc->r_mm < 4 * pulse;
		return p->straight ? 0 : refuse_ticks(diag);
	}
	memcpy(p->runs.start, start, sizeof(start));
	memcpy(p->runs.end, end, sizeof(end));
	if (strategy(p)->runs && !is_tiny(start))
		err = measure_runs(p, diag);
	return err < 0 ? err : count_ticks(p, diag);
}

/* How far the chord is from the arc, at most. */
static double chord_off_mm(const struct interp_arc *arc)
{
	const double r = larger(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double half = smaller(fabs(arc->sweep), ANGLE_TURN) / 2;

	return r * (1 - cos(half));
}

static double pulse_of(const struct build_arc *p)
{
	return larger(limits(p, p->arc.axis_a)->pulse_mm,
		      limits(p, p->arc.axis_b)->pulse_mm);
}

/* A spiral into its centre, or a way outward with hardly a turn: no speed
 * around it is possible. */
static bool is_steep(const struct interp_arc *arc)
{
	const double least = smaller(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double off = fabs(arc->dr_mm);

	return off > SPIRAL_SHARE * least || off > fabs(arc->sweep) * least;
}

/* It goes nowhere, or stays within half a pulse of its centre. */
static bool is_nothing(const struct build_arc *p)
{
	const struct interp_arc *arc = &p->arc;
	const double most = larger(arc->r_mm, arc->r_mm + arc->dr_mm);
	const double pulse = pulse_of(p);

	return most < pulse / 2 ||
	       fabs(arc->sweep) * most < SAME_PLACE * pulse;
}

/* Is a line as near to it as its radii are to each other? */
static bool is_straight(const struct build_arc *p)
{
	const double near = larger(STRAIGHT_PULSES * pulse_of(p),
				   fabs(p->arc.dr_mm) / 4);

	return is_steep(&p->arc) && chord_off_mm(&p->arc) <= near;
}

static bool is_even(const struct build_arc *p)
{
	const double least = smaller(p->arc.r_mm, p->arc.r_mm + p->arc.dr_mm);
	const double pulse = pulse_of(p);

	return fabs(p->arc.dr_mm) <=
	       larger(SPIRAL_PULSES * pulse,
		      smaller(SPIRAL_OF_R * least, SPIRAL_MOST * pulse));
}

enum build_arc_ends build_arc_even(struct build_arc *p,
				   struct interp_build_arc *word)
{
	const struct interp_arc *arc = &p->arc;
	const double a = p->to_mm[arc->axis_a] - p->from_mm[arc->axis_a];
	const double b = p->to_mm[arc->axis_b] - p->from_mm[arc->axis_b];
	const double theta = arc->theta + arc->sweep / 2;
	const double r = arc->r_mm + arc->dr_mm / 2;
	double chord, by;

	if (fabs(arc->sweep) > WHOLE_TURN || is_nothing(p) || is_even(p) ||
	    is_straight(p))
		return BUILD_ARC_AS_IT_IS;
	chord = hypot(a, b);
	by = arc->dr_mm * r / chord;
	p->mid_mm[0] = arc->a_mm + r * cos(theta);
	p->mid_mm[1] = arc->b_mm + r * sin(theta);
	if (fabs(arc->sweep) > ANGLE_TURN / 2 && fabs(by) > pulse_of(p) &&
	    (chord < NEARLY_CLOSED * r || fabs(by) > CENTRE_SHARE * r))
		return BUILD_ARC_HALVES;
	*word = *p->word;
	word->centre_a_mm += by * a / chord;
	word->centre_b_mm += by * b / chord;
	return BUILD_ARC_MOVED;
}

/* The cycle refuses to walk round what it cannot count in pulses. */
static int settle_far(const struct build_arc *p, struct interp_diag *diag)
{
	const struct interp_arc *arc = &p->arc;
	const double a = limits(p, arc->axis_a)->pulse_mm;
	const double b = limits(p, arc->axis_b)->pulse_mm;

	if (pulse_arc_near(arc, 1 / a, 1 / b))
		return 0;
	return interp_diag_say(diag, "an arc of radius %.0f mm round a place "
			       "at %.0f %.0f; a radius and a centre of less "
			       "than %.0f mm, or a line", arc->r_mm, arc->a_mm,
			       arc->b_mm, INTERP_PULSES_MAX * smaller(a, b));
}

int build_arc_plan(struct build_arc *p, struct interp_diag *diag)
{
	int err = arc_travel(p, diag);

	if (err < 0)
		return err;
	p->straight = is_nothing(p) || is_steep(&p->arc);
	if (p->straight)
		return 0;
	err = settle_far(p, diag);
	if (err < 0)
		return err;
	arc_length(p);
	return strategy(p)->at_once ? ticks_simultaneous(p, diag) :
				      ticks_of_pulses(p, diag);
}
