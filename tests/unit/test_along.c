/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_along.c - promise of one place of a path: at its greatest speed no axis
 * is asked for more than it has
 *
 * The places are random; the seed is printed.
 */
#include "speed/along.h"
#include "interp/smaller.h"
#include "seed.h"

#include <math.h>

#define ROUNDS	SEED_ROUNDS(100000)

/* Newton's last step. */
#define ENOUGH	1.002

static uint64_t seed;

static double uniform(uint64_t *s, double from, double to)
{
	*s = *s * 6364136223846793005u + 1442695040888963407u;
	return from + (to - from) * (double)(*s >> 11) / 0x1p53;
}

static double any(uint64_t *s, double from, double to)
{
	const double sign = uniform(s, 0, 1) < 0.5 ? -1 : 1;

	return sign * pow(10, uniform(s, from, to));
}

static void no_bend_takes_more_jerk_than_an_axis_has(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		const struct interp_axes x = {
			.n = 1, .v_mm_s = { pow(10, uniform(&s, 0, 3)) },
			.a_mm_s2 = { pow(10, uniform(&s, 1, 4)) },
			.j_mm_s3 = { pow(10, uniform(&s, 2, 6)) },
		};
		const double way[INTERP_AXES_WAY] = {
			any(&s, -2, 1), any(&s, -4, 4), any(&s, -4, 8)
		};
		const double by = fabs(way[0]);
		const struct interp_straight kept = {
			x.a_mm_s2[0] / by * uniform(&s, 0.05, 0.9),
			x.j_mm_s3[0] / by * uniform(&s, 0.05, 0.9)
		};
		struct interp_straight left;
		const double v = interp_axes_mm_s(&x, way, &kept, &left);
		const double a = smaller(kept.a_mm_s2,
					 sqrt(v * kept.j_mm_s3));
		const double bent = (fabs(way[2]) * v * v +
				     3 * fabs(way[1]) * a) * v;

		if (bent > ENOUGH * x.j_mm_s3[0])
			fail_msg("round %d: %g of %g mm/s3 at %g mm/s", i,
				 bent, x.j_mm_s3[0], v);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_bend_takes_more_jerk_than_an_axis_has),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
