/* SPDX-License-Identifier: Apache-2.0 */
/* minimise.c - NLopt's methods without derivatives, with a budget */
#include "interp/minimise.h"

#include <errno.h>
#include <math.h>
#include <nlopt.h>
#include <string.h>

#define FIRST		0.15		/* first step, as a share of the box */
#define SHRUNK		1e-6		/* if it shrank below this share of the
					 * box, begin again */
#define WORST		1e300		/* NLopt accepts no infinity */

struct search {
	const struct interp_minimise *m;
	nlopt_opt o;			/* the present run */
	unsigned int used;		/* evaluations */
	double best[INTERP_MINIMISE_NMAX], least;
};

/* The best place is stored and the budget is watched here.  NLopt returns no
 * place when it is stopped, and some of its methods go on for a few
 * evaluations. */
static double look(unsigned int n, const double *x, double *gradient, void *arg)
{
	struct search *s = arg;
	double cost;

	(void)gradient;
	if (s->used >= s->m->budget) {
		nlopt_force_stop(s->o);
		return WORST;
	}
	s->used++;
	cost = s->m->cost(s->m->arg, x);
	if (cost < s->least) {
		s->least = cost;
		memcpy(s->best, x, n * sizeof(*x));
	}
	return cost < WORST ? cost : WORST;
}

static nlopt_result set_up(nlopt_opt o, struct search *s, unsigned int budget)
{
	const struct interp_minimise *m = s->m;
	double step[INTERP_MINIMISE_NMAX], shrunk[INTERP_MINIMISE_NMAX];
	nlopt_result err;

	for (int i = 0; i < m->n; i++) {
		step[i] = FIRST * (m->high[i] - m->low[i]);
		shrunk[i] = SHRUNK * (m->high[i] - m->low[i]);
	}
	err = nlopt_set_lower_bounds(o, m->low);
	if (err > 0)
		err = nlopt_set_upper_bounds(o, m->high);
	if (err > 0)
		err = nlopt_set_initial_step(o, step);
	if (err > 0)
		err = nlopt_set_min_objective(o, look, s);
	if (err > 0)
		err = nlopt_set_xtol_abs(o, shrunk);
	return err > 0 ? nlopt_set_maxeval(o, (int)budget) : err;
}

/* One run of one method from @x.  Afterwards @x is the best place so far. */
static int run(struct search *s, nlopt_algorithm method, unsigned int budget,
	       double *x)
{
	nlopt_opt o = nlopt_create(method, (unsigned int)s->m->n);
	nlopt_result err = o ? set_up(o, s, budget) : NLOPT_OUT_OF_MEMORY;
	double least;

	s->o = o;
	if (err > 0)
		err = nlopt_optimize(o, x, &least);
	nlopt_destroy(o);
	memcpy(x, s->best, (size_t)s->m->n * sizeof(*x));
	return err == NLOPT_OUT_OF_MEMORY ? -ENOMEM :
	       err == NLOPT_INVALID_ARGS ? -EINVAL : 0;
}

static void begin(struct search *s, const struct interp_minimise *m, double *x)
{
	*s = (struct search) { .m = m, .least = INFINITY };
	for (int i = 0; i < m->n; i++)
		x[i] = fmin(fmax(x[i], m->low[i]), m->high[i]);
	memcpy(s->best, x, (size_t)m->n * sizeof(*x));
}

/* A run that has shrunk begins again around its best place, while there is
 * budget. */
static int run_local(struct search *s, double *x)
{
	int err = 0;

	while (!err && s->used < s->m->budget)
		err = run(s, NLOPT_LN_NELDERMEAD, s->m->budget - s->used, x);
	return err;
}

int interp_minimise_local(const struct interp_minimise *m, double *x,
			  double *ret_least)
{
	struct search s;
	int err;

	begin(&s, m, x);
	err = run_local(&s, x);
	*ret_least = s.least;
	return err;
}

int interp_minimise_global(const struct interp_minimise *m, double *x,
			   double *ret_least)
{
	struct search s;
	int err;

	begin(&s, m, x);
	/* This search divides the box and would never look at the given
	 * place. */
	look((unsigned int)m->n, x, NULL, &s);
	err = run(&s, NLOPT_GN_DIRECT_L, m->budget / 2, x);
	if (!err)
		err = run_local(&s, x);
	*ret_least = s.least;
	return err;
}
