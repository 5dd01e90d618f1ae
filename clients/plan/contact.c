/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contact.c - how an electrode may move where walls are near
 *
 * In the linear programs a step is the difference of two columns for each axis,
 * so that its length has a price: of two steps that lead as far outward the
 * shorter one is taken.  The last column is the least distance after the step.
 */
#include "contact.h"

#include "eigen.h"
#include "free.h"
#include "lp.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define NEAR_MM		0.5		/* beyond what a step can come to */
#define MIDDLE_MM	0.4		/* more clearance is not looked for */
#define MIDDLE_WORTH	0.5		/* of a mm of it, to a mm along */
#define LENGTH_COST	0.05		/* of a mm of way */
#define CENTRE_MM	3.0
#define WALL_MM		0.05		/* nearer walls hinder no more */

void contact_init(struct contact *c, const struct job *j,
		  const double end[INTERP_NAXES], double mm)
{
	double lattice[INTERP_NAXES];

	*c = (struct contact) { .j = j };
	job_axes_find(j, end, end, &c->axes);
	route_lattice(&j->config, lattice);
	c->keep_mm = mm + j->chord_mm + 2 * PROVE_EPS_MM;
	for (uint32_t a = 0; a < c->axes.n; a++)
		c->keep_mm += lattice[c->axes.axis[a]] *
			      c->axes.reach_mm[c->axes.axis[a]];
}

static void add_pair(struct contact *c, const struct near_pair *x)
{
	double jac[INTERP_NAXES][3], n[3];

	if (!(x->mm > 1e-9))
		return;
	v_sub(x->q, x->p, n);
	motion_jacobian(&c->j->motion, c->q, x->q, jac);
	for (uint32_t a = 0; a < c->axes.n; a++) {
		const uint32_t k = c->axes.axis[a];

		c->a[c->n][a] = v_dot(n, jac[k]) / x->mm / c->axes.reach_mm[k];
	}
	c->mm[c->n++] = x->mm;
}

void contact_look(struct contact *c, const double q[INTERP_NAXES],
		  double room_mm)
{
	static struct near_set set = { .max = NEAR_SET_MAX };
	struct pose pose;

	memcpy(c->q, q, sizeof(c->q));
	motion_pose(&c->j->motion, q, &pose);
	near_less(&c->j->bodies, &pose, DBL_MAX, &c->nearest);
	c->least_mm = c->nearest.mm;
	near_set_collect(&c->j->bodies, &pose, fmax(c->least_mm,
			 c->keep_mm + 2 * room_mm) + NEAR_MM, &set);
	c->n = 0;
	for (uint32_t i = 0; i < set.n; i++)
		add_pair(c, &set.pair[i]);
}

/* -- Linear programs ------------------------------------------------------ */

/* Columns of axis number @a: forward, and back. */
static int forward(uint32_t a)
{
	return 1 + 2 * (int)a;
}

static int least_column(const struct contact *c)
{
	return 1 + 2 * (int)c->axes.n;
}

static void put_motion(const struct contact *c, const double a[INTERP_NAXES],
		       struct lp_row *r)
{
	for (uint32_t k = 0; k < c->axes.n; k++) {
		lp_put(r, forward(k), a[k]);
		lp_put(r, forward(k) + 1, -a[k]);
	}
}

static glp_prob *begin(const struct contact *c, double room_mm, double more_mm)
{
	const double least = fmin(c->keep_mm, c->least_mm);
	glp_prob *p = lp_new();

	glp_add_cols(p, least_column(c));
	for (uint32_t a = 0; a < c->axes.n; a++) {
		const uint32_t k = c->axes.axis[a];
		const struct interp_axis_limits *l = &c->j->config.axes.axis[k];
		const double mm = c->axes.reach_mm[k];

		lp_bound(p, forward(a), 0,
			 fmin(room_mm, (l->travel_max_mm - c->q[k]) * mm));
		lp_bound(p, forward(a) + 1, 0,
			 fmin(room_mm, (c->q[k] - l->travel_min_mm) * mm));
	}
	glp_set_col_bnds(p, least_column(c), GLP_DB, least, least + more_mm);
	for (uint32_t i = 0; i < c->n; i++) {
		struct lp_row r = { 0 };

		put_motion(c, c->a[i], &r);
		lp_put(&r, least_column(c), -1);
		lp_at_least(p, &r, -c->mm[i]);
	}
	return p;
}

