/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.c - an S-curve along the path, sampled cycle by cycle
 *
 * A plan to a place is good as long as what is left to go is what the plan says
 * is left; the distance of a cycle leads onto the plan, so a rounding does not
 * add up.
 */
#include "mover.h"

#include <math.h>
#include <stdbool.h>

/* Nearer than this is there. */
#define THERE_MM	1e-9

struct interp_scurve_limits mover_curve(const struct mover_limits *l)
{
	return (struct interp_scurve_limits) {
		l->v_max_mm_s, l->a_max_mm_s2, l->a_max_mm_s2, l->j_max_mm_s3
	};
}

void mover_set(struct mover *m, double v_mm_s)
{
	m->v_mm_s = v_mm_s;
	m->a_mm_s2 = 0;
	m->kind = MOVER_NO_PLAN;
}

static bool same(const struct mover_limits *p, const struct mover_limits *q)
{
	return p->v_max_mm_s == q->v_max_mm_s &&
	       p->a_max_mm_s2 == q->a_max_mm_s2 &&
	       p->j_max_mm_s3 == q->j_max_mm_s3;
}

static bool is_planned(const struct mover *m, const struct mover_limits *l,
		       enum mover_plan kind)
{
	return m->kind == kind && same(&m->l, l);
}

static void plan(struct mover *m, const struct mover_limits *l,
		 enum mover_plan kind, double goal)
{
	const struct interp_scurve_limits c = mover_curve(l);

	if (kind == MOVER_TO_PLACE)
		interp_scurve_to_place(&m->plan, &c, m->v_mm_s, m->a_mm_s2,
				       goal);
	else
		interp_scurve_to_speed(&m->plan, &c, m->v_mm_s, m->a_mm_s2,
				       goal);
	m->kind = kind;
	m->goal = goal;
	m->l = *l;
	m->t_s = 0;
	m->gone_mm = 0;
}

/* The next sample of the plan; the distance to it from the last one. */
static double sample(struct mover *m, double period_s)
{
	struct interp_scurve_state s;
	double ds;

	m->t_s += period_s;
	s = interp_scurve_at(&m->plan, m->t_s);
	ds = s.x_mm - m->gone_mm;
	m->gone_mm = s.x_mm;
	m->v_mm_s = s.v_mm_s;
	m->a_mm_s2 = s.a_mm_s2;
	return ds;
}

double mover_step(struct mover *m, const struct mover_limits *l,
		  double left_mm)
{
	if (fabs(left_mm) < THERE_MM && m->v_mm_s == 0 && m->a_mm_s2 == 0)
		return left_mm;
	if (!is_planned(m, l, MOVER_TO_PLACE) ||
	    fabs(m->goal - m->gone_mm - left_mm) > THERE_MM)
		plan(m, l, MOVER_TO_PLACE, left_mm);
	sample(m, l->period_s);
	return left_mm - (m->goal - m->gone_mm);
}

double mover_run(struct mover *m, const struct mover_limits *l, double v_mm_s)
{
	if (m->v_mm_s == v_mm_s && m->a_mm_s2 == 0)
		return v_mm_s * l->period_s;
	if (!is_planned(m, l, MOVER_TO_SPEED) || m->goal != v_mm_s)
		plan(m, l, MOVER_TO_SPEED, v_mm_s);
	return sample(m, l->period_s);
}

double mover_stop(struct mover *m, const struct mover_limits *l)
{
	return mover_run(m, l, 0);
}
