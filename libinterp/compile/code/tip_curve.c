/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_curve.c - lines, arcs and curves of the tool's tip under G43.4
 *
 * On a line or an arc, the other axes move in proportion to the tip.  A curve
 * has them in its control points.  It is walked span by span, because a knot
 * may be a corner, and by length, so that sharp bends are not stepped over.
 */
#include "code/nurbs_words.h"
#include "code/tip_way.h"
#include "curve/span.h"
#include "interp/angle.h"
#include "interp/nurbs_length.h"
#include "path/build_arc.h"
#include "path/build_curve.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* If the ends of an arc are this near to each other, they are one place, in
 * pulses. */
#define SAME_PULSES	0.5

/* -- Lines and arcs ------------------------------------------------------- */

struct ends {
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];
	struct interp_arc arc;
};

static void line_at(const void *of, double t, double ret_mm[INTERP_NAXES])
{
	const struct ends *e = of;

	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = t < 1 ? e->from_mm[i] +
				    (e->to_mm[i] - e->from_mm[i]) * t :
				    e->to_mm[i];
}

static void arc_at(const void *of, double t, double ret_mm[INTERP_NAXES])
{
	const struct interp_arc *a = &((const struct ends *)of)->arc;
	const double theta = a->theta + a->sweep * t;
	const double radius = a->r_mm + a->dr_mm * t;

	line_at(of, t, ret_mm);
	if (!(t < 1))
		return;
	ret_mm[a->axis_a] = a->a_mm + radius * cos(theta);
	ret_mm[a->axis_b] = a->b_mm + radius * sin(theta);
}

/* How far the rotary axis turns that turns most. */
static double turn_deg(const struct ends *e)
{
	double turn = 0;

	for (int i = INTERP_A; i <= INTERP_C; i++)
		turn = fmax(turn, fabs(e->to_mm[i] - e->from_mm[i]));
	return turn;
}

static int go(struct nc_reader *r, const struct nc_tip_way *w,
	      const double end_mm[INTERP_NAXES])
{
	const int err = nc_tip_way(r, w);

	memcpy(r->tool.here_mm, end_mm, sizeof(r->tool.here_mm));
	return err;
}

static int line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		bool in_place)
{
	struct nc_tip_way w = { .at = line_at, .in_place = in_place };
	struct ends e;

	memcpy(e.from_mm, r->tool.here_mm, sizeof(e.from_mm));
	memcpy(e.to_mm, end_mm, sizeof(e.to_mm));
	w.of = &e;
	w.turn_deg = turn_deg(&e);
	return go(r, &w, end_mm);
}

int nc_tip_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		bool rapid)
{
	r->word.rapid = rapid;
	return line(r, end_mm, false);
}

int nc_tip_turn(struct nc_reader *r, const double end_mm[INTERP_NAXES])
{
	return line(r, end_mm, true);
}

/* If the axes put the tip somewhere, no program can name the place to the last
 * digit.  An arc that ends there is a full circle all the same. */
static void close_circle(const struct nc_reader *r, struct build_arc *p,
			 struct interp_build_arc *word)
{
	const int plane[] = { (int)word->axis_a, (int)word->axis_b };

	for (int i = 0; i < 2; i++) {
		const double off = p->to_mm[plane[i]] - p->from_mm[plane[i]];

		if (fabs(off) >= SAME_PULSES *
				 r->o->machine->axis[plane[i]].pulse_mm)
			return;
	}
	for (int i = 0; i < 2; i++)
		p->from_mm[plane[i]] = p->to_mm[plane[i]];
	word->sweep = copysign(ANGLE_TURN, word->sweep);
}

int nc_tip_arc(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       const struct interp_build_arc *arc)
{
	const struct interp_build_options o = { .machine = r->o->machine };
	struct interp_build_arc word = *arc;
	struct build_arc plan = { .o = &o, .word = &word };
	struct nc_tip_way w = { .at = arc_at };
	double begin[INTERP_NAXES];
	struct ends e;

	memcpy(e.from_mm, r->tool.here_mm, sizeof(e.from_mm));
	memcpy(e.to_mm, end_mm, sizeof(e.to_mm));
	memcpy(plan.from_mm, e.from_mm, sizeof(plan.from_mm));
	memcpy(plan.to_mm, e.to_mm, sizeof(plan.to_mm));
	close_circle(r, &plan, &word);
	build_arc_shape(&plan);
	e.arc = plan.arc;
	w.of = &e;
	w.turn_deg = turn_deg(&e);
	arc_at(&e, 0, begin);
	for (int i = 0; i < INTERP_NAXES; i++)
		w.off_mm[0][i] = e.from_mm[i] - begin[i];
	return go(r, &w, end_mm);
}

