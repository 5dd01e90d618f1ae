/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tune.c - finds gains of the contour compensation along a job
 *
 * The job is run dry to find the place of the cycle in every period.  The
 * targets of the axes are the programmed path at these places.  The models of
 * [axis.*] follow them, with errors of [contour] model_error and with encoders
 * of one pulse.  The gains with the smallest contour error are printed as lines
 * of a machine file.
 */
#include "sim.h"
#include "trials.h"

#include "interp/at.h"
#include "interp/tune.h"
#include "grow.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define BUDGET	200			/* trials */
#define LOOK_MM	0.02
#define MOST	2000000			/* periods of a job to be tuned on */

/* Targets of the axes that the job moves. */
struct rows {
	double *u, *mm[INTERP_NAXES];
	size_t n, room;
	bool full;
};

struct tuning {
	struct sim_run *run;
	struct rows rows;
	struct interp_at_path way;
	struct interp_at_curve last;
	struct interp_contour_path path;
	struct interp_compensate_config config;
	struct interp_trial trial;
	int axis[INTERP_NAXES];		/* of each model */
	struct trials trials;
};

/* -- Targets -------------------------------------------------------------- */

/* Standing still teaches nothing, and would only make the mean error
 * smaller. */
static void sample(struct sim_run *r)
{
	struct tuning *t = r->on_cycle_arg;
	struct rows *w = &t->rows;
	const double u = interp_cursor_place_mm(&r->v.cycle.cursor);

	if (w->n > 0 && u <= w->u[w->n - 1])
		return;
	if (w->n == MOST || (w->n == w->room &&
			     grow_array(&w->u, &w->room, sizeof(*w->u)))) {
		w->full = true;
		return;
	}
	w->u[w->n++] = u;
}

/* The machine stands still before the first place and after the last. */
static bool fill(struct tuning *t)
{
	struct rows *w = &t->rows;
	const size_t before = INTERP_COMPENSATE_BEHIND;
	const size_t room = before + w->n + INTERP_COMPENSATE_AHEAD + 1;
	double *u = w->n ? calloc(room, sizeof(*u)) : NULL;

	if (!u)
		return false;
	for (size_t i = 0; i < room; i++) {
		const size_t k = i < before ? 0 : i - before;

		u[i] = w->u[k < w->n ? k : w->n - 1];
	}
	free(w->u);
	w->u = u;
	for (int j = 0; j < t->path.naxes; j++) {
		w->mm[j] = calloc(room, sizeof(*u));
		if (!w->mm[j])
			return false;
	}
	for (size_t i = 0; i < room; i++) {
		struct interp_contour_point p;

		t->path.at(t->path.arg, u[i], &p);
		for (int j = 0; j < t->path.naxes; j++)
			w->mm[j][i] = p.mm[j];
	}
	for (int j = 0; j < t->path.naxes; j++)
		t->trial.set.at[j] = w->mm[j] + before;
	t->trial.set.u = u + before;
	t->trial.n = w->n;
	return true;
}

/* -- The trial ------------------------------------------------------------ */

static int refuse(const char *found, const char *wanted)
{
	fprintf(stderr, "edmsim: --tune-contour: %s; %s\n", found, wanted);
	return EX_DATAERR;
}

/* The first axis whose loops are not in the machine file; -1: none. */
static int axis_unknown(const struct sim_run *r)
{
	const struct interp_program_head *h = r->job.program.head;

	for (uint32_t j = 0; j < h->naxes; j++)
		if (!(r->config->loop[h->column[j]].gain_1_s > 0))
			return h->column[j];
	return -1;
}

static void loops_of(struct tuning *t)
{
	const struct interp_program_head *h = t->run->job.program.head;
	const struct machine_config *c = t->run->config;

	for (uint32_t j = 0; j < h->naxes; j++) {
		const int axis = h->column[j];

		t->axis[j] = axis;
		t->config.loop[j] = c->loop[axis];
		t->config.loop[j].kick_mm_s = t->config.loop[j].backlash_mm = 0;
		t->trial.truth[j] = config_loop_true(c, axis, j % 2);
	}
}

