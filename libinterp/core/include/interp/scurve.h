/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scurve.h - jerk-limited motion along one coordinate, in the least time
 *
 * A plan is a row of phases of constant jerk.  It leads from any speed and
 * acceleration to a given speed, or to a stand at a given place.  It stays
 * within v_max, a_up, a_down and j_max.  A motion that begins outside one of
 * these limits comes back inside first, with full jerk.  A motion that is too
 * fast to stop before its place goes past it and comes back.
 *
 * Units: in every name; time in seconds from the beginning of the plan, places
 * from where the plan begins.
 * Threads: no call allocates, blocks or touches a global; all are RT-safe.
 */
#ifndef INTERP_SCURVE_H
#define INTERP_SCURVE_H

/* All > 0. */
struct interp_scurve_limits {
	double v_max_mm_s;
	double a_up_mm_s2;		/* largest toward + */
	double a_down_mm_s2;		/* largest toward - */
	double j_max_mm_s3;
};

struct interp_scurve_state {
	double x_mm, v_mm_s, a_mm_s2;
};

/* To within the limits, up, hold, down; cruise; the same to a stand. */
#define INTERP_SCURVE_RAMP	4
#define INTERP_SCURVE_PHASES	(2 * INTERP_SCURVE_RAMP + 1)

struct interp_scurve {
	int n;
	double t_s[INTERP_SCURVE_PHASES];	/* when each begins */
	double j_mm_s3[INTERP_SCURVE_PHASES];
	struct interp_scurve_state from[INTERP_SCURVE_PHASES];
	double end_s;
	struct interp_scurve_state end;
};

/** interp_scurve_to_speed() - plan from a speed and acceleration to a speed. */
void interp_scurve_to_speed(struct interp_scurve *c,
			    const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double to_mm_s);

/** interp_scurve_to_place() - plan to stand at @way_mm (signed) from here. */
void interp_scurve_to_place(struct interp_scurve *c,
			    const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double way_mm);

/**
 * interp_scurve_to_pass() - plan to pass the place that is @way_mm (signed)
 * from here at the speed @pass_mm_s, without acceleration.
 *
 * @from: its speed and acceleration are read, its place is not.  Unless the
 * speed is 0, @way_mm must be at least interp_scurve_way_mm() to that speed.
 */
void interp_scurve_to_pass(struct interp_scurve *c,
			   const struct interp_scurve_limits *l,
			   const struct interp_scurve_state *from,
			   double way_mm, double pass_mm_s);

/** interp_scurve_way_mm() - the distance until a speed is reached; a speed of 0
 *  is a stand. */
double interp_scurve_way_mm(const struct interp_scurve_limits *l,
			    double v_mm_s, double a_mm_s2, double to_mm_s);

/**
 * interp_scurve_falls_mm() - for a plan that ends slower than @v_mm_s: the
 * place where its speed falls to @v_mm_s for the last time; 0 if it is never so
 * fast.
 */
double interp_scurve_falls_mm(const struct interp_scurve *c, double v_mm_s);

/**
 * interp_scurve_at() - the state at the time @t_s; after the end of the plan it
 * goes on at the last speed.
 */
struct interp_scurve_state interp_scurve_at(const struct interp_scurve *c,
					    double t_s);

#endif /* INTERP_SCURVE_H */
