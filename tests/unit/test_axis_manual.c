/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_manual.c - in jogs, presses and homing an axis keeps its own speed,
 * acceleration and jerk
 *
 * By differences of the pulses that the drives get, over 1 to 16 cycles, with
 * random axes, switches that bounce, stops and speeds that change on the way.
 * The pulses are so small that some axes are faster than their pulses can be
 * put out.  The seed is printed.
 */
#include "manual_help.h"
#include "seed.h"
#include "verbs.h"

#define ROUNDS	SEED_ROUNDS(60)

static uint64_t seed;
static uint64_t looked[CYCLE_NSTATES];

#define FINE_MM		1e-5
#define KEPT		64		/* cycles, at least three times 16 */

/* Pulses of the axis under hand, in the last cycles of one move. */
struct way {
	int32_t at[KEPT];
	int n;
};

static struct cycle_config random_axes(uint64_t *s)
{
	struct cycle_config k = manual_config();

	for (int i = 0; i < 3; i++) {
		struct manual_axis *a = &k.axis[i];

		k.travel_min[i] *= 100;
		k.travel_max[i] *= 100;
		a->pulse_mm = FINE_MM;
		a->v_max_mm_s = uniform(s, 10, 90);
		a->a_max_mm_s2 = pow(10, uniform(s, 1.5, 3.5));
		a->j_max_mm_s3 = pow(10, uniform(s, 3, 5.5));
		a->jog_mm_s = uniform(s, 1, 100);
		a->home_fast_mm_s = uniform(s, 1, 60);
		a->home_slow_mm_s = pow(10, uniform(s, -1, 1.5));
		a->home_toward = rnd(s) % 2 ? -1 : 1;
		a->home_back_mm = uniform(s, 0.05, 2);
		a->method = rnd(s) % 2 ? HOME_SWITCH : HOME_SWITCH_INDEX;
	}
	return k;
}

static double at_mm(const struct way *w, int ago)
{
	return FINE_MM * w->at[(w->n - 1 - ago) % KEPT];
}

/* Each place is half a pulse off, and a jog may end 2e-9 mm early. */
static void check(const struct way *w, const struct cycle *c, int over)
{
	const struct manual_axis *a = manual_axis(c);
	const double t = over * PERIOD_S, off = FINE_MM / 2 + 2e-9;
	const double p[4] = { at_mm(w, 0), at_mm(w, over), at_mm(w, 2 * over),
			      at_mm(w, 3 * over) };
	const double v = fabs(p[0] - p[1]) - 2 * off;
	const double acc = fabs(p[0] - 2 * p[1] + p[2]) - 4 * off;
	const double j = fabs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) - 8 * off;

	if (v > a->v_max_mm_s * t * (1 + 1e-6) ||
	    acc > a->a_max_mm_s2 * t * t * (1 + 1e-6) ||
	    j > a->j_max_mm_s3 * t * t * t * (1 + 1e-6))
		fail_msg("%s, phase %d, over %d cycles: %g of %g mm/s, "
			 "%g of %g mm/s2, %g of %g mm/s3",
			 state_duty[c->state].name, (int)c->manual.phase, over,
			 v / t, a->v_max_mm_s, acc / t / t, a->a_max_mm_s2,
			 j / t / t / t, a->j_max_mm_s3);
	looked[c->state]++;
}

static void note(struct way *w, const struct bench *b, uint32_t *axis)
{
	if (b->c.manual.axis != *axis)
		w->n = 0;
	*axis = b->c.manual.axis;
	w->at[w->n++ % KEPT] = b->out.target[*axis];
	for (int over = 1; over <= 16 && 3 * over < w->n; over *= 2)
		check(w, &b->c, over);
}

/* Until it has ended; @meddle may do something in each cycle. */
static void watch(struct bench *b, enum cycle_state s, uint64_t *rs,
		  void (*meddle)(struct bench *b, uint64_t *rs))
{
	struct way w = { .n = 0 };
	uint32_t axis = INTERP_NAXES;

	period(b);
	for (int n = 0; n < 400000 && b->c.state == s; n++) {
		meddle(b, rs);
		period(b);
		if (b->c.state == s)
			note(&w, b, &axis);
	}
	assert_int_equal(b->c.state, STATE_IDLE);
	assert_int_equal(b->c.fault.first, FAULT_NONE);
}

/* No limit switches, and index marks every 2 mm. */
static void set_up(struct bench *b, const struct cycle_config *k)
{
	bench_init(b, k);
	b->limit_min = INT32_MIN;
	b->limit_max = INT32_MAX;
	b->index = 200000;
}

static void stop_some_time(struct bench *b, uint64_t *s)
{
	if (rnd(s) % 400 == 0)
		ask(b, CYCLE_STOP, 0, 0);
}

static void in_jogs_an_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct cycle_config k = random_axes(&s);
		struct bench b;

		set_up(&b, &k);
		b.c.manual.homed = rnd(&s) % 2 ? 7 : 0;
		assert_int_equal(jog(&b, (uint32_t)i % 3, uniform(&s, -40, 40)),
				 ANSWER_DONE);
		watch(&b, STATE_JOG, &s, stop_some_time);
	}
}

/* Signs of one press at speeds that change, at times none. */
static void press_on(struct bench *b, uint64_t *s)
{
	const double v = b->c.manual.goal_mm > 0 ? 1 : -1;

	if (rnd(s) % 50 == 0)
		ask(b, CYCLE_JOG_ON,
		    1 << 8 | b->c.manual.axis,
		    rnd(s) % 20 ? v * uniform(s, 0.1, 90) : 0);
}

static void in_presses_an_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed + 1;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct cycle_config k = random_axes(&s);
		const double v = uniform(&s, 1, 90);
		struct bench b;

		set_up(&b, &k);
		b.c.manual.homed = 7;
		assert_int_equal(ask(&b, CYCLE_JOG_ON,
				     1 << 8 | VERB_PRESS_BEGINS |
				     (uint32_t)i % 3, i % 2 ? v : -v),
				 ANSWER_DONE);
		watch(&b, STATE_JOG, &s, press_on);
	}
}

/* The switch of each axis, seen from either side; now and then it bounces. */
static void switches(struct bench *b, uint64_t *s)
{
	for (int i = 0; i < 3; i++) {
		const int toward = b->c.config.axis[i].home_toward;
		const int32_t at = b->out.target[i];
		const bool on = toward < 0 ? at <= -2000000 : at >= 2000000;
		const bool near = abs(abs(at) - 2000000) < 30000;

		b->home[i] = on != (near && rnd(s) % 10 == 0) ? INT32_MAX :
								INT32_MIN;
	}
}

static void in_homing_an_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed + 2;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct cycle_config k = random_axes(&s);
		struct bench b;

		set_up(&b, &k);
		assert_int_equal(ask(&b, CYCLE_HOME, MANUAL_ALL_AXES, 0),
				 ANSWER_DONE);
		switches(&b, &s);
		watch(&b, STATE_HOME, &s, switches);
		assert_int_equal(b.c.manual.homed, 7);
	}
	assert_true(looked[STATE_JOG] > 1000 && looked[STATE_HOME] > 1000);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(in_jogs_an_axis_keeps_its_limits),
		cmocka_unit_test(in_presses_an_axis_keeps_its_limits),
		cmocka_unit_test(in_homing_an_axis_keeps_its_limits),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
