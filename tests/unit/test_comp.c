/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_comp.c - backlash and geometric errors, between the path and the pulses
 */
#include "cycle_help.h"

#include "axes/comp.h"

/* One axis, the others without. */
struct bench {
	struct comp_config k;
	struct comp c;
	int32_t at[INTERP_NAXES], out[INTERP_NAXES];
	uint32_t edges;
};

static struct bench make(int32_t backlash, double take_up)
{
	struct bench b = { .edges = 0 };

	for (int i = 0; i < INTERP_NAXES; i++) {
		b.k.axis[i].pulse_mm = PULSE_MM;
		b.k.axis[i].take_up = take_up;
	}
	b.k.axis[0].backlash = backlash;
	return b;
}

static void to(struct bench *b, int32_t place)
{
	b->at[0] = place;
	comp_apply(&b->c, &b->k, &(struct comp_period) {
		.place = b->at, .edges = b->edges }, b->out);
}

static void rest(struct bench *b, int periods)
{
	while (periods-- > 0)
		to(b, b->at[0]);
}

/* Of X, in pulses: 6 to be added at 1000, -4 at 2000, 2 at 3000. */
static void pitch(struct bench *b)
{
	struct interp_errormap_row *r = &b->k.maps.row[b->k.maps.nrows++];

	*r = (struct interp_errormap_row) { .n = 4 };
	for (int i = 0; i < 4; i++) {
		r->at_mm[i] = i;
		r->error_mm[i] = (double[]) { 0, -6, 4, -2 }[i] * PULSE_MM;
	}
	b->k.mapped = true;
}

static int32_t map_at(const struct bench *b, int32_t place)
{
	int32_t add[INTERP_NAXES];

	comp_map(&b->k, (int32_t[INTERP_NAXES]) { place }, add);
	return add[0];
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
	assert_int_equal(map_at(&b, -500), 0);
	assert_int_equal(map_at(&b, 500), 3);
	assert_int_equal(map_at(&b, 1000), 6);
	assert_int_equal(map_at(&b, 1500), 1);
	assert_int_equal(map_at(&b, 3000), 2);
	assert_int_equal(map_at(&b, 300000), 2);
}

