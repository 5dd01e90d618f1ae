/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve.c - from a NURBS to segments
 *
 * The curve is looked at in many places, span by span, and cut into pieces: at
 * a cusp, where the direction turns back; at a knot that may be a corner, or
 * where the bend may make a step; and where the feed that it allows has changed
 * by more than a half since the piece began.  A piece gets its table of stops,
 * and so many places that no axis jumps.  Then every place is tested, also
 * against the travel, and the number of places is increased until all are
 * right.  The cuts depend only on the limits of the axes, not on the period.
 * So the lattice points do not depend on the period either.
 */
#include "curve/span.h"
#include "path/build_arc.h"
#include "path/build_curve.h"
#include "path/builder.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOKS		64		/* in a span */
#define BESIDE_KNOT	1e-9		/* of a span */
#define FEED_RATIO	1.5		/* fastest to slowest feed in a piece */
#define CUSP_HALVINGS	60
#define STOP_PULSES	0.02		/* error of a stop's place, of the axis
					 * that is fastest there */
#define OTHERS_MOST	1.0		/* a degree is a mm */
#define RATE_MOST	100		/* but near a cusp */
#define MARGIN		1.02		/* factor for the number of places */
#define TRIES		24
#define TRIED_MAX	200000000.0	/* places of a curve in all tries; about
					 * twenty seconds */

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
	const double rate = fmin(build_curve_rate(p) * p->pulse_mm, RATE_MOST);
	const struct interp_nurbs_range r = {
		p->from, to, STOP_PULSES * p->pulse_mm / fmax(rate, 1)
	};
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
		return build_refuse_travel(p->b, axis, at_mm, p->diag);
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
	double places = ceil(length_mm * build_curve_rate(p) * MARGIN *
			     (p->turns > 1 ? 2 : 1)) + 1;

	for (int i = 0; i < TRIES; i++) {
		int err;

		p->tried += places;
		if (places * p->turns > INTERP_PULSES_MAX ||
		    p->tried > TRIED_MAX)
			break;
		err = build_walk(p->b, places, p->diag);
		if (err < 0)
			return err;
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
	int err = p->scouts ? 0 : add_stops(p, to, &piece);

	if (err < 0 || p->scouts)
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
	step.feed_max_mm_s = INFINITY;
	step.seg.arg = (uint32_t)p->b->pieces.n;
	stored = build_table_add(&p->b->pieces);
	if (!stored)
		return -ENOMEM;
	*stored = piece;
	p->word.line = build_curve_line(p, p->from);
	if (p->weighed)
		p->word.feed_mm_s = p->feed_mm_s /
				    fmax(p->seen.counted, p->curve.others);
	return build_step(p->b, &step, &p->word, p->diag);
}

static void piece_begin(struct curve_plan *p, double u)
{
	p->from = u;
	p->seen = (struct curve_seen) { .counted = 0 };
	p->last = build_curve_look(p, u);
	p->least_mm_s = p->most_mm_s = p->last.mm_s;
}

/* Would its feeds differ too much, if this was one? */
static bool differs(const struct curve_plan *p, double mm_s)
{
	return fmax(p->most_mm_s, mm_s) >
	       FEED_RATIO * fmin(p->least_mm_s, mm_s);
}

static void piece_take(struct curve_plan *p, const struct curve_look *here)
{
	p->least_mm_s = fmin(p->least_mm_s, here->mm_s);
	p->most_mm_s = fmax(p->most_mm_s, here->mm_s);
	p->last = *here;
}

/* The piece goes on to @u if its feeds stay similar enough.  Otherwise it ends
 * at the place of the last look. */
static int piece_extend(struct curve_plan *p, double last, double u)
{
	const struct curve_seen was = p->seen;
	const struct curve_look here = build_curve_look(p, u);
	struct curve_look before;
	int err = 0;

	if (last > p->from && differs(p, here.mm_s)) {
		p->seen = was;
		err = piece_add(p, last);
		piece_begin(p, last);
		build_curve_look(p, u);
	}
	before = p->last;
	piece_take(p, &here);
	if (err == 0)
		build_curve_look_between(p, &before, &here);
	return err;
}

static int piece_end(struct curve_plan *p, double u)
{
	const int err = u > p->from ? piece_add(p, u) : 0;

	piece_begin(p, u);
	return err;
}

/* At the knot @u, where what is behind it may bend otherwise. */
static int piece_over(struct curve_plan *p, double u)
{
	const struct curve_seen was = p->seen;
	const struct curve_look here = build_curve_look(p, u);

	if (!differs(p, here.mm_s)) {
		piece_take(p, &here);
		return 0;
	}
	p->seen = was;
	return piece_end(p, u);
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

/* May the curve have a corner at @u, or its bend make a step? */
static bool node_at(const struct interp_nurbs *c, double u)
{
	uint32_t n = 0;

	for (uint32_t i = interp_nurbs_span(c, u); c->knots[i] == u; i--) {
		n++;
		if (i == 0)
			break;
	}
	return n + 1 >= c->degree;
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
			/* At its end, this span and no other. */
			const double part = i < LOOKS ? 1.0 * i / LOOKS :
							1 - BESIDE_KNOT;
			const double u = from + (to - from) * part;

			err = along_look(p, last, u);
			last = u;
		}
		last = to;
		if (err == 0)
			err = to >= end || node_at(&e->c, to) ?
			      piece_end(p, to) : piece_over(p, to);
	}
	return err;
}

/*
 * Where the axes that count turn back or stand, those beside the path go on
 * over next to no length.  There they would allow next to no speed and
 * acceleration along it.  So on such a curve they count more: twice as much,
 * until they allow the speed that those that count never go below.
 */
static int weigh(struct curve_plan *p)
{
	struct interp_curve *stored = p->b->curves.at;
	int err = 0;

	stored += p->b->curves.n - 1;
	p->scouts = true;
	for (;;) {
		p->beside_mm_s = HUGE_VAL;
		err = along(p);
		if (err < 0 || p->beside_mm_s >= p->slowest_mm_s ||
		    2 * p->curve.others > OTHERS_MOST)
			break;
		p->curve.others *= 2;
		p->walk.eval.c.others = stored->others = p->curve.others;
		p->weighed = true;
	}
	p->scouts = false;
	return err;
}

int interp_build_curve(struct interp_build *b,
		       const struct interp_build_curve *c,
		       const struct interp_build_word *w,
		       struct interp_diag *diag)
{
	struct curve_plan p = { .b = b, .c = c, .word = *w, .diag = diag,
				.here_mm = b->here_mm,
				.feed_mm_s = w->feed_mm_s };
	struct interp_nurbs n;
	int err = interp_build_flush(b, diag);

	if (err == 0)
		err = build_curve_check(&p);
	if (err == 0 && b->again.counts)
		return build_count_curve(b, c, diag);
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
	build_curve_limit(&p);
	err = build_curve_check_way(&p);
	if (err == 0 && p.curve.counted < p.curve.naxes)
		err = weigh(&p);
	return err == 0 ? along(&p) : err;
}
