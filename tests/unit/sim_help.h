/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_help.h - the simulated gap on a bench: the electrode is put where the
 * test wants it, and what the gap says is read
 */
#ifndef SIM_HELP_H
#define SIM_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "config.h"
#include "io.h"
#include "rng.h"

#include <math.h>
#include <string.h>

#define near(a, b, eps)	assert_true(fabs((a) - (b)) <= (eps))

struct bench {
	struct machine_config k;
	struct io_machine m;
	struct io_outputs out;
	struct io_inputs in;
};

/* The defaults, but silent and without chance: what is left is the model. */
static inline void quiet(struct machine_config *k)
{
	config_defaults(k);
	k->sim.noise_v = 0;
	k->sim.bridge_per_s = 0;
	k->sim.standoff_mm = 1;
}

static inline void open_sim(struct bench *b, uint64_t seed)
{
	assert_int_equal(io_sim_open_seed(&b->m, &b->k, seed), 0);
	b->out = (struct io_outputs) { .path = 1 };
	io_pulse_own(&b->out);
	b->m.write(b->m.self, &b->out);
}

static inline void close_sim(struct bench *b)
{
	b->m.close(b->m.self);
}

static inline double period(struct bench *b)
{
	b->m.write(b->m.self, &b->out);
	b->m.read(b->m.self, &b->in);
	return b->in.gap_v;
}

static inline double cycle_at(struct bench *b, double place_mm, bool power)
{
	b->out.place_mm = place_mm;
	b->out.power = power;
	return period(b);
}

static inline struct io_sim_result result(const struct bench *b)
{
	struct io_sim_result r;

	io_sim_result(&b->m, &r);
	return r;
}

/* Follow the front at @gap_mm for @n cycles; the volume taken away. */
static inline double cut(struct bench *b, double gap_mm, int n)
{
	const double before = result(b).removed_mm3;

	for (int i = 0; i < n; i++) {
		const struct io_sim_result r = result(b);

		cycle_at(b, b->out.place_mm + r.gap_mm - gap_mm -
			 b->k.sim.debris_gap_mm * r.debris, true);
	}
	return result(b).removed_mm3 - before;
}

#endif /* SIM_HELP_H */
