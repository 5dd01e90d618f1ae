/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_dense.c - promises of programs of very short lines whose ends are
 * rounded
 *
 * Some waves are random; the seed is printed.
 */
#include "cycle_help.h"

#include "interp/limits.h"
#include "seed.h"

#define ARC_MM		15.0
#define RADIUS_MM	5.0

#define WAVES		SEED_ROUNDS(100)

/* Of the jerk, where an axis bends and the path speeds up, against the curve
 * that was meant: on sines, on smooth steps, and on steps of so few degrees
 * that a rounding hides how their bend changes. */
#define SINE_JERK	1.25
#define STEP_JERK	1.7
#define SMALL_JERK	2.1
#define SMALL_DEG	0.2

/* At a node an axis may step by 2.6 deg/s (corner_um), and by no more than that
 * again what a rounding of the lines hides; in a cycle it speeds up by 1 deg/s
 * more. */
#define CORNER_JOLT	6.2

struct dense {
	double mm;			/* of a line */
	int decimals;
	double deg_mm;			/* of C beside it */
	bool cut;			/* not positioned */
};

/* Of the acceleration, round short lines whose ends are rounded. */
#define MOST_ROUND	1.05

static const double steps_mm[] = { 0.1, 0.02, 0.01, 0.005 };

static double rounded(double v, int decimals)
{
	const double grain = pow(10, decimals);

	return round(v * grain) / grain;
}

static void dense_line(struct interp_build *b, const double *end, bool rapid)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = rapid, .feed_mm_s = 80,
	};
	struct interp_diag d;

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static struct interp_build *dense_arc(const struct dense *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const int n = (int)lround(ARC_MM / k->mm);

	for (int i = 1; i <= n; i++) {
		const double s = ARC_MM * i / n, at = s / RADIUS_MM;
		const double end[INTERP_NAXES] = {
			[INTERP_X] = rounded(RADIUS_MM * sin(at), k->decimals),
			[INTERP_Y] = rounded(RADIUS_MM * (1 - cos(at)),
					     k->decimals),
			[INTERP_C] = rounded(k->deg_mm * s, k->decimals),
		};

		dense_line(b, end, !k->cut);
	}
	return b;
}

/* Cycles there, and back. */
static void walk_there_and_back(struct interp_build *b, uint64_t ret[2])
{
	struct cycle_config k = usual_config();
	struct rig r;

	k.dry_run = k.hold_at_end = true;
	k.gap.retract_mm_s = 80;
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_HOLD, OPEN_V, 100000);
	ret[0] = r.c.count;
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
	for (int n = 0; n < 100000 && r.c.hold.moving; n++)
		step(&r, OPEN_V);
	assert_true(place(&r) == 0);
	ret[1] = r.c.count - ret[0];
	rig_free(&r);
}

static void three_decimals_cost_no_more_than_long_lines(double deg_mm)
{
	const struct dense sparse = { 0.5, 6, deg_mm, false };
	uint64_t once[2], c[2];

	walk_there_and_back(dense_arc(&sparse), once);
	for (int i = 0; i < 4; i++) {
		for (int decimals = 3; decimals <= 6; decimals++) {
			const struct dense k = { steps_mm[i], decimals,
						 deg_mm, false };

			walk_there_and_back(dense_arc(&k), c);
			for (int leg = 0; leg < 2; leg++)
				if ((double)c[leg] > 1.005 * (double)once[leg] +
				    1)
					fail_msg("%g mm, %d decimals, leg %d: "
						 "%d cycles, long lines %d",
						 k.mm, decimals, leg,
						 (int)c[leg], (int)once[leg]);
		}
	}
}

/* Cycles of a retract under the gap servo, over most of the arc. */
static int retract(const struct dense *d)
{
	struct cycle_config k = usual_config();
	struct rig r;
	int n = 0;

	k.gap.retract_mm_s = 80;
	k.gap.retract_limit_mm = 100;
	k.gap.feed_max_mm_s = 40;
	k.gap.gain_mm_s_v = 10;
	rig_load(&r, dense_arc(d), &k);
	tell(&r, CYCLE_START);
	for (int i = 0; i < 10000 && place(&r) < 0.9 * ARC_MM; i++)
		step(&r, SPARKING_V);
	while (n < 10000 && place(&r) > 0.1 * ARC_MM) {
		step(&r, SHORTED_V);
		n++;
	}
	assert_int_equal(r.c.state, STATE_RETRACT);
	rig_free(&r);
	return n;
}

