/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_world.h - random programs, machine files, gaps, conditions and
 * commands
 */
#ifndef RANDOM_WORLD_H
#define RANDOM_WORLD_H

#include "nc_read.h"

#undef assert_near			/* not with a fixed bound */
#include "plc_help.h"

#define SEGMENTS	30
#define POINTS_MAX	150

/* How the gap behaves for a while. */
enum gap_mood {
	MOOD_WANDERS,
	MOOD_STUCK,			/* the very same, cycle after cycle */
	MOOD_NOISY,			/* anything, cycle after cycle */
	MOOD_ILL,			/* no number */
	NMOODS
};

struct gap_world {
	double v;
	enum gap_mood mood;
	int left;			/* cycles of it */
};

static inline void random_action(struct interp_build *b, uint64_t *s)
{
	static const enum interp_kind kinds[] = {
		INTERP_DWELL, INTERP_STOP, INTERP_OPTIONAL_STOP, INTERP_AUX,
		INTERP_MCODE, INTERP_ELECTRODE,
	};
	const enum interp_kind k = kinds[rnd(s) % 6];
	const struct interp_mcode m = {
		.sync = (uint8_t)(1 + rnd(s) % (INTERP_MCODE_NSYNC - 1)),
		.back = (uint8_t)(rnd(s) % INTERP_MCODE_NBACK),
	};

	action(b, k, k == INTERP_AUX ? (uint32_t)(rnd(s) % INTERP_NAUX) :
		     k == INTERP_MCODE ? interp_mcode_arg(
				(uint8_t)(1 + rnd(s) % 255), m) :
		     k == INTERP_ELECTRODE && rnd(s) % 2 ?
				INTERP_ELECTRODE_STOP | 3 :
				       (uint32_t)(rnd(s) % 20));
}

static inline void random_rapid(struct interp_build *b, uint64_t *s)
{
	rapid_to(b, uniform(s, -0.5, 0.5));
}

/* Values within their order; most are not given. */
static inline void random_condition(uint64_t *s)
{
	static struct interp_tech tech;
	static const enum interp_tech_id live[] = {
		INTERP_TECH_OFF_US, INTERP_TECH_ON_US, INTERP_TECH_GAIN_MM_S_V,
		INTERP_TECH_INTEGRAL_S, INTERP_TECH_FEED_MAX_MM_S,
		INTERP_TECH_RETRACT_MM_S, INTERP_TECH_JUMP_MM,
		INTERP_TECH_JUMP_EVERY_S, INTERP_TECH_JUMP_SHORT_OF_MM,
	};

	interp_tech_clear(&tech);
	for (size_t i = 0; i < sizeof(live) / sizeof(live[0]); i++)
		if (rnd(s) % 3 == 0)
			tech.v[live[i]] = uniform(s, 0.1, 1);
	if (rnd(s) % 2)
		tech.v[INTERP_TECH_SERVO_V] = uniform(s, 30, 50);
	if (rnd(s) % 2)
		tech.v[INTERP_TECH_SHORT_V] = uniform(s, 2, 20);
	if (rnd(s) % 2)
		tech.v[INTERP_TECH_OPEN_V] = uniform(s, 60, 90);
	help_word.cond_letter = 'C';
	help_word.cond_number++;
	help_word.tech = &tech;
}

/* Free or not does not matter here: whether it is kept to does. */
static inline void random_escape(struct interp_build *b, uint64_t *s)
{
	struct interp_escape e = {
		.home = (uint32_t)(rnd(s) % 4),
		.out = rnd(s) % 4 ? 1u << INTERP_Z : (uint32_t)(rnd(s) & 0xff),
		.rise_mm = rnd(s) % 2 ? uniform(s, 0, 0.1) : 0,
	};

	e.out &= ~e.home;
	for (int i = 0; i < INTERP_NAXES; i++) {
		e.home_mm[i] = uniform(s, -0.5, 0.5);
		e.out_mm[i] = uniform(s, 0, 1);
	}
	assert_int_equal(interp_build_escape(b, rnd(s) % 3 ? &e : NULL), 0);
}

static inline struct made random_segments(uint64_t *s)
{
	const enum interp_strategy how = rnd(s) % 2 ? INTERP_POINT_BY_POINT :
						      INTERP_SIMULTANEOUS;
	struct interp_build *b = begin(how);

	help_word = HELP_WORD;
	random_segment(b, s, how);
	for (int i = 0; i < SEGMENTS; i++) {
		if (rnd(s) % 5 == 0)
			random_escape(b, s);
		if (rnd(s) % 8 == 0)
			random_condition(s);
		if (rnd(s) % 5 == 0)
			random_action(b, s);
		else if (rnd(s) % 4 == 0)
			random_rapid(b, s);
		else
			random_segment(b, s, how);
	}
	help_word = HELP_WORD;
	return finish(b);
}

