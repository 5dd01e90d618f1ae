/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.h - go to another place on the path, within limits of speed and jerk
 *
 * The motion is an S-curve along the path, in either direction: speed and
 * acceleration make no step.  Jumps, retracts by command and positioning use
 * it.  It plans when something has changed, and otherwise follows its plan.  A
 * new place, a new limit or a hold starts from the present speed and
 * acceleration.
 *
 * Units: mm along the path, + toward the program's end.
 * Threads: RT-safe.
 */
#ifndef RT_MOVER_H
#define RT_MOVER_H

#include "interp/scurve.h"

#include <stdbool.h>

enum mover_plan {
	MOVER_NO_PLAN,
	MOVER_TO_PLACE,
	MOVER_TO_SPEED,
};

/*
 * A place that is nearer than this has been reached.  Places are sums of
 * doubles: along a path of 1 km they round by 2e-10 mm.  A pulse is a million
 * times longer.
 */
#define MOVER_ONTO_MM	1e-9

struct mover_limits {
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	double period_s;
	double a_back_mm_s2;		/* acceleration toward -; 0: a_max */
};

struct mover {
	double v_mm_s, a_mm_s2;		/* signed, at the end of the cycle */
	double mean_mm_s;		/* of that cycle */
	enum mover_plan kind;
	double goal;			/* mm left when planned, or mm/s */
	double pass_mm_s;		/* speed at the place; 0: stand there */
	double left_mm;			/* to the place, this cycle */
	double t_s, gone_mm;		/* of the plan */
	struct mover_limits l;		/* it was planned with */
	struct interp_scurve plan;
};

static inline bool mover_is_standing(const struct mover *m)
{
	return m->v_mm_s == 0 && m->a_mm_s2 == 0;
}

/** mover_set() - set the speed without a ramp; the plan is dropped. */
void mover_set(struct mover *m, double v_mm_s);

/**
 * mover_step() - the distance to walk this cycle to come nearer to a place
 * @left_mm away (signed).
 *
 * The place is met exactly and never passed, unless the speed is too high to
 * brake before it: then it is passed, and come back to.  The speed is 0 from
 * the cycle that met it.
 */
double mover_step(struct mover *m, const struct mover_limits *l,
		  double left_mm);

/** mover_run() - the distance this cycle to come to a speed and keep it. */
double mover_run(struct mover *m, const struct mover_limits *l, double v_mm_s);

/** mover_stop() - the distance this cycle while braking to a stand. */
double mover_stop(struct mover *m, const struct mover_limits *l);

/*
 * The same in three steps, for a caller that looks ahead: aim; look with
 * mover_peek() where the next cycle would lead; aim at something else if that
 * is not good; go.
 */

/** mover_aim_speed() - plan to reach a speed. */
void mover_aim_speed(struct mover *m, const struct mover_limits *l,
		     double v_mm_s);

/**
 * mover_aim_place() - plan to pass a place @left_mm away (signed) at
 * @pass_mm_s, or to stop there (0).
 *
 * A place can be passed only if it is far enough: interp_scurve_to_pass() says
 * which.
 */
void mover_aim_place(struct mover *m, const struct mover_limits *l,
		     double left_mm, double pass_mm_s);

/** mover_most_mm_s() - no less than the greatest speed that is left of the
 *  plan. */
double mover_most_mm_s(const struct mover *m);

/**
 * mover_peek() - the state after the next cycle; its place counts from here.
 */
struct interp_scurve_state mover_peek(const struct mover *m, double period_s);

/** mover_go() - go that cycle. Return: the distance. */
double mover_go(struct mover *m, double period_s);

/** mover_curve() - the same limits, in the form that interp/scurve.h takes. */
struct interp_scurve_limits mover_curve(const struct mover_limits *l);

#endif /* RT_MOVER_H */