static void in_retracts_three_decimals_are_as_quick(void **st)
{
	(void)st;
	for (int deg = 0; deg < 10; deg += 7) {
		const int once = retract(&(struct dense) { 0.5, 6, deg, true });

		assert_in_range(once, 10, 9999);
		for (int i = 0; i < 4; i++) {
			for (int decimals = 3; decimals <= 6; decimals++) {
				const struct dense k = { steps_mm[i], decimals,
							 deg, true };
				const int n = retract(&k);

				if (n > 1.005 * once + 1)
					fail_msg(
						"%g mm, %d decimals, %d deg/mm: "
						"%d cycles, long lines %d",
						k.mm, decimals, deg, n, once);
			}
		}
	}
}

static void lines_of_three_decimals_are_as_quick(void **st)
{
	(void)st;
	three_decimals_cost_no_more_than_long_lines(0);
}

static void with_a_rotary_axis_too(void **st)
{
	(void)st;
	three_decimals_cost_no_more_than_long_lines(1);
	three_decimals_cost_no_more_than_long_lines(6);
	three_decimals_cost_no_more_than_long_lines(7);
}

/* -- An axis that turns unevenly ------------------------------------------- */

/* X goes @mm, and beside it B a wave of @deg, one smooth step, or to and fro
 * with sharp corners; @w_mm says how wide they are.  Beside TURN, a wave, Y
 * goes the second half of the way. */
struct wave {
	double mm, deg, w_mm;
	enum { SINE, STEP, FRO, TURN } shape;
	double once_mm;			/* lines in which B keeps its jerk; 0:
					 * lines of 0.2 mm */
};

static const struct wave waves[] = {
	{ 30, 10, 0.15, SINE, 0 }, { 30, 2, 0.33, SINE, 0 },
	{ 20, 0.3, 1, SINE, 0 }, { 30, 20, 0.35, STEP, 0.01 },
	{ 30, 5, 0.2, FRO, 0 }, { 24, 0.4, 1, FRO, 0 }, { 30, 6, 0.2, TURN, 0 },
};

/* Time of each, of that in these lines, with six decimals. */
static const double waves_most[] = {
	1.005, 1.005, 1.009, 1.005, 1.005, 1.005, 1.005,
};

#define NWAVES	(sizeof(waves) / sizeof(waves[0]))

static double wave_at(const struct wave *k, double mm)
{
	switch (k->shape) {
	case STEP:
		return k->deg / (1 + exp((k->mm / 2 - mm) * k->w_mm));
	case FRO:
		return k->deg * fabs(fmod(k->w_mm * mm, 2) - 1);
	default:
		return k->deg * sin(k->w_mm * mm);
	}
}

static struct interp_build *wave_build(const struct wave *k, double mm,
				       int decimals)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const int n = (int)lround(k->mm / mm);

	for (int i = 1; i <= n; i++) {
		const double x = k->mm * i / n;
		const double y = k->shape == TURN ? fmax(x - k->mm / 2, 0) : 0;
		const double end[INTERP_NAXES] = {
			[INTERP_X] = rounded(x - y, decimals),
			[INTERP_Y] = rounded(y, decimals),
			[INTERP_B] = rounded(wave_at(k, x) - wave_at(k, 0),
					     decimals),
		};

		dense_line(b, end, true);
	}
	return b;
}

static void with_a_rotary_axis_that_turns_unevenly(void **st)
{
	(void)st;
	for (size_t w = 0; w < NWAVES; w++) {
		const double mm = waves[w].once_mm > 0 ? waves[w].once_mm : 0.2;
		uint64_t once[2], c[2];

		walk_there_and_back(wave_build(&waves[w], mm, 6), once);
		for (int i = 0; i < 4; i++) {
			for (int decimals = 3; decimals <= 6; decimals++) {
				walk_there_and_back(wave_build(&waves[w],
							       steps_mm[i],
							       decimals), c);
				for (int leg = 0; leg < 2; leg++)
					if ((double)c[leg] >
					    waves_most[w] *
					    (double)once[leg])
						fail_msg("wave %d, %g mm, %d "
							 "decimals, leg %d: %d "
							 "cycles, %g mm: %d",
							 (int)w, steps_mm[i],
							 decimals, leg,
							 (int)c[leg], mm,
							 (int)once[leg]);
			}
		}
	}
}

/* In lines of so many mm: the most of what B may do, by differences of the
 * wave's own slope times the speed, because a place is rounded. */
