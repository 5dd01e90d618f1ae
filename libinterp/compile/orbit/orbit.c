/* SPDX-License-Identifier: Apache-2.0 */
/*
 * orbit.c - planetary cycles of a sinker, as a path
 *
 * A round shape is a profile: radius and depth as functions of the way u along
 * the profile.  During one turn, u increases by one step.
 */
#include "interp/angle.h"
#include "interp/orbit.h"

#include <math.h>
#include <string.h>

#define CHORD_PULSES	0.4		/* distance of a polyline from its
					 * curve */
#define NEAR_MM		1e-9

struct walk {
	const struct interp_orbit *o;
	const struct interp_machine *m;
	const struct interp_orbit_to *to;
	double depth_mm, side;		/* depth is 0 or more; side + 1: it
					 * sinks toward + */
	double length_mm;		/* length of the profile */
	double step_mm;			/* along the profile, in each turn */
	uint32_t steps;
	double r_mm, h_mm;		/* where it is now */
};

/* -- The profile ---------------------------------------------------------- */

static double height_of(const struct interp_orbit *o)
{
	return fabs(o->end_mm - o->start_mm[o->sink]);
}

static double cone_radius(const struct interp_orbit *o, double h_mm)
{
	const double depth = height_of(o);
	const double slope = tan(o->angle_deg * ANGLE_TURN / 360);
	const double r = o->angle_given ?
			 o->radius_mm + h_mm * slope :
			 o->radius_mm * (depth - h_mm) / depth;

	return r >= 0 ? r : NAN;
}

double interp_orbit_radius_mm(const struct interp_orbit *o, double h_mm)
{
	const double b = o->bottom_mm;

	if (o->shape == INTERP_ORBIT_CONE)
		return cone_radius(o, h_mm);
	if (o->shape == INTERP_ORBIT_SPHERE && h_mm < b)
		return o->radius_mm - b + sqrt(h_mm * (2 * b - h_mm));
	return o->radius_mm;
}

/* The way down the wall of a sphere, and then along its quarter. */
static double sphere_length(const struct walk *w)
{
	const double b = w->o->bottom_mm, h = w->depth_mm;

	return h > b ? h - b + b * ANGLE_TURN / 4 : b * acos(1 - h / b);
}

static void sphere_at(struct walk *w, double u_mm)
{
	const double b = w->o->bottom_mm, left = w->length_mm - u_mm;

	w->h_mm = left > b * ANGLE_TURN / 4 ? left - b * ANGLE_TURN / 4 + b :
		  b * (1 - cos(left / b));
	w->r_mm = left > b * ANGLE_TURN / 4 ? w->o->radius_mm :
		  w->o->radius_mm - b + b * sin(left / b);
}

static void profile_at(struct walk *w, double u_mm)
{
	const bool end = u_mm >= w->length_mm - NEAR_MM;

	switch (w->o->shape) {
	case INTERP_ORBIT_EXPAND:
		w->h_mm = 0;
		w->r_mm = end ? w->o->radius_mm : u_mm;
		break;
	case INTERP_ORBIT_SPHERE:
		sphere_at(w, end ? w->length_mm : u_mm);
		break;
	default:
		w->h_mm = end ? 0 : w->depth_mm - u_mm;
		w->r_mm = interp_orbit_radius_mm(w->o, w->h_mm);
	}
}

static void plan_steps(struct walk *w)
{
	const struct interp_orbit *o = w->o;

	w->length_mm = o->shape == INTERP_ORBIT_EXPAND ? o->radius_mm :
		       o->shape == INTERP_ORBIT_SPHERE ? sphere_length(w) :
		       w->depth_mm;
	w->steps = 0;
	if (!(o->step_mm > 0) || w->length_mm < NEAR_MM)
		return;
	w->steps = (uint32_t)ceil(w->length_mm / o->step_mm - 1e-6);
	w->step_mm = w->length_mm / w->steps;
}

/* -- Places --------------------------------------------------------------- */

