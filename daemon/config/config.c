/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config.c - the built-in machine, and what the cycle needs of a machine
 */
#include "config.h"

#include "cycle.h"
#include "keys.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define PERIOD_NS	1000000		/* of both backends there are */
#define POINTS_MAX	4096		/* lattice points in one cycle */

/* Pulses a limit may be off by the division alone, far below one. */
#define ROUNDING	1e-6

void config_defaults(struct machine_config *c)
{
	struct interp_diag diag;

	memset(c, 0, sizeof(*c));
	for (int i = 0; i < config_nkeys; i++) {
		const struct config_key *k = &config_key[i];
		int n = config_section[k->section].ninstances;

		for (int j = 0; j < n; j++) {
			int err = config_key_parse(
				k, j, config_key_default(k, j), c, &diag);

			assert(!err);
			(void)err;
		}
	}
}

int64_t config_period_ns(const struct machine_config *c)
{
	return c->period_us > 0 ? llround(c->period_us * 1e3) : PERIOD_NS;
}

static bool has(const struct machine_config *c, enum interp_axis a)
{
	return c->axes.present >> a & 1;
}

/* The weakest of the axes present; rotary ones only if there are no others. */
static void travel_of(const struct machine_config *c, struct cycle_config *ret)
{
	double a[2] = { INFINITY, INFINITY };	/* linear, rotary */
	double j[2] = { INFINITY, INFINITY };

	for (int i = 0; i < INTERP_NAXES; i++) {
		enum interp_axis x = (enum interp_axis)i;
		int rotary = interp_axis_is_rotary(x);

		if (!has(c, x))
			continue;
		a[rotary] = fmin(a[rotary], c->axes.axis[i].a_max_mm_s2);
		j[rotary] = fmin(j[rotary], c->axes.axis[i].j_max_mm_s3);
	}
	ret->travel_a_mm_s2 = isfinite(a[0]) ? a[0] : a[1];
	ret->travel_j_mm_s3 = isfinite(j[0]) ? j[0] : j[1];
}

static uint64_t cycles_of(double s, int64_t period_ns)
{
	return (uint64_t)round(s * 1e9 / (double)period_ns);
}

static void gap_of(const struct config_gap *g, int64_t period_ns,
		   struct cycle_gap_config *ret)
{
	*ret = (struct cycle_gap_config) {
		.servo_v = g->servo_v,
		.short_v = g->short_v,
		.open_v = g->open_v,
		.gain_mm_s_v = g->feed_gain_mm_s_v,
		.feed_max_mm_s = g->feed_max_mm_s,
		.approach_mm_s = g->approach_mm_s,
		.retract_mm_s = g->retract_mm_s,
		.retract_limit_mm = g->retract_limit_mm,
		.retract_wait_cycles = cycles_of(g->retract_wait_s, period_ns),
	};
}

static void jump_of(const struct config_jump *j, int64_t period_ns,
		    struct cycle_jump_config *ret)
{
	const uint64_t cycles = cycles_of(j->every_s, period_ns);

	*ret = (struct cycle_jump_config) {
		.height_mm = j->height_mm,
		.every_cycles = cycles ? cycles : 1,
		.v_max_mm_s = j->v_max_mm_s,
		.a_max_mm_s2 = j->a_max_mm_s2,
		.j_max_mm_s3 = j->j_max_mm_s3,
		.short_of_mm = j->short_of_mm,
	};
}

void config_cycle(const struct machine_config *c, struct cycle_config *ret)
{
	*ret = (struct cycle_config) {
		.period_ns = config_period_ns(c),
		.overrun_limit = (uint32_t)c->overrun_limit,
		.points_max = POINTS_MAX,
		.optional_stop = c->optional_stop,
	};
	travel_of(c, ret);
	gap_of(&c->gap, ret->period_ns, &ret->gap);
	jump_of(&c->jump, ret->period_ns, &ret->jump);

	/* Inward: the last pulse inside the limit, never the first outside. */
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &c->axes.axis[i];

		ret->travel_min[i] = (int32_t)ceil(
			l->travel_min_mm / l->pulse_mm - ROUNDING);
		ret->travel_max[i] = (int32_t)floor(
			l->travel_max_mm / l->pulse_mm + ROUNDING);
	}
}
