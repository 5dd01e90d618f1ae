/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_sim_process.c - promises of the simulated process: pulses, craters,
 * flushing, arcs, axes, the wire; nothing may break it
 */
#include "sim_help.h"

#include "keys.h"

/* -- Shares ---------------------------------------------------------------- */

static double sum(const struct io_shares *s)
{
	return (double)s->open + (double)s->spark + (double)s->arc +
	       (double)s->shorted;
}

static void check_shares(const struct bench *b)
{
	const struct io_shares *s = &b->in.shares;

	assert_true(s->open >= 0 && s->spark >= 0 && s->arc >= 0 &&
		    s->shorted >= 0);
	near(sum(s), b->in.shares_valid ? 1 : 0, 1e-5);
}

static void the_shares_sum_to_one_counted_or_not(void **st)
{
	(void)st;
	for (uint32_t counted = 0; counted < 2; counted++) {
		struct bench b;

		quiet(&b.k);
		b.k.sim.counted = counted;
		open_sim(&b, 1);
		for (double g = -0.01; g < 0.1; g += 1e-4) {
			cycle_at(&b, b.k.sim.standoff_mm - g, true);
			assert_true(b.in.shares_valid);
			check_shares(&b);
		}
		close_sim(&b);
	}
}

static void without_power_nothing_is_counted(void **st)
{
	struct bench b;

	(void)st;
	quiet(&b.k);
	open_sim(&b, 1);
	cycle_at(&b, b.k.sim.standoff_mm - b.k.sim.best_gap_mm, false);
	assert_false(b.in.shares_valid);
	close_sim(&b);
}

static void from_narrow_to_wide_shorts_become_sparks_and_sparks_opens(void **st)
{
	float shorted = 1, open = 0;
	struct bench b;

	(void)st;
	quiet(&b.k);
	b.k.sim.removal_mm3_min = 1e-3;
	b.k.sim.open_us = b.k.sim.wait_us;
	open_sim(&b, 1);
	for (double g = 0; g < 0.07; g += 5e-4) {
		cycle_at(&b, b.k.sim.standoff_mm - g, true);
		assert_true(b.in.shares.shorted <= shorted);
		assert_true(b.in.shares.open >= open - 1e-6F);
		shorted = b.in.shares.shorted;
		open = b.in.shares.open;
		if (g > 0.015 && g < 0.05)
			assert_true(b.in.shares.spark > 0.85F);
	}
	assert_true(shorted < 1e-3F && open > 0.999F);
	close_sim(&b);
}

/* A generator's count of opens must tell of the gap before it is lost. */
static void one_in_five_waits_is_counted_as_open_at_the_best_gap(void **st)
{
	struct bench b;
	float before;

	(void)st;
	quiet(&b.k);
	b.k.sim.removal_mm3_min = 1e-3;
	open_sim(&b, 1);
	cycle_at(&b, b.k.sim.standoff_mm - b.k.sim.best_gap_mm, true);
	near((double)b.in.shares.open / (1 - (double)b.in.shares.shorted),
	     0.2, 1e-3);
	before = b.in.shares.open;
	cycle_at(&b, b.k.sim.standoff_mm - 1.5 * b.k.sim.best_gap_mm, true);
	assert_true(b.in.shares.open > 2 * before);
	close_sim(&b);
}

/* -- Removal -------------------------------------------------------------- */

static double removal_at(const struct machine_config *k, double gap_mm)
{
	struct bench b = { .k = *k };
	double r;

	open_sim(&b, 1);
	r = cut(&b, gap_mm, 1000);
	close_sim(&b);
	return r;
}

static void removal_has_one_maximum_and_it_is_the_best_gap(void **st)
{
	double best = 0, at = 0, before = 0;
	struct machine_config k;
	int turns = 0, rises = 1;

	(void)st;
	quiet(&k);
	k.sim.debris_per_mm = 0;
	for (double g = 5e-4; g < 1.2 * k.sim.open_gap_mm; g += 5e-4) {
		const double r = removal_at(&k, g);

		turns += rises != (r >= before);
		rises = r >= before;
		before = r;
		if (r > best) {
			best = r;
			at = g;
		}
	}
	/* Down after the maximum, then level at nothing. */
	assert_int_equal(turns, 2);
	near(at, k.sim.best_gap_mm, 5.1e-4);
	assert_true(removal_at(&k, k.sim.short_gap_mm / 2) == 0);
	assert_true(removal_at(&k, k.sim.open_gap_mm + 1e-4) == 0);
}

