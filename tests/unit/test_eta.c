/* SPDX-License-Identifier: Apache-2.0 */
/* test_eta.c - promises of daemon/jobs/eta.h */
#include "compile_help.h"

#include "eta.c"

/* 10 mm up and down, 2 mm cut, 4 mm over, 3 mm cut, 15 mm out. */
static const char *const job = "G0 Z10\nZ0\nM3\nF10\nG1 Z-2\nG0 X4\n"
			       "G1 Z-5\nM5\nG0 Z10\n";

static void measure(struct eta *l, const char *text)
{
	struct compiled c = compile_ready("generic");

	compile(&c, text);
	assert_int_equal(eta_measure(l, &c.p), 0);
	compile_done(&c);
}

static void what_is_positioned_takes_no_time(void **state)
{
	struct eta l = { .n = 0 };

	(void)state;
	measure(&l, job);
	assert_float_equal(l.cut_mm, 5, 1e-9);
	assert_float_equal(eta_s(&l, 21, 60), 240, 1e-6);	/* 1 of 5 mm */
	assert_float_equal(eta_s(&l, 22, 60), 90, 1e-6);	/* 2 of 5 mm */
	assert_float_equal(eta_s(&l, 24, 60), 90, 1e-6);	/* moved over */
	assert_float_equal(eta_s(&l, 28, 60), 15, 1e-6);	/* 4 of 5 mm */
	assert_float_equal(eta_s(&l, 29, 60), 0, 1e-6);
	assert_float_equal(eta_s(&l, 44, 60), 0, 1e-6);
	eta_fini(&l);
}

static void before_the_first_cut_there_is_no_estimate(void **state)
{
	struct eta l = { .n = 0 };

	(void)state;
	assert_float_equal(eta_s(&l, 1, 60), -1, 0);
	measure(&l, job);
	assert_float_equal(eta_s(&l, 0, 0), -1, 0);
	assert_float_equal(eta_s(&l, 20, 60), -1, 0);
	assert_float_equal(eta_s(&l, 21, 0), -1, 0);
	eta_fini(&l);
}

static void a_job_that_cuts_nothing_has_no_estimate(void **state)
{
	struct eta l = { .n = 0 };

	(void)state;
	measure(&l, "G0 X5\nG4 P1\n");
	assert_float_equal(eta_s(&l, 2, 60), -1, 0);
	measure(&l, "M3\n");
	assert_float_equal(eta_s(&l, 0, 60), -1, 0);
	eta_fini(&l);
}

static void a_touch_is_not_cut(void **state)
{
	struct eta l = { .n = 0 };

	(void)state;
	measure(&l, "F10\nG80 Z-5\nG92 Z0\nM3\nG1 Z-2\n");
	assert_float_equal(l.cut_mm, 2, 1e-9);
	eta_fini(&l);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_positioned_takes_no_time),
		cmocka_unit_test(before_the_first_cut_there_is_no_estimate),
		cmocka_unit_test(a_job_that_cuts_nothing_has_no_estimate),
		cmocka_unit_test(a_touch_is_not_cut),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
