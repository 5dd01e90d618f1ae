/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve.c - from a NURBS to segments
 *
 * The curve is looked at in many places, span by span, and cut into pieces: at
 * a cusp, where the direction turns back; at a knot that may be a corner; and
 * where the feed that it allows has changed by more than a half since the piece
 * began.  A piece gets its table of stops, and so many places that no axis
 * jumps.  Then every place is tested, also against the travel, and the number
 * of places is increased until all are right.  The cuts depend only on the
 * limits of the axes, not on the period.  So the lattice points do not depend
 * on the period either.
 */
#include "curve/span.h"
#include "path/build_arc.h"
#include "path/build_curve.h"
#include "path/builder.h"
#include "pulse/strategy.h"

#include "interp/limits.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS		64		/* in a span */
#define NEAR		0.1		/* between two looks feed and heading
					 * change by no more */
#define NEAR_HALVINGS	10
#define FEED_RATIO	1.5		/* fastest to slowest feed in a piece */
#define CUSP_HALVINGS	60
#define STOP_PULSES	0.02		/* error of a stop's place */
#define MARGIN		1.02		/* factor for the number of places */
#define TRIES		24
#define TRIED_MAX	200000000.0	/* places of a curve in all tries; about
					 * twenty seconds */

/* -- What limits it ------------------------------------------------------- */

static const struct interp_axis_limits *axis_of(const struct curve_plan *p,
						uint32_t k)
{
	return &p->b->o.machine->axis[p->curve.axis[k]];
}

/* Shares of an axis's acceleration: to follow the curve, and to go along it. */
static double across_part(const struct curve_plan *p, uint32_t k)
{
	return k < p->curve.counted ? INTERP_BEND_ACROSS : INTERP_BESIDE_ACROSS;
}

static double along_part(const struct curve_plan *p, uint32_t k)
{
	return k < p->curve.counted ? INTERP_BEND_ALONG : INTERP_BESIDE_ALONG;
}

static void set_limits(struct curve_plan *p)
{
	const struct interp_build_options *o = &p->b->o;
	struct interp_nurbs_limits *l = &p->limits;
	double jerk = HUGE_VAL, acc = HUGE_VAL;

	*l = (struct interp_nurbs_limits) {
		.chord_error_mm = HUGE_VAL, .period_s = 1,
		.centripetal_mm_s2 = HUGE_VAL,
	};
	p->chord_mm_s = o->chord_error_mm > 0 && o->period_s > 0 ?
			sqrt(8 * o->chord_error_mm) / o->period_s : HUGE_VAL;
	p->pulse_mm = HUGE_VAL;
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const struct interp_axis_limits *m = axis_of(p, k);

		l->v_mm_s[k] = m->v_max_mm_s;
		l->a_mm_s2[k] = across_part(p, k) * m->a_max_mm_s2;
		l->j_mm_s3[k] = INTERP_CURVE_JERK_ROUND * m->j_max_mm_s3;
		p->pulses_mm[p->curve.axis[k]] = 1 / m->pulse_mm;
		p->pulse_mm = fmin(p->pulse_mm, m->pulse_mm);
		jerk = fmin(jerk, m->j_max_mm_s3);
		acc = fmin(acc, m->a_max_mm_s2);
		if (k < p->curve.counted)
			l->centripetal_mm_s2 = fmin(l->centripetal_mm_s2,
						    l->a_mm_s2[k]);
	}
	/* The axes do not notice a bend whose radius is less than a pulse. */
	p->slowest_mm_s = cbrt(jerk * p->pulse_mm * p->pulse_mm);
	p->least_mm_s2 = INTERP_BEND_LEAST * acc;
}

static void learn(struct curve_plan *p, const struct interp_nurbs_way *w)
{
	struct curve_seen *s = &p->seen;

	s->bend = fmax(s->bend, w->cusp ? HUGE_VAL : w->curvature);
	for (int n = 0; !w->cusp && n < 3; n++)
		for (uint32_t k = 0; k < p->curve.naxes; k++)
			s->d[n][k] = fmax(s->d[n][k], fabs(w->d[n][k]));
}

