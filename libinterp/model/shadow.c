/* SPDX-License-Identifier: Apache-2.0 */
/* shadow.c - models and machine against the row of targets that they follow */
#include "interp/shadow.h"

#include <math.h>
#include <string.h>

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

/* The models begin where the machine is.  Their loops were checked before. */
static void begin(struct interp_shadow *s, const double *target,
		  const double *sent, const double *actual)
{
	for (int i = 0; i < s->naxes; i++)
		interp_axis_model_init(&s->model[i], &s->loop[i], s->period_s,
				       actual[i]);
	memcpy(s->before_mm, sent, (size_t)s->naxes * sizeof(*sent));
	interp_row_begin(&s->row, s->naxes, target);
	interp_row_foot(&s->row, &s->measured);
	s->predicted = s->measured;
	s->begun = true;
}

void interp_shadow_step(struct interp_shadow *s, const double *target_mm,
			const double *sent_mm, const double *actual_mm,
			struct interp_shadow_error *ret)
{
	double model[INTERP_NAXES], square = 0;
	struct interp_contour_error e;

	*ret = (struct interp_shadow_error) { 0 };
	if (!s->begun)
		begin(s, target_mm, sent_mm, actual_mm);
	for (int i = 0; i < s->naxes; i++) {
		model[i] = interp_axis_model_actual_mm(&s->model[i]);
		square += (actual_mm[i] - model[i]) * (actual_mm[i] - model[i]);
		interp_axis_model_follow(&s->model[i], sent_mm[i],
					 s->before_mm[i]);
		s->before_mm[i] = sent_mm[i];
	}
	ret->missed_mm = sqrt(square);
	interp_row_take(&s->row, target_mm);
	interp_row_error(&s->row, &s->measured, actual_mm, &e);
	ret->measured_mm = e.mm;
	interp_row_error(&s->row, &s->predicted, model, &e);
	ret->predicted_mm = e.mm;
}
