/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_comp.c - backlash and pitch error between the path and the pulses
 */
#include "cycle_help.h"

#include "comp.h"

/* One axis, the others without. */
struct bench {
	struct comp_config k[INTERP_NAXES];
	struct comp c;
	int32_t at[INTERP_NAXES], out[INTERP_NAXES];
	uint32_t edges;
};

static struct bench make(int32_t backlash, double take_up)
{
	struct bench b = { .edges = 0 };

	b.k[0].backlash = backlash;
	b.k[0].take_up = take_up;
	return b;
}

static void to(struct bench *b, int32_t place)
{
	b->at[0] = place;
	comp_apply(&b->c, b->k, b->at, false, b->edges, b->out);
}

static void rest(struct bench *b, int periods)
{
	while (periods-- > 0)
		to(b, b->at[0]);
}

static void pitch(struct bench *b)
{
	b->k[0].n = 4;
	for (int i = 0; i < 4; i++) {
		b->k[0].at[i] = i * 100;
		b->k[0].add[i] = (double[]) { 0, 6, -4, 2 }[i];
	}
	b->k[0].take_up = 1000;
}

static void without_any_pulses_are_places(void **state)
{
	struct bench b = make(0, 0);

	(void)state;
	for (int32_t p = -500; p <= 500; p += 7) {
		to(&b, p);
		assert_int_equal(b.out[0], p);
	}
}

static void a_turn_takes_the_whole_backlash_up(void **state)
{
	struct bench b = make(12, 5);

	(void)state;
	to(&b, 0);
	to(&b, 100);
	assert_int_equal(b.out[0], 100);
	to(&b, 99);
	assert_int_equal(b.out[0], 99 - 5);
	to(&b, 99);
	assert_int_equal(b.out[0], 99 - 10);
	rest(&b, 5);
	assert_int_equal(b.out[0], 99 - 12);
	to(&b, 100);
	rest(&b, 5);
	assert_int_equal(b.out[0], 100);
}

static void less_than_a_pulse_a_period_still_comes(void **state)
{
	struct bench b = make(4, 0.25);
	int32_t last;

	(void)state;
	to(&b, 0);
	to(&b, -1);
	last = b.out[0];
	for (int i = 0; i < 16; i++) {
		rest(&b, 1);
		assert_in_range(last - b.out[0], 0, 1);
		last = b.out[0];
	}
	assert_int_equal(b.out[0], -1 - 4);
}

static void the_map_is_linear_between_and_level_beyond(void **state)
{
	struct bench b = make(0, 0);

	(void)state;
	pitch(&b);
	assert_int_equal(comp_wanted(&b.k[0], -50, 1), 0);
	assert_int_equal(comp_wanted(&b.k[0], 50, 1), 3);
	assert_int_equal(comp_wanted(&b.k[0], 100, -1), 6);
	assert_int_equal(comp_wanted(&b.k[0], 150, 1), 1);
	assert_int_equal(comp_wanted(&b.k[0], 300, 1), 2);
	assert_int_equal(comp_wanted(&b.k[0], 30000, 1), 2);
}

/* Each place has one output a direction, however it was come to. */
static void there_and_back_is_the_same_pulses(void **state)
{
	struct bench b = make(9, 1000);
	int32_t there[401], back[401];
	int64_t sum = 0;
	int32_t last;

	(void)state;
	pitch(&b);
	to(&b, -50);
	to(&b, -49);
	last = b.out[0];
	for (int pass = 0; pass < 3; pass++) {
		for (int32_t p = -48; p <= 350; p++) {
			to(&b, p);
			if (pass)
				assert_int_equal(b.out[0], there[p + 50]);
			there[p + 50] = b.out[0];
			sum += b.out[0] - last;
			last = b.out[0];
		}
		for (int32_t p = 349; p >= -49; p--) {
			to(&b, p);
			if (pass)
				assert_int_equal(b.out[0], back[p + 50]);
			back[p + 50] = b.out[0];
			assert_int_equal(b.out[0], comp_wanted(&b.k[0], p, -1) +
						   p);
			sum += b.out[0] - last;
			last = b.out[0];
		}
	}
	to(&b, -48);
	to(&b, -49);
	/* As many + as -: it is where it was, but for the last turn. */
	assert_int_equal(sum, -9);
}

static void no_period_has_more_pulses_than_the_machine_makes(void **state)
{
	struct bench b = make(40, 30);
	int32_t last;

	(void)state;
	b.edges = 4;
	to(&b, 0);
	for (int i = 0; i < 400; i++) {
		last = b.out[0];
		to(&b, b.at[0] + (i / 50 % 2 ? -3 : 3));
		assert_true(abs(b.out[0] - last) <= 4);
	}
	rest(&b, 20);
	assert_int_equal(b.out[0], b.at[0] - 40);
}

static void frozen_takes_nothing_up(void **state)
{
	struct bench b = make(40, 3);

	(void)state;
	to(&b, 10);
	to(&b, 9);
	assert_int_equal(b.out[0], 9 - 3);
	for (int i = 0; i < 10; i++) {
		comp_apply(&b.c, b.k, b.at, true, 0, b.out);
		assert_int_equal(b.out[0], 9 - 3);
	}
	rest(&b, 20);
	assert_int_equal(b.out[0], 9 - 40);
}

static void a_new_name_for_a_place_makes_no_pulse(void **state)
{
	struct bench b = make(11, 2);

	(void)state;
	pitch(&b);
	to(&b, 100);
	to(&b, 90);
	rest(&b, 10);
	const int32_t pulses = b.out[0];

	comp_settle(&b.c.axis[0], &b.k[0], 5000, pulses);
	b.at[0] = 5000;
	rest(&b, 10);
	assert_int_equal(b.out[0], pulses);
	to(&b, 5001);
	rest(&b, 10);
	assert_int_equal(b.out[0], pulses + 1 + 11);
}

/* A whole cycle: down, by command back, and on; the drives end as the path. */
static void the_cycle_compensates_what_it_gives(void **state)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)state;
	k.dry_run = true;
	k.comp[INTERP_Z].backlash = 25;
	k.comp[INTERP_Z].take_up = 4;
	begin_cut(&r, &k);
	for (int i = 0; i < 300; i++) {
		step(&r, OPEN_V);
		assert_true(abs(r.out.target[INTERP_Z] -
				r.before.target[INTERP_Z]) <= 4 + 50);
	}
	assert_int_equal(r.out.target[INTERP_Z],
			 r.c.out.target[INTERP_Z] - 25);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.5), ANSWER_DONE);
	steps(&r, OPEN_V, 1000);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(r.out.target[INTERP_Z], r.c.out.target[INTERP_Z]);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_any_pulses_are_places),
		cmocka_unit_test(a_turn_takes_the_whole_backlash_up),
		cmocka_unit_test(less_than_a_pulse_a_period_still_comes),
		cmocka_unit_test(the_map_is_linear_between_and_level_beyond),
		cmocka_unit_test(there_and_back_is_the_same_pulses),
		cmocka_unit_test(no_period_has_more_pulses_than_the_machine_makes),
		cmocka_unit_test(frozen_takes_nothing_up),
		cmocka_unit_test(a_new_name_for_a_place_makes_no_pulse),
		cmocka_unit_test(the_cycle_compensates_what_it_gives),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
