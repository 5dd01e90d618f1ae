/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle_help.h - a cycle with inputs that the test makes: no machine, no gap
 *
 * Every step checks what must always hold.
 */
#ifndef CYCLE_HELP_H
#define CYCLE_HELP_H

#include "walk_help.h"

#include "cycle.h"
#include "path/walk.h"

/* Gap voltages of the zones of usual_config(). */
#define SHORTED_V	5.0
#define NARROW_V	30.0
#define SPARKING_V	50.0
#define OPEN_V		100.0

#define PERIOD_S	1e-3
#define PULSE_MM	0.001

/* cmocka's own compares floats. */
#define assert_near(a, b, eps)	assert_true(fabs((a) - (b)) <= (eps))

struct rig {
	struct made m;
	struct cycle c;
	struct io_inputs in;
	struct io_outputs out;
	struct io_outputs before;	/* out of the cycle before */
	int32_t path_before[INTERP_NAXES];	/* on the path, the same */
	enum cycle_state was;		/* state of the cycle before */
};

static inline struct cycle_config usual_config(void)
{
	struct cycle_config k = {
		.period_ns = 1000000,
		.gap = {
			.servo_v = 40, .short_v = 15, .open_v = 70,
			.gain_mm_s_v = 0.1, .feed_max_mm_s = 4,
			.creep_mm_s = 0.5,
			.approach_mm_s = 2, .retract_mm_s = 5,
			.retract_limit_mm = 0.5, .retract_wait.cycles = 50,
		},
		.jump = {
			.every.cycles = 100, .v_max_mm_s = 50,
			.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000,
			.short_of_mm = 0.02,
		},
		.travel_a_mm_s2 = 1000,
		.travel_j_mm_s3 = 20000,
		.overrun_limit = 10,
		.points_max = 4096,
	};

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -200000;
		k.travel_max[i] = 200000;
	}
	return k;
}

/* The way from any acceleration at a speed to a stand, and a cycle more. */
static inline double braking_mm(const struct cycle_config *k, double v)
{
	const double a = k->travel_a_mm_s2, j = k->travel_j_mm_s3;
	const double top = v + a * PERIOD_S + a * a / (2 * j);

	return top * a / j + top / 2 * (top / a + a / j) + top * PERIOD_S;
}

/* -- Programs ------------------------------------------------------------ */

static inline void go_z(struct interp_build *b, double z_mm, bool rapid)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .rapid = rapid,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_Z] = z_mm;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static inline void cut_to(struct interp_build *b, double z_mm)
{
	go_z(b, z_mm, false);
}

static inline void rapid_to(struct interp_build *b, double z_mm)
{
	go_z(b, z_mm, true);
}

static inline void action(struct interp_build *b, enum interp_kind kind,
			  uint32_t arg)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	struct interp_diag d;

	assert_int_equal(interp_build_action(b, kind, arg, &w, &d), 0);
}

/* -- The cycle ----------------------------------------------------------- */

static inline void rig_take(struct rig *r, struct made m,
			    const struct cycle_config *k)
{
	memset(r, 0, sizeof(*r));
	r->m = m;
	r->in.gap_valid = true;
	r->in.gap_v = OPEN_V;
	cycle_init(&r->c, k);
	assert_int_equal(cycle_load(&r->c, &r->m.p), ANSWER_DONE);
	r->out = r->c.out;
}

static inline void rig_load(struct rig *r, struct interp_build *b,
			    const struct cycle_config *k)
{
	rig_take(r, finish(b), k);
}

static inline void rig_free(struct rig *r)
{
	unmake(&r->m);
}

static inline enum cycle_answer tell_mm(struct rig *r, enum cycle_verb v,
					double mm)
{
	const struct cycle_command m = { .verb = v, .arg_mm = mm };

	return cycle_command(&r->c, &m);
}

static inline enum cycle_answer tell(struct rig *r, enum cycle_verb v)
{
	return tell_mm(r, v, 0);
}

