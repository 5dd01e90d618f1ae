/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim.c - a simulated machine: axes, and a gap process with a seed
 *
 * The workpiece is a front on the path: what lies beyond it is solid.  The
 * gap is the way from the electrode to that front,
 *
 *	gap = front + wear - place + off_path
 *
 * so every cut meets material after [sim] standoff_mm of air, and positioning
 * (rapid) moves through free space and leaves the front there.  How much of the
 * frontal area meets material that was not eroded before: sim_ground.c.
 *
 * What happens in it each period: sim_process.h.
 */
#include "sim_process.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Another program is another path, and a workpiece of its own. */
static void fresh(struct sim *s)
{
	sim_axes_place(s);
	sim_ground_clear(s);
	s->front_mm = s->out.place_mm - s->wear_mm + s->p.standoff_mm;
	s->begin_mm = s->front_mm;
	s->depth_mm = s->p.depth_mm;
	s->sparked = false;
	s->bridge_mm = 0;
	s->hot = 0;
	s->debris = 0;
}

/* As bits: NAN is the same as NAN. */
static bool same_pulse(const struct io_outputs *a, const struct io_outputs *b)
{
	return memcmp(a->pulse, b->pulse, sizeof(a->pulse)) == 0;
}

static void power(struct sim *s)
{
	s->powered_s = s->out.power ? s->powered_s + s->period_s : 0;
	s->unpowered_s = s->out.power ? 0 : s->unpowered_s + s->period_s;
}

static void sim_write(void *self, const struct io_outputs *out)
{
	struct sim *s = self;
	const bool pulse = !same_pulse(out, &s->out);
	const bool path = out->path != s->out.path;
	const double was_off_mm = s->out.off_path_mm;
	int32_t was[IO_NAXES];

	memcpy(was, s->out.target, sizeof(was));
	s->out = *out;
	if (pulse)
		sim_pulses_set(s);
	if (path)
		fresh(s);
	sim_axes_follow(s, was, was_off_mm);
	if (out->rapid && s->front_mm < out->place_mm - s->wear_mm +
					s->p.standoff_mm) {
		s->front_mm = out->place_mm - s->wear_mm + s->p.standoff_mm;
		s->begin_mm = s->front_mm;
	}
	sim_ground_follow(s);
	power(s);
	sim_wash(s);
}

/* What is left of the gap for the pulses. */
static double left_mm(const struct sim *s, double gap_mm)
{
	const double left = gap_mm - s->p.debris_gap_mm * s->debris;

	if (s->broken)
		return INFINITY;
	if (s->out.sense)
		return sim_probe(s) ? 0 : INFINITY;
	return left <= s->pulse.short_mm || gap_mm < s->bridge_mm ? 0 : left;
}

static void sim_read(void *self, struct io_inputs *in)
{
	struct sim *s = self;
	const bool sparks = s->powered_s > s->p.respond_s;
	const double gap = sim_gap_mm(s);

	sim_bridge(s, gap);
	/* With the power off too: the sensing supply keeps the generator's
	 * time. */
	sim_pulses_train(s, left_mm(s, gap));
	if (sparks && !s->broken)
		sim_erode(s);
	sim_heat(s);
	sim_wire(s);
	*in = (struct io_inputs) {
		.gap_v = sim_pulses_volts(s, sparks),
		.gap_valid = true,
		.energy_j = sparks && !s->broken ? sim_pulses_j(s) : 0,
		.energy_valid = true,
		.wire_broken = s->broken,
		.generator = { .in_force = s->out.asked },
	};
	in->shares_valid = sparks || s->comparators;
	if (s->comparators)
		in->shares = sim_pulses_lines(s, sparks);
	else if (sparks)
		in->shares = sim_pulses_shares(s);
	sim_axes_measure(s, in);
	sim_switches_read(s, in);
}

static void sim_close(void *self)
{
	free(self);
}

void io_sim_result(const struct io_machine *m, struct io_sim_result *ret)
{
	const struct sim *s = m->self;

	*ret = (struct io_sim_result) {
		.removed_mm3 = s->removed_mm3, .wear_mm = s->wear_mm,
		.debris = s->debris, .gap_mm = sim_gap_mm(s),
		.area_mm2 = sim_area_mm2(s), .depth_mm = s->depth_mm,
		.hot = s->hot, .burns = s->burns,
	};
}

int io_sim_open_seed(struct io_machine *m, const struct machine_config *c,
		     uint64_t seed)
{
	struct sim *s = calloc(1, sizeof(*s));

	if (!s)
		return -ENOMEM;
	s->p = c->sim;
	s->comparators = c->gap.source == GAP_LINES;
	s->period_s = (double)config_period_ns(c) * 1e-9;
	if (c->axes.present & 1u << INTERP_Z)
		s->z_pulse_mm = c->axes.axis[INTERP_Z].pulse_mm;
	for (int i = INTERP_X; i <= INTERP_Z; i++)
		s->pulse_mm[i] = c->axes.axis[i].pulse_mm;
	io_pulse_own(&s->out);
	s->depth_mm = s->p.depth_mm;
	sim_pulses_init(s);
	sim_switches_init(s, c);
	sim_axes_init(s, c);
	sim_ground_init(s);
	rng_seed(&s->rng, seed);
	*m = (struct io_machine) {
		.name = "sim", .self = s, .read = sim_read,
		.write = sim_write, .close = sim_close, .stays = true,
	};
	return 0;
}

int io_sim_open(struct io_machine *m, const struct machine_config *c,
		struct interp_diag *diag)
{
	(void)diag;
	return io_sim_open_seed(m, c, (uint64_t)c->sim.seed);
}