/* @x and @y from the centre, at height w->h_mm. */
static void place(const struct walk *w, double x_mm, double y_mm,
		  double ret_mm[INTERP_NAXES])
{
	const struct interp_orbit *o = w->o;
	const double c_deg = o->start_mm[INTERP_C];

	memcpy(ret_mm, o->start_mm, sizeof(o->start_mm));
	ret_mm[o->a] += x_mm;
	ret_mm[o->b] += y_mm;
	if (w->h_mm == w->depth_mm)
		return;
	ret_mm[o->sink] = o->end_mm - w->side * w->h_mm;
	ret_mm[INTERP_C] = w->h_mm == 0 ? o->c_end_deg :
			   c_deg + (o->c_end_deg - c_deg) *
			   (1 - w->h_mm / w->depth_mm);
}

static int line_to(const struct walk *w, double x_mm, double y_mm, bool rapid)
{
	double end_mm[INTERP_NAXES];

	place(w, x_mm, y_mm, end_mm);
	return w->to->line(w->to->arg, end_mm, rapid);
}

static double pulse_mm(const struct walk *w)
{
	return fmin(w->m->axis[w->o->a].pulse_mm, w->m->axis[w->o->b].pulse_mm);
}

/* -- Ways out ------------------------------------------------------------- */

/* C turns back while it rises. */
static void lead_out(const struct walk *w, struct interp_escape *e)
{
	const struct interp_orbit *o = w->o;
	const struct interp_axis_limits *c = &w->m->axis[INTERP_C];
	const double by_deg = fabs(o->c_end_deg - o->start_mm[INTERP_C]);

	e->out = 1u << o->sink;
	e->out_mm[o->sink] = o->top_mm;
	if (by_deg == 0)
		return;
	e->out |= 1u << INTERP_C;
	e->out_mm[INTERP_C] = o->start_mm[INTERP_C];
	e->out_mm[o->sink] = o->start_mm[o->sink];
	e->v_max_mm_s = c->v_max_mm_s * w->depth_mm / by_deg;
	e->a_max_mm_s2 = c->a_max_mm_s2 * w->depth_mm / by_deg;
	e->j_max_mm_s3 = c->j_max_mm_s3 * w->depth_mm / by_deg;
}

static int no_escape(const struct walk *w)
{
	return w->to->escape(w->to->arg, NULL);
}

/* In the centre: straight up, the way it came. */
static int escape_up(const struct walk *w)
{
	struct interp_escape e = { .out = 0 };

	if (w->o->escape == INTERP_ESCAPE_PATH)
		return 0;
	lead_out(w, &e);
	return w->to->escape(w->to->arg, &e);
}

/* Up by @rise_mm, then the axes @home to the centre, then out. */
static int escape_home(const struct walk *w, uint32_t home, double rise_mm)
{
	const struct interp_orbit *o = w->o;
	struct interp_escape e = { .home = home, .rise_mm = rise_mm };

	if (o->escape != INTERP_ESCAPE_CENTRE &&
	    o->escape != INTERP_ESCAPE_NORMAL)
		return no_escape(w);
	for (int i = 0; i < INTERP_NAXES; i++)
		e.home_mm[i] = home & 1u << i ? o->start_mm[i] : 0;
	lead_out(w, &e);
	return w->to->escape(w->to->arg, &e);
}

static uint32_t both(const struct walk *w)
{
	return 1u << w->o->a | 1u << w->o->b;
}

/* Does the electrode meet too much material in the gate of a turn that is
 * @by_mm smaller? */
static bool gate_ok(const struct walk *w, double by_mm)
{
	return by_mm * by_mm / (8 * w->o->radius_mm) <= pulse_mm(w);
}

struct round {
	double from_mm, to_mm;		/* of the profile */
	uint32_t home;			/* axes that its way out moves; 0:
					 * none */
	double rise_mm;
	bool level;			/* the radius is the same everywhere */
};

/*
 * Does the previous turn lie around this one, at the same depth or one step
 * above it?  A cone that grows with the depth has smaller turns above it.
 */
