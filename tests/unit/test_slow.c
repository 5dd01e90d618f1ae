/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_slow.c - promises of moves that are too short for their speed, over
 * lines beside which a rotary axis bends
 *
 * Some waves and moves are random; the seed is printed.
 */
#include "cycle_help.h"

#include "interp/bends.h"
#include "interp/limits.h"
#include "seed.h"

#define WAVES		SEED_ROUNDS(60)

/* As test_dense.c has it. */
#define BOTH_JERK	2.5

/* Where X Y Z and B are at a place of the path. */
struct way {
	double mm, r_mm;		/* a helix; 0: along X */
	double deg, w_mm;		/* B goes by deg * cos(w_mm * s) */
};

static const struct way helix = { 30, 5, 8, 7.0 / 30 };

static void way_at(const struct way *k, double s, double ret[INTERP_NAXES])
{
	const double r = k->r_mm;

	ret[INTERP_X] = r > 0 ? r * sin(s / r) : s;
	ret[INTERP_Y] = r > 0 ? r * (1 - cos(s / r)) : 0;
	ret[INTERP_Z] = r > 0 ? -s / 10 : 0;
	ret[INTERP_B] = k->deg * (cos(k->w_mm * s) - 1);
}

static struct interp_build *way_build(const struct way *k, double mm,
				      int decimals)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = true, .feed_mm_s = 80,
	};
	const double grain = pow(10, decimals);
	const int n = (int)lround(k->mm / mm);
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	for (int i = 1; i <= n; i++) {
		double end[INTERP_NAXES] = { 0 };

		way_at(k, k->mm * i / n, end);
		for (int j = 0; j < INTERP_NAXES; j++)
			end[j] = round(end[j] * grain) / grain;
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	}
	return b;
}

static void at_its_end(struct rig *r, struct interp_build *b)
{
	struct cycle_config k = usual_config();

	k.dry_run = k.hold_at_end = true;
	k.gap.retract_mm_s = 80;
	rig_load(r, b, &k);
	tell(r, CYCLE_START);
	until(r, STATE_HOLD, OPEN_V, 100000);
}

/* Cycles. */
static int go_back(struct rig *r, double mm)
{
	int n = 0;

	assert_int_equal(tell_mm(r, CYCLE_RETRACT, mm), ANSWER_DONE);
	for (; n < 100000 && r->c.hold.moving; n++)
		step(r, OPEN_V);
	assert_false(r->c.hold.moving);
	return n;
}

/* Cycles of moves of @mm each, over all of the helix. */
static int go_back_by(double line_mm, int decimals, double mm)
{
	struct rig r;
	int n = 0;

	at_its_end(&r, way_build(&helix, line_mm, decimals));
	while (place(&r) > mm)
		n += go_back(&r, mm);
	rig_free(&r);
	return n;
}

static void in_short_lines_they_are_as_quick(void **st)
{
	static const double line_mm[] = { 0.1, 0.02, 0.01, 0.005 };

	(void)st;
	for (double mm = 0.5; mm < 5; mm *= 2) {
		const int once = go_back_by(0.2, 6, mm);

		for (int i = 0; i < 4; i++) {
			const int n = go_back_by(line_mm[i], 3, mm);

			if (n > 1.005 * once)
				fail_msg("moves of %g mm, lines of %g mm: %d "
					 "cycles, lines of 0.2 mm: %d", mm,
					 line_mm[i], n, once);
		}
	}
}

/* -- What B may do --------------------------------------------------------- */

struct most {
	double v[3];			/* deg/s, in the last cycles */
	double a, j;			/* shares of the limits */
};

/* By its own slope times the speed, because a place is rounded. */
static void note(struct most *m, const struct way *k, double from, double to)
{
	const double at = (from + to) / 2;
	const double slope = -k->deg * k->w_mm * sin(k->w_mm * at);
	double *v = m->v;

	v[0] = v[1];
	v[1] = v[2];
	v[2] = slope * (to - from) / PERIOD_S;
	m->a = fmax(m->a, fabs(v[2] - v[1]) / PERIOD_S / 1000);
	m->j = fmax(m->j, fabs(v[2] - 2 * v[1] + v[0]) / PERIOD_S / PERIOD_S /
			  20000);
}

/* A command may come while it moves. */
static struct most moves_of_b(const struct way *k, double mm, uint64_t *s)
{
	struct most m = { .a = 0 };
	struct rig r;

	at_its_end(&r, way_build(k, mm, 6));
	for (int n = 0; n < 20 && place(&r) > 0; n++) {
		const double way = pow(10, uniform(s, -1, 0.8));
		const int most = rnd(s) % 3 == 0 ? (int)(rnd(s) % 300) : 100000;

		tell_mm(&r, CYCLE_RETRACT, way);
		for (int i = 0; i < most && r.c.hold.moving; i++) {
			const double from = place(&r);

			step(&r, OPEN_V);
			assert_int_equal((int)r.c.fault.first, FAULT_NONE);
			note(&m, k, from, place(&r));
		}
	}
	rig_free(&r);
	return m;
}

static void an_axis_that_bends_keeps_its_limits(void **st)
{
	uint64_t s = seed_take();

	(void)st;
	for (int i = 0; i < WAVES; i++) {
		const double w_mm = pow(10, uniform(&s, -1.3, 0.3));
		const double slope = pow(10, uniform(&s, -1, 0.7));
		const struct way k = { 20, 0, fmin(slope / w_mm, 90), w_mm };
		const double mm = pow(10, uniform(&s, -2, -0.7));
		const struct most m = moves_of_b(&k, mm, &s);

		if (m.a > 1.03 || m.j > BOTH_JERK)
			fail_msg("%g deg, %g, lines of %g mm: %g of a, %g of "
				 "the jerk", k.deg, w_mm, mm, m.a, m.j);
	}
}

/* -- What bends leave ------------------------------------------------------ */

static void the_slower_the_more_acceleration_is_left(void **st)
{
	uint64_t s = seed_take();

	(void)st;
	for (int i = 0; i < SEED_ROUNDS(10000); i++) {
		const struct interp_bends b = {
			.a_mm_s2 = (float)uniform(&s, 10, 1000),
			.j_mm_s3 = (float)uniform(&s, 1000, 50000),
			.bent_a_mm_s2 = (float)uniform(&s, 10, 1000),
			.bent_j_mm_s3 = (float)uniform(&s, 1000, 50000),
			.by_v2 = (float)uniform(&s, 0, 1e-3),
			.by_v3 = (float)uniform(&s, 0, 1e-5),
			.by_va = (float)uniform(&s, 0, 1e-4),
		};
		const struct interp_along most = { uniform(&s, 10, 1000), 2e4 };
		const double v = uniform(&s, 0.1, 60);
		const struct interp_along is = interp_bends_leave(&b, v, &most);
		const struct interp_along less =
			interp_bends_leave(&b, v * uniform(&s, 0.1, 1), &most);

		assert_true(is.a_mm_s2 <= most.a_mm_s2);
		assert_true(is.j_mm_s3 <= most.j_mm_s3);
		assert_true(less.a_mm_s2 >= is.a_mm_s2);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(in_short_lines_they_are_as_quick),
		cmocka_unit_test(an_axis_that_bends_keeps_its_limits),
		cmocka_unit_test(the_slower_the_more_acceleration_is_left),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