static void config_of(struct tuning *t)
{
	const struct config_contour *k = &t->run->config->contour;
	const double pulse_mm =
		t->run->job.program.head->pulse_mm[t->axis[0]];

	t->config.methods = (uint32_t)interp_compensate_parse(k->method);
	config_gains(t->run->config, &t->config.gains);
	t->config.naxes = t->path.naxes;
	t->config.period_s = (double)config_period_ns(t->run->config) * 1e-9;
	t->config.look_mm = LOOK_MM;
	t->config.noise = (struct interp_kalman_noise) {
		5, k->noise_mm + 0.3 * pulse_mm
	};
	t->trial.compensate = &t->config;
	t->trial.path = &t->path;
	t->trial.encoder_mm = pulse_mm;
	t->trial.noise_mm = k->noise_mm;
	t->trial.seed = t->run->o->seed_given ? t->run->o->seed : 1;
}

static bool has_pairs(const struct interp_program *p)
{
	for (uint32_t i = 0; i < p->head->nsegs; i++)
		if (p->segs[i].kind == INTERP_PAIR)
			return true;
	return false;
}

static int check_job(const struct sim_run *r)
{
	const int axis = axis_unknown(r);
	char found[48];

	if (has_pairs(&r->job.program))
		return refuse("the job has two contours at once",
			      "one of lines and arcs");
	if (!(r->job.program.head->length_mm > 0))
		return refuse("the job does not move", "one that does");
	if (axis < 0)
		return 0;
	snprintf(found, sizeof(found), "[axis.%c] has no loop_gain_1_s",
		 INTERP_AXIS_LETTERS[axis]);
	return refuse(found, "edmctl identify finds it from a trace");
}

static void watch(struct tuning *t)
{
	t->way = (struct interp_at_path) { &t->run->job.program, &t->last };
	interp_program_path(&t->way, &t->path);
	loops_of(t);
	config_of(t);
	t->run->on_cycle = sample;
	t->run->on_cycle_arg = t;
}

/* The first model whose position loop swings by itself, and the gain at which
 * this begins; -1: none. */
static int swings(const struct tuning *t, double *ret_max_1_s)
{
	for (int j = 0; j < t->path.naxes; j++) {
		const struct interp_axis_loop *l = &t->trial.truth[j];
		struct interp_axis_model m;

		if (interp_axis_model_init(&m, l, t->config.period_s, 0) < 0)
			continue;
		*ret_max_1_s = interp_axis_model_gain_max_1_s(&m);
		if (l->gain_1_s >= *ret_max_1_s)
			return j;
	}
	return -1;
}

static int check_loops(const struct tuning *t)
{
	char found[80], wanted[80];
	double max_1_s;
	const int j = swings(t, &max_1_s);
	double gain_1_s;

	if (j < 0)
		return 0;
	/* The message has the value of the machine file, not the one that may
	 * be true. */
	gain_1_s = t->config.loop[j].gain_1_s;
	max_1_s *= gain_1_s / t->trial.truth[j].gain_1_s;
	snprintf(found, sizeof(found), "[axis.%c] loop_gain_1_s = %g swings of "
		 "itself", INTERP_AXIS_LETTERS[t->axis[j]], gain_1_s);
	snprintf(wanted, sizeof(wanted), "below %.0f with its loop_hz, "
		 "loop_damping and loop_delay_s", max_1_s);
	return refuse(found, wanted);
}

static int check_method(const struct tuning *t)
{
	const uint32_t tuned = INTERP_COMPENSATE_FEEDFORWARD |
			       INTERP_COMPENSATE_CROSS |
			       INTERP_COMPENSATE_PREDICTIVE;
	const uint32_t methods = t->config.methods;
	char found[100];

	if (methods & tuned)
		return 0;
	snprintf(found, sizeof(found), "[contour] method = %.40s has no gains "
		 "to find", t->run->config->contour.method);
	return refuse(found, "feedforward, cross-coupled or predictive, "
		      "joined by +; zpetc beside the last two");
}

static int prepare(struct tuning *t)
{
	int err = check_job(t->run);

	if (err)
		return err;
	watch(t);
	err = check_loops(t);
	if (err)
		return err;
	err = check_method(t);
	if (err)
		return err;
	err = run_job(t->run);
	if (err == 0 && t->rows.full)
		return refuse("the job takes too long", "a piece of it, of at "
			      "most 2000000 periods");
	return err == 0 && !fill(t) ? EX_OSERR : err;
}