static void way_out(const struct walk *w, uint32_t nth, double r0, double r1,
		    struct round *q)
{
	const bool expand = w->o->shape == INTERP_ORBIT_EXPAND;
	const bool smaller = r1 > r0 + NEAR_MM;

	q->level = r0 == r1;
	q->home = 0;
	if (nth == 0 || (smaller && !expand) ||
	    !gate_ok(w, fmax(fabs(r1 - r0), expand ? w->step_mm : 0)))
		return;
	q->home = both(w);
	q->rise_mm = expand ? 0 : w->step_mm;
}

/* -- Once round ----------------------------------------------------------- */

static int turn_arc(struct walk *w, const struct round *q)
{
	const struct interp_build_arc arc = {
		.axis_a = w->o->a, .axis_b = w->o->b,
		.centre_a_mm = w->o->start_mm[w->o->a],
		.centre_b_mm = w->o->start_mm[w->o->b],
		.sweep = ANGLE_TURN,
	};
	double end_mm[INTERP_NAXES];

	profile_at(w, q->to_mm);
	place(w, w->r_mm, 0, end_mm);
	return w->to->arc(w->to->arg, end_mm, &arc);
}

/* So many lines that they stay within CHORD_PULSES: the sagitta is r dt^2 /
 * 8. */
static uint32_t chords(struct walk *w, const struct round *q)
{
	const double e = CHORD_PULSES * pulse_mm(w);
	double r0, r1, r, n;

	profile_at(w, q->from_mm);
	r0 = w->r_mm;
	profile_at(w, q->to_mm);
	r1 = w->r_mm;
	/* A spiral is more curved than a circle, most of all at its inside. */
	r = fmax(r0, r1) + 2 * fabs(r1 - r0) / ANGLE_TURN;
	n = ceil(ANGLE_TURN / sqrt(8 * e / r));
	return n > 8 ? (uint32_t)n : 8;
}

static int turn_polyline(struct walk *w, const struct round *q)
{
	const uint32_t n = chords(w, q);
	int err = 0;

	for (uint32_t j = 1; j <= n && !err; j++) {
		const double t = (double)j / n;
		const double angle = j == n ? 0 : ANGLE_TURN * t;

		profile_at(w, q->from_mm + t * (q->to_mm - q->from_mm));
		err = line_to(w, w->r_mm * cos(angle), w->r_mm * sin(angle),
			     false);
	}
	return err;
}

/* From the middle of a side; square to the side only one axis moves. */
static int turn_square(struct walk *w, const struct round *q)
{
	static const struct { double t; int x, y, along_b; } corner[] = {
		{ 0.125, 1, 1, 1 }, { 0.375, -1, 1, 0 }, { 0.625, -1, -1, 1 },
		{ 0.875, 1, -1, 0 }, { 1, 1, 0, 1 },
	};
	const bool normal = w->o->escape == INTERP_ESCAPE_NORMAL;
	int err = 0;

	for (int j = 0; j < 5 && !err; j++) {
		if (q->home && normal)
			err = escape_home(w, 1u << (corner[j].along_b ?
						   w->o->a : w->o->b),
					 q->rise_mm);
		profile_at(w, q->from_mm + corner[j].t *
				       (q->to_mm - q->from_mm));
		if (!err)
			err = line_to(w, corner[j].x * w->r_mm,
				     corner[j].y * w->r_mm, false);
	}
	return err;
}

static int turn(struct walk *w, const struct round *q)
{
	const struct interp_orbit *o = w->o;
	int err = q->home ? escape_home(w, q->home, q->rise_mm) : no_escape(w);

	if (err)
		return err;
	if (o->shape == INTERP_ORBIT_SQUARE)
		return turn_square(w, q);
	return q->level ? turn_arc(w, q) : turn_polyline(w, q);
}

/* -- The stages ----------------------------------------------------------- */

