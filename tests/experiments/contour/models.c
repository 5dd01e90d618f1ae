/* SPDX-License-Identifier: Apache-2.0 */
/* models.c - gains found, loops identified, what history teaches */
#include "contour.h"
#include "interp/identify.h"
#include "interp/ridge.h"
#include "interp/tune.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

/* -- Tuning ------------------------------------------------------------------ */

#define BUDGET	150
#define PIECE	6000			/* set values tuned on */

static void print_tuned(struct speeds *s, const char *name,
			const struct interp_compensate_gains *g, double cost)
{
	printf("| %s | %.2f, %.2f, %.2f, %.0f, %.0f, %.0f, %.0f | %.2f |",
	       name, g->velocity, g->acceleration, g->lead_periods,
	       g->cross_1_s, g->predicted_1_s, g->measured_1_s,
	       g->horizon_s * 1e3, cost);
	for (int k = 0; k < 3; k++) {
		struct interp_trial_result r;
		struct bench b;

		bench_make(&b, &s->feed[k], true);
		b.config.methods = INTERP_COMPENSATE_FEEDFORWARD |
				   INTERP_COMPENSATE_CROSS |
				   INTERP_COMPENSATE_PREDICTIVE;
		b.config.gains = *g;
		b.trial.seed = 7;
		r = bench_run(&b);
		printf(" %.1f / %.2f |", r.max_mm * 1e3, r.mean_mm * 1e3);
		bench_free(&b);
	}
	printf("\n");
}

static void tune_row(struct speeds *s, struct bench *b, const char *from,
		     uint64_t seed)
{
	const struct interp_tune t = {
		.trial = b->trial, .budget = BUDGET, .seed = seed,
		.method = seed ? INTERP_TUNE_SWARM : INTERP_TUNE_SIMPLEX,
	};
	struct interp_compensate_gains g;
	char name[60];
	double cost;

	if (seed)
		snprintf(name, sizeof(name), "swarm %d, from %s", (int)seed,
			 from);
	else
		snprintf(name, sizeof(name), "simplex, from %s", from);
	if (interp_tune_run(&t, &g, &cost) == 0)
		print_tuned(s, name, &g, cost);
}

void table_tuning(struct speeds *s)
{
	const struct interp_compensate_gains none = { .horizon_s = 0.005 };
	struct bench b;

	printf("## Gains by an optimiser\n\n"
	       "Feedforward, cross-coupled and predictive together, %d trials "
	       "each on the first %d ms\nat 1000 mm/min on the real machine, "
	       "begun with every gain 0 or with those of the table\nabove; "
	       "then the whole path with other noise.  Gains: speed, "
	       "acceleration, lead, cross,\nKff, Kfb, 1/s, horizon, ms.  Cost: "
	       "largest and ten times the mean error, um.\n\n| by | gains | "
	       "cost | 500 | 1000 | 1500 |\n|---|---|---|---|---|---|\n",
	       BUDGET, PIECE);
	bench_make(&b, &s->feed[1], true);
	b.config.methods = INTERP_COMPENSATE_FEEDFORWARD |
			   INTERP_COMPENSATE_CROSS |
			   INTERP_COMPENSATE_PREDICTIVE;
	b.trial.n = PIECE;
	for (uint64_t seed = 0; seed < 3; seed++)
		tune_row(s, &b, "those above", seed);
	b.config.gains = none;
	for (uint64_t seed = 0; seed < 3; seed++)
		tune_row(s, &b, "0", seed);
	bench_free(&b);
	printf("\nBoth come to about the same cost.  From gains that are "
	       "about right the simplex is as good\nas any, and needs no "
	       "seed.\n\n");
}

/* -- Identification ---------------------------------------------------------- */

/* What a trace of the real machine holds of one axis. */
struct recorded {
	double *target, *actual;
	size_t n;
};

static void record(struct bench *b, int axis, struct recorded *r)
{
	double (*m)[INTERP_NAXES] = must(calloc(b->trial.n, sizeof(*m)));

	b->trial.measured_mm = m;
	bench_run(b);
	r->n = b->trial.n;
	r->target = must(calloc(r->n, sizeof(double)));
	r->actual = must(calloc(r->n, sizeof(double)));
	for (size_t i = 0; i < r->n; i++) {
		r->target[i] = b->set[axis][i];
		r->actual[i] = m[i][axis];
	}
	free(m);
}

static void print_number(const struct interp_identified *d,
			 enum interp_identify_id id, double truth)
{
	if (!d->sought[id])
		printf(" 0 |");
	else if (!d->told[id])
		printf(" not told |");
	else if (truth != 0)
		printf(" %.4g +- %.1g (%+.1f %%) |", d->value[id],
		       d->sigma[id], 100 * (d->value[id] / truth - 1));
	else
		printf(" %.2g +- %.1g |", d->value[id], d->sigma[id]);
}