/* Words that each cycle needs beside its bottom. */
static inline int orbit_words(char *to, size_t room, uint64_t *s, double z_mm)
{
	const double r = uniform(s, 0.01, 0.1), q = uniform(s, 0.01, 0.05);
	const int timed = rnd(s) % 3 == 0 ? 1 + (int)(rnd(s) % 4) : 100;

	switch (rnd(s) % 7) {
	case 0:
		return snprintf(to, room, "G130 Z%.3f R%.3f Q%.3f P1 S%d\n",
				z_mm, r, q, timed);
	case 1:
		return snprintf(to, room, "G131 Z%.3f R%.3f Q%.3f S%d\n",
				z_mm, r, q, timed);
	case 2:
		return snprintf(to, room, "G132 Z%.3f R%.3f B%.3f Q%.3f\n",
				z_mm, r, r / 2, q);
	case 3:
		return snprintf(to, room, "G133 Z%.3f R%.3f A3 Q%.3f S%d\n",
				z_mm, r, q, timed);
	case 4:
		return snprintf(to, room, "G134 Z%.3f R%.3f A45 L4 S%d\n",
				z_mm, r, timed);
	case 5:
		return snprintf(to, room, "G135 Z%.3f R%.3f Q%.3f P1\n", z_mm,
				r, q);
	default:
		return snprintf(to, room, "G86 Z%.3f S%d P1\n", z_mm, timed);
	}
}

/* A few planetary cycles, one below the other. */
static inline struct made random_orbits(uint64_t *s)
{
	char text[1024];
	struct nc_read n;
	double z_mm = 0;
	int at = sprintf(text, "G21 G90 F60\nG0 Z0.5\nZ0\n");

	for (int i = 0; i < 4; i++) {
		z_mm -= uniform(s, 0.03, 0.15);
		at += sprintf(text + at, "G14%d\n", (int)(rnd(s) % 4));
		at += orbit_words(text + at, sizeof(text) - (size_t)at, s,
				  z_mm);
	}
	sprintf(text + at, "M30\n");
	n = nc_read_text(text);
	return (struct made) { .block = n.block, .p = n.p };
}

static inline void random_sensor(struct cycle_gap_config *g, uint64_t *s)
{
	g->source = (enum gap_source)(rnd(s) % GAP_NSOURCES);
	g->filter = (enum gap_filter)(rnd(s) % GAP_NFILTERS);
	g->filter_cycles = (uint32_t)(rnd(s) % (GAP_FILTER_MAX + 3));
	g->short_cycles = (uint32_t)(rnd(s) % 5);
	g->share_v = uniform(s, 1, 100);
	g->share_set = uniform(s, -0.5, 0.5);
	g->share_weight = uniform(s, 0, 3);
	g->share_short = uniform(s, 0.1, 0.9);
	g->share_open = uniform(s, 0.5, 1);
	g->ignition_v = rnd(s) % 2 ? 100 : 0;
	g->stuck.cycles = rnd(s) % 2 ? 100 + rnd(s) % 500 : 0;
	g->noise_limit_v = rnd(s) % 2 ? uniform(s, 1, 40) : 0;
}

/* As a condition, or `set`, may change at any cycle. */
static inline void random_law(struct cycle_gap_config *g, uint64_t *s)
{
	g->window_low_v = rnd(s) % 2 ? uniform(s, 10, 60) : 0;
	g->window_high_v = rnd(s) % 2 ? uniform(s, 10, 60) : 0;
	g->gain_mm_s_v = uniform(s, 0.01, 1);
	g->integral_s = rnd(s) % 2 ? uniform(s, 0.001, 1) : 0;
	g->feed_max_mm_s = uniform(s, 0.1, 5);
	g->creep_mm_s = uniform(s, 0, 1);
	g->feed_a_mm_s2 = rnd(s) % 2 ? uniform(s, 10, 2000) : 0;
	g->retract_mm_s = uniform(s, 0.1, 10);
	g->abort_count = (uint32_t)(rnd(s) % 20);
}

