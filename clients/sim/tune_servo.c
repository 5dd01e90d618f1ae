/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tune_servo.c - finds the best values of [gap] and [jump]
 *
 * The search uses the logarithms of the values.  First it tries the points of a
 * Halton sequence, a third of the budget, to find the region.  Then it uses the
 * local method of interp/minimise.h from the best of them.  Nothing is random:
 * the same job is always tuned in the same way.
 */
#include "tune_servo.h"
#include "keys.h"

#include "interp/minimise.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TRAIN_SEEDS	4
#define TEST_SEEDS	8
#define TEST_FROM	1000000		/* far from the seeds that are used for
					 * tuning */
#define BUDGET		200		/* trials */
#define LIMIT_S		60
#define DIGITS		3		/* of a value */
#define SCREEN_PART	3		/* one part of the budget in so many */
#define COUNT(a)	(sizeof(a) / sizeof((a)[0]))

/* -- How good a trial is
 * ---------------------------------------------------- */

/* A little less is a little better; more is ten times as bad. */
static double worse(double now, double was)
{
	const double x = log(now / was);

	return 0.1 * x + 0.9 * fmax(x, 0);
}

double tune_score(const struct trial_sum *s, const struct trial_sum *ref)
{
	const double least = 1e-6;
	const double faults = (double)s->faults / s->runs -
			      (double)ref->faults / ref->runs;

	return log((s->removal_mm3_min + least) /
		   (ref->removal_mm3_min + least)) -
	       worse(1 + s->shorts_min, 1 + ref->shorts_min) -
	       worse(1 + s->arcs_min, 1 + ref->arcs_min) -
	       worse(1 + s->burns_min, 1 + ref->burns_min) -
	       worse(s->wear_mm_mm3 + least, ref->wear_mm_mm3 + least) -
	       2 * faults;
}

/* -- Values --------------------------------------------------------------- */

double tune_value(const struct tune_key *k, const struct machine_config *c)
{
	return *(const double *)config_key_in(config_key(k->row), 0, c);
}

static double as_written(const struct tune_key *k, double v)
{
	char text[32];

	snprintf(text, sizeof(text), "%.*g", DIGITS, v);
	v = fmin(fmax(strtod(text, NULL), k->min), k->max);
	return k->none_above > 0 && v >= k->none_above ? 0 : v;
}

static void put_values(const struct tune *t, const double *x,
		       struct machine_config *c)
{
	for (uint32_t i = 0; i < t->nkeys; i++) {
		const struct tune_key *k = &t->key[i];
		double *v = config_key_at(config_key(k->row), 0, c);

		*v = as_written(k, k->min * pow(k->max / k->min, x[i]));
	}
}

static double place_of(const struct tune_key *k, double v)
{
	if (v <= 0)
		v = k->max;
	return fmin(fmax(log(v / k->min) / log(k->max / k->min), 0), 1);
}

/* -- Which keys ----------------------------------------------------------- */

struct candidate {
	enum config_section_id section;
	const char *name;
	double min, max, none_above;
	int tech;			/* the field of a condition that
					 * replaces it; -1: none */
};

static const struct candidate servo_keys[] = {
	{ SECTION_GAP, "feed_gain_mm_s_v", 0.0005, 0.5, 0,
	  INTERP_TECH_GAIN_MM_S_V },
	{ SECTION_GAP, "integral_s", 0.02, 20, 15, INTERP_TECH_INTEGRAL_S },
	{ SECTION_GAP, "retract_mm_s", 0.5, 20, 0, INTERP_TECH_RETRACT_MM_S },
};

static const struct candidate jump_keys[] = {
	{ SECTION_JUMP, "every_s", 0.1, 20, 0, INTERP_TECH_JUMP_EVERY_S },
	{ SECTION_JUMP, "height_mm", 0.1, 20, 0, INTERP_TECH_JUMP_MM },
};

static const struct candidate adaptive_keys[] = {
	{ SECTION_JUMP, "every_min_s", 0.1, 20, 0, -1 },
	{ SECTION_JUMP, "height_mm", 0.1, 20, 0, INTERP_TECH_JUMP_MM },
	{ SECTION_JUMP, "bad_share", 0.001, 0.3, 0, -1 },
};

/* A value that a condition gives does not come from the machine file, so it
 * cannot be tuned there. */
static bool is_given(const struct sim_job *job, int tech)
{
	const struct interp_program *p = &job->program;

	for (uint32_t i = 0; tech >= 0 && i < p->head->nconds; i++)
		if (interp_tech_given(&p->conds[i].tech,
				      (enum interp_tech_id)tech))
			return true;
	return false;
}

static void take_keys(struct tune *t, const struct candidate *a, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		if (is_given(t->train.job, a[i].tech)) {
			fprintf(stderr, "edmsim: %s is not tuned: a condition "
				"of the job gives it\n", a[i].name);
			continue;
		}
		t->key[t->nkeys++] = (struct tune_key) {
			config_key_find(a[i].section, a[i].name),
			a[i].min, a[i].max, a[i].none_above,
		};
	}
}

