/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_travel.c - promises of positioning over segments of many speeds
 *
 * The programs are random; the seed is printed.
 */
#include "cycle_help.h"
#include "seed.h"

#define ROUNDS	SEED_ROUNDS(150)
#define SEGS	40

static uint64_t seed;

static void random_line(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = pow(10, uniform(s, -0.5, 1.8)),
		.rapid = rnd(s) % 6 == 0,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] += uniform(s, 0.001, 1) * (rnd(s) % 3 ? 0.1 : 3);
	if (rnd(s) % 2)
		end[INTERP_Y] += uniform(s, 0, 0.1);
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void load_random(struct rig *r, uint64_t *s, bool stops)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();

	k.dry_run = true;
	k.travel_a_mm_s2 = pow(10, uniform(s, 2, 3.5));
	k.travel_j_mm_s3 = k.travel_a_mm_s2 * pow(10, uniform(s, 0.5, 2.5));
	for (int i = 0; i < SEGS; i++) {
		random_line(b, s);
		if (stops && rnd(s) % 5 == 0)
			action(b, rnd(s) % 2 ? INTERP_DWELL :
					       INTERP_OPTIONAL_STOP, 3);
	}
	rig_load(r, b, &k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

/* One cycle; neither speed nor acceleration steps. */
static void step_smoothly(struct rig *r)
{
	const struct cycle_config *k = &r->c.config;
	const double v = r->c.mover.v_mm_s, a = r->c.mover.a_mm_s2;
	const uint32_t done = r->c.job.action_done;

	step(r, OPEN_V);
	/* From there another move begins, with limits of its own. */
	assert_true(r->c.job.action_done == done ||
		    mover_is_standing(&r->c.mover));
	assert_true(fabs(r->c.mover.v_mm_s - v) <=
		    k->travel_a_mm_s2 * PERIOD_S * (1 + 1e-9));
	/* A stop less than 1e-9 mm ahead is met, a little early. */
	assert_true(fabs(r->c.mover.a_mm_s2 - a) <=
		    k->travel_j_mm_s3 * PERIOD_S * (1 + 1e-9) +
		    (r->c.mover.v_mm_s != 0 ? 0 :
		     cbrt(6e-9 * k->travel_j_mm_s3 * k->travel_j_mm_s3)));
	assert_true(r->c.mover.v_mm_s >= -1e-9);
}

static void it_keeps_to_each_segments_speed_without_a_step(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct rig r;

		load_random(&r, &s, true);
		for (int n = 0; n < 400000 && r.c.state == STATE_TRAVEL; n++) {
			const struct interp_seg *g = &r.c.cursor.seg;

			step_smoothly(&r);
			if (g->kind < INTERP_BEGIN)
				assert_true(r.c.mover.v_mm_s <=
					    fmin(g->feed_mm_s,
						 g->feed_max_mm_s) *
					    (1 + 1e-9));
		}
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		rig_free(&r);
	}
}

static void a_hold_at_any_instant_stops_where_it_says(void **st)
{
	uint64_t s = seed + 1;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		double from, way;
		struct rig r;

		load_random(&r, &s, false);
		for (uint64_t n = rnd(&s) % 400; n > 0; n--)
			step_smoothly(&r);
		while (r.c.state == STATE_TRAVEL) {
			const double v = r.c.mover.v_mm_s;
			const double a = r.c.mover.a_mm_s2;
			struct interp_scurve_limits l;

			from = place(&r);
			tell(&r, CYCLE_HOLD);
			step_smoothly(&r);
			/* What its axes allow, if it began to move. */
			l = (struct interp_scurve_limits) {
				1, r.c.mover.l.a_max_mm_s2,
				r.c.mover.l.a_max_mm_s2,
				r.c.mover.l.j_max_mm_s3,
			};
			way = l.a_up_mm_s2 > 0 ?
			      interp_scurve_way_mm(&l, v, a, 0) : 0;
			for (int n = 0; n < 5000 && r.c.mover.v_mm_s != 0; n++)
				step_smoothly(&r);
			assert_int_equal(r.c.state, STATE_HOLD);
			assert_near(place(&r) - from, way, 1e-7);
			tell(&r, CYCLE_RESUME);
			for (uint64_t n = 1 + rnd(&s) % 300; n > 0 &&
			     r.c.state == STATE_TRAVEL; n--)
				step_smoothly(&r);
		}
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		rig_free(&r);
	}
}

/* A line in one piece, or in hundreds: the same time, a cycle or two. */
static uint64_t cycles_of_pieces(int pieces)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;
	uint64_t n;

	for (int i = 1; i <= pieces; i++)
		rapid_to(b, -20.0 * i / pieces);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_IDLE, OPEN_V, 100000);
	n = r.c.totals.cycles;
	rig_free(&r);
	return n;
}

static void nodes_on_a_line_cost_no_time(void **st)
{
	const uint64_t one = cycles_of_pieces(1);

	(void)st;
	for (int n = 5; n <= 500; n *= 10)
		assert_in_range(cycles_of_pieces(n), one - 2, one + 2);
}

/* So slow that it stands within a rounding from anywhere. */
static void the_slowest_override_does_not_enter_a_cut(void **state)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)state;
	rapid_to(b, -2e-6);
	cut_to(b, -1);
	rig_load(&r, b, &k);
	assert_int_equal(tell_mm(&r, CYCLE_OVERRIDE, 1e-9), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int n = 0; n < 60000 && r.c.state == STATE_TRAVEL; n++) {
		assert_true(place(&r) < 2e-6 + 4 * MOVER_ONTO_MM);
		step(&r, OPEN_V);
	}
	assert_int_equal(r.c.state, STATE_APPROACH);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_keeps_to_each_segments_speed_without_a_step),
		cmocka_unit_test(a_hold_at_any_instant_stops_where_it_says),
		cmocka_unit_test(nodes_on_a_line_cost_no_time),
		cmocka_unit_test(the_slowest_override_does_not_enter_a_cut),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
