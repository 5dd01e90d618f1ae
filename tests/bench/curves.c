/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curves.c - nanoseconds a point of a curve of six axes: interpolated by the
 * default, with and without a limit of chord error, and evaluated alone, beside
 * SISL
 */
#include "bench.h"

#include "tried/nurbs_step.h"
#include "random_curve.h"

#include <sisl.h>

#define POINTS		20
#define AXES		6
#define EVALUATIONS	200000
#define STEP_MM		0.1

/* Like a blade's section: a smooth wave in every axis. */
static void smooth_curve(struct random_curve *r, uint32_t degree)
{
	r->c = (struct interp_nurbs) {
		.degree = degree, .naxes = AXES, .npoints = POINTS,
		.counted = 3, .knots = r->knots, .points = r->points,
	};
	for (uint32_t i = 0; i < POINTS + degree + 1; i++)
		r->knots[i] = i <= degree ? 0 : i >= POINTS ? 1 :
			      (i - degree) / (double)(POINTS - degree);
	for (uint32_t i = 0; i < POINTS; i++) {
		double *row = r->points + i * (AXES + 1);

		row[AXES] = 1 + 0.2 * (i % 2);
		for (uint32_t j = 0; j < AXES; j++)
			row[j] = row[AXES] * 100 * sin(0.4 * i + j);
	}
}

static double step_ns(const struct interp_nurbs *c, double limit_mm)
{
	struct interp_nurbs_stepper s;
	const double from_s = bench_now_s();
	uint32_t n = 0;

	interp_nurbs_stepper_init(&s, c, 0, INTERP_NURBS_PREDICTOR_CORRECTOR);
	s.chord_error_mm = limit_mm;
	while (!interp_nurbs_step(&s, STEP_MM).ended)
		n++;
	return (bench_now_s() - from_s) * 1e9 / n;
}

static double at_ns(const struct interp_nurbs *c)
{
	struct interp_nurbs_eval e;
	const double from_s = bench_now_s();

	interp_nurbs_open(&e, c);
	for (int i = 0; i < EVALUATIONS; i++) {
		struct interp_nurbs_point p;

		interp_nurbs_at(&e, i / (double)EVALUATIONS, 2, &p);
		__asm__ volatile("" : : "m"(p));
	}
	return (bench_now_s() - from_s) * 1e9 / EVALUATIONS;
}

static double sisl_ns(struct random_curve *r)
{
	SISLCurve *c = newCurve(POINTS, (int)r->c.degree + 1, r->knots,
				r->points, 2, AXES, 1);
	double p[3 * AXES], from_s;
	int left = 0, status;

	if (!c)
		exit(70);
	from_s = bench_now_s();
	for (int i = 0; i < EVALUATIONS; i++)
		s1221(c, 2, i / (double)EVALUATIONS, &left, p, &status);
	freeCurve(c);
	return (bench_now_s() - from_s) * 1e9 / EVALUATIONS;
}

static void say(const char *what, uint32_t degree, double ns[BENCH_RUNS])
{
	char name[64];

	snprintf(name, sizeof(name), "%s-%u", what, degree);
	bench_say(name, bench_median(ns, BENCH_RUNS));
}

int main(void)
{
	for (uint32_t degree = 3; degree <= 5; degree += 2) {
		double ns[4][BENCH_RUNS];
		struct random_curve r;

		smooth_curve(&r, degree);
		for (int i = 0; i < BENCH_RUNS; i++) {
			ns[0][i] = sisl_ns(&r);
			ns[1][i] = at_ns(&r.c);
			ns[2][i] = step_ns(&r.c, 0);
			ns[3][i] = step_ns(&r.c, 0.001);
		}
		say("sisl", degree, ns[0]);
		say("evaluated", degree, ns[1]);
		say("step", degree, ns[2]);
		say("checked-step", degree, ns[3]);
	}
	return 0;
}