static void most_of_b(const struct wave *k, double mm, int decimals,
		      double ret[3])
{
	struct cycle_config c = usual_config();
	double v[3] = { 0 }, s = 0;
	struct rig r;

	c.dry_run = c.hold_at_end = true;
	ret[0] = ret[1] = ret[2] = 0;
	rig_load(&r, wave_build(k, mm, decimals), &c);
	tell(&r, CYCLE_START);
	for (int n = 0; n < 100000 && r.c.state != STATE_HOLD; n++) {
		double at, from = s;

		step(&r, OPEN_V);
		s = place(&r);
		at = (s + from) / 2;
		v[0] = v[1];
		v[1] = v[2];
		v[2] = (wave_at(k, at + 1e-4) - wave_at(k, at - 1e-4)) / 2e-4 *
		       (s - from) / PERIOD_S;
		ret[0] = fmax(ret[0], fabs(v[2]) / 80);
		/* Both ends are corners. */
		if (n < 3 || s < 0.3 || s > k->mm - 0.3)
			continue;
		ret[1] = fmax(ret[1], fabs(v[2] - v[1]) / PERIOD_S / 1000);
		ret[2] = fmax(ret[2], fabs(v[2] - 2 * v[1] + v[0]) / PERIOD_S /
				      PERIOD_S / 20000);
	}
	assert_int_equal(r.c.state, STATE_HOLD);
	rig_free(&r);
}

static double most_jerk(const struct wave *k)
{
	if (k->shape == SINE)
		return SINE_JERK;
	return k->deg < SMALL_DEG ? SMALL_JERK : STEP_JERK;
}

static void check_most_of_b(const struct wave *k, double mm, int decimals)
{
	double most[3];

	most_of_b(k, mm, decimals, most);
	if (most[0] > 1.03 || most[1] > 1.03 || most[2] > most_jerk(k))
		fail_msg("%g deg, %g, lines of %g mm, %d decimals: %g of v, "
			 "%g of a, %g of the jerk", k->deg, k->w_mm, mm,
			 decimals, most[0], most[1], most[2]);
}

static void a_rotary_axis_that_turns_unevenly_keeps_its_limits(void **st)
{
	uint64_t s = seed_take();

	(void)st;
	for (int i = 0; i < WAVES; i++) {
		const double w_mm = pow(10, uniform(&s, -1.3, 0.3));
		const double slope = pow(10, uniform(&s, -1, 0.7));
		const struct wave k = {
			20, fmin(slope / w_mm, 90), w_mm,
			rnd(&s) % 5 == 0 ? STEP : SINE, 0,
		};

		check_most_of_b(&k, pow(10, uniform(&s, -2, -0.7)), 6);
	}
}

/* By up to 100 degrees in a mm, to and fro within one mm: wide windows see less
 * of its rate than there is. */
static void a_rotary_axis_that_turns_far_keeps_its_limits(void **st)
{
	uint64_t s = seed_take();

	(void)st;
	for (int i = 0; i < WAVES; i++) {
		const double w_mm = pow(10, uniform(&s, -0.5, 0.8));
		const double slope = pow(10, uniform(&s, 0.5, 2));
		const struct wave k = {
			10, fmin(slope / w_mm, 90), w_mm, SINE, 0,
		};

		check_most_of_b(&k, pow(10, uniform(&s, -2.3, -1.7)),
				rnd(&s) % 2 ? 3 : 6);
	}
}

/* -- A narrow peak --------------------------------------------------------- */

/* U goes on evenly, @step_mm a line, and X waits for it: at the middle it keeps
 * a share @rest of its speed, over about @w_mm of U. */
struct wait {
	double step_mm, w_mm, rest;
};

static struct made wait_made(const struct wait *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES] = { 0 };

	for (int i = 1; i * k->step_mm < 6; i++) {
		const double at = (i * k->step_mm - 3) / k->w_mm;

		end[INTERP_X] += k->step_mm *
				 (1 - (1 - k->rest) * exp(-at * at));
		end[INTERP_U] = i * k->step_mm;
		dense_line(b, end, true);
	}
	return finish(b);
}

/* The greatest speed of U over a way of @mm that the ceilings allow, by the
 * places that are walked. */
static double most_of_u(const struct wait *k, double mm)
{
	struct made m = wait_made(k);
	enum interp_step is = INTERP_ARRIVED;
	struct interp_cursor c;
	double most = 0;

	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	while (is == INTERP_ARRIVED) {
		const int32_t from = c.pos[INTERP_U];
		double v = (double)c.seg.feed_max_mm_s;

		interp_cursor_aim(&c, mm);
		while ((is = interp_cursor_step(&c)) == INTERP_MOVED)
			v = fmin(v, (double)c.seg.feed_max_mm_s);
		if (is == INTERP_ARRIVED)
			most = fmax(most, (c.pos[INTERP_U] - from) * 0.001 /
						  mm * v);
	}
	unmake(&m);
	return most;
}