/* The reference pulse gives the figure; a stronger one as its charge. */
static void removal_at_the_best_gap_is_what_the_machine_file_says(void **st)
{
	const double s = 1000 * 1e-3;
	struct machine_config k;

	(void)st;
	quiet(&k);
	k.sim.debris_per_mm = 0;
	near(removal_at(&k, k.sim.best_gap_mm) / s * 60, 12.75, 0.1);
	k.sim.on_us = 40;
	k.sim.off_us = 100;
	k.sim.peak_a = 30;
	near(removal_at(&k, k.sim.best_gap_mm) / s * 60, 5 * 12.75, 0.5);
}

static double removal_with(double peak_a, double on_us, double off_us)
{
	struct bench b;
	double r;

	quiet(&b.k);
	b.k.sim.debris_per_mm = 0;
	open_sim(&b, 1);
	b.out.pulse[INTERP_TECH_PEAK_A] = peak_a;
	b.out.pulse[INTERP_TECH_ON_US] = on_us;
	b.out.pulse[INTERP_TECH_OFF_US] = off_us;
	b.out.pulse[INTERP_TECH_ISO] = 1;
	r = cut(&b, b.k.sim.best_gap_mm, 300);
	close_sim(&b);
	return r;
}

static void a_stronger_pulse_removes_more_and_a_longer_pause_less(void **st)
{
	double before = 0;

	(void)st;
	for (double a = 1; a < 12; a++) {
		assert_true(removal_with(a, NAN, NAN) > before);
		before = removal_with(a, NAN, NAN);
	}
	before = INFINITY;
	for (double off = 5; off < 200; off *= 1.5) {
		assert_true(removal_with(NAN, 8, off) < before);
		before = removal_with(NAN, 8, off);
	}
}

static void more_volts_ignite_in_a_wider_gap(void **st)
{
	struct bench b;

	(void)st;
	quiet(&b.k);
	b.k.sim.open_us = b.k.sim.wait_us;
	open_sim(&b, 1);
	cycle_at(&b, b.k.sim.standoff_mm - 1.1 * b.k.sim.open_gap_mm, true);
	assert_true(b.in.shares.open > 0.999F);
	b.out.pulse[INTERP_TECH_IGNITION_V] = 2 * b.k.sim.open_v;
	period(&b);
	assert_true(b.in.shares.spark > 0.9F);
	close_sim(&b);
}

static void nothing_is_removed_without_power(void **st)
{
	struct bench b;

	(void)st;
	quiet(&b.k);
	open_sim(&b, 1);
	for (int i = 0; i < 1000; i++)
		cycle_at(&b, b.k.sim.standoff_mm - b.k.sim.best_gap_mm, false);
	assert_true(result(&b).removed_mm3 == 0);
	close_sim(&b);
}

static void the_generator_answers_after_its_delay(void **st)
{
	struct bench b;
	int n = 1;

	(void)st;
	quiet(&b.k);
	b.k.sim.respond_s = 0.05;
	open_sim(&b, 1);
	while (cycle_at(&b, b.k.sim.standoff_mm - b.k.sim.best_gap_mm, true),
	       result(&b).removed_mm3 == 0)
		assert_true(n++ < 1000);
	assert_in_range(n, 50, 52);
	close_sim(&b);
}

/* -- Volume is conserved: removed = front * area -------------------------- */

