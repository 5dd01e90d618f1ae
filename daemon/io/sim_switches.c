/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_switches.c - home and limit switches and index marks of the drives
 *
 * Of axes with home_method switch or switch-index.  They lie where the machine
 * file says, but for [sim] home_off_mm: a machine whose pulses are not its
 * places yet.  Limit switches are a millimetre outside the travel.
 */
#include "sim_process.h"

#include <math.h>

#define OUTSIDE_MM	1.0

void sim_switches_init(struct sim *s, const struct machine_config *c)
{
	for (int i = 0; i < IO_NAXES; i++) {
		const struct interp_axis_limits *l = &c->axes.axis[i];
		const struct manual_axis *h = &c->manual[i];
		const double off_mm = s->p.home_off_mm;

		s->wired |= (uint32_t)config_has_switch(c, i) << i;
		s->switches[i] = (struct sim_switches) {
			.toward = c->home_dir[i] ? 1 : -1,
			.home = (h->home_at_mm + off_mm) / l->pulse_mm,
			.min = (l->travel_min_mm + off_mm - OUTSIDE_MM) /
			       l->pulse_mm,
			.max = (l->travel_max_mm + off_mm + OUTSIDE_MM) /
			       l->pulse_mm,
			.index = s->p.index_mm / l->pulse_mm,
		};
	}
}

void sim_switches_read(struct sim *s, struct io_inputs *in)
{
	for (uint32_t left = s->wired; left; left &= left - 1) {
		const int i = __builtin_ctz(left);
		struct sim_switches *w = &s->switches[i];
		const int32_t at = s->out.target[i];
		const uint32_t bit = 1u << i;

		if (w->toward * (at - w->home) >= 0)
			in->home |= bit;
		if (at < w->min || at > w->max)
			in->limit |= bit;
		if (floor(at / w->index) != floor(w->was / w->index) &&
		    ~s->latched & s->out.latch & bit) {
			s->latched |= bit;
			w->mark = at;
		}
		in->latched_at[i] = w->mark;
		w->was = at;
	}
	s->latched &= s->out.latch;
	in->latched = s->latched;
	in->latching = s->out.latch & ~s->latched;
}