/* In 10 um U goes 14 pulses and more: one of them is 7 %. */
static void a_peak_narrower_than_any_window_keeps_the_speed(void **st)
{
	static const double step_mm[] = { 0.008, 0.012, 0.016 };
	static const double w_mm[] = { 0.15, 0.3, 0.6 };
	static const double rest[] = { 0.1, 0.15, 0.3 };

	(void)st;
	for (int i = 0; i < 27; i++) {
		const struct wait k = {
			step_mm[i % 3], w_mm[i / 3 % 3], rest[i / 9],
		};
		const double most = most_of_u(&k, 0.01);

		if (most > 1.12 * 80)
			fail_msg("lines of %g mm, %g mm, %g: U goes %g mm/s",
				 k.step_mm, k.w_mm, k.rest, most);
	}
}

/*
 * The most that the speed of B changes in a cycle.  Its rate is that of the
 * line, so that corners between lines and in two nodes count as they are.
 */
static double most_jolt(const struct wave *k, double mm, int decimals)
{
	struct cycle_config c = usual_config();
	double v = 0, s = 0, most = 0;
	struct rig r;

	c.dry_run = c.hold_at_end = true;
	rig_load(&r, wave_build(k, mm, decimals), &c);
	tell(&r, CYCLE_START);
	for (int n = 0; n < 100000 && r.c.state != STATE_HOLD; n++) {
		const double from = s, was = v;
		const double first = floor((s + 1e-9) / mm) * mm;
		double last;

		step(&r, OPEN_V);
		s = place(&r);
		last = fmax(first, floor((s - 1e-9) / mm) * mm);
		v = (wave_at(k, last + mm) - wave_at(k, last)) / mm *
		    (s - from) / PERIOD_S;
		if (first > mm && last < k->mm - 2 * mm)
			most = fmax(most, fabs(v - was));
	}
	assert_int_equal(r.c.state, STATE_HOLD);
	rig_free(&r);
	return most;
}

static void a_corner_jolts_an_axis_no_more_in_short_lines(void **st)
{
	uint64_t s = seed_take();

	(void)st;
	for (int i = 0; i < WAVES; i++) {
		const double w_mm = pow(10, uniform(&s, -0.7, 0));
		const double slope = pow(10, uniform(&s, -0.5, 1));
		const struct wave k = { 12, slope / w_mm, w_mm, FRO, 0 };
		const double mm = pow(10, uniform(&s, -2.3, -1));
		const double n = round(k.mm / mm);
		const double most = most_jolt(&k, k.mm / n,
					      3 + (int)(rnd(&s) % 4));

		if (most > CORNER_JOLT)
			fail_msg("%g deg, %g, lines of %g mm: %g deg/s in a "
				 "cycle", k.deg, w_mm, mm, most);
	}
}

/* Round a square corner, or one of the rotary axis alone. */
static double slowest(double mm, double turn, double deg_mm)
{
	const int n = (int)lround(1 / mm);
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES] = { 0 }, least = INFINITY;
	struct made m;

	for (int i = 1; i <= 2 * n; i++) {
		const double s = (double)(i < n ? i : n) / n;
		const double t = i > n ? (double)(i - n) / n : 0;

		end[INTERP_X] = rounded(s + t * cos(turn), 3);
		end[INTERP_Y] = rounded(t * sin(turn), 3);
		end[INTERP_C] = rounded(deg_mm * t, 3);
		dense_line(b, end, true);
	}
	m = finish(b);
	for (uint32_t i = 1; i + 2 < m.p.head->nsegs; i++)
		least = fmin(least, (double)m.p.segs[i].node_mm_s);
	unmake(&m);
	return least;
}

static void true_corners_are_as_slow_as_between_long_lines(void **st)
{
	static const double turns[] = {
		0.05, 0.1, 0.2, 0.3, 0.5, 1, 1.5707963, 2.5, 3.1415926
	};

	(void)st;
	for (int i = 0; i < 4; i++) {
		for (int k = 0; k < 9; k++)
			assert_true(slowest(steps_mm[i], turns[k], 0) <=
				    1.05 * slowest(1, turns[k], 0));
		/* Steps of an axis beside the path. */
		for (double deg = 2; deg < 100; deg *= 3)
			assert_true(slowest(steps_mm[i], 0, deg) <=
				    1.05 * slowest(1, 0, deg));
	}
}

