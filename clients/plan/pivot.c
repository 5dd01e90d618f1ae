/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pivot.c - where the work, or the electrode in its holder, had better be
 *
 * A block is straight in the axes, so the way of the electrode depends on where
 * the lines of the rotary joints are.  Shift the part by s and the electrode by
 * e, and keep all poses as seen from the part: then the positions of the linear
 * axes change linearly with s and e.  So a problem of least squares with six
 * unknowns gives the shifts with which the axes move straightest between a few
 * nodes.  A small cost on long shifts keeps those at 0 that change nothing.
 */
#include "check.h"
#include "plan.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHIFTS		6		/* three of the part, three of the
					 * electrode */
#define COST		1e-6		/* of a mm of shift, to a mm of bend */
#define SHIFT_LEAST_MM	0.001

struct nodes {
	uint32_t n;
	double (*q)[INTERP_NAXES];
	double *share;		/* of the turn, 0 ... 1 */
	double (*by)[SHIFTS][3];	/* linear axes, per mm of shift */
};

/* The axes at which the electrode stands to the part as it did at @q, with the
 * part moved by the first three of @s and the electrode by the others. */
static int place(const struct interp_kinematics *k, const double *q,
		 const double s[SHIFTS], double ret[INTERP_NAXES])
{
	struct interp_kin_pose pose;
	struct interp_kinematics tool = *k;
	double tip[3];

	memcpy(ret, q, INTERP_NAXES * sizeof(*ret));
	/* Where the electrode's point goes that is to be at the old tip's. */
	interp_kin_forward(k, q, &pose);
	for (int i = 0; i < 3; i++) {
		tool.tip_mm[i] = k->tip_mm[i] + s[3 + i];
		tip[i] = pose.tip_mm[i] + s[i];
	}
	return interp_kin_place(&tool, tip, ret);
}

static int find_columns(const struct job *j, struct nodes *n)
{
	for (uint32_t i = 0; i < n->n; i++) {
		for (int c = 0; c < SHIFTS; c++) {
			double s[SHIFTS] = { 0 }, q[INTERP_NAXES];

			s[c] = 1;
			if (place(&j->kin, n->q[i], s, q))
				return -EDOM;
			for (int k = 0; k < 3; k++)
				n->by[i][c][k] = q[k] - n->q[i][k];
		}
	}
	return 0;
}

/* The share of the turn is that of all rotaries together. Return: false if none
 * turns. */
static bool find_shares(struct nodes *n)
{
	double sum = 0;

	n->share[0] = 0;
	for (uint32_t i = 1; i < n->n; i++) {
		double turn = 0;

		for (int k = INTERP_A; k <= INTERP_C; k++)
			turn += fabs(n->q[i][k] - n->q[i - 1][k]);
		sum += turn;
		n->share[i] = sum;
	}
	for (uint32_t i = 0; i < n->n && sum > 0; i++)
		n->share[i] /= sum;
	return sum > 1;
}

/* -- Least squares -------------------------------------------------------- */

struct squares {
	double a[SHIFTS][SHIFTS + 1];
};

/* @row . shifts + @rest is to be 0. */
static void add_row(struct squares *s, const double row[SHIFTS], double rest)
{
	for (int i = 0; i < SHIFTS; i++) {
		for (int k = 0; k < SHIFTS; k++)
			s->a[i][k] += row[i] * row[k];
		s->a[i][SHIFTS] -= row[i] * rest;
	}
}

static void eliminate(struct squares *s, double ret[SHIFTS])
{
	for (int i = 0; i < SHIFTS; i++) {
		int top = i;

		for (int k = i + 1; k < SHIFTS; k++)
			if (fabs(s->a[k][i]) > fabs(s->a[top][i]))
				top = k;
		for (int k = 0; k <= SHIFTS; k++) {
			const double keep = s->a[i][k];

			s->a[i][k] = s->a[top][k];
			s->a[top][k] = keep;
		}
		for (int r = 0; r < SHIFTS; r++) {
			const double f = s->a[r][i] / s->a[i][i];

			for (int k = i; k <= SHIFTS && r != i; k++)
				s->a[r][k] -= f * s->a[i][k];
		}
	}
	for (int i = 0; i < SHIFTS; i++)
		ret[i] = s->a[i][SHIFTS] / s->a[i][i];
}

/* The nodes between @from and @to on the line between those two. */
static void add_block(struct squares *s, const struct nodes *n, uint32_t from,
		      uint32_t to)
{
	const double turn = n->share[to] - n->share[from];

	for (uint32_t i = from + 1; i < to && turn > 0; i++) {
		const double t = (n->share[i] - n->share[from]) / turn;

		for (int k = 0; k < 3; k++) {
			double row[SHIFTS];

			for (int c = 0; c < SHIFTS; c++)
				row[c] = n->by[i][c][k] -
					 (1 - t) * n->by[from][c][k] -
					 t * n->by[to][c][k];
			add_row(s, row, n->q[i][k] - (1 - t) * n->q[from][k] -
					t * n->q[to][k]);
		}
	}
}

