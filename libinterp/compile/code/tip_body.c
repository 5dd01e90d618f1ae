/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_body.c - G6.3: a rigid body along two NURBS with one parameter
 *
 * One curve leads the tip of the body.  The other leads its rotation, a
 * quaternion that is brought to length 1 at every point (interp/pose.h).  They
 * have the same knots and weights.  Both are walked by their length, where
 * degrees count as mm, so that sharp bends and turns are not stepped over.
 */
#include "code/nurbs_words.h"
#include "code/tip_turn.h"
#include "curve/span.h"
#include "interp/angle.h"
#include "interp/nurbs_length.h"
#include "interp/pose.h"
#include "kinematics/vector.h"
#include "path/build_curve.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROW		(INTERP_NAXES + 1)
#define ORDER		4
#define START_PULSES	2.0
#define START_DEG	0.01

/* Columns of a control point: X Y Z, then w x y z. */
#define TURN		3
#define COLUMNS		7

#define XYZ		(NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z))
#define QUATERNION	(NC_BIT(NC_Q) | NC_CENTRE)

/* -- Control points ------------------------------------------------------- */

static int body_open(struct nc_reader *r)
{
	const uint32_t order = nc_has(r, NC_L) ?
			       (uint32_t)r->block.value[NC_L] : ORDER;
	double *last = r->curve.last_mm;

	if (order < 2 || order > INTERP_NURBS_ORDER_MAX)
		return nc_refuse(r, r->block.at[NC_L], "an order of 2 to 10, "
				 "the degree + 1", "a curve of order %u",
				 order);
	nc_curve_open(r, NC_BODY, order);
	nc_pose_turned(&r->tool.k, r->contour.here_mm, last + TURN);
	last[COLUMNS] = 0;
	return 0;
}

static int body_point(struct nc_reader *r)
{
	static const enum nc_slot part[] = { NC_Q, NC_I, NC_J, NC_K };
	const double weight = nc_has(r, NC_R) ? r->block.value[NC_R] : 1;
	double at[INTERP_NAXES], target[INTERP_NAXES];

	if (!(weight >= NC_WEIGHT_MIN))
		return nc_curve_refuse_weight(r, NC_R);
	nc_curve_target(r, target);
	memcpy(at, r->curve.last_mm, sizeof(at));
	memcpy(at, target, 3 * sizeof(*at));
	for (int i = 0; i < 4 && r->block.words & QUATERNION; i++)
		at[TURN + i] = nc_has(r, part[i]) ?
			       r->block.value[part[i]] : 0;
	return nc_curve_point(r, at, weight);
}

/* -- The walk ------------------------------------------------------------- */

/* Both curves, and both as one curve, for its length. */
struct pair {
	double *move, *turn, *both;	/* rows with weights */
	struct interp_pose_path path;
	struct interp_nurbs_eval e;	/* of both */
	const struct interp_kinematics *k;
};

static struct interp_nurbs nurbs_of(const struct nc_curve *c, uint32_t naxes,
				    const double *points)
{
	return (struct interp_nurbs) {
		.degree = c->order - 1, .naxes = naxes, .npoints = c->npoints,
		.counted = naxes, .knots = c->knots, .points = points,
	};
}

/* The largest rotation of a control point; lengths are compared with it. */
static double largest(const struct nc_curve *c)
{
	double most = 0;

	for (uint32_t i = 0; i < c->npoints; i++) {
		const double *row = c->points + (size_t)i * ROW;

		for (int j = TURN; j < COLUMNS; j++)
			most = fmax(most, fabs(row[j] / row[INTERP_NAXES]));
	}
	return most;
}

static bool pair_make(struct pair *p, const struct nc_curve *c)
{
	const double scale = 2 * ANGLE_RADIAN / largest(c);

	p->move = malloc((size_t)c->npoints * 4 * sizeof(double));
	p->turn = malloc((size_t)c->npoints * 5 * sizeof(double));
	p->both = malloc((size_t)c->npoints * (COLUMNS + 1) * sizeof(double));
	if (!p->move || !p->turn || !p->both)
		return false;
	for (size_t i = 0; i < c->npoints; i++) {
		const double *row = c->points + i * ROW;
		double *both = p->both + i * (COLUMNS + 1);

		memcpy(p->move + i * 4, row, 3 * sizeof(double));
		p->move[i * 4 + 3] = row[INTERP_NAXES];
		memcpy(p->turn + i * 5, row + TURN, 4 * sizeof(double));
		p->turn[i * 5 + 4] = row[INTERP_NAXES];
		memcpy(both, row, COLUMNS * sizeof(double));
		for (int j = TURN; j < COLUMNS; j++)
			both[j] *= scale;
		both[COLUMNS] = row[INTERP_NAXES];
	}
	return true;
}

