/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_axes.c - where the electrode really is
 *
 * It is at once where it was sent, unless the machine file says otherwise: a
 * lag of first order ([sim] lag_s), or the drive's whole loop ([sim] loops); a
 * dead time whenever another axis begins to move or one turns back (start_s);
 * noise of the scales (measure_pulses).
 */
#include "sim_process.h"

#include <math.h>
#include <string.h>

void sim_axes_init(struct sim *s, const struct machine_config *c)
{
	for (int i = 0; i < IO_NAXES; i++) {
		const struct interp_axis_loop l = config_loop_true(c, i, i % 2);

		s->drive_mm[i] = c->axes.axis[i].pulse_mm;
		if (!c->sim.loops || !(l.gain_1_s > 0))
			continue;
		if (interp_axis_model_init(&s->model[i], &l, s->period_s, 0) ==
		    0)
			s->modelled |= 1u << i;
	}
	s->exact = s->p.lag_s == 0 && s->p.start_s == 0 &&
		   s->p.measure_pulses == 0 && s->modelled == 0;
}

void sim_axes_place(struct sim *s)
{
	s->at_mm = s->out.place_mm;
	for (int i = 0; i < IO_NAXES; i++) {
		s->axis[i] = s->out.target[i];
		s->step[i] = 0;
		if (s->modelled >> i & 1)
			interp_axis_model_stand(&s->model[i],
						s->axis[i] * s->drive_mm[i]);
	}
	s->wait_s = 0;
}

/*
 * Does an axis start?  One does when nothing that moved last goes on, and
 * when one that moved last turns back.
 */
static bool starts(struct sim *s, const int32_t step[IO_NAXES])
{
	bool moves = false, goes_on = false, turns = false;

	for (int i = 0; i < IO_NAXES; i++) {
		const int64_t same = (int64_t)step[i] * s->step[i];

		moves = moves || step[i] != 0;
		goes_on = goes_on || same > 0;
		turns = turns || same < 0;
	}
	if (moves)
		memcpy(s->step, step, sizeof(s->step));
	return moves && (turns || !goes_on);
}

static double follow(const struct sim *s, double at, double to)
{
	return s->wait_s > 0 ? at :
	       at + (to - at) * s->period_s / (s->p.lag_s + s->period_s);
}

/* By its loop, with the drive's own feedforward. */
static double follow_model(struct sim *s, int i, int32_t was)
{
	struct interp_axis_model *m = &s->model[i];

	interp_axis_model_follow(m, s->out.target[i] * s->drive_mm[i],
				 was * s->drive_mm[i]);
	return interp_axis_model_actual_mm(m) / s->drive_mm[i];
}

static void follow_slowly(struct sim *s, const int32_t was[IO_NAXES])
{
	int32_t step[IO_NAXES];

	for (int i = 0; i < IO_NAXES; i++)
		step[i] = (int32_t)((uint32_t)s->out.target[i] -
				    (uint32_t)was[i]);
	if (starts(s, step) && s->wait_s <= 0)
		s->wait_s = s->p.start_s;
	s->at_mm = follow(s, s->at_mm, s->out.place_mm);
	for (int i = 0; i < IO_NAXES; i++)
		s->axis[i] = s->modelled >> i & 1 ?
			     follow_model(s, i, was[i]) :
			     follow(s, s->axis[i], s->out.target[i]);
	s->wait_s -= s->period_s;
}

void sim_axes_follow(struct sim *s, const int32_t was[IO_NAXES],
		     double was_off_mm)
{
	const double at = s->at_mm;

	if (s->exact)
		s->at_mm = s->out.place_mm;
	else
		follow_slowly(s, was);
	s->stroke_mm = fabs(s->at_mm - at) +
		       fabs(s->out.off_path_mm - was_off_mm);
}

double sim_axis(const struct sim *s, int i)
{
	return s->exact ? s->out.target[i] : s->axis[i];
}

void sim_axes_measure(struct sim *s, struct io_inputs *in)
{
	memcpy(in->actual, s->out.target, sizeof(in->actual));
	memcpy(in->own, s->out.target, sizeof(in->own));
	for (int i = 0; i < IO_NAXES && !s->exact; i++)
		in->actual[i] = (int32_t)lround(s->axis[i] +
				s->p.measure_pulses * rng_normal(&s->rng));
}
