/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contouring.c - [contour] for the cycle, and values that the cycle cannot have
 */
#include "config.h"
#include "cycle.h"
#include "keys.h"

#include <errno.h>
#include <math.h>

/* From a measured place to the target that depends on it, in periods. */
#define CAN402_PERIODS	2

/* Refuse at the line of `method`, with the words of interp_diag_say(). */
static int refuse(const struct machine_config *c, struct interp_diag *diag)
{
	diag->line = c->contour.line;
	diag->column = 0;
	return -EINVAL;
}

static double period_s(const struct machine_config *c)
{
	return (double)config_period_ns(c) * 1e-9;
}

static int check_methods(const struct machine_config *c, int methods,
			 struct interp_diag *diag)
{
	const int had = INTERP_COMPENSATE_FEEDFORWARD | INTERP_COMPENSATE_CROSS;

	if ((methods & ~had) == 0)
		return 0;
	interp_diag_say(diag, "contour.method %.40s asks for more than the "
			      "cycle knows of what comes; none, feedforward, "
			      "cross-coupled or feedforward+cross-coupled; "
			      "predictive and zpetc are for edmsim "
			      "--tune-contour and --dry-run",
			      c->contour.method);
	return refuse(c, diag);
}

/* The axes of the backend must lag, and must accept targets. */
static int check_backend(const struct machine_config *c,
			 struct interp_diag *diag)
{
	if (config_machine_is(c, MACHINE_DRIVES) ||
	    (config_machine_is(c, MACHINE_MODEL) &&
	     (c->sim.loops || c->sim.lag_s > 0)))
		return 0;
	interp_diag_say(diag, "contour.method %.40s on axes that do not lag; "
			      "none; or backend = can402, or sim with [sim] "
			      "loops = yes", c->contour.method);
	return refuse(c, diag);
}

static double lead_periods(const struct machine_config *c, int axis)
{
	return c->contour.lead_periods + c->loop[axis].delay_s / period_s(c);
}

static int check_lead(const struct machine_config *c, int axis,
		      struct interp_diag *diag)
{
	const double lead = lead_periods(c, axis);

	if (floor(lead) <= CONTOURING_LEAD_MAX)
		return 0;
	interp_diag_say(diag, "contour.lead_periods and axis.%c.loop_delay_s "
			      "are %.3g periods together; below 7 periods; or "
			      "contour.method = none",
			      INTERP_AXIS_LETTERS[axis], lead);
	return refuse(c, diag);
}

/* Half of the gain at which the loop would swing is kept as its margin. */
static int check_margin(const struct machine_config *c, int axis,
			struct interp_diag *diag)
{
	const double gain = c->loop[axis].gain_1_s + c->contour.cross_1_s;
	struct interp_axis_loop l = c->loop[axis];
	struct interp_axis_model m;
	double most;

	if (config_machine_is(c, MACHINE_DRIVES))
		l.delay_s += CAN402_PERIODS * period_s(c);
	if (interp_axis_model_init(&m, &l, period_s(c), 0) < 0) {
		interp_diag_say(diag, "axis.%c.loop_* are no loop; what "
				      "edmctl identify prints",
				      INTERP_AXIS_LETTERS[axis]);
		return refuse(c, diag);
	}
	most = interp_axis_model_gain_max_1_s(&m) / 2;
	if (gain <= most)
		return 0;
	/* Round down, so that the value in the message is accepted. */
	interp_diag_say(diag, "contour.cross_1_s %g and axis.%c.loop_gain_1_s "
			"%g leave less than 6 dB before they swing; at most "
			"%.4g 1/s together: cross_1_s %.4g and less",
			c->contour.cross_1_s, INTERP_AXIS_LETTERS[axis],
			c->loop[axis].gain_1_s, floor(most * 10) / 10,
			floor(fmax(most - c->loop[axis].gain_1_s, 0) * 10) /
			10);
	return refuse(c, diag);
}

static int check_axis(const struct machine_config *c, int methods, int axis,
		      struct interp_diag *diag)
{
	if (c->loop[axis].gain_1_s > 0)
		return check_lead(c, axis, diag) ||
		       (methods & INTERP_COMPENSATE_CROSS &&
			check_margin(c, axis, diag)) ? -EINVAL : 0;
	interp_diag_say(diag, "contour.method %.40s, and axis.%c has no "
			"loop_gain_1_s; the loop of each axis that is "
			"present, by edmctl identify; or method = none",
			c->contour.method, INTERP_AXIS_LETTERS[axis]);
	return refuse(c, diag);
}

int config_check_contouring(const struct machine_config *c,
			    struct interp_diag *diag)
{
	const int methods = interp_compensate_parse(c->contour.method);

	if (methods <= 0)
		return 0;
	if (check_methods(c, methods, diag) || check_backend(c, diag))
		return -EINVAL;
	for (int i = 0; i < INTERP_NAXES; i++)
		if (c->axes.present >> i & 1 &&
		    check_axis(c, methods, i, diag))
			return -EINVAL;
	return 0;
}

struct interp_axis_loop config_loop_true(const struct machine_config *c,
					 int axis, bool odd)
{
	const double off = odd ? -c->contour.model_error :
				 c->contour.model_error;
	struct interp_axis_loop l = c->loop[axis];

	l.gain_1_s *= 1 + off;
	l.velocity_hz *= 1 + off;
	l.delay_s *= 1 - off;
	return l;
}

void config_gains(const struct machine_config *c,
		  struct interp_compensate_gains *ret)
{
	const struct config_contour *k = &c->contour;

	*ret = (struct interp_compensate_gains) {
		.velocity = k->speed, .acceleration = k->acceleration,
		.lead_periods = k->lead_periods, .cross_1_s = k->cross_1_s,
		.predicted_1_s = k->predicted_1_s,
		.measured_1_s = k->measured_1_s, .horizon_s = k->horizon_s,
	};
}

void config_contouring(const struct machine_config *c,
		       struct contouring_config *ret)
{
	struct interp_diag diag;

	*ret = (struct contouring_config) { .axes = c->axes.present };
	if (config_check_contouring(c, &diag) < 0)
		return;
	ret->methods = (uint32_t)interp_compensate_parse(c->contour.method);
	config_gains(c, &ret->gains);
	for (uint32_t m = ret->axes; m; m &= m - 1) {
		const int i = __builtin_ctz(m);
		const struct interp_axis_limits *l = &c->axes.axis[i];
		const int ahead = (int)floor(lead_periods(c, i)) + 2;

		ret->ahead = ahead > ret->ahead ? ahead : ret->ahead;
		ret->loop[i] = c->loop[i];
		ret->most_mm[i] = l->v_max_mm_s /
				  fmax(c->loop[i].gain_1_s, 1e-3);
	}
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->pulse_mm[i] = c->axes.axis[i].pulse_mm;
}