static void check_volume(int electrode, double expected_mm3)
{
	double front = 0, volume = 0;
	struct bench b;

	quiet(&b.k);
	b.k.sim.electrode = electrode;
	b.k.sim.wear_ratio = 0;
	b.k.sim.standoff_mm = 0.5;
	open_sim(&b, 1);
	while (front < 3) {
		const double area = result(&b).area_mm2;
		double to;

		cut(&b, b.k.sim.best_gap_mm, 1);
		to = b.out.place_mm + result(&b).gap_mm - 0.5;
		volume += area * (to - front);
		front = to;
	}
	near(volume, result(&b).removed_mm3, 1e-6 * volume);
	near(volume, expected_mm3, 0.01 * expected_mm3);
	close_sim(&b);
}

/* 5 mm round, the tip 2.5 mm, 3 mm deep: cylinder, ball, cone. */
static void what_is_removed_is_what_the_electrode_went_through(void **st)
{
	const double a = 19.635;

	(void)st;
	check_volume(ELECTRODE_FLAT, 3 * a);
	check_volume(ELECTRODE_BALL, a * 2.5 * 2 / 3 + 0.5 * a);
	check_volume(ELECTRODE_CONE, a * 2.5 / 3 + 0.5 * a);
}

static double wear_after(bool negative, double *ret_depth)
{
	struct bench b;
	double before = 0;

	quiet(&b.k);
	b.k.sim.wear_ratio = 0.02;
	open_sim(&b, 1);
	b.out.pulse[INTERP_TECH_POLARITY] = negative ? -1 : 1;
	for (int i = 0; i < 20; i++) {
		cut(&b, b.k.sim.best_gap_mm, 500);
		assert_true(result(&b).wear_mm > before);
		before = result(&b).wear_mm;
	}
	*ret_depth = result(&b).removed_mm3 / b.k.sim.area_mm2;
	close_sim(&b);
	return before;
}

static void wear_grows_with_the_depth_and_with_the_polarity(void **st)
{
	double depth;

	(void)st;
	near(wear_after(false, &depth), 0.02 * depth, 1e-12);
	near(wear_after(true, &depth), 5 * 0.02 * depth, 1e-12);
}

/* -- Flushing ------------------------------------------------------------- */

/* Debris left of 1 by one stroke up and down. */
static double left_by(struct bench *b, double height_mm, double v_mm_s)
{
	const int n = (int)(height_mm / v_mm_s * 1000);
	double from, before;

	b->k.sim.debris_settle_s = 1e5;
	b->k.sim.debris_per_mm = 1e3;
	open_sim(b, 1);
	cut(b, b->k.sim.best_gap_mm, 1000);
	before = result(b).debris;
	from = b->out.place_mm;
	for (int i = 1; i <= 2 * n; i++)
		cycle_at(b, from - height_mm * (i <= n ? i : 2 * n - i) / n,
			 false);
	before = result(b).debris / before;
	close_sim(b);
	return before;
}

static double left(double depth_mm, double height_mm, double v_mm_s)
{
	struct bench b;

	quiet(&b.k);
	b.k.sim.depth_mm = depth_mm;
	return left_by(&b, height_mm, v_mm_s);
}

static void a_stroke_flushes_more_high_fast_and_shallow(void **st)
{
	(void)st;
	assert_true(left(10, 2, 20) < left(10, 1, 20));
	assert_true(left(10, 1, 40) < left(10, 1, 10));
	assert_true(left(2, 1, 20) < left(30, 1, 20));
	/* Twice as high does more than twice as often, in a deep cavity. */
	assert_true(left(50, 2, 20) < pow(left(50, 1, 20), 2));
}

static void a_thin_rib_flushes_worse_than_a_round(void **st)
{
	struct bench b;

	(void)st;
	quiet(&b.k);
	b.k.sim.depth_mm = 20;
	b.k.sim.perimeter_mm = 41;
	assert_true(left_by(&b, 1, 20) > left(20, 1, 20));
}

static double settled(bool pump, double depth_mm)
{
	struct bench b;
	double before;

	quiet(&b.k);
	b.k.sim.depth_mm = depth_mm;
	b.k.sim.debris_per_mm = 1e3;
	open_sim(&b, 1);
	cut(&b, b.k.sim.best_gap_mm, 1000);
	before = result(&b).debris;
	b.out.pump = pump;
	for (int i = 0; i < 5000; i++)
		cycle_at(&b, b.out.place_mm, false);
	before = result(&b).debris / before;
	close_sim(&b);
	return before;
}