/* Each place has one output a direction, however it was come to. */
static void there_and_back_is_the_same_pulses(void **state)
{
	struct bench b = make(9, 1000);
	int32_t there[3701], back[3701];
	int64_t sum = 0;
	int32_t last;

	(void)state;
	pitch(&b);
	to(&b, -50);
	to(&b, -49);
	last = b.out[0];
	for (int pass = 0; pass < 3; pass++) {
		for (int32_t p = -48; p <= 3650; p++) {
			to(&b, p);
			if (pass)
				assert_int_equal(b.out[0], there[p + 50]);
			there[p + 50] = b.out[0];
			sum += b.out[0] - last;
			last = b.out[0];
		}
		for (int32_t p = 3649; p >= -49; p--) {
			to(&b, p);
			if (pass)
				assert_int_equal(b.out[0], back[p + 50]);
			back[p + 50] = b.out[0];
			assert_int_equal(b.out[0], map_at(&b, p) - 9 + p);
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
		comp_apply(&b.c, &b.k, &(struct comp_period) {
			.place = b.at, .frozen = true }, b.out);
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
	to(&b, 1000);
	to(&b, 990);
	rest(&b, 10);
	const int32_t pulses = b.out[0];

	b.at[0] = 5000;
	comp_settle(&b.c, &b.k, 0, b.at, pulses);
	rest(&b, 10);
	assert_int_equal(b.out[0], pulses);
	to(&b, 5001);
	rest(&b, 10);
	assert_int_equal(b.out[0], pulses + 1 + 11);
}

/* -- Maps of several axes ------------------------------------------------- */

/* A worn machine: every kind of error, on places that are not even. */
static void worn(struct bench *b)
{
	struct interp_errormap *m = &b->k.maps;

	*m = (struct interp_errormap) { .nrows = 3, .nleans = 2 };
	for (int r = 0; r < 3; r++) {
		m->row[r].along = (uint8_t)(r == 1);
		m->row[r].across = (uint8_t)r;
		m->row[r].n = 40;
		for (int i = 0; i < 40; i++) {
			m->row[r].at_mm[i] = -20 + i + 0.3 * sin(i);
			m->row[r].error_mm[i] = 0.003 * sin(0.7 * i + r);
		}
	}
	m->lean[0] = (struct interp_errormap_lean) { 0, 1, 400e-6 };
	m->lean[1] = (struct interp_errormap_lean) { 2, 0, -250e-6 };
	m->growth[0] = (struct interp_errormap_growth) { 11.5e-6, -5, 6 };
	m->growth[2] = (struct interp_errormap_growth) { 23e-6, 100, -4 };
	b->k.mapped = true;
	assert_int_equal(interp_errormap_check(m), 0);
}

static void period(struct bench *b)
{
	comp_apply(&b->c, &b->k, &(struct comp_period) {
		.place = b->at, .edges = b->edges }, b->out);
}

/* How far the machine truly is from its place, in pulses. */
static double off_pulses(const struct bench *b, int axis)
{
	double told[INTERP_NAXES], error[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		told[i] = b->out[i] * PULSE_MM;
	interp_errormap_error(&b->k.maps, told, error);
	return (told[axis] + error[axis]) / PULSE_MM - b->at[axis];
}

static void settled_the_machine_truly_is_at_its_place(void **state)
{
	struct bench b = make(0, 3);
	uint64_t seed = 1;

	(void)state;
	worn(&b);
	period(&b);
	for (int n = 0; n < 300; n++) {
		for (int i = 0; i < 3; i++) {
			seed = seed * 6364136223846793005u +
			       1442695040888963407u;
			b.at[i] = (int32_t)(seed >> 33) % 30000;
		}
		for (int k = 0; k < 200; k++)
			period(&b);
		for (int i = 0; i < INTERP_NAXES; i++)
			assert_true(fabs(off_pulses(&b, i)) <= 0.6);
	}
}

/* A random walk and the same walk back, with a pause before each turn. */
static void a_random_walk_back_makes_the_same_pulses(void **state)
{
	enum { STEPS = 4000 };
	static int32_t at[STEPS][INTERP_NAXES], out[STEPS][INTERP_NAXES];
	uint64_t seed = 7;

	(void)state;
	for (int run = 0; run < 20; run++) {
		struct bench b = make(0, 1000);

		worn(&b);
		period(&b);
		for (int n = 0; n < STEPS; n++) {
			for (int i = 0; i < 3; i++) {
				seed = seed * 6364136223846793005u +
				       1442695040888963407u;
				b.at[i] += (int32_t)(seed >> 40) % 41 - 20;
			}
			period(&b);
			memcpy(at[n], b.at, sizeof(b.at));
			memcpy(out[n], b.out, sizeof(b.out));
		}
		for (int n = STEPS - 1; n >= 0; n--) {
			memcpy(b.at, at[n], sizeof(b.at));
			period(&b);
			assert_memory_equal(b.out, out[n], sizeof(b.out));
		}
	}
}

static void maps_make_no_more_pulses_than_the_machine_can(void **state)
{
	struct bench b = make(25, 30);
	int32_t last[INTERP_NAXES];

	(void)state;
	worn(&b);
	b.edges = 4;
	period(&b);
	for (int n = 0; n < 20000; n++) {
		memcpy(last, b.out, sizeof(last));
		b.at[0] += n / 3000 % 2 ? -4 : 4;
		b.at[1] += n / 1000 % 2 ? 3 : -3;
		period(&b);
		for (int i = 0; i < INTERP_NAXES; i++)
			assert_true(abs(b.out[i] - last[i]) <= 4);
	}
}

static void warmth_is_taken_up_at_the_pace_and_given_back(void **state)
{
	struct bench b = make(0, 2);
	int32_t cold, last;

	(void)state;
	worn(&b);
	to(&b, 15000);
	rest(&b, 100);
	cold = b.out[0];
	comp_warm(&b.c, &b.k, 40);
	for (int n = 0; n < 50; n++) {
		last = b.out[0];
		rest(&b, 1);
		assert_true(abs(b.out[0] - last) <= 2);
	}
	assert_true(fabs(off_pulses(&b, 0)) <= 0.6);
	assert_true(cold - b.out[0] >= 7);
	comp_warm(&b.c, &b.k, 6);
	rest(&b, 50);
	assert_int_equal(b.out[0], cold);
}

/* Only the errors of other axes along it are taken up, slowly. */
static void a_new_name_moves_others_by_their_error_alone(void **state)
{
	struct bench b = make(0, 2);
	int32_t before[INTERP_NAXES];

	(void)state;
	worn(&b);
	period(&b);
	rest(&b, 200);
	memcpy(before, b.out, sizeof(before));
	b.at[0] = 10000;
	comp_settle(&b.c, &b.k, 0, b.at, before[0]);
	period(&b);
	assert_int_equal(b.out[0], before[0]);
	assert_true(abs(b.out[1] - before[1]) <= 2);
	rest(&b, 200);
	assert_int_equal(b.out[0], before[0]);
	assert_true(abs(b.out[1] - before[1]) >= 3);
}

/* A whole cycle: down, by command back, and on; the drives end as the path. */
static void the_cycle_compensates_what_it_gives(void **state)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)state;
	k.dry_run = true;
	k.comp.axis[INTERP_Z].backlash = 25;
	k.comp.axis[INTERP_Z].take_up = 4;
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
		cmocka_unit_test(settled_the_machine_truly_is_at_its_place),
		cmocka_unit_test(a_random_walk_back_makes_the_same_pulses),
		cmocka_unit_test(maps_make_no_more_pulses_than_the_machine_can),
		cmocka_unit_test(warmth_is_taken_up_at_the_pace_and_given_back),
		cmocka_unit_test(a_new_name_moves_others_by_their_error_alone),
		cmocka_unit_test(the_cycle_compensates_what_it_gives),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