static void best_shift(const struct nodes *n, uint32_t blocks,
		       double ret[SHIFTS])
{
	struct squares s = { { { 0 } } };
	uint32_t from = 0;

	for (int i = 0; i < SHIFTS; i++)
		s.a[i][i] = COST * n->n;
	for (uint32_t k = 1; k <= blocks; k++) {
		uint32_t to = from + 1;

		while (to + 1 < n->n &&
		       n->share[to] < (double)k / blocks - 1e-9)
			to++;
		if (k == blocks)
			to = n->n - 1;
		add_block(&s, n, from, to);
		from = to;
	}
	eliminate(&s, ret);
}

/* -- Trying a shift ------------------------------------------------------- */

static int shifted_body(const struct mesh *from, const double by[3],
			struct mesh *ret, struct tree *tree)
{
	*ret = *from;
	ret->vert = malloc(from->nverts * sizeof(*ret->vert));
	if (!ret->vert)
		return -ENOMEM;
	for (uint32_t i = 0; i < from->nverts; i++)
		v_add(from->vert[i], by, ret->vert[i]);
	mesh_bounds(ret);
	return tree_build(tree, ret);
}

static int shifted_job(const struct job *j, const double s[SHIFTS],
		       struct job *ret)
{
	*ret = *j;
	ret->part_tree = ret->tool_tree = (struct tree) { 0 };
	ret->tool.vert = NULL;
	if (shifted_body(&j->part, s, &ret->part, &ret->part_tree) ||
	    shifted_body(&j->tool, s + 3, &ret->tool, &ret->tool_tree))
		return -ENOMEM;
	ret->bodies = (struct bodies) { &ret->part_tree, &ret->tool_tree,
					NULL };
	motion_init(&ret->motion, &ret->kin, &ret->tool);
	return 0;
}

static void drop_job(struct job *j)
{
	tree_free(&j->part_tree);
	tree_free(&j->tool_tree);
	free(j->part.vert);
	free(j->tool.vert);
}

static bool in_travel(const struct job *j, const struct plan_way *w)
{
	for (uint32_t i = 0; i < w->n; i++) {
		for (int k = 0; k < INTERP_NAXES; k++) {
			const struct interp_axis_limits *a =
				&j->config.axes.axis[k];

			if (w->q[i][k] < a->travel_min_mm ||
			    w->q[i][k] > a->travel_max_mm)
				return false;
		}
	}
	return true;
}

/* For one micrometre nobody clamps the work anew. */
static bool is_better(const struct plan_way *a, const struct plan_way *b)
{
	return a->n < b->n ||
	       (a->n == b->n && a->least_mm > b->least_mm + 0.001);
}

static int try_shift(struct plan *p, const struct nodes *n,
		     const double s[SHIFTS])
{
	static double q[FEWEST_NODES_MAX][INTERP_NAXES];
	static struct plan trial;
	struct job j;
	int err = shifted_job(p->j, s, &j);

	trial = (struct plan) { .j = &j, .trial = true };
	for (uint32_t i = 0; i < n->n && err == 0; i++) {
		err = place(&p->j->kin, n->q[i], s, q[i]);
		free_round(&p->j->config, q[i]);
	}
	if (err == 0) {
		/* The end zone is about the end pose as it is then. */
		check_clearance(&j, q[n->n - 1], &trial.c);
		err = plan_over(&trial, &j, q, n->n);
	}
	p->queries += trial.queries;
	if (err == 0 && is_better(&trial.best, &p->best) &&
	    (!p->pivot.way.how || is_better(&trial.best, &p->pivot.way))) {
		plan_prove(&j, &trial.best, PROVE_FINE_MM, &p->queries);
		p->pivot.way = trial.best;
		memcpy(p->pivot.part_mm, s, sizeof(p->pivot.part_mm));
		memcpy(p->pivot.tool_mm, s + 3, sizeof(p->pivot.tool_mm));
		p->pivot.outside = !in_travel(p->j, &trial.best);
	}
	drop_job(&j);
	return err;
}

static int try_all(struct plan *p, struct nodes *n)
{
	int err = 0;

	if (!find_shares(n)) {
		snprintf(p->pivot.why, sizeof(p->pivot.why),
			 "no rotary turns: it does not matter");
		return 0;
	}
	if (find_columns(p->j, n))
		return 0;
	for (uint32_t blocks = 1; blocks <= 2 && !bar_interrupted(); blocks++) {
		double s[SHIFTS];

		best_shift(n, blocks, s);
		for (int i = 0; i < SHIFTS; i++)
			s[i] = round(s[i] / SHIFT_LEAST_MM) * SHIFT_LEAST_MM;
		err = try_shift(p, n, s);
		if (err == -ENOMEM)
			return err;
	}
	if (!p->pivot.way.how && !bar_interrupted())
		snprintf(p->pivot.why, sizeof(p->pivot.why),
			 "no better place of the work or the electrode found");
	return 0;
}

int plan_pivot(struct plan *p)
{
	uint32_t at[FEWEST_NODES_MAX];
	struct nodes n = { .n = plan_choose_nodes(p, at) };
	int err = -ENOMEM;

	if (n.n == 0)
		return err;
	n.q = malloc(n.n * sizeof(*n.q));
	n.share = malloc(n.n * sizeof(*n.share));
	n.by = malloc(n.n * sizeof(*n.by));
	if (n.q && n.share && n.by) {
		for (uint32_t i = 0; i < n.n; i++)
			memcpy(n.q[i], p->dense.node[at[i]].q, sizeof(n.q[i]));
		err = try_all(p, &n);
	}
	free(n.q);
	free(n.share);
	free(n.by);
	return err;
}