/* Nodes as slow as a way back, where the way goes back before it turns. */
static int turned_back(double mm, double turn, double back)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const int there = (int)lround((1 + back) / mm);
	const int n = there + (int)lround(back / mm);
	const double most = 1.05 * slowest(1, M_PI, 0);
	double end[INTERP_NAXES] = { 0 };
	struct made m;
	int ret = 0;

	for (int i = 1; i <= n + (int)lround(1 / mm); i++) {
		const int along = i <= there ? i : 2 * there - (i < n ? i : n);
		const double t = i > n ? (i - n) * mm : 0;

		end[INTERP_X] = rounded(along * mm + t * cos(turn), 3);
		end[INTERP_Y] = rounded(t * sin(turn), 3);
		dense_line(b, end, true);
	}
	m = finish(b);
	for (uint32_t i = 1; i + 2 < m.p.head->nsegs; i++)
		ret += (double)m.p.segs[i].node_mm_s <= most;
	unmake(&m);
	return ret;
}

static void a_way_back_is_no_shallow_corner(void **st)
{
	static const double turns[] = { 0.02, 0.05, 0.1, 0.2, 0.3 };

	(void)st;
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 5; k++)
			for (double back = 0.02; back < 0.2; back *= 1.5) {
				const double mm = steps_mm[i];

				assert_true(turned_back(mm, turns[k],
							fmax(back, mm)) >= 2);
			}
}

/* -- Corners below the rounding -------------------------------------------- */

static struct interp_build *circle(double r_mm, double mm, double corner_mm)
{
	const struct interp_build_options o = {
		.machine = &help_machine, .corner_mm = corner_mm,
		.strategy = INTERP_SIMULTANEOUS,
	};
	struct interp_build *b = interp_build_create(&o);
	const int n = (int)lround(ARC_MM / mm);
	double end[INTERP_NAXES] = { 0 };

	for (int i = 1; i <= n; i++) {
		end[INTERP_X] = rounded(r_mm * sin(i * mm / r_mm), 3);
		end[INTERP_Y] = rounded(r_mm * (1 - cos(i * mm / r_mm)), 3);
		dense_line(b, end, true);
	}
	return b;
}

/* The most of the acceleration that it takes to go round. */
static double most_round(double r_mm, double mm, double corner_mm)
{
	struct cycle_config c = usual_config();
	double most = 0;
	struct rig r;

	c.dry_run = c.hold_at_end = true;
	rig_load(&r, circle(r_mm, mm, corner_mm), &c);
	tell(&r, CYCLE_START);
	for (int n = 0; n < 100000 && r.c.state != STATE_HOLD; n++) {
		step(&r, OPEN_V);
		most = fmax(most, r.c.mover.v_mm_s * r.c.mover.v_mm_s / r_mm /
				  1000);
	}
	assert_int_equal(r.c.state, STATE_HOLD);
	rig_free(&r);
	return most;
}

static void a_corner_below_the_rounding_shows_the_bend(void **st)
{
	static const double radii[] = { 0.5, 1, 2, 5 };

	(void)st;
	/* It sets the machine. */
	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	for (double corner_mm = 0.00003; corner_mm < 0.006; corner_mm *= 5)
		for (int r = 0; r < 4; r++)
			for (double mm = 0.005; mm < 0.3; mm *= 1.5) {
				const double most = most_round(radii[r], mm,
							       corner_mm);

				if (most > MOST_ROUND)
					fail_msg("radius %g, lines of %g mm, "
						 "corner %g mm: %g of a_max",
						 radii[r], mm, corner_mm, most);
			}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lines_of_three_decimals_are_as_quick),
		cmocka_unit_test(with_a_rotary_axis_too),
		cmocka_unit_test(with_a_rotary_axis_that_turns_unevenly),
		cmocka_unit_test(
			a_rotary_axis_that_turns_unevenly_keeps_its_limits),
		cmocka_unit_test(
			a_rotary_axis_that_turns_far_keeps_its_limits),
		cmocka_unit_test(
			a_peak_narrower_than_any_window_keeps_the_speed),
		cmocka_unit_test(a_corner_jolts_an_axis_no_more_in_short_lines),
		cmocka_unit_test(in_retracts_three_decimals_are_as_quick),
		cmocka_unit_test(true_corners_are_as_slow_as_between_long_lines),
		cmocka_unit_test(a_way_back_is_no_shallow_corner),
		cmocka_unit_test(a_corner_below_the_rounding_shows_the_bend),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