static void the_pump_flushes_and_less_at_depth(void **st)
{
	(void)st;
	assert_true(settled(true, 0) < settled(true, 40));
	assert_true(settled(true, 40) < settled(false, 0));
	near(settled(false, 0), settled(false, 40), 1e-12);
}

/* The cavity deepens as Z goes below the place of the first spark. */
static void the_cavity_is_as_deep_as_z_has_been(void **st)
{
	struct bench b;

	(void)st;
	quiet(&b.k);
	b.k.sim.depth_mm = 3;
	open_sim(&b, 1);
	b.out.target[INTERP_Z] = 1000;
	cut(&b, b.k.sim.best_gap_mm, 10);
	near(result(&b).depth_mm, 3, 1e-12);
	b.out.target[INTERP_Z] = -500;
	cut(&b, b.k.sim.best_gap_mm, 10);
	b.out.target[INTERP_Z] = 800;
	cut(&b, b.k.sim.best_gap_mm, 10);
	near(result(&b).depth_mm, 4.5, 1e-12);
	close_sim(&b);
}

/* -- Arcs ----------------------------------------------------------------- */

static float arcs_with(struct bench *b, double off_us)
{
	b->k.sim.off_us = off_us;
	b->k.sim.debris_settle_s = 1e5;
	open_sim(b, 1);
	while (result(b).debris < 0.5)
		cut(b, b->k.sim.best_gap_mm, 1);
	return b->in.shares.arc;
}

static void the_shorter_the_pause_the_more_arcs(void **st)
{
	float before = 1;

	(void)st;
	for (double off = 2; off < 60; off *= 1.5) {
		struct bench b;
		float arc;

		quiet(&b.k);
		arc = arcs_with(&b, off);
		assert_true(arc < before);
		before = arc;
		close_sim(&b);
	}
}

static void arcs_stay_remove_little_and_are_counted_once(void **st)
{
	double clean, burning;
	struct bench b;

	(void)st;
	quiet(&b.k);
	open_sim(&b, 1);
	clean = cut(&b, b.k.sim.best_gap_mm, 100);
	close_sim(&b);
	b.k.sim.off_us = 10;
	open_sim(&b, 1);
	cut(&b, b.k.sim.best_gap_mm, 10000);
	assert_true(b.in.shares.arc > 0.5F);
	assert_int_equal(result(&b).burns, 1);
	burning = cut(&b, b.k.sim.best_gap_mm, 100);
	assert_true(burning < 0.8 * clean);
	close_sim(&b);
}

/* Hot: what makes the next pulse burn on in the same place. */
static double hot_after(double lift_mm, double off_us, bool power)
{
	struct bench b;
	double from, before;

	quiet(&b.k);
	b.k.sim.off_us = 10;
	open_sim(&b, 1);
	cut(&b, b.k.sim.best_gap_mm, 10000);
	before = result(&b).hot;
	assert_true(before > 0.3);
	from = b.out.place_mm;
	b.out.pulse[INTERP_TECH_OFF_US] = off_us;
	for (int i = 1; i <= 100; i++)
		cycle_at(&b, from - lift_mm * i / 100, power);
	before = result(&b).hot / before;
	close_sim(&b);
	return before;
}

static void a_pause_or_a_lift_ends_an_arc(void **st)
{
	(void)st;
	assert_true(hot_after(0, NAN, true) > 0.9);
	assert_true(hot_after(0, 100, true) < hot_after(0, NAN, true));
	assert_true(hot_after(0, 100, true) > hot_after(0, NAN, false));
	assert_true(hot_after(0, NAN, false) > hot_after(1, NAN, false));
}

/* -- Axes ----------------------------------------------------------------- */

static int periods_to_follow(double lag_s, double start_s)
{
	struct bench b;
	int n = 1;

	quiet(&b.k);
	b.k.sim.lag_s = lag_s;
	b.k.sim.start_s = start_s;
	open_sim(&b, 1);
	cycle_at(&b, 0, false);
	b.out.target[INTERP_X] = 1000;
	while (cycle_at(&b, 0.5, false),
	       result(&b).gap_mm > 0.5 + 0.5 * exp(-1))
		assert_true(n++ < 1000);
	assert_true(lag_s > 0 || start_s > 0 || b.in.actual[INTERP_X] == 1000);
	close_sim(&b);
	return n;
}