static void identify_row(const char *what, struct bench *b, int axis)
{
	const struct interp_axis_loop *l = &b->trial.truth[axis];
	struct interp_identified d;
	struct recorded r;
	int err;

	record(b, axis, &r);
	err = interp_identify(&(struct interp_identify_trace) {
		r.target, r.actual, r.n, PERIOD_S }, &d);
	printf("| %s, %c |", what, "XY"[axis]);
	if (err) {
		printf(" refused | | | | | | | | |\n");
	} else {
		print_number(&d, INTERP_IDENTIFY_GAIN, l->gain_1_s);
		print_number(&d, INTERP_IDENTIFY_VELOCITY, l->velocity_hz);
		print_number(&d, INTERP_IDENTIFY_DAMPING, l->damping);
		print_number(&d, INTERP_IDENTIFY_DELAY, l->delay_s);
		print_number(&d, INTERP_IDENTIFY_FEEDFORWARD, l->feedforward);
		print_number(&d, INTERP_IDENTIFY_KICK, l->kick_mm_s);
		print_number(&d, INTERP_IDENTIFY_KICK_TIME, l->kick_s);
		print_number(&d, INTERP_IDENTIFY_BACKLASH, l->backlash_mm);
		printf(" %.2f |\n", d.left_mm * 1e3);
	}
	free(r.target);
	free(r.actual);
}

static void identify_pair(const char *what, struct feed *f, double delay_s,
			  double backlash_mm)
{
	struct bench b;

	bench_make(&b, f, true);
	for (int k = 0; k < 2; k++) {
		b.trial.truth[k].delay_s = delay_s;
		b.trial.truth[k].backlash_mm = backlash_mm;
	}
	for (int k = 0; k < 2; k++)
		identify_row(what, &b, k);
	bench_free(&b);
}

#define MADE	8000

static double at_one_speed(int i)
{
	return 0.002 * i;
}

/* At 10 mm/s it never turns. */
static double in_steps(int i)
{
	return 0.010 * i + (i > 0 && i / 250 % 2 ? 0.1 : 0);
}

static void identify_made(const char *what, struct feed *f, double (*at)(int),
			  double delay_s)
{
	const int room = INTERP_COMPENSATE_BEHIND + MADE +
			 INTERP_COMPENSATE_AHEAD + 1;
	struct feed made = *f;

	made.n = MADE;
	for (int k = 0; k < 2; k++) {
		made.mm[k] = (double *)must(calloc((size_t)room,
						   sizeof(double))) +
			     INTERP_COMPENSATE_BEHIND;
		for (int i = 0; i < room; i++)
			made.mm[k][i - INTERP_COMPENSATE_BEHIND] =
				at(i - INTERP_COMPENSATE_BEHIND);
	}
	identify_pair(what, &made, delay_s, 0);
	for (int k = 0; k < 2; k++)
		free(made.mm[k] - INTERP_COMPENSATE_BEHIND);
}

void table_identify(struct speeds *s)
{
	printf("## Loops identified from a trace\n\n"
	       "Traces of the real machine, target and encoder (1 um, 0.5 um "
	       "noise), position loops\nalone: value, one sigma, and how far "
	       "from the truth.\n\n| trace | gain, 1/s | velocity loop, Hz | "
	       "damping | delay, s | feedforward | kick, mm/s | decay, s | "
	       "backlash, mm | left, um |\n"
	       "|---|---|---|---|---|---|---|---|---|---|\n");
	identify_pair("butterfly 500", &s->feed[0], 0, 0);
	identify_pair("butterfly 1000", &s->feed[1], 0, 0);
	identify_pair("butterfly 1500", &s->feed[2], 0, 0);
	identify_pair("1000, delay 2 ms", &s->feed[1], 0.002, 0);
	identify_pair("1000, backlash 5 um", &s->feed[1], 0, 0.005);
	identify_made("steps of 0.1 mm on a ramp", &s->feed[1], in_steps, 0);
	identify_made("the same, delay 2 ms", &s->feed[1], in_steps, 0.002);
	identify_made("a line at one speed", &s->feed[1], at_one_speed, 0);
	printf("\nDelay and feedforward are sought only where the trace is not "
	       "explained without them.\nOn the butterfly a delay of 2 ms is: "
	       "it looks like a slower velocity loop, and only\nsteps tell "
	       "the two apart.  On the ramp the axis never turns: nothing is "
	       "told of friction\nand backlash.\n\n");
}

/* -- What history teaches ----------------------------------------------------- */

#define PRICE	1e-4

/* A run of the machine, and of the model beside it. */
struct history {
	double (*is)[INTERP_NAXES], (*model)[INTERP_NAXES];
	struct bench bench;
};

static void history_make(struct history *h, struct feed *f, uint64_t seed)
{
	struct bench model;

	h->is = must(calloc(f->n, sizeof(*h->is)));
	h->model = must(calloc(f->n, sizeof(*h->model)));
	bench_make(&model, f, false);
	model.config.methods = INTERP_COMPENSATE_FEEDFORWARD;
	model.trial.actual_mm = h->model;
	bench_run(&model);
	bench_free(&model);
	bench_make(&h->bench, f, true);
	h->bench.config.methods = INTERP_COMPENSATE_FEEDFORWARD;
	h->bench.trial.measured_mm = h->is;
	h->bench.trial.seed = seed;
	bench_run(&h->bench);
}