static inline void random_bounds(struct cycle_gap_config *g, uint64_t *s)
{
	g->process = rnd(s) % 4 ? PROCESS_SINK : PROCESS_WIRE;
	g->retract_to = (enum retract_to)(rnd(s) % RETRACT_NPLACES);
	g->retract_limit_mm = uniform(s, 0.05, 1);
	g->retract_max.cycles = rnd(s) % 300;
	g->progress_mm = uniform(s, 0, 0.1);
	g->arcing_share = rnd(s) % 2 ? uniform(s, 0.05, 0.5) : 0;
	g->arcing_cycles = (uint32_t)(rnd(s) % 30);
	g->arcing_sigma_v = rnd(s) % 2 ? uniform(s, 0, 3) : 0;
	g->off_us = rnd(s) % 2 ? 20 : 0;
	g->arcing_off_max = uniform(s, 1, 5);
	g->arcing_recover.cycles = rnd(s) % 200;
	g->arcing_retract_mm = uniform(s, 0, 1);
	g->retract_escape = rnd(s) % 2;
	g->wire_retract_mm = uniform(s, 0.01, 0.1);
	g->wire_retreat_to = (enum retreat_to)(rnd(s) % RETREAT_NPLACES);
	g->wire_retreat_mm = uniform(s, 0, 1);
}

static inline void random_jump(struct cycle_jump_config *j, uint64_t *s)
{
	j->height_mm = rnd(s) % 3 ? uniform(s, 0, 1) : 0;
	j->every_mm = rnd(s) % 3 ? 0 : uniform(s, 0.01, 0.1);
	j->every.cycles = 1 + rnd(s) % 200;
	j->adaptive = rnd(s) % 2;
	j->every_min.cycles = 1 + rnd(s) % 50;
	j->every_max.cycles = 50 + rnd(s) % 200;
	j->height_min_mm = uniform(s, 0.01, 0.5);
	j->height_max_mm = uniform(s, 0.5, 2);
	j->bad_share = uniform(s, 0.001, 0.5);
}

static inline struct cycle_config random_config(uint64_t *s)
{
	struct cycle_config k = usual_config();

	k.points_max = POINTS_MAX;
	k.mcode_cycles = rnd(s) % 4 ? 5 + rnd(s) % 40 : 0;
	k.axes_wait_cycles = rnd(s) % 2 ? 1 + rnd(s) % 200 : 0;
	k.optional_stop = rnd(s) % 2;
	k.dry_run = rnd(s) % 8 == 0;
	random_law(&k.gap, s);
	random_sensor(&k.gap, s);
	random_bounds(&k.gap, s);
	random_jump(&k.jump, s);
	for (int i = 0; i < INTERP_NAXES && rnd(s) % 4 == 0; i++) {
		k.travel_min[i] = -(int32_t)(rnd(s) % 500);
		k.travel_max[i] = (int32_t)(rnd(s) % 500);
	}
	return k;
}

/* Shares that hang together with the voltage, and now and then do not. */
static inline void random_shares(struct rig *r, double v, uint64_t *s)
{
	const double shorted = v < SHORTED_V ? 1 : 0;
	const double open = fmin(fmax((v - 40) / 80, 0), 1 - shorted);
	const double arc = uniform(s, 0, 1) * (1 - open - shorted);

	if (rnd(s) % 2000 == 0)
		shares(r, uniform(s, -1, 2), NAN, 0, 0);
	else if (isfinite(v))
		shares(r, open, fmax(0, 1 - open - shorted - arc), arc,
		       shorted);
	r->in.shares_valid = rnd(s) % 3000 != 0;
}

/* Wanders through the zones, with sudden shorts. */
static inline double wander_on(double v, uint64_t *s)
{
	const uint64_t pick = rnd(s) % 200;

	if (pick == 0)
		return 0;
	if (pick == 1)
		return OPEN_V;
	return fmin(120, fmax(0, v + uniform(s, -4, 4.2)));
}

static inline double no_number(uint64_t *s)
{
	const double odd[] = { NAN, INFINITY, -INFINITY, -1e300, 1e300 };

	return odd[rnd(s) % 5];
}

static inline double random_gap(struct gap_world *g, uint64_t *s)
{
	if (g->left-- <= 0) {
		g->mood = rnd(s) % 2000 ? MOOD_WANDERS :
					  (enum gap_mood)(rnd(s) % NMOODS);
		g->left = g->mood == MOOD_WANDERS ? 0 :
			  g->mood == MOOD_ILL	  ? (int)(rnd(s) % 5) :
						    (int)(rnd(s) % 1500);
	}
	if (g->mood == MOOD_WANDERS)
		g->v = wander_on(g->v, s);
	if (g->mood == MOOD_NOISY)
		g->v = uniform(s, 0, 120);
	return g->mood == MOOD_ILL ? no_number(s) : g->v;
}