static void the_axes_follow_at_once_or_with_their_lag(void **st)
{
	(void)st;
	assert_int_equal(periods_to_follow(0, 0), 1);
	assert_in_range(periods_to_follow(0.05, 0), 49, 52);
	assert_in_range(periods_to_follow(0, 0.02), 20, 22);
}

static void measured_places_scatter_about_the_true_ones(void **st)
{
	double mean = 0, squares = 0;
	struct bench b;

	(void)st;
	quiet(&b.k);
	b.k.sim.measure_pulses = 20;
	open_sim(&b, 1);
	b.out.target[INTERP_Y] = -777;
	for (int i = 0; i < 10000; i++) {
		double d;

		cycle_at(&b, 0, false);
		d = b.in.actual[INTERP_Y] + 777;
		mean += d / 10000;
		squares += d * d / 10000;
	}
	near(mean, 0, 1);
	near(sqrt(squares), 20, 1);
	close_sim(&b);
}

/* -- Wire ----------------------------------------------------------------- */

static void a_wire_breaks_by_shorts_and_is_threaded_without_power(void **st)
{
	struct bench b;
	int n = 0;

	(void)st;
	quiet(&b.k);
	b.k.sim.process = PROCESS_WIRE;
	b.k.sim.break_per_j = 0.01;
	b.k.sim.rethread_s = 2;
	open_sim(&b, 1);
	near(result(&b).area_mm2, (0.25 + 2 * 0.02) * 40, 1e-9);
	cut(&b, b.k.sim.best_gap_mm, 100);
	assert_false(b.in.wire_broken);
	assert_true(result(&b).removed_mm3 > 0 && result(&b).wear_mm == 0);
	while (cycle_at(&b, 2, true), !b.in.wire_broken)
		assert_true(n++ < 1000000);
	assert_true(cut(&b, b.k.sim.best_gap_mm, 100) == 0);
	for (n = 0; b.in.wire_broken; n++)
		cycle_at(&b, 0, false);
	assert_in_range(n, 1998, 2002);
	close_sim(&b);
}

/* -- Nothing breaks it ---------------------------------------------------- */

static double random_in(struct rng *r, double min, double max)
{
	const double u = rng_uniform(r);

	if (u < 0.2)
		return u < 0.1 ? min : max;
	if (min > 0)
		return min * pow(max / min, rng_uniform(r));
	return min + (max - min) * pow(rng_uniform(r), 4);
}

static void set_any(struct machine_config *k, struct rng *r)
{
	for (int i = 0; config_key(i); i++) {
		const struct config_key *key = config_key(i);
		double *at = config_key_at(key, 0, k);

		if (key->section == SECTION_SIM && key->kind == KEY_NUMBER)
			*at = random_in(r, key->min, key->max);
	}
	k->sim.electrode = (int)(rng_next(r) % 3);
	k->sim.process = (int)(rng_next(r) % 2);
	k->sim.iso = rng_next(r) & 1;
	k->sim.counted = rng_next(r) & 1;
	k->period_us = random_in(r, 20, 20000);
}

static void drive(struct bench *b, struct rng *r)
{
	const double scale = pow(10, 6 * rng_uniform(r) - 4);

	b->out.place_mm += scale * (rng_uniform(r) - 0.45);
	b->out.target[rng_next(r) % IO_NAXES] = (int32_t)rng_next(r) >> 2;
	b->out.power = rng_uniform(r) < 0.9;
	b->out.rapid = rng_uniform(r) < 0.01;
	b->out.pump = rng_next(r) & 1;
	b->out.path += rng_uniform(r) < 0.001;
	b->out.off_path_mm = rng_uniform(r) < 0.1 ? rng_uniform(r) : 0;
	b->out.pulse[INTERP_TECH_POLARITY] = rng_next(r) & 1 ? -1 : 1;
	if (rng_uniform(r) < 0.01) {
		b->out.pulse[INTERP_TECH_PEAK_A] = random_in(r, 0.01, 1e3);
		b->out.pulse[INTERP_TECH_ON_US] = random_in(r, 0.01, 1e4);
		b->out.pulse[INTERP_TECH_OFF_US] = rng_uniform(r) < 0.5 ?
			NAN : random_in(r, 0.01, 1e4);
		b->out.pulse[INTERP_TECH_IGNITION_V] = rng_uniform(r) < 0.5 ?
			NAN : random_in(r, 1, 500);
		b->out.pulse[INTERP_TECH_ISO] = rng_next(r) & 1 ? 1 : 0;
	}
	period(b);
}

