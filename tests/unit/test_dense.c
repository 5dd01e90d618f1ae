/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_dense.c - promises of programs of very short lines whose ends are
 * rounded
 */
#include "cycle_help.h"

#include "interp/limits.h"

#define ARC_MM		15.0
#define RADIUS_MM	5.0

struct dense {
	double mm;			/* of a line */
	int decimals;
	double deg_mm;			/* of C beside it */
	bool cut;			/* not positioned */
};

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
	static const double turns[] = { 0.5, 1, 1.5707963, 2.5, 3.1415926 };

	(void)st;
	for (int i = 0; i < 4; i++) {
		for (int k = 0; k < 5; k++)
			assert_true(slowest(steps_mm[i], turns[k], 0) <=
				    1.05 * slowest(1, turns[k], 0));
		/* Steps of an axis beside the path. */
		for (double deg = 2; deg < 100; deg *= 3)
			assert_true(slowest(steps_mm[i], 0, deg) <=
				    1.05 * slowest(1, 0, deg));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lines_of_three_decimals_are_as_quick),
		cmocka_unit_test(with_a_rotary_axis_too),
		cmocka_unit_test(in_retracts_three_decimals_are_as_quick),
		cmocka_unit_test(true_corners_are_as_slow_as_between_long_lines),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