/* So slow that the jerk lets it speed up here, by no less than it must. */
static double set_off_mm_s(const struct curve_plan *p,
			   const struct interp_nurbs_way *w)
{
	double v = HUGE_VAL;

	for (uint32_t k = 0; !w->cusp && k < p->curve.naxes; k++)
		if (w->d[1][k] != 0)
			v = fmin(v, INTERP_CURVE_JERK_BOTH *
				    axis_of(p, k)->j_max_mm_s3 /
				    (3 * fabs(w->d[1][k]) * p->least_mm_s2));
	return v;
}

/* Look at @u: find the feed that its axes allow.  The present piece learns how
 * its axes go there. */
static struct curve_look look(struct curve_plan *p, double u)
{
	struct interp_nurbs_eval *e = &p->walk.eval;
	struct curve_look ret = { .u = u };
	struct interp_nurbs_way w;
	double feed;

	interp_nurbs_way(e, u, &w);
	learn(p, &w);
	feed = interp_nurbs_feed_mm_s(&e->c, &w, &p->limits);
	ret.mm_s = fmax(fmin(feed, set_off_mm_s(p, &w)), p->slowest_mm_s);
	memcpy(ret.heading, w.d[0], sizeof(ret.heading));
	return ret;
}

static bool is_near(const struct curve_plan *p, const struct curve_look *a,
		    const struct curve_look *b)
{
	double size = 0, turn = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		size = fmax(size, fabs(a->heading[k]));
		turn = fmax(turn, fabs(a->heading[k] - b->heading[k]));
	}
	return turn <= NEAR * size &&
	       fmax(a->mm_s, b->mm_s) <= (1 + NEAR) * fmin(a->mm_s, b->mm_s);
}

/* The tightest place of a bend may lie between two looks: look there, until
 * neighbours are alike. */
static void look_between(struct curve_plan *p, const struct curve_look *a,
			 const struct curve_look *b, int halvings)
{
	struct curve_look middle;

	if (halvings == 0 || is_near(p, a, b))
		return;
	middle = look(p, (a->u + b->u) / 2);
	p->least_mm_s = fmin(p->least_mm_s, middle.mm_s);
	p->most_mm_s = fmax(p->most_mm_s, middle.mm_s);
	look_between(p, a, &middle, halvings - 1);
	look_between(p, &middle, b, halvings - 1);
}

/* The feed of the present piece. */
static double feed_of(const struct curve_plan *p)
{
	const double chord = p->chord_mm_s / sqrt(p->seen.bend);

	return fmax(fmin(p->least_mm_s, chord), p->slowest_mm_s);
}

/* The most pulses of an axis in a mm. */
static double rate_of(const struct curve_plan *p)
{
	double rate = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++)
		rate = fmax(rate, p->seen.d[0][k] *
				  p->pulses_mm[p->curve.axis[k]]);
	return rate;
}

/*
 * What following the present piece at @v_mm_s leaves of the acceleration of
 * column @k.  The ways along and across are square to each other, so a counted
 * axis has what is left of both together.  A cusp is passed at the slowest speed
 * whatever it takes, and leaves the share.
 */
static double left_mm_s2(const struct curve_plan *p, uint32_t k, double v_mm_s)
{
	const double a = axis_of(p, k)->a_max_mm_s2;
	const double across = p->seen.bend * v_mm_s * v_mm_s;
	const double left = a - p->seen.d[1][k] * v_mm_s * v_mm_s;

	return fmax(fmax(left, along_part(p, k) * a),
		    k < p->curve.counted && across < a ?
		    sqrt(a * a - across * across) : 0);
}

/* The same of its jerk. */
static double left_mm_s3(const struct curve_plan *p, uint32_t k, double v_mm_s)
{
	const double j = axis_of(p, k)->j_max_mm_s3;

	return fmax(j - p->seen.d[2][k] * v_mm_s * v_mm_s * v_mm_s,
		    (1 - INTERP_CURVE_JERK_ROUND) * j);
}

