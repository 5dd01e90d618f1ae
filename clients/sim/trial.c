/* SPDX-License-Identifier: Apache-2.0 */
/*
 * trial.c - runs one set of values with several seeds side by side
 *
 * The results are added in the order of the seeds.  So the sum does not depend
 * on the number of processors.
 */
#include "tune_servo.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

/* What is kept of one run. */
struct ran {
	struct cycle_totals totals;
	struct io_sim_result cut;
	double virtual_s;
	bool fault;
	int e;
};

struct crew {
	const struct trial *t;
	const struct machine_config *c;
	atomic_uint next;
	struct ran ran[TRIAL_SEEDS_MAX];
};

static void run_seed(struct crew *w, uint32_t k)
{
	struct ran *x = &w->ran[k];
	struct sim_options o = *w->t->o;
	struct sim_run *r = calloc(1, sizeof(*r));

	if (!r) {
		x->e = EX_OSERR;
		return;
	}
	o.seed = w->t->seed + k;
	o.seed_given = true;
	o.limit_s = w->t->limit_s;
	o.quiet = true;
	r->o = &o;
	r->config = w->c;
	r->job = *w->t->job;
	x->e = run_job(r);
	x->totals = r->v.cycle.totals;
	x->cut = r->result.cut;
	x->virtual_s = (double)x->totals.cycles *
		       (double)config_period_ns(w->c) * 1e-9;
	x->fault = r->v.cycle.fault.first != FAULT_NONE;
	free(r->spent);
	free(r);
}

static void *work(void *arg)
{
	struct crew *w = arg;
	uint32_t k;

	while ((k = atomic_fetch_add(&w->next, 1)) < w->t->seeds)
		run_seed(w, k);
	return NULL;
}

static void work_all(struct crew *w)
{
	const long cpus = sysconf(_SC_NPROCESSORS_ONLN);
	pthread_t helper[TRIAL_SEEDS_MAX];
	uint32_t n = 0;

	while (n + 1 < w->t->seeds && n + 1 < cpus &&
	       pthread_create(&helper[n], NULL, work, w) == 0)
		n++;
	work(w);
	while (n > 0)
		pthread_join(helper[--n], NULL);
}

static void add_up(const struct crew *w, struct trial_sum *s)
{
	double removed = 0, wear = 0, stood_min = 0;

	*s = (struct trial_sum) { .runs = w->t->seeds };
	for (uint32_t k = 0; k < w->t->seeds; k++) {
		const struct ran *x = &w->ran[k];

		s->minutes += x->virtual_s / 60;
		if (x->fault) {
			stood_min += (w->t->limit_s - x->virtual_s) / 60;
			s->faults++;
		}
		removed += x->cut.removed_mm3;
		wear += x->cut.wear_mm;
		s->shorts_min += x->totals.shorts;
		s->retracts_min += x->totals.retracts;
		s->arcs_min += x->totals.arcs;
		s->burns_min += x->cut.burns;
	}
	s->minutes = fmax(s->minutes, 1e-9);
	s->shorts_min /= s->minutes;
	s->retracts_min /= s->minutes;
	s->arcs_min /= s->minutes;
	s->burns_min /= s->minutes;
	s->removal_mm3_min = removed / (s->minutes + stood_min);
	s->wear_mm_mm3 = removed > 0 ? wear / removed : 0;
}

int trial_run(const struct trial *t, const struct machine_config *c,
	      struct trial_sum *ret)
{
	struct crew w = { .t = t, .c = c };

	work_all(&w);
	if (run_interrupted())
		return -EINTR;
	for (uint32_t k = 0; k < t->seeds; k++)
		if (w.ran[k].e)
			return w.ran[k].e;
	add_up(&w, ret);
	return 0;
}
