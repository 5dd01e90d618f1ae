/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_texts.c - every axis keeps its own speed, acceleration and jerk in
 * programs of every dialect: orbits, splines, tapers, rotary axes and tiny
 * lines
 *
 * By differences of where each axis is, eight cycles apart: places of a curve
 * are 0.02 pulses off, and that is a jerk from cycle to cycle.  The program is
 * held at any moment, gone on with, taken back, told another speed, and cut
 * with jumps.  The seed is printed; EDM_RUNS is the number of texts.
 */
#include "axis_track.h"
#include "random_compile.h"

#define RUNS	SEED_ROUNDS(40)
#define CYCLES	20000

static uint64_t seed;

static struct cycle_config config_of(uint64_t *s, bool dry)
{
	struct cycle_config k = usual_config();

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -1000000;
		k.travel_max[i] = 1000000;
	}
	k.dry_run = dry;
	k.travel_a_mm_s2 = k.jump.a_max_mm_s2 = 4000;
	k.travel_j_mm_s3 = k.jump.j_max_mm_s3 = 2e5;
	k.jump.height_mm = uniform(s, 0.5, 6);
	k.jump.every.cycles = 200;
	k.jump.v_max_mm_s = 80;
	k.gap.retract_mm_s = dry ? 1000 : 5;
	k.gap.feed_max_mm_s = k.gap.approach_mm_s = 8;
	k.gap.gain_mm_s_v = 1;
	return k;
}

static bool take(struct rig *r, uint64_t *s, bool dry)
{
	static struct script text;
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
		.fit_mm = rnd(s) % 4 ? 0 : 0.01,
	};
	struct cycle_config k;
	const char *dialect;
	struct made m;

	set_machine(s);
	dialect = random_text(&text, s);
	k = config_of(s, dry);
	if (!random_compile(&text, dialect, &o, &m))
		return false;
	if (getenv("EDM_SHOW"))
		print_message("--dialect %s\n%s", dialect, text.at);
	rig_take(r, m, &k);
	tell(r, CYCLE_START);
	return true;
}

static void walk(struct rig *r, uint64_t *s, bool dry)
{
	struct track t = { .n = 0 };

	for (int n = 0; n < CYCLES && r->c.loaded; n++) {
		if (r->c.fault.first != FAULT_NONE) {
			assert_int_not_equal(r->c.fault.first, FAULT_PROGRAM);
			assert_int_not_equal(r->c.fault.first, FAULT_STUCK);
			break;
		}
		disturb(r, s, 100);
		/* From the cut a jump first comes to a stand. */
		if (!dry && (r->c.state != STATE_JUMP ||
			     (r->c.lift.up && r->c.mover.v_mm_s > 0)))
			t.n = 0;
		step(r, dry ? OPEN_V : SPARKING_V);
		if (t.n > 0 && (r->c.state != t.state[3] ||
				r->c.cursor.index != t.index[3]))
			t.n = 0;
		if (n % track_stride)
			continue;
		note(&t, r);
		if (is_whole(&t))
			check_axes(&t, r);
	}
	rig_free(r);
}

static void try(bool dry)
{
	const char *given = getenv("EDM_RUNS");
	const int runs = given ? atoi(given) : RUNS;
	int taken = 0;

	for (int i = 0; i < runs; i++) {
		uint64_t s = seed + (uint64_t)i * 1000003;
		struct rig r;

		if (!take(&r, &s, dry))
			continue;
		walk(&r, &s, dry);
		taken++;
	}
	print_message("    %d of %d programs were taken\n", taken, runs);
	assert_true(taken > runs / 3);
}

static void positioned_and_held_every_axis_keeps_its_limits(void **st)
{
	(void)st;
	try(true);
}

static void in_jumps_every_axis_keeps_its_limits(void **st)
{
	(void)st;
	try(false);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(positioned_and_held_every_axis_keeps_its_limits),
		cmocka_unit_test(in_jumps_every_axis_keeps_its_limits),
	};

	seed = seed_take();
	track_stride = 8;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