/* How fast to speed up along the present piece, at @v_mm_s at most: to speed up
 * on a bend takes jerk, and no more than half of what is left. */
static void along_of(const struct curve_plan *p, double v_mm_s,
		     struct interp_piece *ret)
{
	double a = HUGE_VAL, j = HUGE_VAL;

	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		a = fmin(a, left_mm_s2(p, k, v_mm_s) / p->seen.d[0][k]);
		a = fmin(a, fmax(left_mm_s3(p, k, v_mm_s) / 2 /
				 (3 * p->seen.d[1][k] * v_mm_s),
				 p->least_mm_s2));
	}
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const double left = left_mm_s3(p, k, v_mm_s);

		j = fmin(j, fmax(left - 3 * p->seen.d[1][k] * v_mm_s * a,
				 left / 2) / p->seen.d[0][k]);
	}
	ret->a_mm_s2 = a;
	ret->j_mm_s3 = j;
}

/* -- Pieces --------------------------------------------------------------- */

static const struct interp_nurbs_stop *stops_of(const struct curve_plan *p,
						const struct interp_piece *q)
{
	const struct interp_nurbs_stop *s = p->b->stops.at;

	return s + q->stops_at;
}

static int add_stops(struct curve_plan *p, double to,
		     struct interp_piece *piece)
{
	const struct interp_nurbs_range r = { p->from, to,
					      STOP_PULSES * p->pulse_mm };
	struct interp_nurbs_eval *e = &p->walk.eval;
	const size_t n = interp_nurbs_stops(e, &r, NULL, 0);
	struct interp_nurbs_stop *s = malloc(n * sizeof(*s));
	bool ok = s != NULL;

	piece->curve = (uint32_t)p->b->curves.n - 1;
	piece->nstops = (uint32_t)n;
	piece->stops_at = p->b->stops.n;
	if (ok)
		interp_nurbs_stops(e, &r, s, n);
	for (size_t i = 0; ok && i < n; i++) {
		struct interp_nurbs_stop *at = build_table_add(&p->b->stops);

		ok = at != NULL;
		if (ok)
			*at = s[i];
	}
	free(s);
	return ok ? 0 : -ENOMEM;
}

/* Axis @k is at @pulses and comes from @was.  Return: 1 if it jumps, or
 * refused. */
static int try_axis(struct curve_plan *p, uint32_t k, int32_t pulses,
		    int32_t was)
{
	const int axis = p->curve.axis[k];
	const double at_mm = pulses / p->pulses_mm[axis];

	if (!build_axis_ok(p->b, axis, at_mm)) {
		build_curve_blame(p, p->from);
		return build_refuse_travel(p->b->o.machine, axis, at_mm,
					   p->diag);
	}
	return pulses - was > 1 || pulses - was < -1;
}

/* Does no axis jump, and does none leave its travel?  Return: 1 if one
 * jumps. */
static int try_places(struct curve_plan *p, const double end_mm[INTERP_NAXES])
{
	struct interp_curve_walk *w = &p->walk;
	int32_t was[INTERP_NAXES];
	int err = 0;

	for (uint32_t k = 0; k < p->curve.naxes; k++)
		was[k] = interp_round_sub(p->b->here[p->curve.axis[k]]);
	for (uint32_t i = 1; err == 0 && i <= w->places; i++) {
		if (i < w->places)
			pulse_curve_place(w, p->pulses_mm, i);
		for (uint32_t k = 0; err == 0 && k < p->curve.naxes; k++) {
			const int axis = p->curve.axis[k];

			if (i == w->places)
				w->pos[k] = interp_round_sub(llround(
					end_mm[axis] * p->b->sub_mm[axis]));
			err = try_axis(p, k, w->pos[k], was[k]);
			was[k] = w->pos[k];
		}
	}
	return err;
}