static void check_sane(const struct bench *b, const struct io_sim_result *was)
{
	const struct io_sim_result r = result(b);

	assert_true(isfinite(b->in.gap_v) && b->in.gap_v >= 0);
	assert_true(b->in.gap_v <= 500 + 4 * b->k.sim.noise_v);
	check_shares(b);
	assert_true(isfinite(r.gap_mm) && isfinite(r.removed_mm3));
	assert_true(isfinite(r.area_mm2) && r.area_mm2 > 0);
	assert_true(r.debris >= 0 && r.debris <= 1);
	assert_true(r.hot >= 0 && r.hot <= 1);
	assert_true(r.removed_mm3 >= was->removed_mm3);
	assert_true(r.wear_mm >= was->wear_mm && isfinite(r.wear_mm));
}

static void no_machine_file_and_no_motion_makes_it_fail(void **st)
{
	static const struct config_lines none;
	struct rng r;
	int taken = 0;

	(void)st;
	rng_seed(&r, 20250714);
	for (int i = 0; taken < 300; i++) {
		struct interp_diag d;
		struct bench b;

		assert_true(i < 1000000);
		config_defaults(&b.k);
		set_any(&b.k, &r);
		if (config_check(&b.k, &none, &d) < 0)
			continue;
		taken++;
		open_sim(&b, (uint64_t)i);
		for (int n = 0; n < 500; n++) {
			const struct io_sim_result was = result(&b);

			drive(&b, &r);
			check_sane(&b, &was);
		}
		close_sim(&b);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_shares_sum_to_one_counted_or_not),
		cmocka_unit_test(without_power_nothing_is_counted),
		cmocka_unit_test(from_narrow_to_wide_shorts_become_sparks_and_sparks_opens),
		cmocka_unit_test(one_in_five_waits_is_counted_as_open_at_the_best_gap),
		cmocka_unit_test(removal_has_one_maximum_and_it_is_the_best_gap),
		cmocka_unit_test(removal_at_the_best_gap_is_what_the_machine_file_says),
		cmocka_unit_test(a_stronger_pulse_removes_more_and_a_longer_pause_less),
		cmocka_unit_test(more_volts_ignite_in_a_wider_gap),
		cmocka_unit_test(nothing_is_removed_without_power),
		cmocka_unit_test(the_generator_answers_after_its_delay),
		cmocka_unit_test(what_is_removed_is_what_the_electrode_went_through),
		cmocka_unit_test(wear_grows_with_the_depth_and_with_the_polarity),
		cmocka_unit_test(a_stroke_flushes_more_high_fast_and_shallow),
		cmocka_unit_test(a_thin_rib_flushes_worse_than_a_round),
		cmocka_unit_test(the_pump_flushes_and_less_at_depth),
		cmocka_unit_test(the_cavity_is_as_deep_as_z_has_been),
		cmocka_unit_test(the_shorter_the_pause_the_more_arcs),
		cmocka_unit_test(arcs_stay_remove_little_and_are_counted_once),
		cmocka_unit_test(a_pause_or_a_lift_ends_an_arc),
		cmocka_unit_test(the_axes_follow_at_once_or_with_their_lag),
		cmocka_unit_test(measured_places_scatter_about_the_true_ones),
		cmocka_unit_test(a_wire_breaks_by_shorts_and_is_threaded_without_power),
		cmocka_unit_test(no_machine_file_and_no_motion_makes_it_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
