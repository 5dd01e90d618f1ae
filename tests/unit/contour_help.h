/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour_help.h - paths with known feet, and set values along them
 */
#ifndef CONTOUR_HELP_H
#define CONTOUR_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "interp/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PERIOD_S	0.001

/* cmocka's own is for float. */
#define assert_near(a, b, within) \
	do { \
		const double near_a = (a), near_b = (b); \
		if (!(fabs(near_a - near_b) <= (within))) \
			fail_msg("%s is %.12g, not %.12g", #a, near_a, \
				 near_b); \
	} while (0)

/* A circle of 10 mm, u in radians. */
static inline void circle_at(const void *arg, double u,
			     struct interp_contour_point *p)
{
	(void)arg;
	*p = (struct interp_contour_point) {
		{ 10 * cos(u), 10 * sin(u) }, { -10 * sin(u), 10 * cos(u) }
	};
}

static const struct interp_contour_path circle = {
	NULL, circle_at, 0, 6, 2
};

/* Two branches with an acute tip between them, 0.01 mm sharp, at u = 0. */
static inline void tip_at(const void *arg, double u,
			  struct interp_contour_point *p)
{
	const double r = sqrt(u * u + 0.25);

	(void)arg;
	*p = (struct interp_contour_point) {
		{ -r, 0.15 * u }, { -u / r, 0.15 }
	};
}

static const struct interp_contour_path tip = { NULL, tip_at, -10, 10, 2 };

/* Set values along a path, u growing evenly, standing before and after. */
struct set_row {
	double *u, *mm[2];
	size_t n;
};

static inline void set_row_make(struct set_row *s,
				const struct interp_contour_path *p,
				double per_s)
{
	const size_t before = INTERP_COMPENSATE_BEHIND;
	const double all_s = (p->u_max - p->u_min) / per_s;
	size_t room;

	s->n = (size_t)(all_s / PERIOD_S);
	room = before + s->n + INTERP_COMPENSATE_AHEAD + 1;
	s->u = (double *)calloc(room, sizeof(double)) + before;
	for (int k = 0; k < 2; k++)
		s->mm[k] = (double *)calloc(room, sizeof(double)) + before;
	for (size_t i = 0; i < room; i++) {
		const double t = ((double)i - (double)before) * PERIOD_S;
		/* A fifth of a second to come to speed. */
		const double way = t < 0 ? 0 : t < 0.2 ? t * t / 0.4 : t - 0.1;
		const long at = (long)i - (long)before;
		struct interp_contour_point c;

		s->u[at] = fmin(p->u_min + per_s * way, p->u_max);
		p->at(p->arg, s->u[at], &c);
		for (int k = 0; k < 2; k++)
			s->mm[k][at] = c.mm[k];
	}
}

static inline void set_row_free(struct set_row *s)
{
	free(s->u - INTERP_COMPENSATE_BEHIND);
	for (int k = 0; k < 2; k++)
		free(s->mm[k] - INTERP_COMPENSATE_BEHIND);
}

/* Two axes that lag differently, believed as they are. */
struct rig {
	struct set_row set;
	struct interp_compensate_config config;
	struct interp_trial trial;
};

static inline void rig_make(struct rig *r,
			    const struct interp_contour_path *p, double per_s)
{
	static const double gain[2] = { 30, 21.5 };

	*r = (struct rig) { .config = {
		.gains = {
			.velocity = 1, .acceleration = 1, .lead_periods = 0.5,
			.cross_1_s = 100, .predicted_1_s = 60,
			.measured_1_s = 60, .horizon_s = 0.02,
		},
		.naxes = 2, .period_s = PERIOD_S, .look_mm = 0.02,
		.noise = { .drive_mm_s = 5, .sensor_mm = 0.0006 },
	} };
	set_row_make(&r->set, p, per_s);
	for (int k = 0; k < 2; k++) {
		r->config.loop[k] = r->trial.truth[k] =
			(struct interp_axis_loop) {
				.gain_1_s = gain[k], .velocity_hz = 60,
				.damping = 0.7,
			};
		r->trial.set.at[k] = r->set.mm[k];
	}
	r->trial.set.u = r->set.u;
	r->trial.path = p;
	r->trial.n = r->set.n;
	r->trial.compensate = &r->config;
}

static inline struct interp_trial_result rig_run(struct rig *r,
						 const char *methods)
{
	struct interp_trial_result ret = { 0 };

	r->config.methods = (uint32_t)interp_compensate_parse(methods);
	assert_int_equal(interp_trial_run(&r->trial, &ret), 0);
	return ret;
}

static inline void rig_free(struct rig *r)
{
	set_row_free(&r->set);
}

#endif /* CONTOUR_HELP_H */