/* Find a number of places that is enough.  Return: 0, or the refusal. */
static int find_places(struct curve_plan *p, const struct interp_piece *piece,
		       const double end_mm[INTERP_NAXES])
{
	const struct interp_nurbs_stop *stops = stops_of(p, piece);
	const double length_mm = stops[piece->nstops - 1].s_mm;
	double places = ceil(length_mm * rate_of(p) * MARGIN *
			     (p->turns > 1 ? 2 : 1)) + 1;

	for (int i = 0; i < TRIES; i++) {
		int err;

		p->tried += places;
		if (places * p->turns > INTERP_PULSES_MAX ||
		    p->tried > TRIED_MAX)
			break;
		pulse_curve_aim(&p->walk, stops, piece->nstops,
				(uint32_t)places, length_mm);
		err = try_places(p, end_mm);
		if (err <= 0)
			return err;
		places = ceil(places * 1.2);
	}
	return build_curve_refuse(p, "a curve with too many pulses for one "
				  "segment", "a shorter curve");
}

uint32_t build_curve_line(struct curve_plan *p, double u)
{
	const struct interp_build_curve *c = p->c;

	if (c->nmarks == 0)
		return p->word.line;
	while (p->mark + 1 < c->nmarks && c->marks[p->mark + 1].u <= u)
		p->mark++;
	return c->marks[p->mark].line;
}

/* The end of the curve is its last control point, without rounding. */
static void end_of(struct curve_plan *p, double to,
		   double end_mm[INTERP_NAXES])
{
	const struct interp_nurbs *n = &p->walk.eval.c;
	struct interp_nurbs_point at;

	memcpy(end_mm, p->b->here_mm, sizeof(p->b->here_mm));
	interp_nurbs_at(&p->walk.eval, to, 0, &at);
	for (uint32_t k = 0; k < n->naxes; k++)
		end_mm[p->curve.axis[k]] = at.d[0][k];
}

static int piece_add(struct curve_plan *p, double to)
{
	double end_mm[INTERP_NAXES];
	struct build_step step = { .seg = { .kind = INTERP_CURVE },
				   .moved = p->moved, .end_mm = end_mm };
	struct interp_piece piece, *stored;
	int err = add_stops(p, to, &piece);

	if (err < 0)
		return err;
	end_of(p, to, end_mm);
	step.seg.length_mm = stops_of(p, &piece)[piece.nstops - 1].s_mm;
	/* The curve stands still here. */
	if (!(step.seg.length_mm > 0))
		return 0;
	err = find_places(p, &piece, end_mm);
	if (err < 0)
		return err;
	step.seg.ticks = p->walk.places * p->turns;
	step.feed_max_mm_s = feed_of(p);
	along_of(p, step.feed_max_mm_s, &piece);
	step.seg.arg = (uint32_t)p->b->pieces.n;
	stored = build_table_add(&p->b->pieces);
	if (!stored)
		return -ENOMEM;
	*stored = piece;
	p->word.line = build_curve_line(p, p->from);
	return build_step(p->b, &step, &p->word, p->diag);
}

static void piece_begin(struct curve_plan *p, double u)
{
	p->from = u;
	p->seen = (struct curve_seen) { .bend = 0 };
	p->last = look(p, u);
	p->least_mm_s = p->most_mm_s = p->last.mm_s;
}

/* The piece goes on to @u if its feeds stay similar enough.  Otherwise it ends
 * at the place of the last look. */
static int piece_extend(struct curve_plan *p, double last, double u)
{
	const struct curve_seen was = p->seen;
	const struct curve_look here = look(p, u);
	const double feed = here.mm_s;
	int err = 0;

	if (last > p->from && fmax(p->most_mm_s, feed) >
			      FEED_RATIO * fmin(p->least_mm_s, feed)) {
		p->seen = was;
		err = piece_add(p, last);
		piece_begin(p, last);
		look(p, u);
	}
	p->least_mm_s = fmin(p->least_mm_s, feed);
	p->most_mm_s = fmax(p->most_mm_s, feed);
	if (err == 0)
		look_between(p, &p->last, &here, NEAR_HALVINGS);
	p->last = here;
	return err;
}