static void pair_free(struct pair *p)
{
	free(p->move);
	free(p->turn);
	free(p->both);
}

struct body_span {
	const struct nc_reader *r;
	struct pair *pair;
	struct interp_nurbs_stop *stops;
	size_t nstops;
};

/* The pose at the parameter @u.  A rotation of length 0 has no direction. */
static void pose_at(struct pair *p, double u, struct nc_pose *ret)
{
	struct interp_pose pose;

	memset(ret->dir, 0, sizeof(ret->dir));
	if (interp_pose_at(&p->path, u, &pose))
		return;
	memcpy(ret->mm, pose.at_mm, sizeof(pose.at_mm));
	memcpy(ret->q, pose.q, sizeof(pose.q));
	memcpy(ret->dir, p->k->tool_dir, sizeof(ret->dir));
	nc_pose_turn(ret->q, ret->dir);
}

static void span_at(const void *of, double t, struct nc_pose *ret)
{
	const struct body_span *s = of;
	const struct interp_nurbs_stop *last = s->stops + s->nstops - 1;
	const double s_mm = last->s_mm * t;
	struct interp_nurbs_between b;
	double u = last->u;

	memcpy(ret->mm, s->r->tool.here_mm, sizeof(ret->mm));
	if (t < 1) {
		interp_nurbs_between(s->stops +
			interp_nurbs_stop_of(s->stops, s->nstops, s_mm), &b);
		u = interp_nurbs_between_at(&b, s_mm);
	}
	pose_at(s->pair, u, ret);
}

static int go_span(struct nc_reader *r, struct pair *p)
{
	struct interp_nurbs_eval *e = &p->e;
	const struct interp_nurbs_range range = { e->from, e->to,
						  r->o->tip_tolerance_mm };
	struct body_span s = { .r = r, .pair = p };
	const struct nc_pose_way w = { .at = span_at, .of = &s, .body = true };
	int err = 0;

	s.nstops = interp_nurbs_stops(e, &range, NULL, 0);
	s.stops = malloc(s.nstops * sizeof(*s.stops));
	if (!s.stops)
		return -ENOMEM;
	interp_nurbs_stops(e, &range, s.stops, s.nstops);
	/* Where both curves stand still, there is no length to walk by. */
	if (s.stops[s.nstops - 1].s_mm > 0)
		err = nc_pose_way(r, &w);
	free(s.stops);
	return err;
}

/* -- Checks --------------------------------------------------------------- */

/* The angle between two poses of the body.  Without a rotary axis that rolls
 * the tool, it is the angle between their directions. */
static double apart_deg(const struct interp_kinematics *k, const double a[4],
			const double b[4])
{
	double da[3], db[3], x[3], dot = 0;

	if (nc_pose_roll(k) >= 0) {
		for (int i = 0; i < 4; i++)
			dot += a[i] * b[i];
		return 2 * acos(fmin(1, fabs(dot))) * ANGLE_RADIAN;
	}
	memcpy(da, k->tool_dir, sizeof(da));
	memcpy(db, k->tool_dir, sizeof(db));
	nc_pose_turn(a, da);
	nc_pose_turn(b, db);
	vec_cross(da, db, x);
	return atan2(vec_length(x), vec_dot(da, db)) * ANGLE_RADIAN;
}

