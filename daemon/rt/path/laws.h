/* SPDX-License-Identifier: Apache-2.0 */
/*
 * laws.h - the feed laws of the gap, and what all laws share
 *
 * A law says how far to go in this cycle.  It leaves its speed in the mover, so
 * that the law of the next state goes on from there.  Private to the files of
 * daemon/rt.
 *
 * Threads: RT-safe.
 */
#ifndef RT_LAWS_H
#define RT_LAWS_H

#include "cycle.h"

#include <math.h>

static inline double law_period_s(const struct cycle *c)
{
	return (double)c->config.period_ns * 1e-9;
}

/* A speed set at once, without a ramp. */
static inline double law_go_at(struct cycle *c, double v_mm_s)
{
	mover_set(&c->mover, v_mm_s);
	return v_mm_s * law_period_s(c);
}

static inline double law_seg_speed(const struct interp_seg *s)
{
	return s->feed_mm_s < s->feed_max_mm_s ? s->feed_mm_s :
						 s->feed_max_mm_s;
}

/* To brake, position and move by command. */
static inline struct mover_limits law_travel_limits(const struct cycle *c,
						    double v_max_mm_s)
{
	return (struct mover_limits) {
		.v_max_mm_s = v_max_mm_s,
		.a_max_mm_s2 = c->config.travel_a_mm_s2,
		.j_max_mm_s3 = c->config.travel_j_mm_s3,
		.period_s = law_period_s(c),
	};
}

/* By what the axes of a segment allow. */
static inline void law_soften(struct mover_limits *l,
			      const struct interp_seg *s)
{
	const double a = (double)s->a_mm_s2, j = (double)s->j_mm_s3;

	if (s->kind >= INTERP_BEGIN)
		return;
	l->a_max_mm_s2 = fmin(l->a_max_mm_s2, a);
	if (l->a_back_mm_s2 > 0)
		l->a_back_mm_s2 = fmin(l->a_back_mm_s2, a);
	l->j_max_mm_s3 = fmin(l->j_max_mm_s3, j);
}

/* servo.c: the gap. */
double law_approach(struct cycle *c);
double law_erode(struct cycle *c);
double law_retract(struct cycle *c);

#endif /* RT_LAWS_H */
