/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_servo.c - under the gap servo and in touches every axis keeps its
 * own speed and acceleration
 *
 * By differences of where each axis is from cycle to cycle, along random paths
 * and through all changes of state; the seed is printed.
 */
#include "axis_track.h"

#define ROUNDS	SEED_ROUNDS(40)
#define CYCLES	8000

static uint64_t seed;

/* Three cycles on one segment of the path, none of them standing in a fault. */
static bool is_servo(const struct track *k, const struct rig *r)
{
	return k->n >= 4 && k->index[1] == k->index[3] &&
	       k->index[2] == k->index[3] &&
	       r->c.cursor.seg.kind < INTERP_BEGIN &&
	       state_duty[r->c.state].running;
}

/* A place less than 1e-9 mm ahead is met; two of these in a difference. */
static void check_servo(const struct track *k, const struct rig *r)
{
	const double t = PERIOD_S;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const double onto = 4e-9 * rate_of(r, i) / (t * t);
		const struct interp_axis_limits *l = &axes_machine.axis[i];
		const double v[2] = { (k->at[2][i] - k->at[1][i]) / t,
				      (k->at[3][i] - k->at[2][i]) / t };
		const double a = (v[1] - v[0]) / t;

		const double more = rounding_of(r, i) * (1 + 1e-6);

		if (fabs(v[1]) > l->v_max_mm_s * more ||
		    fabs(a) > l->a_max_mm_s2 * more + onto)
			fail_msg("axis %c, %s, segment %u: %g mm/s, %g of %g "
				 "mm/s2", INTERP_AXIS_LETTERS[i],
				 state_duty[r->c.state].name,
				 (unsigned)k->index[3], v[1], a,
				 l->a_max_mm_s2);
	}
}

static struct cycle_config config_of(uint64_t *s)
{
	struct cycle_config k = usual_config();

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -1000000;
		k.travel_max[i] = 1000000;
	}
	k.travel_a_mm_s2 = k.jump.a_max_mm_s2 = 4000;
	k.travel_j_mm_s3 = k.jump.j_max_mm_s3 = 2e5;
	k.jump.height_mm = uniform(s, 0, 3);
	k.jump.every.cycles = 50 + rnd(s) % 500;
	k.gap.feed_max_mm_s = pow(10, uniform(s, -0.5, 1));
	k.gap.approach_mm_s = pow(10, uniform(s, -0.5, 1));
	k.gap.retract_mm_s = pow(10, uniform(s, 0, 1.5));
	k.gap.retract_limit_mm = pow(10, uniform(s, -1, 1));
	k.gap.feed_a_mm_s2 = rnd(s) % 2 ? 0 : pow(10, uniform(s, 1, 4));
	k.gap.gain_mm_s_v = 1;
	k.gap.integral_s = rnd(s) % 2 ? 0.1 : 0;
	return k;
}

/* A gap that holds a zone for a while. */
static double gap_of(uint64_t *s, double was_v)
{
	static const double zones[] = { SHORTED_V, NARROW_V, 40, SPARKING_V,
					SPARKING_V, 60, OPEN_V };

	return rnd(s) % 25 ? was_v : zones[rnd(s) % 7];
}

static void whatever_the_gap_says_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed;
	uint32_t retracts = 0;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct cycle_config k;
		struct track t = { .n = 0 };
		double v = OPEN_V;
		struct rig r;

		set_machine(&s);
		k = config_of(&s);
		rig_take(&r, random_path(&s), &k);
		tell(&r, CYCLE_START);
		for (int n = 0; n < CYCLES && r.c.loaded; n++) {
			if (r.c.state == STATE_FAULT) {
				tell(&r, CYCLE_RESET);
				t.n = 0;
			}
			if (r.c.state == STATE_HOLD && !r.c.hold.moving)
				tell(&r, CYCLE_START);
			else if (rnd(&s) % 500 == 0)
				tell(&r, CYCLE_HOLD);
			v = gap_of(&s, v);
			step(&r, v);
			note(&t, &r);
			if (is_servo(&t, &r))
				check_servo(&t, &r);
		}
		retracts += r.c.totals.retracts;
		rig_free(&r);
	}
	assert_true((int)retracts > ROUNDS);
}

/* -- Touches -------------------------------------------------------------- */

static struct made touch(int axis)
{
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
		.ends = INTERP_SEG_PROBE,
	};
	struct interp_build *b = interp_build_create(&o);
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;

	end[axis] = 5;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	return finish(b);
}

static struct probe_config probe_of(uint64_t *s)
{
	return (struct probe_config) {
		.feed_mm_s = pow(10, uniform(s, 0, 0.5)),
		.fine_mm_s = pow(10, uniform(s, -1, 1)),
		.back_mm = rnd(s) % 4 ? uniform(s, 0.1, 0.3) : 0,
		.settle.cycles = 5,
	};
}

static void in_touches_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed + 1;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const int axis = i % INTERP_NAXES;
		const double front_mm = uniform(&s, 0.2, 3);
		struct track t = { .n = 0 };
		struct cycle_config k;
		struct rig r;

		set_machine(&s);
		k = config_of(&s);
		k.probe = probe_of(&s);
		rig_take(&r, touch(axis), &k);
		tell(&r, CYCLE_START);
		/* Where it has ended, the program jumps to its end. */
		while (r.c.loaded && r.c.probe.phase != PROBE_DONE) {
			r.in.contact = r.out.target[axis] * PULSE_MM >=
				       front_mm;
			step(&r, OPEN_V);
			assert_int_equal(r.c.fault.first, FAULT_NONE);
			note(&t, &r);
			if (is_servo(&t, &r) && r.c.probe.phase != PROBE_DONE)
				check_servo(&t, &r);
		}
		assert_true(r.c.probe.phase == PROBE_DONE);
		rig_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whatever_the_gap_says_every_axis_keeps_its_limits),
		cmocka_unit_test(in_touches_every_axis_keeps_its_limits),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