static int go_round(struct walk *w)
{
	int err = 0;

	for (uint32_t k = 0; k < w->steps && !err; k++) {
		struct round q = {
			.from_mm = k * w->step_mm,
			.to_mm = k + 1 == w->steps ? w->length_mm :
						     (k + 1) * w->step_mm,
		};
		double r0;

		profile_at(w, q.from_mm);
		r0 = w->r_mm;
		profile_at(w, q.to_mm);
		way_out(w, k, r0, w->r_mm, &q);
		err = turn(w, &q);
	}
	return err;
}

/* The first turn after a helix has the helix's last turn one step above it. */
static int finish(struct walk *w)
{
	double r0;
	int err = 0;

	profile_at(w, fmax(0, w->length_mm - w->step_mm));
	r0 = w->r_mm;
	profile_at(w, w->length_mm);
	if (w->r_mm < pulse_mm(w))
		return 0;
	for (uint32_t k = 0; k < w->o->turns && !err; k++) {
		struct round q = {
			.from_mm = w->length_mm, .to_mm = w->length_mm,
		};

		way_out(w, w->steps, r0, w->r_mm, &q);
		if (k > 0)
			q = (struct round) { w->length_mm, w->length_mm,
					     both(w), 0, true };
		q.level = true;
		err = turn(w, &q);
	}
	return err;
}

/* Straight down in the centre, to @h_mm above the bottom. */
static int sink(struct walk *w, double h_mm)
{
	int err = escape_up(w);

	w->h_mm = h_mm;
	return err ? err : line_to(w, 0, 0, false);
}

static int step_aside(struct walk *w)
{
	const int err = escape_home(w, both(w), 0);

	return err ? err : line_to(w, w->r_mm, 0, false);
}

static int vectors(struct walk *w)
{
	const struct interp_orbit *o = w->o;
	int err = escape_home(w, both(w), 0);

	for (uint32_t i = 0; i < o->directions && !err; i++) {
		const double angle = (o->angle_deg +
				      360.0 * i / o->directions) *
				     ANGLE_TURN / 360;

		err = line_to(w, o->radius_mm * cos(angle),
			     o->radius_mm * sin(angle), false);
		if (!err)
			err = line_to(w, 0, 0, true);
	}
	return err;
}

static int walk_vectors(struct walk *w)
{
	const uint32_t levels = w->steps > 0 ? w->steps : 1;
	int err = 0;

	for (uint32_t k = 1; k <= levels && !err; k++) {
		err = sink(w, k == levels ? 0 : w->depth_mm - k * w->step_mm);
		for (uint32_t n = k == levels ? w->o->turns : 1; n > 0 && !err;
		     n--)
			err = vectors(w);
	}
	return err;
}

static int walk_round(struct walk *w)
{
	const bool first = w->o->shape == INTERP_ORBIT_EXPAND || !w->steps;
	int err = 0;

	if (first)
		err = sink(w, 0);
	if (w->o->shape != INTERP_ORBIT_EXPAND && !err) {
		profile_at(w, first ? w->length_mm : 0);
		err = step_aside(w);
	}
	if (!err)
		err = go_round(w);
	return err ? err : finish(w);
}

/*
 * Go to the centre: rapidly over a flat floor, otherwise cutting.  Then go out
 * by a way that is free.
 */
static int go_home(struct walk *w)
{
	const bool cut = w->o->turns == 0 && w->o->shape != INTERP_ORBIT_VECTOR;
	int err = no_escape(w);

	w->h_mm = 0;
	if (!err)
		err = line_to(w, 0, 0, !cut);
	w->h_mm = w->depth_mm;
	return err ? err : line_to(w, 0, 0, true);
}

int interp_orbit_walk(const struct interp_orbit *o,
		      const struct interp_machine *m,
		      const struct interp_orbit_to *to)
{
	struct walk w = { .o = o, .m = m, .to = to };
	int err;

	w.depth_mm = height_of(o);
	w.side = o->end_mm < o->start_mm[o->sink] ? -1 : 1;
	w.h_mm = w.depth_mm;
	plan_steps(&w);
	err = o->shape == INTERP_ORBIT_VECTOR ? walk_vectors(&w) :
					       walk_round(&w);
	if (!err)
		err = go_home(&w);
	return err ? err : no_escape(&w);
}
