/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mover.c - an S-curve along the path, sampled cycle by cycle
 *
 * A plan to a place is valid as long as the distance left is the one that the
 * plan expects. Each cycle goes to the place that the plan has then, so
 * roundings do not add up.
 */
#include "path/mover.h"

#include <math.h>
#include <stdbool.h>

struct interp_scurve_limits mover_curve(const struct mover_limits *l)
{
	return (struct interp_scurve_limits) {
		l->v_max_mm_s, l->a_max_mm_s2,
		l->a_back_mm_s2 > 0 ? l->a_back_mm_s2 : l->a_max_mm_s2,
		l->j_max_mm_s3
	};
}

void mover_set(struct mover *m, double v_mm_s)
{
	m->v_mm_s = m->mean_mm_s = v_mm_s;
	m->a_mm_s2 = 0;
	m->kind = MOVER_NO_PLAN;
}

static bool same(const struct mover_limits *p, const struct mover_limits *q)
{
	return p->v_max_mm_s == q->v_max_mm_s &&
	       p->a_max_mm_s2 == q->a_max_mm_s2 &&
	       p->j_max_mm_s3 == q->j_max_mm_s3 &&
	       p->a_back_mm_s2 == q->a_back_mm_s2;
}

static void planned(struct mover *m, const struct mover_limits *l,
		    enum mover_plan kind, double goal)
{
	m->kind = kind;
	m->goal = goal;
	m->l = *l;
	m->t_s = 0;
	m->gone_mm = 0;
}

void mover_aim_speed(struct mover *m, const struct mover_limits *l,
		     double v_mm_s)
{
	struct interp_scurve_limits c;

	if (m->kind == MOVER_TO_SPEED && m->goal == v_mm_s && same(&m->l, l))
		return;
	c = mover_curve(l);
	interp_scurve_to_speed(&m->plan, &c, m->v_mm_s, m->a_mm_s2, v_mm_s);
	planned(m, l, MOVER_TO_SPEED, v_mm_s);
}

void mover_aim_place(struct mover *m, const struct mover_limits *l,
		     double left_mm, double pass_mm_s)
{
	const struct interp_scurve_state from = { 0, m->v_mm_s, m->a_mm_s2 };
	struct interp_scurve_limits c;

	m->left_mm = left_mm;
	if (m->kind == MOVER_TO_PLACE && m->pass_mm_s == pass_mm_s &&
	    same(&m->l, l) &&
	    fabs(m->goal - m->gone_mm - left_mm) <= MOVER_ONTO_MM)
		return;
	c = mover_curve(l);
	interp_scurve_to_pass(&m->plan, &c, &from, left_mm, pass_mm_s);
	planned(m, l, MOVER_TO_PLACE, left_mm);
	m->pass_mm_s = pass_mm_s;
}

double mover_most_mm_s(const struct mover *m)
{
	const struct interp_scurve *p = &m->plan;
	double most = fmax(fabs(m->v_mm_s), fabs(p->end.v_mm_s));

	for (int k = 0; k < p->n; k++) {
		const struct interp_scurve_state from =
			interp_scurve_at(p, fmax(p->t_s[k], m->t_s));
		const double a = from.a_mm_s2, j = p->j_mm_s3[k];

		most = fmax(most, fabs(from.v_mm_s));
		if (a * j < 0)
			most = fmax(most, fabs(from.v_mm_s - a * a / (2 * j)));
	}
	return most;
}

static bool stands_there(const struct mover *m)
{
	return m->kind == MOVER_TO_PLACE && m->pass_mm_s == 0 &&
	       fabs(m->left_mm) < MOVER_ONTO_MM && mover_is_standing(m);
}

struct interp_scurve_state mover_peek(const struct mover *m, double period_s)
{
	struct interp_scurve_state s = { m->left_mm, 0, 0 };

	if (stands_there(m))
		return s;
	s = interp_scurve_at(&m->plan, m->t_s + period_s);
	s.x_mm -= m->gone_mm;
	return s;
}

/* The distance leads to the place that the plan has then. */
double mover_go(struct mover *m, double period_s)
{
	const struct interp_scurve_state s = mover_peek(m, period_s);

	m->mean_mm_s = s.x_mm / period_s;
	if (stands_there(m))
		return s.x_mm;
	m->t_s += period_s;
	m->gone_mm += s.x_mm;
	m->v_mm_s = s.v_mm_s;
	m->a_mm_s2 = s.a_mm_s2;
	return m->kind == MOVER_TO_PLACE ? m->left_mm - (m->goal - m->gone_mm) :
					   s.x_mm;
}

double mover_step(struct mover *m, const struct mover_limits *l,
		  double left_mm)
{
	mover_aim_place(m, l, left_mm, 0);
	return mover_go(m, l->period_s);
}

double mover_run(struct mover *m, const struct mover_limits *l, double v_mm_s)
{
	if (m->v_mm_s == v_mm_s && m->a_mm_s2 == 0) {
		m->mean_mm_s = v_mm_s;
		return v_mm_s * l->period_s;
	}
	mover_aim_speed(m, l, v_mm_s);
	return mover_go(m, l->period_s);
}

double mover_stop(struct mover *m, const struct mover_limits *l)
{
	return mover_run(m, l, 0);
}
