/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curves.c - feed fluctuation and chord error of each way of stepping along
 * three curves of the literature
 *
 *	curves			tables in Markdown
 *	curves steps N		the steps of way N along the butterfly at 100
 *				mm/s and 2 ms, for a picture
 */
#include "curves.h"
#include "interp/nurbs_way.h"
#include "interp/nurbs_length.h"
#include "tried/nurbs_step.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define LIMIT_MM	0.001
#define LOOKS		100		/* into each chord */
#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

struct way {
	const char *name;
	enum interp_nurbs_method method;
	double limit_mm;
};

static const struct way ways[] = {
	{ "equal-parameter", INTERP_NURBS_EQUAL_PARAMETER, 0 },
	{ "equal-chord", INTERP_NURBS_EQUAL_CHORD, 0 },
	{ "taylor2", INTERP_NURBS_TAYLOR2, 0 },
	{ "predictor-corrector, no limit", INTERP_NURBS_PREDICTOR_CORRECTOR,
	  0 },
	{ "predictor-corrector, 1 um", INTERP_NURBS_PREDICTOR_CORRECTOR,
	  LIMIT_MM },
};

static const double feeds_mm_s[] = { 25, 100, 200 };
static const double periods_ms[] = { 1, 2 };

struct tally {
	int steps, limited, back;
	double feed_max, feed_sum2;	/* of steps not shortened; shares */
	double error_max_mm, error_sum_mm, slowest_mm;
};

static double off_mm(const struct interp_nurbs_point *a,
		     const struct interp_nurbs_point *b,
		     const struct interp_nurbs_point *p)
{
	const double x = b->d[0][0] - a->d[0][0], y = b->d[0][1] - a->d[0][1];
	const double px = p->d[0][0] - a->d[0][0];
	const double py = p->d[0][1] - a->d[0][1];
	const double l2 = x * x + y * y;
	const double along = l2 > 0 ? fmin(fmax((px * x + py * y) / l2, 0), 1) :
				      0;

	return hypot(px - along * x, py - along * y);
}

static double error_mm(struct interp_nurbs_eval *e, double from, double to)
{
	struct interp_nurbs_point a, b, p;
	double most = 0;

	interp_nurbs_at(e, from, 0, &a);
	interp_nurbs_at(e, to, 0, &b);
	for (int i = 1; i < LOOKS; i++) {
		interp_nurbs_at(e, from + (to - from) * i / LOOKS, 0, &p);
		most = fmax(most, off_mm(&a, &b, &p));
	}
	return most;
}

static void count(struct tally *t, const struct interp_nurbs_step *s,
		  double step_mm, double error)
{
	const double feed = fabs(s->chord_mm / step_mm - 1);

	t->steps++;
	t->error_max_mm = fmax(t->error_max_mm, error);
	t->error_sum_mm += error;
	t->limited += s->limited;
	if (s->limited || s->ended) {
		if (s->limited)
			t->slowest_mm = fmin(t->slowest_mm, s->chord_mm);
		return;
	}
	t->feed_max = fmax(t->feed_max, feed);
	t->feed_sum2 += feed * feed;
}

static struct tally walk(const struct interp_nurbs *c, const struct way *w,
			 double step_mm, double length_mm)
{
	struct tally t = { .slowest_mm = step_mm };
	struct interp_nurbs_stepper s;
	struct interp_nurbs_step step;

	interp_nurbs_stepper_init(&s, c, interp_nurbs_first(c), w->method);
	s.chord_error_mm = w->limit_mm;
	s.mm_per_u = length_mm / (interp_nurbs_last(c) - interp_nurbs_first(c));
	do {
		const double u = s.u;

		step = interp_nurbs_step(&s, step_mm);
		t.back += s.u <= u;
		count(&t, &step, step_mm, error_mm(&s.e, u, s.u));
		if (t.steps > 2 * length_mm / step_mm + 1000)
			abort();
	} while (!step.ended);
	return t;
}