static void choose_keys(struct tune *t)
{
	const struct cycle_gap_config *g = &t->was->gap;
	/* If the upper end of the window is set, the servo holds that. */
	const struct candidate held = {
		SECTION_GAP, g->window_high_v > 0 ? "window_high_v" : "servo_v",
		fmax(g->short_v * 1.05, fmax(g->window_low_v, 0.1)),
		g->open_v * 0.95, 0,
		g->window_high_v > 0 ? INTERP_TECH_WINDOW_HIGH_V :
				       INTERP_TECH_SERVO_V,
	};

	take_keys(t, &held, 1);
	take_keys(t, servo_keys, COUNT(servo_keys));
	if (g->process == PROCESS_WIRE || t->was->jump.height_mm <= 0)
		return;
	if (t->was->jump.adaptive)
		take_keys(t, adaptive_keys, COUNT(adaptive_keys));
	else
		take_keys(t, jump_keys, COUNT(jump_keys));
}

/* -- The search ----------------------------------------------------------- */

static void progress(const struct tune *t)
{
	char best[80];

	snprintf(best, sizeof(best), "%+.3f: %.4g mm3/min, %.3g shorts/min",
		 t->score, t->after.removal_mm3_min, t->after.shorts_min);
	trials_tell(&t->trials, t->used, best);
}

static bool can_be(const struct machine_config *c)
{
	static const struct config_lines no_lines;
	struct interp_diag d = { 0 };

	return config_check(c, &no_lines, &d) == 0;
}

/* Return NAN quickly after the search was told to stop. */
static double cost(void *arg, const double *x)
{
	struct tune *t = arg;
	struct machine_config c = *t->was;
	struct trial_sum sum;
	double score;

	if (t->e)
		return NAN;
	put_values(t, x, &c);
	t->used++;
	if (!can_be(&c))
		return NAN;
	t->e = trial_run(&t->train, &c, &sum);
	if (t->e)
		return NAN;
	score = tune_score(&sum, &t->before);
	if (score > t->score) {
		t->score = score;
		t->after = sum;
		t->now = c;
		t->better = true;
	}
	progress(t);
	return -score;
}

static double radical_inverse(uint32_t i, uint32_t base)
{
	double x = 0, digit = 1;

	for (; i; i /= base) {
		digit /= base;
		x += digit * (i % base);
	}
	return x;
}

/* In the later dimensions, the first points of the sequence lie on a line. */
static void screen(struct tune *t)
{
	static const uint32_t primes[] = { 2, 3, 5, 7, 11, 13, 17, 19 };
	const uint32_t first = 20, n = t->budget / SCREEN_PART;

	_Static_assert(COUNT(primes) == TUNE_KEYS_MAX, "one for each key");
	for (uint32_t k = first; k < first + n && !t->e; k++) {
		double x[TUNE_KEYS_MAX];

		for (uint32_t i = 0; i < t->nkeys; i++)
			x[i] = radical_inverse(k, primes[i]);
		cost(t, x);
	}
}

static void look(struct tune *t)
{
	struct interp_minimise m = { .n = (int)t->nkeys, .cost = cost,
				     .arg = t };
	double x[INTERP_MINIMISE_NMAX], least;

	screen(t);
	for (uint32_t i = 0; i < t->nkeys; i++) {
		x[i] = place_of(&t->key[i], tune_value(&t->key[i], &t->now));
		m.high[i] = 1;
	}
	m.budget = t->budget - t->used;
	if (interp_minimise_local(&m, x, &least) == -ENOMEM)
		t->e = EX_OSERR;
	trials_end(&t->trials);
}

static int test(struct tune *t)
{
	int err = trial_run(&t->test, t->was, &t->test_before);

	if (err == 0)
		err = trial_run(&t->test, &t->now, &t->test_after);
	t->tested = err == 0;
	if (t->tested)
		t->test_score = tune_score(&t->test_after, &t->test_before);
	return err;
}

static int search_and_test(struct tune *t)
{
	int e = trial_run(&t->train, t->was, &t->before);

	if (e == 0) {
		t->after = t->before;
		look(t);
		e = t->e;
	}
	if (e == 0 && t->better)
		e = test(t);
	t->interrupted = e == -EINTR;
	return t->interrupted ? 0 : e;
}

static int refuse(const char *found, const char *wanted)
{
	fprintf(stderr, "edmsim: --tune: %s; %s\n", found, wanted);
	return EX_USAGE;
}

static struct trial trial_from(const struct sim_options *o,
			       const struct sim_job *job, uint64_t seed,
			       uint32_t seeds)
{
	return (struct trial) {
		.o = o, .job = job, .seed = seed, .seeds = seeds,
		.limit_s = o->limit_s > 0 ? o->limit_s : LIMIT_S,
	};
}

int tune_servo(const struct sim_options *o, const struct machine_config *c,
	     const struct sim_job *job)
{
	const uint64_t seed = o->seed_given ? o->seed : (uint64_t)c->sim.seed;
	static struct tune t;
	int err;

	t.was = c;
	t.now = *c;
	t.budget = o->budget > 0 ? (uint32_t)o->budget : BUDGET;
	t.train = trial_from(o, job, seed, TRAIN_SEEDS);
	t.test = trial_from(o, job, seed + TEST_FROM, TEST_SEEDS);
	if (!config_machine_is(c, MACHINE_MODEL) || o->dry_run)
		return refuse("no gap to tune for",
			      "[machine] backend = sim, and no --dry-run");
	choose_keys(&t);
	if (t.nkeys == 0)
		return refuse("the job's conditions give every key",
			      "a job, or a table, that leaves some to the "
			      "machine file");
	t.trials = trials_begin(o->quiet, t.budget);
	err = search_and_test(&t);
	if (err)
		return err;
	if (o->json)
		err = tune_write(&t, stdout);
	else
		tune_print(&t, stdout);
	return err ? err : t.interrupted;
}