static int piece_end(struct curve_plan *p, double u)
{
	const int err = u > p->from ? piece_add(p, u) : 0;

	piece_begin(p, u);
	return err;
}

/* -- Along the curve ------------------------------------------------------ */

/* Between two looks at a span, the direction has turned back.  Find where. */
static double cusp_of(const struct interp_nurbs_eval *e, double from,
		      double to)
{
	struct interp_nurbs_point a, b;

	nurbs_span_at(e, from, 1, &a);
	for (int i = 0; i < CUSP_HALVINGS; i++) {
		const double middle = (from + to) / 2;

		nurbs_span_at(e, middle, 1, &b);
		if (interp_nurbs_dot(&e->c, a.d[1], b.d[1]) > 0)
			from = middle;
		else
			to = middle;
	}
	return to;
}

static int along_look(struct curve_plan *p, double last, double u)
{
	const struct interp_nurbs_eval *e = &p->walk.eval;
	struct interp_nurbs_point a, b;
	int err = 0;

	interp_nurbs_at(&p->walk.eval, last, 1, &a);
	nurbs_span_at(e, u, 1, &b);
	if (interp_nurbs_dot(&e->c, a.d[1], b.d[1]) < 0) {
		const double cusp = cusp_of(e, last, u);

		if (cusp > last && cusp < u) {
			err = piece_extend(p, last, cusp);
			err = err == 0 ? piece_end(p, cusp) : err;
			last = cusp;
		}
	}
	return err == 0 ? piece_extend(p, last, u) : err;
}

/* May the curve have a corner at @u? */
static bool corner_at(const struct interp_nurbs *c, double u)
{
	uint32_t n = 0;

	for (uint32_t i = interp_nurbs_span(c, u); c->knots[i] == u; i--) {
		n++;
		if (i == 0)
			break;
	}
	return n >= c->degree;
}

static int along(struct curve_plan *p)
{
	struct interp_nurbs_eval *e = &p->walk.eval;
	double last = interp_nurbs_first(&e->c);
	const double end = interp_nurbs_last(&e->c);
	struct interp_nurbs_point at;
	int err = 0;

	piece_begin(p, last);
	while (err == 0 && last < end) {
		double to, from = last;

		interp_nurbs_at(e, last, 0, &at);
		to = e->to;
		for (int i = 1; err == 0 && i <= LOOKS; i++) {
			const double u = i < LOOKS ? from + (to - from) * i /
						     LOOKS : to;

			err = along_look(p, last, u);
			last = u;
		}
		if (err == 0 && (last >= end || corner_at(&e->c, last)))
			err = piece_end(p, last);
	}
	return err;
}

int interp_build_curve(struct interp_build *b,
		       const struct interp_build_curve *c,
		       const struct interp_build_word *w,
		       struct interp_diag *diag)
{
	struct curve_plan p = { .b = b, .c = c, .word = *w, .diag = diag,
				.here_mm = b->here_mm };
	struct interp_nurbs n;
	int err = interp_build_flush(b, diag);

	if (err == 0)
		err = build_curve_check(&p);
	if (err == 0)
		err = build_curve_store(b, c, &p.curve, &p.moved);
	if (err < 0 || p.curve.naxes == 0)
		return err;
	n = (struct interp_nurbs) {
		.degree = p.curve.degree, .naxes = p.curve.naxes,
		.npoints = p.curve.npoints, .counted = p.curve.counted,
		.others = p.curve.others,
		.knots = (double *)b->numbers.at + p.curve.knots_at,
		.points = (double *)b->numbers.at + p.curve.points_at,
	};
	interp_nurbs_open(&p.walk.eval, &n);
	memcpy(p.walk.axis, p.curve.axis, sizeof(p.walk.axis));
	p.turns = pulse_curve_turns(b->o.strategy, n.naxes);
	set_limits(&p);
	err = build_curve_check_way(&p);
	return err == 0 ? along(&p) : err;
}
