/* SPDX-License-Identifier: Apache-2.0 */
/* models.c - gains that are found by optimisers, and a model that learns from
 * history */
#include "contour_try.h"
#include "tried/ridge.h"
#include "interp/tune.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

/* -- Tuning --------------------------------------------------------------- */

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
		     enum interp_tune_method method)
{
	const struct interp_tune t = {
		.trial = b->trial, .budget = BUDGET, .method = method,
	};
	struct interp_compensate_gains g;
	char name[60];
	double cost;

	snprintf(name, sizeof(name), "%s, from %s",
		 method == INTERP_TUNE_GLOBAL ? "global" : "local", from);
	if (interp_tune_run(&t, &g, &cost) == 0)
		print_tuned(s, name, &g, cost);
}

void table_tuning(struct speeds *s)
{
	const struct interp_compensate_gains none = { .horizon_s = 0.005 };
	struct bench b;

	printf("## Gains by an optimiser\n\nFeedforward, cross-coupled and "
	       "predictive work together. Each optimiser has %d\ntrials on the "
	       "first %d ms of the path, at 1000 mm/min on the real machine; "
	       "it\nbegins with all gains 0 or with the gains of the table "
	       "above. The result is\nthen tried on the whole path with other "
	       "noise. The gains are speed,\nacceleration, lead, cross, Kff, "
	       "Kfb (1/s) and the horizon (ms). The cost is the\nlargest error "
	       "plus ten times the mean error, um.\n\n| by | gains | cost | "
	       "500 | 1000 | 1500 |\n|---|---|---|---|---|---|\n",
	       BUDGET, PIECE);
	bench_make(&b, &s->feed[1], true);
	b.config.methods = INTERP_COMPENSATE_FEEDFORWARD |
			   INTERP_COMPENSATE_CROSS |
			   INTERP_COMPENSATE_PREDICTIVE;
	b.trial.n = PIECE;
	tune_row(s, &b, "those above", INTERP_TUNE_LOCAL);
	tune_row(s, &b, "those above", INTERP_TUNE_GLOBAL);
	b.config.gains = none;
	tune_row(s, &b, "0", INTERP_TUNE_LOCAL);
	tune_row(s, &b, "0", INTERP_TUNE_GLOBAL);
	bench_free(&b);
	printf("\nThe largest error has many local minima, so where the local "
	       "method ends depends\non where it begins. The global method "
	       "does not depend on a beginning, and needs\nno seed.\n\n");
}

/* -- What history teaches ------------------------------------------------- */

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

	printf("## A model learned from history\n\nThe difference between the "
	       "axis model and the encoder, um rms, before and after\na ridge "
	       "regression over features of the set motion, which was trained "
	       "on the\nbutterfly at 500 and 1500 mm/min. The regression is "
	       "kept only if it is better\non runs that it was not trained on. "
	       "The last columns have the contour error,\num, with feedforward "
	       "alone, and with the expected difference taken off the set\n"
	       "values as well.\n\n| run | trained on | X before | after | Y "
	       "before | after | wins | feedforward | and learned |\n"
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
