/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_pair.c - from two contours to a pair segment
 *
 * One axis at a time, the builder walks both contours once and notes whose
 * pulse each tick is.  With m1 on X Y and m2 on U V:
 *
 * Arcs of one sense, one phase and one sweep follow each other by angle.  Let
 * (x, y) and (u, v) be the places from the two centres, sigma +1 counter-
 * clockwise and -1 clockwise; for arcs half a turn apart sigma changes sign.
 *
 *	F = sigma * (x*v - y*u)
 *	F >= 0: m2 is level or ahead, m1 pulses; F < 0: m2 pulses
 *	x by d: F += sigma*d*v		y by d: F -= sigma*d*u
 *	u by d: F -= sigma*d*y		v by d: F += sigma*d*x
 *
 * This is the discriminant of Duan, Liu and Lin (1995) with signed places, so
 * that no quadrant is a case of its own.  (Their table of recursions has the
 * rows of U and V exchanged, and ends the wire by the table's count; here each
 * contour ends on its own end point and is not pulsed beyond it.)
 *
 * Everything else goes by shares of length, never by shares of pulses, which
 * an arc sends at an uneven rate: with P done of T in all, in the measure of
 * walk.h (for a line the products of its two axes),
 *
 *	F = P2*T1 - P1*T2, the same rule.
 */
#include "path/build_pair.h"
#include "path/build_arc.h"
#include "path/builder.h"
#include "pulse/strategy.h"

#include "interp/angle.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Arcs follow each other by angle if phase and sweep agree to this: so many
 * pulses on the smaller circle, which rounding can cause, and never more than
 * so many radians. */
#define SAME_PULSES	3.0
#define SAME_MAX	0.5

static const enum interp_axis plane[2][2] = {
	{ INTERP_X, INTERP_Y }, { INTERP_U, INTERP_V },
};

/* -- One contour --------------------------------------------------------- */

static int refuse_long(struct interp_diag *diag)
{
	return interp_diag_say(diag, "two contours of too many pulses for one "
			       "segment; shorter segments");
}

static int side_line(const struct build_pair *p, int i, struct interp_arc *ret,
		     double *ret_mm, struct interp_diag *diag)
{
	const enum interp_axis a = plane[i][0], b = plane[i][1];
	const int64_t da = llabs((int64_t)p->to[a] - p->from[a]);
	const int64_t db = llabs((int64_t)p->to[b] - p->from[b]);

	if (da >= INT64_C(1) << 28 || db >= INT64_C(1) << 28)
		return refuse_long(diag);
	*ret = (struct interp_arc) {
		.axis_a = (uint8_t)a, .axis_b = (uint8_t)b,
		.a_mm = p->from_mm[a], .b_mm = p->from_mm[b],
		.measure = da * da + db * db,
		.circle_ticks = (uint32_t)(da + db),
	};
	*ret_mm = hypot(p->to_mm[a] - p->from_mm[a],
			p->to_mm[b] - p->from_mm[b]);
	return 0;
}

static bool at_once(const struct build_pair *p)
{
	return pulse_strategy(p->strategy)->at_once;
}

/* An arc of its own, as if nothing else moved. */
static int side_arc(const struct build_pair *p, int i, struct build_arc *plan,
		    struct interp_diag *diag)
{
	const struct interp_build_contour *k = &p->contour[i];
	const struct interp_build_arc word = {
		.axis_a = plane[i][0], .axis_b = plane[i][1],
		.centre_a_mm = k->centre_mm[0], .centre_b_mm = k->centre_mm[1],
		.sweep = k->sweep,
	};
	const struct interp_build_options o = {
		.machine = p->machine,
		.strategy = at_once(p) ? INTERP_SIMULTANEOUS :
					 INTERP_POINT_BY_POINT,
	};
	int err;

	*plan = (struct build_arc) { .o = &o, .walks = p->walks, .word = &word,
				     .loose = p->loose };
	for (int j = 0; j < 2; j++) {
		const enum interp_axis a = plane[i][j];

		plan->from_mm[a] = p->from_mm[a];
		plan->to_mm[a] = p->to_mm[a];
		plan->way.from[a] = p->from[a];
		plan->way.to[a] = p->to[a];
		plan->way.except |= 1u << a;
	}
	build_arc_shape(plan);
	err = build_arc_plan(plan, diag);
	plan->word = NULL;
	plan->o = NULL;
	return err;
}

static double v_max(const struct build_pair *p, int i)
{
	return fmin(p->machine->axis[plane[i][0]].v_max_mm_s,
		    p->machine->axis[plane[i][1]].v_max_mm_s);
}

/* Put contour @i into the couple; find its length and the ticks that an arc
 * needs. */
static int side_plan(struct build_pair *p, int i, double *ret_mm,
		     struct interp_diag *diag)
{
	struct build_arc plan;
	int err;

	if (!p->contour[i].arc)
		return side_line(p, i, &p->couple.side[i], ret_mm, diag);
	err = side_arc(p, i, &plan, diag);
	if (err < 0)
		return err;
	if (plan.straight)
		return side_line(p, i, &p->couple.side[i], ret_mm, diag);
	p->near_edge |= plan.near_edge;
	p->couple.side[i] = plan.arc;
	memcpy(p->start[i], plan.runs.start, sizeof(p->start[i]));
	memcpy(p->end[i], plan.runs.end, sizeof(p->end[i]));
	*ret_mm = plan.length_mm;
	if (at_once(p) && plan.ticks > p->ticks)
		p->ticks = plan.ticks;
	return 0;
}

