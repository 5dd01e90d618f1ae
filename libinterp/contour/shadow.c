/* SPDX-License-Identifier: Apache-2.0 */
/* shadow.c - models and machine against the row of targets they follow */
#include "interp/shadow.h"

#include <math.h>
#include <string.h>

#define LOOK_MM		0.02
#define SAME_MM		1e-7
/* Lattice points nearer than that are steps, not the path. */
#define SPACING_MM	0.005

static const double *point(const struct interp_shadow *s, uint64_t i)
{
	return s->mm[i % INTERP_SHADOW_POINTS];
}

/* The row of chords; u counts the points. */
static void chord_at(const void *arg, double u, struct interp_contour_point *ret)
{
	const struct interp_shadow *s = arg;
	const double last = (double)(s->n - 2);
	const double from = fmin(floor(u), last), part = u - from;
	const double *a = point(s, (uint64_t)from);
	const double *b = point(s, (uint64_t)from + 1);

	for (int i = 0; i < s->naxes; i++) {
		ret->mm[i] = a[i] + part * (b[i] - a[i]);
		ret->per_u[i] = b[i] - a[i];
	}
}

int interp_shadow_init(struct interp_shadow *s,
		       const struct interp_axis_loop *loop, int naxes,
		       double period_s)
{
	int err = 0;

	*s = (struct interp_shadow) { .naxes = naxes, .period_s = period_s };
	memcpy(s->loop, loop, (size_t)naxes * sizeof(*loop));
	for (int i = 0; i < naxes && err == 0; i++)
		err = interp_axis_model_init(&s->model[i], &loop[i], period_s,
					     0);
	return err;
}

void interp_shadow_forget(struct interp_shadow *s)
{
	s->begun = false;
}

/* The models stand where the machine is; their loops were checked. */
static void begin(struct interp_shadow *s, const double *target,
		  const double *actual)
{
	for (int i = 0; i < s->naxes; i++)
		interp_axis_model_init(&s->model[i], &s->loop[i], s->period_s,
				       actual[i]);
	memcpy(s->before_mm, target, (size_t)s->naxes * sizeof(*target));
	memcpy(s->mm[0], target, (size_t)s->naxes * sizeof(*target));
	s->n = 1;
	s->path = (struct interp_contour_path) {
		.arg = s, .at = chord_at, .naxes = s->naxes
	};
	interp_contour_begin(&s->measured, &s->path, 0, LOOK_MM);
	s->predicted = s->measured;
	s->begun = true;
}

static double way_mm(const struct interp_shadow *s, const double *a,
		     const double *b)
{
	double square = 0;

	for (int i = 0; i < s->naxes; i++)
		square += (a[i] - b[i]) * (a[i] - b[i]);
	return sqrt(square);
}

/* The last point goes along with the targets until its chord is long enough. */
static void take(struct interp_shadow *s, const double *target)
{
	const uint64_t last = s->n - 1;

	if (way_mm(s, point(s, last), target) < SAME_MM)
		return;
	if (last > 0 &&
	    way_mm(s, point(s, last - 1), point(s, last)) < SPACING_MM) {
		if (way_mm(s, point(s, last - 1), target) < SAME_MM)
			return;
		s->n = last;
	}
	memcpy(s->mm[s->n % INTERP_SHADOW_POINTS], target,
	       (size_t)s->naxes * sizeof(*target));
	s->n++;
	s->path.u_max = (double)(s->n - 1);
	if (s->n > INTERP_SHADOW_POINTS)
		s->path.u_min = (double)(s->n - INTERP_SHADOW_POINTS);
}

/* A foot that fell out of the row is taken up at its end. */
static double error_of(struct interp_shadow *s, struct interp_contour *foot,
		       const double *mm)
{
	struct interp_contour_error e;

	if (foot->u < s->path.u_min)
		interp_contour_begin(foot, &s->path, s->path.u_min, LOOK_MM);
	interp_contour_step(foot, mm, s->path.u_max, &e);
	return e.mm;
}

void interp_shadow_step(struct interp_shadow *s, const double *target_mm,
			const double *actual_mm,
			struct interp_shadow_error *ret)
{
	double model[INTERP_NAXES], square = 0;

	*ret = (struct interp_shadow_error) { 0 };
	if (!s->begun)
		begin(s, target_mm, actual_mm);
	for (int i = 0; i < s->naxes; i++) {
		model[i] = interp_axis_model_actual_mm(&s->model[i]);
		square += (actual_mm[i] - model[i]) * (actual_mm[i] - model[i]);
		interp_axis_model_follow(&s->model[i], target_mm[i],
					 s->before_mm[i]);
		s->before_mm[i] = target_mm[i];
	}
	ret->missed_mm = sqrt(square);
	take(s, target_mm);
	if (s->n < 2)
		return;
	ret->measured_mm = error_of(s, &s->measured, actual_mm);
	ret->predicted_mm = error_of(s, &s->predicted, model);
}
