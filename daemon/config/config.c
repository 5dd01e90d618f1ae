/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config.c - the built-in machine, and what the cycle needs of a machine
 */
#include "config.h"

#include "cycle.h"
#include "keys.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#define POINTS_MAX	4096		/* lattice points in one cycle */

/* Pulses a limit may be off by the division alone, far below one. */
#define ROUNDING	1e-6

void config_defaults(struct machine_config *c)
{
	struct interp_diag diag;

	memset(c, 0, sizeof(*c));
	for (int i = 0; config_key(i); i++) {
		const struct config_key *k = config_key(i);
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
	if (c->period_us > 0)
		return llround(c->period_us * 1e3);
	return config_backend(c)->period_ns;
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

/* 0 in the file is "as the machine has it". */
static double or_own(double x, double own)
{
	return x > 0 ? x : own;
}

static void gap_of(const struct machine_config *m, struct cycle_config *c,
		   struct cycle_gap_config *ret)
{
	const struct config_gap *g = &m->gap;
	const bool sim = m->backend == BACKEND_SIM;

	*ret = (struct cycle_gap_config) {
		.process = (enum cycle_process)g->process,
		.source = (enum gap_source)g->source,
		.filter = (enum gap_filter)g->filter,
		.filter_cycles = (uint32_t)g->filter_cycles,
		.short_cycles = (uint32_t)g->short_cycles,
		.servo_v = g->servo_v,
		.short_v = g->short_v,
		.open_v = g->open_v,
		.window_low_v = g->window_low_v,
		.window_high_v = g->window_high_v,
		.ignition_v = or_own(g->ignition_v, sim ? m->sim.open_v : 0),
		.gain_mm_s_v = g->feed_gain_mm_s_v,
		.integral_s = g->integral_s,
		.feed_max_mm_s = g->feed_max_mm_s,
		.creep_mm_s = g->creep_mm_s,
		.feed_a_mm_s2 = or_own(g->feed_a_mm_s2, c->travel_a_mm_s2),
		.approach_mm_s = g->approach_mm_s,
		.share_v = g->share_v,
		.share_set = g->share_set,
		.share_weight = g->share_weight,
		.share_short = g->share_short,
		.share_open = g->share_open,
		.retract_mm_s = g->retract_mm_s,
		.retract_to = (enum retract_to)g->retract_to,
		.retract_limit_mm = g->retract_limit_mm,
		.retract_wait_cycles = cycles_of(g->retract_wait_s,
						 c->period_ns),
		.retract_max_cycles = cycles_of(g->retract_max_s,
						c->period_ns),
		.retract_escape = g->retract == 1,
		.abort_count = (uint32_t)g->abort_count,
		.progress_mm = g->progress_mm,
		.arcing_share = g->arcing_share,
		.arcing_cycles = (uint32_t)g->arcing_cycles,
		.arcing_sigma_v = g->arcing_sigma_v,
		.off_us = or_own(g->off_us, sim ? m->sim.off_us : 0),
		.arcing_off_max = g->arcing_off_max,
		.arcing_recover_cycles = cycles_of(g->arcing_recover_s,
						c->period_ns),
		.arcing_retract_mm = g->arcing_retract_mm,
		.stuck_cycles = cycles_of(g->stuck_s, c->period_ns),
		.noise_limit_v = g->noise_limit_v,
		.wire_retract_mm = g->wire_retract_mm,
		.wire_retreat_to = (enum retreat_to)g->wire_retreat_to,
		.wire_retreat_mm = g->wire_retreat_mm,
	};
}

static void jump_of(const struct config_jump *j, int64_t period_ns,
		    struct cycle_jump_config *ret)
{
	const uint64_t cycles = cycles_of(j->every_s, period_ns);

	*ret = (struct cycle_jump_config) {
		.height_mm = j->height_mm,
		.every_cycles = cycles ? cycles : 1,
		.every_mm = j->every_mm,
		.adaptive = j->adaptive,
		.every_min_cycles = cycles_of(j->every_min_s, period_ns),
		.every_max_cycles = cycles_of(j->every_max_s, period_ns),
		.height_min_mm = j->height_min_mm,
		.height_max_mm = j->height_max_mm,
		.bad_share = j->bad_share,
		.v_max_mm_s = j->v_max_mm_s,
		.a_max_mm_s2 = j->a_max_mm_s2,
		.j_max_mm_s3 = j->j_max_mm_s3,
		.a_down_mm_s2 = j->a_down_mm_s2,
		.short_of_mm = j->short_of_mm,
	};
}

static void hand_of(const struct machine_config *c, int axis,
		    struct manual_axis *ret)
{
	const struct interp_axis_limits *l = &c->axes.axis[axis];
	const struct config_hand *h = &c->hand[axis];

	*ret = (struct manual_axis) {
		.present = has(c, (enum interp_axis)axis),
		.pulse_mm = l->pulse_mm,
		.v_max_mm_s = l->v_max_mm_s,
		.a_max_mm_s2 = l->a_max_mm_s2,
		.j_max_mm_s3 = l->j_max_mm_s3,
		.jog_mm_s = h->jog_mm_s,
		.method = (enum home_method)h->home_method,
		.home_toward = h->home_dir ? 1 : -1,
		.home_fast_mm_s = h->home_fast_mm_s,
		.home_slow_mm_s = h->home_slow_mm_s,
		.home_at_mm = h->home_at_mm,
		.home_back_mm = h->home_back_mm,
		.home_order = (uint32_t)h->home_order,
	};
}

bool config_has_switch(const struct machine_config *c, int axis)
{
	return has(c, (enum interp_axis)axis) &&
	       (c->hand[axis].home_method == HOME_SWITCH ||
		c->hand[axis].home_method == HOME_SWITCH_INDEX);
}

static void comp_of(const struct machine_config *c, struct comp_config *ret)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct config_hand *h = &c->hand[i];
		const double pulse_mm = c->axes.axis[i].pulse_mm;

		ret->axis[i].backlash =
			(int32_t)lround(h->backlash_um * 1e-3 / pulse_mm);
		ret->axis[i].take_up = h->backlash_mm_s / pulse_mm *
				       (double)config_period_ns(c) * 1e-9;
		ret->axis[i].pulse_mm = pulse_mm;
	}
	ret->maps = c->geometry;
	ret->maps_c = c->maps_c;
	ret->mapped = !interp_errormap_is_empty(&c->geometry);
}