static int check_start(struct nc_reader *r, struct pair *p)
{
	struct nc_pose at = { .mm = { 0 } };
	double here[4], off = 0;

	pose_at(p, interp_nurbs_first(&p->e.c), &at);
	nc_pose_turned(p->k, r->contour.here_mm, here);
	for (int i = 0; i < 3; i++)
		off = fmax(off, fabs(at.mm[i] - r->tool.here_mm[i]) /
				r->o->machine->axis[i].pulse_mm);
	if (off <= START_PULSES && apart_deg(p->k, at.q, here) <= START_DEG)
		return 0;
	return nc_refuse_at(r, r->curve.line, "a first control point where "
		"the body is, its knot as often as the order", "a body that "
		"begins elsewhere than where it is: X%.4f Y%.4f Z%.4f "
		"Q%.6f I%.6f J%.6f K%.6f", r->tool.here_mm[0],
		r->tool.here_mm[1], r->tool.here_mm[2], here[0], here[1],
		here[2], here[3]);
}

static int check_end(struct nc_reader *r, struct pair *p)
{
	struct nc_pose at = { .mm = { 0 } };
	double here[INTERP_NAXES];

	pose_at(p, interp_nurbs_last(&p->e.c), &at);
	memcpy(here, r->curve.last_mm, sizeof(here));
	memcpy(here, at.mm, 3 * sizeof(*here));
	return nc_curve_check_end(r, here);
}

static int check(struct nc_reader *r, struct curve_plan *plan, struct pair *p)
{
	const struct nc_curve *c = &r->curve;
	const struct interp_nurbs both = nurbs_of(c, COLUMNS, p->both);
	const struct interp_nurbs move = nurbs_of(c, 3, p->move);
	const struct interp_nurbs turn = nurbs_of(c, 4, p->turn);
	int err = build_curve_check(plan);

	if (err) {
		if (!r->diag->line)
			r->diag->line = r->line;
		return err;
	}
	interp_nurbs_open(&p->e, &both);
	interp_pose_open(&p->path, &move, &turn);
	err = check_start(r, p);
	return err ? err : check_end(r, p);
}

static int walk(struct nc_reader *r, struct curve_plan *plan, struct pair *p)
{
	const struct interp_nurbs *c = &p->e.c;
	int err;

	nurbs_span_enter(&p->e, interp_nurbs_span(c, interp_nurbs_first(c)));
	do {
		r->word.line = build_curve_line(plan, p->e.from);
		err = go_span(r, p);
	} while (!err && nurbs_span_next(&p->e));
	return err;
}

static int body_build(struct nc_reader *r)
{
	struct nc_curve *c = &r->curve;
	struct interp_build_curve bc = {
		.nurbs = nurbs_of(c, INTERP_NAXES, c->points),
		.marks = c->marks, .nmarks = c->npoints,
	};
	struct curve_plan plan = { .c = &bc, .diag = r->diag };
	struct pair p = { .k = &r->tool.k };
	int err = nc_word(r, false, false);

	c->open = 0;
	nc_curve_set_marks(c);
	if (!err)
		err = pair_make(&p, c) ? check(r, &plan, &p) : -ENOMEM;
	if (!err)
		err = walk(r, &plan, &p);
	if (!err)
		nc_tool_looks(r);
	pair_free(&p);
	return err;
}

int nc_body(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint32_t point = XYZ | QUATERNION | NC_BIT(NC_R);
	struct nc_curve *c = &r->curve;
	const bool first = !c->open;
	int err = 0;

	if (!(b->words & (point | NC_BIT(NC_P) | NC_BIT(NC_L))))
		return 0;
	if (!r->tool.on)
		return nc_refuse(r, b->code_at[NC_MOTION], "G43.4 or G43.5 "
				 "before it", "G6.3 where X Y Z are axes");
	if (!nc_has(r, NC_P))
		return nc_refuse(r, b->code_at[NC_MOTION],
				 "P and a knot in each block of G6.3",
				 "a block of G6.3 without a knot");
	if (first)
		err = body_open(r);
	else if (nc_has(r, NC_L))
		err = nc_refuse(r, b->at[NC_L], "L in the first block of G6.3",
			       "a second order of one curve");
	if (!err)
		err = nc_curve_next_knot(r, NC_P);
	if (!err && (first || b->words & point))
		err = nc_curve_in_turn(r, NC_P);
	if (!err && (first || b->words & point))
		err = body_point(r);
	if (err || c->nknots != c->npoints + c->order)
		return err;
	err = nc_curve_check_points(r, b->at[NC_P]);
	return err ? err : body_build(r);
}
