/* SPDX-License-Identifier: Apache-2.0 */
/* identify.c - loops that are identified from traces, and the worst of many */
#include "contour_try.h"
#include "interp/identify.h"

#include <math.h>
#include <stdlib.h>

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

static void forget(struct recorded *r)
{
	free(r->target);
	free(r->actual);
}

static int identify(const struct recorded *r, struct interp_identified *ret)
{
	return interp_identify(&(struct interp_identify_trace) {
		.target_mm = r->target, .actual_mm = r->actual, .n = r->n,
		.period_s = PERIOD_S }, ret);
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
	err = identify(&r, &d);
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
	forget(&r);
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

#define MADE	12500

static double at_one_speed(int i)
{
	return 0.002 * i;
}

/* At 10 mm/s it never turns. */
static double in_steps(int i)
{
	return 0.010 * i + (i > 0 && i / 250 % 2 ? 0.1 : 0);
}

/* One axis of examples/identify.ngc: rings as fast as 500 mm/s^2 permits. */
static double in_rings(int i)
{
	static const struct ring {
		double mm;
		int turns;
	} rings[] = {
		{ 2, 5 }, { 0.5, 10 }, { 0.1, 20 }, { 0.05, 20 }, { 0.02, 60 },
		{ 0.01, 100 },
	};
	double s = i * PERIOD_S;

	for (size_t k = 0; i > 0 && k < sizeof(rings) / sizeof(rings[0]); k++) {
		const double turn_s = 2 * M_PI * sqrt(rings[k].mm / 500);

		if (s < rings[k].turns * turn_s)
			return rings[k].mm * (1 - cos(2 * M_PI * s / turn_s));
		s -= rings[k].turns * turn_s;
	}
	return 0;
}

/* Both axes at @at. */
static void made_make(struct feed *made, struct feed *f, double (*at)(int))
{
	const int room = INTERP_COMPENSATE_BEHIND + MADE +
			 INTERP_COMPENSATE_AHEAD + 1;

	*made = *f;
	made->n = MADE;
	for (int k = 0; k < 2; k++) {
		made->mm[k] = (double *)must(calloc((size_t)room,
						    sizeof(double))) +
			      INTERP_COMPENSATE_BEHIND;
		for (int i = 0; i < room; i++)
			made->mm[k][i - INTERP_COMPENSATE_BEHIND] =
				at(i - INTERP_COMPENSATE_BEHIND);
	}
}

static void made_free(struct feed *made)
{
	for (int k = 0; k < 2; k++)
		free(made->mm[k] - INTERP_COMPENSATE_BEHIND);
}

static void identify_made(const char *what, struct feed *f, double (*at)(int),
			  double delay_s)
{
	struct feed made;

	made_make(&made, f, at);
	identify_pair(what, &made, delay_s, 0);
	made_free(&made);
}

/* -- The worst of many ---------------------------------------------------- */

#define SEEDS	20

struct worst {
	double part[INTERP_NIDENTIFY];
	int told[INTERP_NIDENTIFY];
};

static void judge(struct worst *w, const struct interp_identified *d,
		  const struct interp_axis_loop *l)
{
	const double truth[INTERP_NIDENTIFY] = {
		l->gain_1_s, l->velocity_hz, l->damping, l->delay_s,
		l->feedforward, l->kick_mm_s, l->kick_s, l->backlash_mm,
	};

	for (int i = 0; i < INTERP_NIDENTIFY; i++) {
		/* What is not there must not be told at all. */
		const double part = truth[i] != 0 ? d->value[i] / truth[i] - 1 :
						    INFINITY;

		if (!d->told[i])
			continue;
		w->told[i]++;
		w->part[i] = fmax(w->part[i], fabs(part));
	}
}

static void worst_row(const char *what, struct feed *f, double delay_s,
		      double backlash_mm)
{
	for (int axis = 0; axis < 2; axis++) {
		struct worst w = { 0 };
		struct bench b;

		bench_make(&b, f, true);
		b.trial.truth[axis].delay_s = delay_s;
		b.trial.truth[axis].backlash_mm = backlash_mm;
		for (uint64_t seed = 1; seed <= SEEDS; seed++) {
			struct interp_identified d = { 0 };
			struct recorded r;

			b.trial.seed = seed;
			record(&b, axis, &r);
			if (identify(&r, &d) == 0)
				judge(&w, &d, &b.trial.truth[axis]);
			forget(&r);
		}
		printf("| %s, %c |", what, "XY"[axis]);
		for (int i = 0; i < INTERP_NIDENTIFY; i++)
			if (w.told[i] == SEEDS)
				printf(" %.1f |", 100 * w.part[i]);
			else if (w.told[i])
				printf(" %.1f (%d) |", 100 * w.part[i],
				       w.told[i]);
			else
				printf(" |");
		printf("\n");
		fflush(stdout);
		bench_free(&b);
	}
}

static void table_worst(struct speeds *s)
{
	struct feed rings;

	made_make(&rings, &s->feed[1], in_rings);
	printf("The worst of %d traces, each with its own noise, in %% of the "
	       "truth. If not all\ntraces told the number, brackets have how "
	       "many did.\n\n| trace | gain | velocity loop | damping | delay "
	       "| feedforward | kick | decay | backlash |\n"
	       "|---|---|---|---|---|---|---|---|---|\n", SEEDS);
	for (int k = 0; k < 3; k++) {
		char name[40];

		snprintf(name, sizeof(name), "butterfly %g", speed_mm_min[k]);
		worst_row(name, &s->feed[k], 0, 0);
	}
	worst_row("butterfly 1000, backlash 5 um", &s->feed[1], 0, 0.005);
	worst_row("rings", &rings, 0, 0);
	worst_row("rings, backlash 5 um", &rings, 0, 0.005);
	worst_row("rings, delay 2 ms", &rings, 0.002, 0);
	printf("\nThe slow butterfly hardly excites the velocity loop. Where "
	       "an axis hardly\nmoves, the sum of squares has more than one "
	       "minimum, and a value may be wrong\nby several of its sigma.\n\n");
	made_free(&rings);
}

void table_identify(struct speeds *s)
{
	printf("## Loops identified from a trace\n\nWhat is found from traces "
	       "of the real machine, of target and encoder (steps of\n1 um, "
	       "noise of 0.5 um), with the position loops alone. Each cell has "
	       "the value,\none sigma, and the distance from the truth.\n\n| "
	       "trace | gain, 1/s | velocity loop, Hz | damping | delay, s | "
	       "feedforward | kick, mm/s | decay, s | backlash, mm | left, um "
	       "|\n|---|---|---|---|---|---|---|---|---|---|\n");
	identify_pair("butterfly 500", &s->feed[0], 0, 0);
	identify_pair("butterfly 1000", &s->feed[1], 0, 0);
	identify_pair("butterfly 1500", &s->feed[2], 0, 0);
	identify_pair("1000, delay 2 ms", &s->feed[1], 0.002, 0);
	identify_pair("1000, backlash 5 um", &s->feed[1], 0, 0.005);
	identify_made("steps of 0.1 mm on a ramp", &s->feed[1], in_steps, 0);
	identify_made("the same, delay 2 ms", &s->feed[1], in_steps, 0.002);
	identify_made("rings", &s->feed[1], in_rings, 0);
	identify_made("rings, delay 2 ms", &s->feed[1], in_rings, 0.002);
	identify_made("a line at one speed", &s->feed[1], at_one_speed, 0);
	printf("\nThe rings are those of examples/identify.ngc, of 2 mm down "
	       "to 0.01 mm. They\nreverse often, and fast enough to tell the "
	       "velocity loop from a delay. Delay\nand feedforward are looked "
	       "for only where the trace cannot be explained without\nthem. On "
	       "the butterfly a delay of 2 ms can be explained without: it "
	       "looks like\na slower velocity loop. On the ramp the axis never "
	       "reverses, so it tells\nnothing of friction and backlash.\n\n");
	table_worst(s);
}
