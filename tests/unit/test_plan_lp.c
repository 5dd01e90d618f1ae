/* SPDX-License-Identifier: Apache-2.0 */
/* test_plan_lp.c - promises of the linear programs of edm-plan */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "lp.h"

/* A step of a rib through a slot.  GLPK's presolver divides by roundings like
 * those of its first row, calls 4.31 the best, and misses a row by 1.7 mm. */
static const char with_dust[] =
	"Maximize\n"
	" obj: + 0.346176293235637 x_1 + 0.0429391551357388 x_2\n"
	" + 0.346176293235637 x_3 + 4 x_4\n"
	"Subject To\n"
	" r_1: - x_4 + 1.00076441656352e-14 x_3 + x_2 -\n"
	" 1.56056701207874e-13 x_1\n"
	" >= -0.71\n"
	" r_2: - x_4 - 2.5019110414088e-15 x_3 + x_2 -\n"
	" 2.5019110414088e-14 x_1\n"
	" >= -0.71\n"
	" r_3: - x_4 - 0.0570599418281938 x_3 + 0.755897981834087 x_2\n"
	" + 0.652198132546941 x_1 >= -1.33293349725906\n"
	" r_4: - x_4 + 0.087155738833336 x_3 - 0.996194698434204 x_1\n"
	" >= -0.783780516623871\n"
	" r_5: - x_4 + 5.00382208281761e-15 x_3 + x_2 >= -0.71\n"
	" r_6: - x_4 + 0.0871557354957724 x_3 - 5.66598864260583e-16\n"
	" x_2\n"
	" - 0.996194698726203 x_1 >= -0.783780621285931\n"
	" r_7: - x_4 + 0.0871557354957724 x_3 - 0.996194698726203 x_1\n"
	" >= -0.783780621285931\n"
	" r_8: - x_4 + 0.0871557354957756 x_3 - 1.51910313648369e-08\n"
	" x_2\n"
	" - 0.996194698726203 x_1 >= -0.783780610500304\n"
	" r_9: - x_4 - 0.0871557410158966 x_3 + 0.996194698243255 x_1\n"
	" >= -1.21621932743413\n"
	" r_10: - x_4 + 2.75404161147326e-15 x_3 - x_2 +\n"
	" 3.44255201434157e-16 x_1\n"
	" >= -1.29\n"
	" r_11: - x_4 - 0.0871557410158995 x_3 + 0.996194698243255 x_1\n"
	" >= -1.21621932743413\n"
	" r_12: - x_4 - 2.75404161147326e-15 x_3 - x_2 +\n"
	" 5.71463634380701e-14 x_1\n"
	" >= -1.29\n"
	" r_13: - x_4 - 5.50808322294651e-15 x_3 - x_2 +\n"
	" 2.54748849061276e-14 x_1\n"
	" >= -1.29\n"
	" r_14: - x_4 - 0.0871557410158992 x_3 + 5.87208935862274e-09\n"
	" x_2\n"
	" + 0.996194698243255 x_1 >= -1.21621931985914\n"
	" r_15: - x_4 - 0.087155739715729 x_3 + 0.996194698357005 x_1\n"
	" >= -1.21621928702775\n"
	" r_16: - x_4 + 0.087155738833336 x_3 - 0.996194698434204 x_1\n"
	" >= -0.783780516623871\n"
	" r_17: - x_4 - 0.087155739715729 x_3 + 0.996194698357005 x_1\n"
	" >= -1.21621928702775\n"
	" r_18: - x_4 + x_2 >= -0.71\n"
	" r_19: - x_4 + x_2 >= -0.71\n"
	" r_20: - x_4 - 0.00105172081245522 x_3 + 0.662966878144035 x_2\n"
	" - 0.748647989623485 x_1 >= -1.61627602131737\n"
	" r_21: - x_4 + 0.0871557327270594 x_3 - 2.77929067791098e-08\n"
	" x_2\n"
	" - 0.996194698968434 x_1 >= -0.783780521619102\n"
	" r_22: - x_4 - x_2 >= -1.29\n"
	" r_23: - x_4 - 0.0892914897015756 x_3 - 0.858921858082658 x_2\n"
	" + 0.504262106026923 x_1 >= -1.50188284051779\n"
	" r_24: - x_4 + 2.75404161147326e-15 x_3 - x_2 -\n"
	" 4.8195728200782e-15 x_1\n"
	" >= -1.29\n"
	"Bounds\n"
	" -2 <= x_1 <= 2\n"
	" -2 <= x_2 <= 2\n"
	" -2 <= x_3 <= 2\n"
	" 0.31000773811189 <= x_4 <= 0.71000773811189\n"
	"End\n";

static glp_prob *read_lp(const char *text)
{
	const int fd = memfd_create("lp", MFD_CLOEXEC);
	glp_prob *p = glp_create_prob();
	char name[40];

	assert_int_equal(write(fd, text, strlen(text)), strlen(text));
	snprintf(name, sizeof(name), "/proc/self/fd/%d", fd);
	glp_term_out(GLP_OFF);
	assert_int_equal(glp_read_lp(p, NULL, name), 0);
	close(fd);
	return p;
}

static bool never(void)
{
	return false;
}

static bool at_once(void)
{
	return true;
}

static void rounding_is_no_term(void **state)
{
	glp_prob *p = read_lp(with_dust);
	double value[5];
	int index[5];

	(void)state;
	assert_true(lp_solve(p, never));
	assert_float_equal(glp_get_obj_val(p), 3.6435, 1e-4);
	/* r_1 has x_4 and x_2 left. */
	assert_int_equal(glp_get_mat_row(p, 1, index, value), 2);
	glp_delete_prob(p);
}

static void what_has_no_place_is_not_found(void **state)
{
	glp_prob *p = read_lp("Maximize\n obj: x + y\nSubject To\n"
			      " r_1: x + y >= 3\nBounds\n 0 <= x <= 1\n"
			      " 0 <= y <= 1\nEnd\n");

	(void)state;
	assert_false(lp_solve(p, never));
	glp_set_row_bnds(p, 1, GLP_LO, 1, 0);
	assert_true(lp_solve(p, never));
	assert_float_equal(glp_get_obj_val(p), 2, 1e-9);
	glp_delete_prob(p);
}

static void who_waits_may_stop_it(void **state)
{
	glp_prob *p = read_lp(with_dust);

	(void)state;
	assert_false(lp_solve(p, at_once));
	glp_delete_prob(p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rounding_is_no_term),
		cmocka_unit_test(what_has_no_place_is_not_found),
		cmocka_unit_test(who_waits_may_stop_it),
	};

	return cmocka_run_group_tests_name("plan/lp", tests, NULL, NULL);
}