/* -- Whose pulse it is ---------------------------------------------------- */

struct follow {
	struct interp_side side[2];
	int64_t sign;			/* sigma; 0: by length */
	int64_t angle;			/* F by angle */
	pulse_wide length;		/* F by length */
	int64_t total[2];		/* measures */
};

/* sigma, or 0 if the two must go by length. */
static int follow_sign(const struct build_pair *p)
{
	const struct interp_arc *a = &p->couple.side[0];
	const struct interp_arc *b = &p->couple.side[1];
	const double pulse = p->machine->axis[INTERP_X].pulse_mm;
	const double r = fmin(a->r_mm, b->r_mm) / pulse;
	const double same = fmin(SAME_PULSES / r, SAME_MAX);
	const double phase = fabs(angle_nearest(b->theta - a->theta, 0));
	const int sigma = a->sweep > 0 ? 1 : -1;

	if (!(r > 0) || a->sweep * b->sweep < 0 ||
	    fabs(a->sweep - b->sweep) > same)
		return 0;
	if (phase <= same)
		return sigma;
	return phase >= ANGLE_TURN / 2 - same ? -sigma : 0;
}

static bool follow_init(struct follow *f, const struct build_pair *p)
{
	const struct interp_arc *arc = p->couple.side;

	*f = (struct follow) { .sign = follow_sign(p) };
	for (int i = 0; i < 2; i++) {
		int64_t at[2][2];

		for (int j = 0; j < 2; j++) {
			const enum interp_axis a = plane[i][j];
			const double centre = j ? arc[i].b_mm : arc[i].a_mm;
			const int64_t c = llround(centre /
					p->machine->axis[a].pulse_mm);

			at[0][j] = p->from[a] - c;
			at[1][j] = p->to[a] - c;
		}
		f->total[i] = arc[i].measure;
		if (!side_enter(&f->side[i], &arc[i], at[0], at[1], false))
			return false;
	}
	f->angle = f->sign * (f->side[0].circle.x * f->side[1].circle.y -
			      f->side[0].circle.y * f->side[1].circle.x);
	return true;
}

/* Find the side with the next pulse, and take the pulse from it. */
static int follow_next(struct follow *f)
{
	struct interp_side *s = f->side;
	const bool level = f->sign ? f->angle >= 0 : f->length >= 0;
	const int i = !(s[0].tick < s[0].ticks &&
			(level || s[1].tick == s[1].ticks));
	const int64_t across = s[!i].circle.y, along = s[!i].circle.x;
	int8_t d[2];

	if (!side_forward(&s[i], d))
		return -EINVAL;
	if (f->sign)
		f->angle += (i ? -f->sign : f->sign) *
			    (d[0] * across - d[1] * along);
	else
		f->length += (i ? (pulse_wide)f->total[0] :
				  -(pulse_wide)f->total[1]) *
			     side_measure_of(&s[i], d);
	return i;
}

static int follow_walk(struct build_pair *p, struct interp_diag *diag)
{
	const struct interp_arc *arc = p->couple.side;
	const uint64_t ticks = (uint64_t)arc[0].circle_ticks +
			       arc[1].circle_ticks;
	struct follow f;
	const int err = build_walk_may(p->walks, (double)ticks, diag);

	if (err < 0)
		return err;
	if (ticks > INTERP_PULSES_MAX || !follow_init(&f, p))
		return refuse_long(diag);
	p->ticks = (uint32_t)ticks;
	p->bits = calloc(pulse_string_words(ticks) + 1, sizeof(*p->bits));
	if (!p->bits)
		return -ENOMEM;
	for (uint64_t k = 0; k < ticks; k++) {
		const int i = follow_next(&f);

		if (i < 0)
			return refuse_long(diag);
		p->bits[k / 64] |= (uint64_t)i << k % 64;
	}
	pulse_string_count(p->bits, ticks);
	return 0;
}

int build_pair_plan(struct build_pair *p, struct interp_diag *diag)
{
	double mm[2], seconds = 0;

	p->bits = NULL;
	p->ticks = 0;
	p->near_edge = false;
	for (int i = 0; i < 2; i++) {
		const int err = side_plan(p, i, &mm[i], diag);

		if (err < 0)
			return err;
		seconds = fmax(seconds, mm[i] / v_max(p, i));
	}
	p->fed_mm = mm[0] > 0 ? mm[0] : mm[1];
	p->length_mm = build_counts(mm[0] * mm[0], mm[1] * mm[1]) ? mm[0] :
								   mm[1];
	p->feed_max_mm_s = p->length_mm / seconds;
	if (at_once(p)) {
		const int64_t n = (p->longest_sub + INTERP_SUB - 1) >>
				  INTERP_SUB_BITS;

		if (n > INTERP_PULSES_MAX)
			return refuse_long(diag);
		if (n > p->ticks)
			p->ticks = (uint32_t)n;
		return 0;
	}
	return follow_walk(p, diag);
}