static void history_free(struct history *h)
{
	free(h->is);
	free(h->model);
	bench_free(&h->bench);
}

/* Each period: the features, and what the model missed. */
static void each_row(const struct history *h, int axis,
		     void (*take)(void *arg, const double *x, double missed),
		     void *arg)
{
	double x[INTERP_RIDGE_NFEATURES];
	struct interp_ridge_motion m;

	interp_ridge_motion_init(&m, PERIOD_S);
	for (size_t i = 0; i < h->bench.trial.n; i++) {
		interp_ridge_features(&m, h->bench.set[axis] + i, x);
		take(arg, x, h->is[i][axis] - h->model[i][axis]);
	}
}

static void learn(void *arg, const double *x, double missed)
{
	interp_ridge_add(arg, x, missed);
}

struct judged {
	const struct interp_ridge *ridge;
	double before, after, rows;
};

/* A row of set values being corrected. */
struct corrected {
	const struct interp_ridge *ridge;
	double *at;
};

static void judge(void *arg, const double *x, double missed)
{
	struct judged *j = arg;
	const double left = missed - interp_ridge_eval(j->ridge, x);

	j->before += missed * missed;
	j->after += left * left;
	j->rows++;
}

static void train(struct speeds *s, struct interp_ridge ridge[2])
{
	struct history h;

	for (int axis = 0; axis < 2; axis++) {
		struct interp_ridge_training t = { 0 };

		for (int k = 0; k < 3; k += 2) {
			history_make(&h, &s->feed[k], (uint64_t)k);
			each_row(&h, axis, learn, &t);
			history_free(&h);
		}
		if (interp_ridge_solve(&t, PRICE, &ridge[axis]) < 0)
			exit(1);
	}
}

static void correct(void *arg, const double *x, double missed)
{
	struct corrected *c = arg;

	(void)missed;
	*c->at++ -= interp_ridge_eval(c->ridge, x);
}

/* The set values less what the machine is expected to miss them by. */
static void print_corrected(struct history *h, const struct interp_ridge *ridge)
{
	const size_t n = h->bench.trial.n;
	struct interp_trial_result before, after;

	before = bench_run(&h->bench);
	for (int axis = 0; axis < 2; axis++) {
		double *set = must(calloc(n, sizeof(*set)));
		struct corrected c = { &ridge[axis], set };

		memcpy(set, h->bench.set[axis], n * sizeof(*set));
		each_row(h, axis, correct, &c);
		memcpy(h->bench.set[axis], set, n * sizeof(*set));
		free(set);
	}
	after = bench_run(&h->bench);
	printf(" %.1f / %.2f | %.1f / %.2f |", before.max_mm * 1e3,
	       before.mean_mm * 1e3, after.max_mm * 1e3, after.mean_mm * 1e3);
}

void table_learned(struct speeds *s)
{
	static const char *const names[] = { "infinity", "circle" };
	struct interp_ridge ridge[2];

	printf("## A model learned from history\n\n"
	       "What the axis model misses of the encoder, um rms, before and "
	       "after a ridge regression\nover features of the set motion, "
	       "trained on the butterfly at 500 and 1500 mm/min.  It is\nkept "
	       "only if it wins on runs it was not trained on.  Last, the "
	       "contour error, um, with\nfeedforward alone, and with what it "
	       "expects to be missed taken off the set values.\n\n"
	       "| run | trained on | X before | after | Y before | after | "
	       "wins | feedforward | and learned |\n"
	       "|---|---|---|---|---|---|---|---|---|\n");
	train(s, ridge);
	for (int k = 0; k < 5; k++) {
		struct history h;
		struct spline c;
		struct feed f;
		bool wins = true;

		if (k > 2) {
			spline_load(&c, names[k - 3]);
			feed_make(&f, &c, 1000);
		}
		history_make(&h, k > 2 ? &f : &s->feed[k], 10 + (uint64_t)k);
		if (k > 2)
			printf("| %s 1000 | no |", names[k - 3]);
		else
			printf("| butterfly %g | %s |", speed_mm_min[k],
			       k == 1 ? "no" : "yes, other noise");
		for (int axis = 0; axis < 2; axis++) {
			struct judged j = { .ridge = &ridge[axis] };

			each_row(&h, axis, judge, &j);
			printf(" %.3f | %.3f |", 1e3 * sqrt(j.before / j.rows),
			       1e3 * sqrt(j.after / j.rows));
			wins &= j.after < j.before;
		}
		printf(" %s |", wins ? "yes" : "no");
		print_corrected(&h, ridge);
		printf("\n");
		history_free(&h);
		if (k > 2)
			feed_free(&f);
	}
	printf("\n");
}
