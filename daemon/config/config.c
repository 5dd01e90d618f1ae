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

/* An error of the division, in pulses; far below one. */
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

double config_points_s(const struct machine_config *c)
{
	const double cycle = POINTS_MAX * 1e9 / (double)config_period_ns(c);
	const struct config_backend *b = config_backend(c);

	return b->points_s ? fmin(cycle, b->points_s(c)) : cycle;
}

static bool has(const struct machine_config *c, enum interp_axis a)
{
	return c->axes.present >> a & 1;
}

static uint64_t cycles_of(double s, int64_t period_ns)
{
	return (uint64_t)round(s * 1e9 / (double)period_ns);
}

/* 0 in the file means "as the machine has it". */
static double or_own(double x, double own)
{
	return x > 0 ? x : own;
}

/* The settings that the cycle has as the file gives them. */
static const struct { size_t from, to, size; } settings[] = {
#define SETTINGS(member) \
	{ offsetof(struct machine_config, member), \
	  offsetof(struct cycle_config, member), \
	  sizeof(((struct cycle_config *)0)->member) }
	SETTINGS(gap), SETTINGS(jump), SETTINGS(probe),
#undef SETTINGS
};

static void settings_of(const struct machine_config *m, struct cycle_config *c)
{
	for (size_t i = 0; i < sizeof(settings) / sizeof(settings[0]); i++)
		memcpy((char *)c + settings[i].to,
		       (const char *)m + settings[i].from, settings[i].size);
}

/* The time that a row of the keys' table puts @at into a machine_config. */
static struct cycle_time *time_at(struct cycle_config *c, size_t at)
{
	for (size_t i = 0; i < sizeof(settings) / sizeof(settings[0]); i++)
		if (at >= settings[i].from &&
		    at < settings[i].from + settings[i].size)
			return (void *)((char *)c + settings[i].to + at -
					settings[i].from);
	return NULL;
}

static void count_periods(struct cycle_config *c)
{
	const struct config_key *k;

	for (int i = 0; (k = config_key(i)); i++) {
		struct cycle_time *t = k->periods ? time_at(c, k->offset) :
						    NULL;

		if (t)
			t->cycles = cycles_of(t->s, c->period_ns);
	}
	c->jump.every.cycles += c->jump.every.cycles == 0;
}

static void generator_of(const struct machine_config *m,
			 struct cycle_gap_config *g)
{
	const bool sim = config_machine_is(m, MACHINE_MODEL);

	g->ignition_v = or_own(g->ignition_v, sim ? m->sim.open_v : 0);
	g->off_us = or_own(g->off_us, sim ? m->sim.off_us : 0);
}

/* Seconds of the machine in a real one. */
static double model_speed(const struct machine_config *c)
{
	return config_machine_is(c, MACHINE_MODEL) ? (double)c->sim.speed : 1;
}

static void asking_of(const struct machine_config *m, struct cycle_config *c)
{
	const struct config_generator *g = &m->generator;
	struct asking_config *a = &c->asking;

	a->limited = config_generator_limits(m);
	a->answers = config_generator_interface(m) >= GENERATOR_MODBUS;
	a->settle_cycles = cycles_of(g->settle_ms * 1e-3, c->period_ns);
	a->polarity_cycles = cycles_of(g->polarity_ms * 1e-3, c->period_ns);
	a->lease_cycles = cycles_of((g->confirm_s + VERB_TRY_S) *
				    model_speed(m), c->period_ns);
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		struct config_way asked, told;

		config_delivers(m, i, &a->field[i]);
		config_way(m, i, false, &asked);
		config_way(m, i, true, &told);
		a->answers = a->answers || told.kind != WAY_NONE ||
			     asked.kind == WAY_DAC;
	}
}

static void manual_of(const struct machine_config *c, int axis,
		      struct manual_axis *ret)
{
	const struct interp_axis_limits *l = &c->axes.axis[axis];

	*ret = c->manual[axis];
	ret->present = has(c, (enum interp_axis)axis);
	ret->home_toward = c->home_dir[axis] ? 1 : -1;
	ret->pulse_mm = l->pulse_mm;
	ret->v_max_mm_s = l->v_max_mm_s;
	ret->a_max_mm_s2 = l->a_max_mm_s2;
	ret->j_max_mm_s3 = l->j_max_mm_s3;
}

bool config_has_switch(const struct machine_config *c, int axis)
{
	return has(c, (enum interp_axis)axis) &&
	       (c->manual[axis].method == HOME_SWITCH ||
		c->manual[axis].method == HOME_SWITCH_INDEX);
}

static void comp_of(const struct machine_config *c, struct comp_config *ret)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct config_backlash *b = &c->backlash[i];
		const double pulse_mm = c->axes.axis[i].pulse_mm;

		ret->axis[i].backlash =
			(int32_t)lround(b->um * 1e-3 / pulse_mm);
		ret->axis[i].take_up = b->mm_s / pulse_mm *
				       (double)config_period_ns(c) * 1e-9;
		ret->axis[i].pulse_mm = pulse_mm;
	}
	ret->maps = c->geometry;
	ret->maps_c = c->maps_c;
	ret->mapped = !interp_errormap_is_empty(&c->geometry);
}

static void resync_of(const struct machine_config *c, struct resync_config *ret)
{
	const bool drives = config_machine_is(c, MACHINE_DRIVES);
	const double max_mm = drives ? c->can402.resync_mm : c->gpio.resync_mm;

	ret->v_mm_s = drives ? c->can402.resync_mm_s : c->gpio.resync_mm_s;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->max[i] = (int32_t)(max_mm / c->axes.axis[i].pulse_mm);
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
	};
	ret->press_cycles = cycles_of(VERB_PRESS_S * model_speed(c),
				      ret->period_ns);
	ret->mcode_cycles = cycles_of(c->plc.m_timeout_s, ret->period_ns);
	settings_of(c, ret);
	count_periods(ret);
	interp_machine_travel(&c->axes, &ret->travel_a_mm_s2,
			      &ret->travel_j_mm_s3);
	generator_of(c, &ret->gap);
	asking_of(c, ret);

	/* Round inward: to the last pulse inside the limit, never to the first
	 * outside. */
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &c->axes.axis[i];

		ret->start[i] = (int32_t)lround(c->start_mm[i] / l->pulse_mm);
		ret->travel_min[i] = (int32_t)ceil(
			l->travel_min_mm / l->pulse_mm - ROUNDING);
		ret->travel_max[i] = (int32_t)floor(
			l->travel_max_mm / l->pulse_mm + ROUNDING);
		manual_of(c, i, &ret->axis[i]);
	}
	comp_of(c, &ret->comp);
	resync_of(c, &ret->resync);
	config_contouring(c, &ret->contouring);
}