void config_cycle(const struct machine_config *c, struct cycle_config *ret)
{
	*ret = (struct cycle_config) {
		.period_ns = config_period_ns(c),
		.overrun_limit = (uint32_t)c->overrun_limit,
		.axes_wait_cycles = cycles_of(c->can402.enable_s,
					      config_period_ns(c)),
		.points_max = POINTS_MAX,
		.optional_stop = c->optional_stop,
		.stop_at_nodes = c->nodes == 1,
		.require_home = c->require_home,
		.probe = {
			.feed_mm_s = c->probe.feed_mm_s,
			.fine_mm_s = c->probe.fine_mm_s,
			.back_mm = c->probe.back_mm,
			.settle_cycles = cycles_of(c->probe.settle_s,
						   config_period_ns(c)),
		},
	};
	ret->press_cycles = cycles_of(VERB_PRESS_S *
				      (c->backend == BACKEND_SIM ?
				       (double)c->sim.speed : 1),
				      ret->period_ns);
	ret->mcode_cycles = cycles_of(c->plc.m_timeout_s, ret->period_ns);
	travel_of(c, ret);
	gap_of(c, ret, &ret->gap);
	jump_of(&c->jump, ret->period_ns, &ret->jump);

	/* Inward: the last pulse inside the limit, never the first outside. */
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &c->axes.axis[i];

		ret->start[i] = (int32_t)lround(c->start_mm[i] / l->pulse_mm);
		ret->travel_min[i] = (int32_t)ceil(
			l->travel_min_mm / l->pulse_mm - ROUNDING);
		ret->travel_max[i] = (int32_t)floor(
			l->travel_max_mm / l->pulse_mm + ROUNDING);
		hand_of(c, i, &ret->axis[i]);
	}
	comp_of(c, &ret->comp);
	config_contouring(c, &ret->contouring);
}