/* -- Curves --------------------------------------------------------------- */

struct knot_span {
	const struct interp_nurbs_eval *e;
	struct interp_nurbs_stop *stops;
	size_t nstops;
};

static void span_at(const void *of, double t, double ret_mm[INTERP_NAXES])
{
	const struct knot_span *k = of;
	const struct interp_nurbs_stop *last = k->stops + k->nstops - 1;
	const double s_mm = last->s_mm * t;
	struct interp_nurbs_between b;
	struct interp_nurbs_point p;
	double u = last->u;

	if (t < 1) {
		interp_nurbs_between(k->stops +
			interp_nurbs_stop_of(k->stops, k->nstops, s_mm), &b);
		u = interp_nurbs_between_at(&b, s_mm);
	}
	nurbs_span_at(k->e, u, 0, &p);
	memcpy(ret_mm, p.d[0], sizeof(p.d[0]));
}

/* The table by length for the span that was entered. */
static int make_stops(struct knot_span *k, struct interp_nurbs_eval *e,
		      double error_mm)
{
	const struct interp_nurbs_range range = { e->from, e->to, error_mm };

	k->e = e;
	k->nstops = interp_nurbs_stops(e, &range, NULL, 0);
	k->stops = malloc(k->nstops * sizeof(*k->stops));
	if (!k->stops)
		return -ENOMEM;
	interp_nurbs_stops(e, &range, k->stops, k->nstops);
	return 0;
}

/* How far @at_mm is from the place that the program names. */
static void lack(const double want_mm[INTERP_NAXES],
		 const double at_mm[INTERP_NAXES], double ret[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = want_mm[i] - at_mm[i];
}

static int go_span(struct nc_reader *r, struct interp_nurbs_eval *e)
{
	struct nc_tip_way w = { .at = span_at };
	double at_mm[INTERP_NAXES];
	struct knot_span k;
	int err = make_stops(&k, e, r->o->tip_tolerance_mm);

	if (err)
		return err;
	w.of = &k;
	w.turn_deg = k.stops[k.nstops - 1].s_mm;
	span_at(&k, 0, at_mm);
	lack(r->tool.here_mm, at_mm, w.off_mm[0]);
	span_at(&k, 1, at_mm);
	if (e->to == interp_nurbs_last(&e->c)) {
		lack(r->curve.last_mm, at_mm, w.off_mm[1]);
		memcpy(at_mm, r->curve.last_mm, sizeof(at_mm));
	}
	/* Where the curve stands still, there is no length to walk by. */
	if (w.turn_deg > 0)
		err = go(r, &w, at_mm);
	free(k.stops);
	return err;
}

static int check(struct nc_reader *r, struct curve_plan *p)
{
	struct interp_nurbs_point end;
	int err = build_curve_check(p);

	for (uint8_t i = 0; i < INTERP_NAXES; i++) {
		p->curve.axis[i] = p->c->axis[i];
		p->pulses_mm[i] = 1 / r->o->machine->axis[i].pulse_mm;
	}
	p->curve.naxes = INTERP_NAXES;
	if (!err) {
		interp_nurbs_open(&p->walk.eval, &p->c->nurbs);
		err = build_curve_check_start(p);
	}
	if (err) {
		if (!r->diag->line)
			r->diag->line = r->line;
		return nc_placed(r, err, r->curve.last_mm);
	}
	interp_nurbs_at(&p->walk.eval, interp_nurbs_last(&p->c->nurbs), 0,
			&end);
	return nc_curve_check_end(r, end.d[0]);
}

int nc_tip_curve(struct nc_reader *r, const struct interp_build_curve *c)
{
	struct curve_plan p = { .c = c, .word = r->word, .diag = r->diag,
				.here_mm = r->tool.here_mm };
	struct interp_nurbs_eval *e = &p.walk.eval;
	int err = check(r, &p);

	if (err)
		return err;
	nurbs_span_enter(e, interp_nurbs_span(&c->nurbs,
					      interp_nurbs_first(&c->nurbs)));
	do {
		r->word.line = build_curve_line(&p, e->from);
		err = go_span(r, e);
	} while (!err && nurbs_span_next(e));
	return err;
}
