/* SPDX-License-Identifier: Apache-2.0 */
/* A way through a gap that the guess misses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "corridor.h"

/* A wall at X5 with one gap, 0.4 mm wide, at Y1.5; thinner than any step. */
#define GAP_MM	1.5

static bool in_gap(const double a[INTERP_NAXES], const double b[INTERP_NAXES])
{
	const double t = (5 - a[INTERP_X]) / (b[INTERP_X] - a[INTERP_X]);
	const double y = a[INTERP_Y] + t * (b[INTERP_Y] - a[INTERP_Y]);

	return fabs(y - GAP_MM) < 0.2;
}

static bool keeps(void *arg, const double a[INTERP_NAXES],
		  const double b[INTERP_NAXES])
{
	++*(unsigned int *)arg;
	if (a[INTERP_X] == 5 || b[INTERP_X] == 5)
		return false;
	return (a[INTERP_X] < 5) == (b[INTERP_X] < 5) || in_gap(a, b);
}

static bool never(void *arg)
{
	(void)arg;
	return false;
}

static bool at_once(void *arg)
{
	(void)arg;
	return true;
}

static const double guess[3][INTERP_NAXES] = {
	{ 0, 0, 7 }, { 5.2, 0.1, 7 }, { 10, 0, 7 },
};

static struct corridor through(unsigned int *asked)
{
	struct corridor c = {
		.naxes = 2, .axis = { INTERP_X, INTERP_Y }, .guess = guess,
		.nguess = 3, .wide_mm = 3, .tries = 20000, .keeps = keeps,
		.stop = never, .arg = asked,
	};

	for (int i = 0; i < 2; i++) {
		c.low[i] = -20;
		c.high[i] = 20;
		c.reach_mm[i] = 1;
	}
	return c;
}

static void a_gap_beside_the_guess_is_found(void **state)
{
	double q[64][INTERP_NAXES];
	unsigned int asked = 0;
	const struct corridor c = through(&asked);
	const int n = corridor_find(&c, q, 64);

	(void)state;
	assert_in_range(n, 3, 64);
	assert_memory_equal(q[0], guess[0], sizeof(q[0]));
	assert_memory_equal(q[n - 1], guess[2], sizeof(q[0]));
	for (int i = 0; i + 1 < n; i++) {
		assert_true(keeps(&asked, q[i], q[i + 1]));
		/* An axis that may not move stays. */
		assert_true(q[i][INTERP_Z] == 7);
	}
}

static void none_is_found_where_none_may_be_kept(void **state)
{
	double q[64][INTERP_NAXES];
	unsigned int asked = 0;
	struct corridor c = through(&asked);

	(void)state;
	assert_int_equal(corridor_find(&c, q, 2), 0);
	c.high[INTERP_Y] = 1;	/* the gap is beyond the travel */
	c.tries = 500;
	assert_int_equal(corridor_find(&c, q, 64), 0);
	assert_true(asked > 100);
}

static void it_can_be_stopped(void **state)
{
	double q[64][INTERP_NAXES];
	unsigned int asked = 0;
	struct corridor c = through(&asked);

	(void)state;
	c.stop = at_once;
	assert_int_equal(corridor_find(&c, q, 64), 0);
	assert_in_range(asked, 0, 100);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_gap_beside_the_guess_is_found),
		cmocka_unit_test(none_is_found_where_none_may_be_kept),
		cmocka_unit_test(it_can_be_stopped),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
