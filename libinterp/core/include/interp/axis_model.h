/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis_model.h - one axis and its drive as a state space
 *
 * A proportional position loop around a velocity loop of second order:
 *
 *	p' = v + kick
 *	v' = a
 *	a' = w^2 (u(t - delay) - v) - 2 damping w a,	w = 2 pi velocity_hz
 *	u  = gain (target - actual) + feedforward target' + correction
 *
 * It is stepped in periods of T, during which u is held, and discretised
 * exactly.  The kick stands for friction: when the axis turns back it lags by
 * kick_mm_s, which decays with the time constant kick_s.  Backlash is motion
 * that is lost between p and the actual place.
 *
 * The literature on contour errors uses the same state-space model (x' = A x +
 * B u, y = C x).  Here its structure is given, so that only a few numbers must
 * be identified (interp/identify.h).
 *
 * Units: mm, s; rotary axes degrees.  Sign: + as the axis.
 * Threads: one object, one thread; all but _init() RT-safe.
 */
#ifndef INTERP_AXIS_MODEL_H
#define INTERP_AXIS_MODEL_H

/* Longest delay, in periods. */
#define INTERP_AXIS_DELAY_MAX	15
#define INTERP_AXIS_NSTATES	3	/* place, speed, acceleration */

/* What is known of an axis and its drive. */
struct interp_axis_loop {
	double gain_1_s;		/* position loop, > 0 */
	double velocity_hz;		/* velocity loop, > 0 */
	double damping;			/* of it, > 0 */
	double delay_s;			/* before it, 0 and more */
	double feedforward;		/* of speed, by the drive itself; 0 ...
					 * 1 */
	double kick_mm_s;		/* friction at a reversal; 0: none */
	double kick_s;			/* it decays with this time constant */
	double backlash_mm;		/* 0: none */
};

/* Placed by the caller; fields are private. */
struct interp_axis_model {
	struct interp_axis_loop loop;
	double period_s;
	double phi[INTERP_AXIS_NSTATES][INTERP_AXIS_NSTATES];
	double gamma_new[INTERP_AXIS_NSTATES];	/* of the last u in force */
	double gamma_old[INTERP_AXIS_NSTATES];	/* of the one before it */
	int whole;			/* whole periods of delay */
	double kick_keeps, kick_way_s;	/* over one period */
	double x[INTERP_AXIS_NSTATES];
	double past[INTERP_AXIS_DELAY_MAX + 2];	/* u, the newest first */
	double kick_mm_s;
	int direction;			/* of the last motion; 0: none yet */
	double actual_mm;		/* behind the backlash */
};

/**
 * interp_axis_model_init() - at rest at @place_mm.
 * Return: 0; -EINVAL if a number is out of its range, -ERANGE if the delay is
 * longer than INTERP_AXIS_DELAY_MAX periods.  Startup only.
 */
int interp_axis_model_init(struct interp_axis_model *m,
			   const struct interp_axis_loop *loop,
			   double period_s, double place_mm);

/** interp_axis_model_stand() - put it at rest at @place_mm; no earlier demand
 *  is still to come. */
void interp_axis_model_stand(struct interp_axis_model *m, double place_mm);

/** interp_axis_model_step() - one period with the speed @u_mm_s demanded. */
void interp_axis_model_step(struct interp_axis_model *m, double u_mm_s);

/**
 * interp_axis_model_step_beside() - the same, but it turns back when @leader
 * has turned back.
 *
 * This is for finding out how much a changed number changes the result.  If one
 * model turned back a period sooner than the other, its kick would make a step
 * in the difference.  @leader must have been stepped first; it may be @m
 * itself.
 */
void interp_axis_model_step_beside(struct interp_axis_model *m, double u_mm_s,
				   const struct interp_axis_model *leader);

/**
 * interp_axis_model_follow() - one period of the closed loop.
 *
 * @target_mm: the set value; @before_mm: the one of the period before, for the
 * drive's own feedforward.
 * Return: the speed it demanded.
 */
double interp_axis_model_follow(struct interp_axis_model *m, double target_mm,
				double before_mm);

/** interp_axis_model_shift() - something else moved the axis by @by_mm. */
static inline void interp_axis_model_shift(struct interp_axis_model *m,
					   double by_mm)
{
	m->x[0] += by_mm;
	m->actual_mm += by_mm;
}

/** interp_axis_model_actual_mm() - where the axis is. */
static inline double
interp_axis_model_actual_mm(const struct interp_axis_model *m)
{
	return m->actual_mm;
}

/**
 * The model without its delay, kick and backlash as a quotient in z:
 * (b[0] z^2 + b[1] z + b[2]) / (z^3 + a[0] z^2 + a[1] z + a[2]), from u to
 * place.
 */
struct interp_axis_quotient {
	double b[INTERP_AXIS_NSTATES], a[INTERP_AXIS_NSTATES];
};

/** interp_axis_model_quotient() - Startup only. */
void interp_axis_model_quotient(const struct interp_axis_model *m,
				struct interp_axis_quotient *ret);

/**
 * interp_axis_model_gain_max_1_s() - the position gain at which the loop
 * begins to swing of itself, delay and sampling counted.  Startup only.
 */
double interp_axis_model_gain_max_1_s(const struct interp_axis_model *m);

#endif /* INTERP_AXIS_MODEL_H */