static void print_gains(const struct tuning *t,
			const struct interp_compensate_gains *g)
{
	const uint32_t m = t->config.methods;
	const int d = INTERP_TUNE_DIGITS;

	printf("[contour]\nmethod = %s\n", t->run->config->contour.method);
	if (m & INTERP_COMPENSATE_FEEDFORWARD)
		printf("speed = %.*g\nacceleration = %.*g\n"
		       "lead_periods = %.*g\n",
		       d, g->velocity, d, g->acceleration, d, g->lead_periods);
	if (m & INTERP_COMPENSATE_CROSS)
		printf("cross_1_s = %.*g\n", d, g->cross_1_s);
	if (m & INTERP_COMPENSATE_PREDICTIVE)
		printf("predicted_1_s = %.*g\nmeasured_1_s = %.*g\n"
		       "horizon_s = %.*g\n", d, g->predicted_1_s,
		       d, g->measured_1_s, d, g->horizon_s);
}

static int try_out(struct tuning *t, const char *what, uint32_t methods,
		   const struct interp_compensate_gains *g)
{
	struct interp_compensate_config c = t->config;
	struct interp_trial_result r;

	c.methods = methods;
	c.gains = *g;
	t->trial.compensate = &c;
	if (interp_trial_run(&t->trial, &r) < 0)
		return refuse("the gains of [contour] are out of range",
			      "a horizon_s of at most 64 periods");
	t->trial.compensate = &t->config;
	printf("# %s: %.2f um largest, %.3f um mean\n", what, r.max_mm * 1e3,
	       r.mean_mm * 1e3);
	return 0;
}

static void tell(void *arg, unsigned int used, double best_um)
{
	const struct tuning *t = arg;
	char best[32];

	snprintf(best, sizeof(best), "cost %.2f um", best_um);
	trials_tell(&t->trials, used, best);
}

/* Find the smallest sum of the largest and ten times the mean contour error. */
static int find(struct tuning *t, struct interp_compensate_gains *ret)
{
	const struct sim_options *o = t->run->o;
	const struct interp_tune how = {
		.trial = t->trial,
		.budget = o->budget > 0 ? (unsigned int)o->budget : BUDGET,
		.method = INTERP_TUNE_GLOBAL,
		.on_trial = tell, .on_trial_arg = t,
	};
	double cost;
	int err;

	t->trials = trials_begin(o->quiet, how.budget);
	err = interp_tune_run(&how, ret, &cost);
	trials_end(&t->trials);
	return err;
}

static int tune(struct tuning *t)
{
	struct interp_compensate_gains g = t->config.gains;
	int err = try_out(t, "position loops alone", 0, &g);

	if (err == 0)
		err = try_out(t, "the gains it has", t->config.methods, &g);
	if (err)
		return err;
	if (find(t, &g) < 0)
		return refuse("its method has no gains",
			      "feedforward, cross-coupled or predictive");
	err = try_out(t, "these gains", t->config.methods, &g);
	print_gains(t, &g);
	return err;
}

static void forget(struct tuning *t)
{
	free(t->rows.u);
	for (int j = 0; j < INTERP_NAXES; j++)
		free(t->rows.mm[j]);
}

int tune_contour(struct sim_run *r)
{
	struct tuning t = { .run = r };
	int err = prepare(&t);

	if (err == 0)
		err = tune(&t);
	forget(&t);
	return err;
}

void tune_contour_watch(struct sim_run *r)
{
	struct tuning *t;
	double max_1_s;

	if (axis_unknown(r) >= 0 || has_pairs(&r->job.program) ||
	    !(r->job.program.head->length_mm > 0))
		return;
	t = calloc(1, sizeof(*t));
	if (!t)
		return;
	t->run = r;
	watch(t);
	if (swings(t, &max_1_s) < 0)
		return;
	r->on_cycle = NULL;
	r->on_cycle_arg = NULL;
	free(t);
}

void tune_contour_measure(struct sim_run *r)
{
	struct tuning *t = r->on_cycle_arg;
	struct interp_trial_result found;

	if (!t)
		return;
	if (!t->rows.full && fill(t) &&
	    interp_trial_run(&t->trial, &found) == 0) {
		r->result.contour_known = true;
		r->result.contour_mm_max = found.max_mm;
		r->result.contour_mm_mean = found.mean_mm;
	}
	forget(t);
	free(t);
	r->on_cycle_arg = NULL;
}
