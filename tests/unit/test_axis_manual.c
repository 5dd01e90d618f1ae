/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_manual.c - in jogs, presses and homing an axis keeps its own speed,
 * acceleration and jerk
 *
 * By differences of the way from cycle to cycle, with random axes, switches
 * that bounce, stops and speeds that change on the way; the seed is printed.
 */
#include "manual_help.h"
#include "seed.h"
#include "verbs.h"

#define ROUNDS	60

static uint64_t seed;
static uint64_t looked[CYCLE_NSTATES];

/* The way of the axis under hand, in four cycles of one move. */
struct way {
	double at[4];
	int n;
};

static struct cycle_config random_axes(uint64_t *s)
{
	struct cycle_config k = manual_config();

	for (int i = 0; i < 3; i++) {
		struct manual_axis *a = &k.axis[i];

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

/* A place less than 2e-9 mm ahead counts as met; a difference has four. */
static void check(const struct way *w, const struct cycle *c)
{
	const struct manual_axis *a = manual_axis(c);
	const double t = PERIOD_S, onto = 2 * MOVER_ONTO_MM;
	const double v[3] = { (w->at[1] - w->at[0]) / t,
			      (w->at[2] - w->at[1]) / t,
			      (w->at[3] - w->at[2]) / t };
	const double acc[2] = { (v[1] - v[0]) / t, (v[2] - v[1]) / t };
	const double jerk = (acc[1] - acc[0]) / t;

	if (fabs(v[2]) > a->v_max_mm_s * (1 + 1e-6) ||
	    fabs(acc[1]) > a->a_max_mm_s2 * (1 + 1e-6) + 4 * onto / (t * t) ||
	    fabs(jerk) > a->j_max_mm_s3 * (1 + 1e-6) + 8 * onto / (t * t * t))
		fail_msg(
			"%s, phase %d: %g of %g mm/s, %g of %g mm/s2, %g of %g "
			"mm/s3",
			state_duty[c->state].name, (int)c->manual.phase, v[2],
			a->v_max_mm_s, acc[1], a->a_max_mm_s2, jerk,
			a->j_max_mm_s3);
	looked[c->state]++;
}

static void note(struct way *w, const struct bench *b, uint32_t *axis)
{
	const struct manual *h = &b->c.manual;

	if (h->axis != *axis || h->gone_mm == 0)
		w->n = 0;
	*axis = h->axis;
	memmove(w->at, w->at + 1, 3 * sizeof(w->at[0]));
	w->at[3] = h->gone_mm;
	if (++w->n >= 4)
		check(w, &b->c);
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

		bench_init(&b, &k);
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

		bench_init(&b, &k);
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
		const bool on = toward < 0 ? at <= -20000 : at >= 20000;
		const bool near = abs(abs(at) - 20000) < 300;

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

		bench_init(&b, &k);
		b.limit_min = INT32_MIN;
		b.limit_max = INT32_MAX;
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