static inline void random_command(struct rig *r, uint64_t *s)
{
	const struct cycle_command m = {
		.verb = (uint32_t)(rnd(s) % (CYCLE_NVERBS + 1)),
		.arg = (uint32_t)(rnd(s) % (INTERP_NTECH + 1)),
		.arg_mm = rnd(s) % 10 ? uniform(s, -0.1, 2) *
					(rnd(s) % 4 ? 1 : 40) : NAN,
	};

	/* A stop ends the job: rarely. */
	if (m.verb != CYCLE_STOP || rnd(s) % 8 == 0)
		assert_string_not_equal(
			cycle_answer_text(cycle_command(&r->c, &m)), "?");
}

/* Drives that take their time, lose their power, and keep their troubles. */
static inline void random_axes(struct rig *r, uint64_t *s)
{
	if (r->out.reset)
		r->in.trouble = IO_WELL;
	else if (rnd(s) % 4000 == 0)
		r->in.trouble = (enum io_trouble)(rnd(s) % IO_NTROUBLES);
	if (!r->out.enable || rnd(s) % 6000 == 0)
		r->in.axes_off = r->c.config.axes_wait_cycles > 0;
	else if (rnd(s) % 10 == 0)
		r->in.axes_off = false;
	r->in.starting = rnd(s) % 1000 == 0;
	if (rnd(s) % 200 == 0)
		r->in.steers = rnd(s) % 2;
}

/* It does what it is told, in its time, and loses things now and then. */
static inline void random_plc(struct rig *r, uint64_t *s)
{
	struct io_plc *p = &r->in.plc;
	const uint8_t done = p->mcode_done;

	if (!p->present)
		return;
	*p = well();
	p->mcode_done = done;
	p->alive = rnd(s) % 3000 != 0;
	p->permit = rnd(s) % 3000 != 0;
	p->door_closed = rnd(s) % 3000 != 0;
	p->level_ok = rnd(s) % 3000 != 0;
	p->temperature_ok = rnd(s) % 3000 != 0;
	p->no_fire = rnd(s) % 3000 != 0;
	p->wire_whole = rnd(s) % 3000 != 0;
	p->start = rnd(s) % 200 == 0;
	p->reset = rnd(s) % 200 == 0;
	p->hold = rnd(s) % 1000 == 0;
	p->override = rnd(s) % 100 ? r->c.plc.override : uniform(s, 0, 2);
	if (rnd(s) % 80 == 0)
		p->mcode_done = rnd(s) % 50 ? r->c.mcode.number :
					      (uint8_t)rnd(s);
}

static inline void random_world(struct rig *r, uint64_t *s)
{
	random_axes(r, s);
	random_plc(r, s);
	r->in.estop = rnd(s) % 3000 == 0;
	r->in.lost = rnd(s) % 5000 == 0;
	r->in.gap_valid = rnd(s) % 2000 != 0;
	r->in.wire_broken = rnd(s) % 2000 == 0;
	r->in.limit = rnd(s) % 6000 == 0 ? 1u << rnd(s) % 8 : 0;
	r->in.door_open = rnd(s) % 6000 == 0;
	r->in.dielectric_low = rnd(s) % 6000 == 0;
	r->in.busy = rnd(s) % 50 < 5;
	if (rnd(s) % 500 == 0)
		random_law(&r->c.gap, s);
	r->in.generator.trouble = rnd(s) % 8000 == 0;
	if (rnd(s) % 500 == 0)
		random_jump(&r->c.jump, s);
	if (rnd(s) % 1000 == 0)
		cycle_overrun(&r->c, (uint32_t)(rnd(s) % 12));
	if (rnd(s) % 100 == 0)
		random_command(r, s);
	/* An operator who goes on. */
	if (r->c.state == STATE_FAULT && rnd(s) % 20 == 0)
		tell(r, CYCLE_RESET);
	if (stand_asks(&r->c) && rnd(s) % 20 == 0)
		tell_mm(r, CYCLE_CONFIRM, r->c.stand.of);
	if (r->c.state == STATE_HOLD && rnd(s) % 20 == 0)
		tell(r, CYCLE_START);
}

#endif /* RANDOM_WORLD_H */