/* Of the cut that the cursor is in, or in front of which it stands. */
static inline const struct interp_cond *
cond_cut(const struct interp_cursor *at)
{
	const struct interp_seg *s = &at->seg;

	for (uint32_t i = at->index + 1; s->kind >= INTERP_BEGIN; i++)
		s = &at->p.segs[i];
	return &at->p.conds[s->cond];
}

static inline bool sparking_state(enum cycle_state s)
{
	return s == STATE_APPROACH || s == STATE_ERODE;
}

/* What must hold in every cycle of every test. */
static inline void check_always(const struct rig *r)
{
	const struct cycle_config *k = &r->c.config;

	assert_true(r->c.state > STATE_STAY && r->c.state < CYCLE_NSTATES);
	assert_int_equal(r->out.power,
			 sparking_state(r->c.state) && !r->c.job.power_off &&
			 !walk_positions(&r->c) && r->c.asking.in_force);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t at = r->c.out.target[i];
		const int64_t step = (int64_t)at - r->path_before[i];
		/* Maps and backlash reach beyond. */
		const bool cured = k->comp.mapped || k->comp.axis[i].backlash;

		assert_true(at >= k->travel_min[i] && at <= k->travel_max[i]);
		assert_true(cured || r->out.target[i] >= k->travel_min[i]);
		assert_true(cured || r->out.target[i] <= k->travel_max[i]);
		assert_true(llabs(step) <= k->points_max);
		if (r->was == STATE_FAULT)
			assert_int_equal(step, 0);
	}
}

static inline void step(struct rig *r, double gap_v)
{
	r->before = r->out;
	memcpy(r->path_before, r->c.out.target, sizeof(r->path_before));
	r->was = r->c.state;
	r->in.gap_v = gap_v;
	memcpy(r->in.stands_at, r->out.target, sizeof(r->out.target));
	cycle_step(&r->c, &r->in, &r->out);
	check_always(r);
}

static inline void steps(struct rig *r, double gap_v, int n)
{
	while (n-- > 0)
		step(r, gap_v);
}

static inline double place(const struct rig *r)
{
	return interp_cursor_place_mm(&r->c.cursor);
}

/* The way of @n cycles from one speed to another, changing it by the
 * acceleration @a: as a servo goes. */
static inline double ramp_mm(double from, double to, double a, int n)
{
	const double dv = a * PERIOD_S;
	double mm = 0;

	while (n-- > 0) {
		from = from < to ? fmin(from + dv, to) : fmax(from - dv, to);
		mm += from * PERIOD_S;
	}
	return mm;
}

/* Step until the state is @s; it must come within @n cycles. */
static inline int until(struct rig *r, enum cycle_state s, double gap_v, int n)
{
	int i = 0;

	while (r->c.state != s && i < n) {
		step(r, gap_v);
		i++;
	}
	assert_string_equal(state_duty[r->c.state].name, state_duty[s].name);
	return i;
}

/* Cut on until @place_mm of the path is reached. */
static inline void cut_until(struct rig *r, double place_mm)
{
	for (int i = 0; i < 100000 && place(r) < place_mm; i++)
		step(r, SPARKING_V);
	assert_true(place(r) >= place_mm);
}

/* A millimetre of air, then a cut of four; begun. */
static inline void begin_cut(struct rig *r, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -1);
	cut_to(b, -5);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static inline void cut_at(struct rig *r, const struct cycle_config *k,
			  double mm)
{
	begin_cut(r, k);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	cut_until(r, mm);
	assert_int_equal(r->c.state, STATE_ERODE);
}

/* A step with the inputs as they are. */
static inline void step_on(struct rig *r)
{
	step(r, r->in.gap_v);
}

static inline void shares(struct rig *r, double open, double spark, double arc,
			  double shorted)
{
	r->in.shares = (struct io_shares) {
		(float)open, (float)spark, (float)arc, (float)shorted
	};
	r->in.shares_valid = true;
}

static inline double z_mm(const struct rig *r)
{
	return r->out.target[INTERP_Z] * PULSE_MM;
}

#endif /* CYCLE_HELP_H */