static bool solve(const struct contact *c, glp_prob *p, double s[INTERP_NAXES])
{
	const bool ok = lp_solve(p, bar_interrupted);

	memset(s, 0, INTERP_NAXES * sizeof(*s));
	for (uint32_t a = 0; a < c->axes.n && ok; a++)
		s[a] = glp_get_col_prim(p, forward(a)) -
		       glp_get_col_prim(p, forward(a) + 1);
	glp_delete_prob(p);
	return ok;
}

bool contact_step(const struct contact *c, const double toward[INTERP_NAXES],
		  double room_mm, double s[INTERP_NAXES])
{
	glp_prob *p = begin(c, room_mm, MIDDLE_MM);

	for (uint32_t a = 0; a < c->axes.n; a++) {
		glp_set_obj_coef(p, forward(a), toward[a] - LENGTH_COST);
		glp_set_obj_coef(p, forward(a) + 1, -toward[a] - LENGTH_COST);
	}
	glp_set_obj_coef(p, least_column(c), MIDDLE_WORTH);
	return solve(c, p, s);
}

bool contact_centre(const struct contact *c, const double along[INTERP_NAXES],
		    double room_mm, double s[INTERP_NAXES])
{
	glp_prob *p = begin(c, room_mm, CENTRE_MM);
	struct lp_row r = { 0 };

	for (int col = 1; col < least_column(c); col++)
		glp_set_obj_coef(p, col, -LENGTH_COST);
	glp_set_obj_coef(p, least_column(c), 1);
	put_motion(c, along, &r);
	lp_at_least(p, &r, 0);
	for (int i = 1; i <= r.n; i++)
		r.value[i] = -r.value[i];
	lp_at_least(p, &r, 0);
	return solve(c, p, s);
}

/* -- Directions ----------------------------------------------------------- */

void contact_directions(const struct contact *c,
			double ret[INTERP_NAXES][INTERP_NAXES])
{
	double sum[INTERP_NAXES * INTERP_NAXES] = { 0 };
	double vectors[INTERP_NAXES * INTERP_NAXES];
	const uint32_t n = c->axes.n;

	for (uint32_t i = 0; i < c->n; i++) {
		const double w = 1 / fmax(c->mm[i] - c->keep_mm, WALL_MM);

		for (uint32_t a = 0; a < n; a++)
			for (uint32_t b = 0; b < n; b++)
				sum[a * n + b] += w * w * c->a[i][a] *
						  c->a[i][b];
	}
	eigen_vectors(n, sum, vectors);
	for (uint32_t k = 0; k < n; k++)
		for (uint32_t a = 0; a < n; a++)
			ret[k][a] = vectors[k * n + a];
}

void contact_to(const struct contact *c, const double s[INTERP_NAXES],
		double ret[INTERP_NAXES])
{
	memcpy(ret, c->q, sizeof(c->q));
	for (uint32_t a = 0; a < c->axes.n; a++)
		ret[c->axes.axis[a]] += s[a] /
					c->axes.reach_mm[c->axes.axis[a]];
	free_round(&c->j->config, ret);
}

double contact_apart_mm(const struct contact *c, const double a[INTERP_NAXES],
			const double b[INTERP_NAXES])
{
	double sum = 0;

	for (uint32_t i = 0; i < c->axes.n; i++) {
		const uint32_t k = c->axes.axis[i];
		const double d = (a[k] - b[k]) * c->axes.reach_mm[k];

		sum += d * d;
	}
	return sqrt(sum);
}
