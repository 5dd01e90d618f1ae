/* SPDX-License-Identifier: Apache-2.0 */
/* lp.c - linear programs: solved within limits, and checked */
#include "lp.h"

#include <math.h>
#include <stdlib.h>

#define DUST		1e-7		/* of the largest term of a row: none */
#define MISS		1e-6		/* a row may be missed by that, mm */
#define ITERATIONS	200		/* until it is asked whether to stop */
#define ROUNDS		500		/* of these */
#define ROUND_MS	10000		/* a longer one has lost its way */

glp_prob *lp_new(void)
{
	glp_prob *p = glp_create_prob();

	glp_set_obj_dir(p, GLP_MAX);
	return p;
}

void lp_bound(glp_prob *p, int col, double low, double high)
{
	if (low < high)
		glp_set_col_bnds(p, col, GLP_DB, low, high);
	else
		glp_set_col_bnds(p, col, GLP_FX, 0, 0);
}

void lp_put(struct lp_row *r, int col, double value)
{
	if (value == 0)
		return;
	r->n++;
	r->index[r->n] = col;
	r->value[r->n] = value;
}

void lp_at_least(glp_prob *p, const struct lp_row *r, double least)
{
	const int row = glp_add_rows(p, 1);

	glp_set_row_bnds(p, row, GLP_LO, least, 0);
	glp_set_mat_row(p, row, r->n, r->index, r->value);
}

/* Room for a row, as GLPK counts: from 1 on. */
struct row {
	int *index;
	double *value;
	int n;
};

static void take_row(glp_prob *p, int i, struct row *r)
{
	r->n = glp_get_mat_row(p, i, r->index, r->value);
}

static void sweep_row(glp_prob *p, int i, struct row *r)
{
	double most = 0;
	int kept = 0;

	take_row(p, i, r);
	for (int k = 1; k <= r->n; k++)
		most = fmax(most, fabs(r->value[k]));
	for (int k = 1; k <= r->n; k++) {
		if (fabs(r->value[k]) <= DUST * most)
			continue;
		r->index[++kept] = r->index[k];
		r->value[kept] = r->value[k];
	}
	if (kept < r->n)
		glp_set_mat_row(p, i, kept, r->index, r->value);
}

/* Is @v within bounds of @type, as GLPK calls them? */
static bool is_within(int type, double low, double high, double v)
{
	const bool above = type == GLP_LO || type == GLP_DB || type == GLP_FX;
	const bool below = type == GLP_UP || type == GLP_DB || type == GLP_FX;

	return isfinite(v) && !(above && v < low - MISS) &&
	       !(below && v > high + MISS);
}

static bool keeps_row(glp_prob *p, int i, struct row *r)
{
	double sum = 0;

	take_row(p, i, r);
	for (int k = 1; k <= r->n; k++)
		sum += r->value[k] * glp_get_col_prim(p, r->index[k]);
	return is_within(glp_get_row_type(p, i), glp_get_row_lb(p, i),
			 glp_get_row_ub(p, i), sum);
}

static bool keeps_all(glp_prob *p, struct row *r)
{
	for (int j = 1; j <= glp_get_num_cols(p); j++) {
		if (!is_within(glp_get_col_type(p, j), glp_get_col_lb(p, j),
			       glp_get_col_ub(p, j), glp_get_col_prim(p, j)))
			return false;
	}
	for (int i = 1; i <= glp_get_num_rows(p); i++) {
		if (!keeps_row(p, i, r))
			return false;
	}
	return true;
}

/* Each round goes on where the one before ended. */
static bool search(glp_prob *p, bool (*stop)(void))
{
	glp_smcp how;
	int err = GLP_EITLIM;

	glp_init_smcp(&how);
	how.msg_lev = GLP_MSG_OFF;
	how.presolve = GLP_OFF;
	how.it_lim = ITERATIONS;
	how.tm_lim = ROUND_MS;
	glp_term_out(GLP_OFF);
	for (int i = 0; i < ROUNDS && err == GLP_EITLIM; i++) {
		if (stop())
			return false;
		err = glp_simplex(p, &how);
	}
	return err == 0 && glp_get_status(p) == GLP_OPT;
}

bool lp_solve(glp_prob *p, bool (*stop)(void))
{
	const size_t room = (size_t)glp_get_num_cols(p) + 1;
	struct row r = { calloc(room, sizeof(*r.index)),
			 calloc(room, sizeof(*r.value)), 0 };
	bool found = r.index && r.value;

	for (int i = 1; found && i <= glp_get_num_rows(p); i++)
		sweep_row(p, i, &r);
	found = found && search(p, stop) && keeps_all(p, &r);
	free(r.index);
	free(r.value);
	return found;
}