static void print_curve(const struct curve_data *d)
{
	double points[CURVES_POINTS_MAX][3], length_mm;
	struct interp_nurbs_eval e;
	struct interp_nurbs_way way;
	struct interp_nurbs c;
	double sharpest = 0;

	curve_load(d, points, &c);
	interp_nurbs_open(&e, &c);
	length_mm = interp_nurbs_length(&e, 0, 1, 1e-9);
	for (int i = 0; i <= 100000; i++) {
		interp_nurbs_way(&e, i / 100000.0, &way);
		sharpest = fmax(sharpest, sqrt(interp_nurbs_dot(
				&c, way.d[1], way.d[1])));
	}
	printf("| %s | %u | %u | %.4f | %.4f |\n", d->name, d->degree,
	       d->npoints, length_mm, 1 / sharpest);
}

static void print_ways(const struct curve_data *d, double feed_mm_s,
		       double period_ms)
{
	const double step_mm = feed_mm_s * period_ms / 1000;
	double points[CURVES_POINTS_MAX][3], length_mm;
	struct interp_nurbs_eval e;
	struct interp_nurbs c;

	curve_load(d, points, &c);
	interp_nurbs_open(&e, &c);
	length_mm = interp_nurbs_length(&e, 0, 1, 1e-9);
	for (size_t i = 0; i < COUNT(ways); i++) {
		const struct tally t = walk(&c, &ways[i], step_mm, length_mm);

		printf("| %s | %g, %g | %s | %d | %.2g | %.2g | %.4f | %.4f | "
		       "%d | %.4g | %d |\n", d->name, feed_mm_s, period_ms,
		       ways[i].name, t.steps, 100 * t.feed_max,
		       100 * sqrt(t.feed_sum2 / t.steps),
		       1000 * t.error_max_mm, 1000 * t.error_sum_mm / t.steps,
		       t.limited, 1000 * t.slowest_mm / period_ms, t.back);
	}
}

/* Place, chord and error of each step. */
static void print_steps(const struct way *w, double step_mm)
{
	double points[CURVES_POINTS_MAX][3], place_mm = 0;
	struct interp_nurbs_stepper s;
	struct interp_nurbs_step step;
	struct interp_nurbs_eval e;
	struct interp_nurbs c;

	curve_load(&curves_data[2], points, &c);
	interp_nurbs_open(&e, &c);
	interp_nurbs_stepper_init(&s, &c, 0, w->method);
	s.chord_error_mm = w->limit_mm;
	s.mm_per_u = interp_nurbs_length(&e, 0, 1, 1e-9);
	do {
		const double u = s.u;

		step = interp_nurbs_step(&s, step_mm);
		printf("%.5f %.6f %.6f\n", place_mm, 1000 * step.chord_mm / 2,
		       1000 * error_mm(&s.e, u, s.u));
		if (s.u > u)
			place_mm += interp_nurbs_length(&e, u, s.u, 1e-6);
	} while (!step.ended);
}

int main(int argc, char **argv)
{
	if (argc == 3) {
		print_steps(&ways[(size_t)atoi(argv[2]) % COUNT(ways)], 0.2);
		return 0;
	}
	printf("\n## The curves\n\n"
	       "| curve | degree | control points | length mm | "
	       "smallest radius mm |\n|---|---|---|---|---|\n");
	for (size_t i = 0; i < NCURVES; i++)
		print_curve(&curves_data[i]);
	printf("\n## Steps of time\n\n| curve | feed mm/s, period ms | method |"
	       " steps | feed off, most %% | rms %% | chord error, most um | "
	       "mean um | shortened | slowest mm/s | back |\n"
	       "|---|---|---|---|---|---|---|---|---|---|---|\n");
	for (size_t i = 0; i < NCURVES; i++) {
		for (size_t f = 0; f < COUNT(feeds_mm_s); f++) {
			for (size_t t = 0; t < COUNT(periods_ms); t++)
				print_ways(&curves_data[i], feeds_mm_s[f],
					   periods_ms[t]);
		}
	}
	return 0;
}
