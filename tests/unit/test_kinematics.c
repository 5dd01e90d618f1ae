/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What interp/kinematics.h promises.
 */
#include "interp/kinematics.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t seed = 1;

static double draw(double lo, double hi)
{
	seed = seed * UINT64_C(6364136223846793005) + 1442695040888963407u;
	return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

static const char *const chains[] = {
	"C(1 -2 -120) A(0 15 -80) X Y Z",	/* trunnion table */
	"X Y Z C(0 0 3) A(0.5 0 210)",		/* both in the head */
	"C(4 5 -60) X Y Z B(0 0 180)",		/* one in each */
	"B(0 0 0 / 0 0.70710678 0.70710678) C(0 0 -50) Y X Z",	/* nutating */
	"X Y Z C",				/* a spindle that rolls */
	"A(0 20 30) X Y Z",			/* one rotary */
};

#define NCHAINS	((int)(sizeof(chains) / sizeof(chains[0])))

static void make(struct interp_kinematics *k, const char *chain)
{
	struct interp_diag d = { 0 };

	interp_kin_clear(k);
	k->tip_mm[2] = -75;
	if (interp_kin_parse(k, chain, &d))
		fail_msg("%s: %s; %s", chain, d.found, d.wanted);
}

static void draw_axes(const struct interp_kinematics *k,
		      double q[INTERP_NAXES])
{
	memset(q, 0, INTERP_NAXES * sizeof(*q));
	for (uint32_t i = 0; i < k->njoints; i++) {
		const enum interp_axis a = k->joint[i].axis;

		q[a] = interp_axis_is_rotary(a) ? draw(-170, 170) :
						  draw(-200, 200);
	}
}

static void assert_pose(const struct interp_kin_pose *p,
			const struct interp_kin_pose *q, double mm)
{
	for (int i = 0; i < 3; i++) {
		assert_true(fabs(p->tip_mm[i] - q->tip_mm[i]) <= mm);
		assert_true(fabs(p->dir[i] - q->dir[i]) <= 1e-9);
	}
}

static void forward_of_a_trunnion_is_what_a_drawing_says(void **state)
{
	struct interp_kinematics k;
	struct interp_kin_pose p;
	double q[INTERP_NAXES] = { 0 };

	(void)state;
	make(&k, "C(0 0 0) A(0 0 -100) X Y Z");
	k.tip_mm[2] = 0;
	q[INTERP_X] = 10;
	interp_kin_forward(&k, q, &p);
	assert_true(fabs(p.tip_mm[0] - 10) < 1e-12);
	/* C by 90: what was to the right is seen ahead. */
	q[INTERP_C] = 90;
	interp_kin_forward(&k, q, &p);
	assert_true(fabs(p.tip_mm[0]) < 1e-12);
	assert_true(fabs(p.tip_mm[1] - 10) < 1e-12);
	/* A by 90 about a line 100 below: the tip swings toward -Y. */
	q[INTERP_X] = q[INTERP_C] = 0;
	q[INTERP_A] = 90;
	interp_kin_forward(&k, q, &p);
	assert_true(fabs(p.tip_mm[1] + 100) < 1e-12);
	assert_true(fabs(p.tip_mm[2] + 100) < 1e-12);
	assert_true(fabs(p.dir[1] + 1) < 1e-12);
}

static void inverse_undoes_forward(void **state)
{
	(void)state;
	for (int n = 0; n < 100000; n++) {
		struct interp_kin_pose want, got;
		double q[INTERP_NAXES], r[INTERP_NAXES];
		struct interp_kinematics k;

		make(&k, chains[n % NCHAINS]);
		draw_axes(&k, q);
		interp_kin_forward(&k, q, &want);
		if (interp_kin_margin(&k, q) < 1e-3)
			continue;
		draw_axes(&k, r);
		/* What the direction does not tell is not looked for. */
		if (k.nturn == 0)
			r[INTERP_C] = q[INTERP_C];
		assert_int_equal(interp_kin_inverse(&k, &want, r), 0);
		interp_kin_forward(&k, r, &got);
		assert_pose(&got, &want, 1e-9);
	}
}

static void of_two_solutions_the_nearer_is_taken(void **state)
{
	(void)state;
	for (int n = 0; n < 10000; n++) {
		double q[INTERP_NAXES], r[INTERP_NAXES];
		struct interp_kin_pose want;
		struct interp_kinematics k;

		make(&k, chains[n % 3]);
		draw_axes(&k, q);
		if (interp_kin_margin(&k, q) < 0.05)
			continue;
		interp_kin_forward(&k, q, &want);
		memcpy(r, q, sizeof(r));
		for (int i = INTERP_A; i <= INTERP_C; i++)
			r[i] += draw(-0.5, 0.5);
		r[INTERP_X] = r[INTERP_Y] = r[INTERP_Z] = 0;
		assert_int_equal(interp_kin_inverse(&k, &want, r), 0);
		for (uint32_t i = 0; i < k.njoints; i++) {
			const enum interp_axis a = k.joint[i].axis;

			assert_true(fabs(r[a] - q[a]) < 1e-6);
		}
	}
}

static void place_keeps_the_tip_while_the_rotaries_turn(void **state)
{
	const double tip_mm[3] = { 12, -7, -110 };

	(void)state;
	for (int n = 0; n < 20000; n++) {
		struct interp_kin_pose got;
		double q[INTERP_NAXES], turned[INTERP_NAXES];
		struct interp_kinematics k;

		make(&k, chains[n % NCHAINS]);
		draw_axes(&k, q);
		memcpy(turned, q, sizeof(q));
		assert_int_equal(interp_kin_place(&k, tip_mm, q), 0);
		interp_kin_forward(&k, q, &got);
		for (int i = 0; i < 3; i++)
			assert_true(fabs(got.tip_mm[i] - tip_mm[i]) < 1e-9);
		for (int i = INTERP_A; i <= INTERP_C; i++)
			assert_true(q[i] == turned[i]);
	}
}

static void a_tool_upright_on_a_trunnion_is_singular(void **state)
{
	struct interp_kin_pose up = { { 1, 2, 3 }, { 0, 0, 1 } };
	double q[INTERP_NAXES] = { [INTERP_C] = 33 };
	struct interp_kinematics k;

	(void)state;
	make(&k, chains[0]);
	assert_true(interp_kin_margin(&k, q) < 1e-12);
	q[INTERP_A] = 30;
	assert_true(fabs(interp_kin_margin(&k, q) - 0.5) < 1e-12);
	q[INTERP_A] = 0;
	assert_int_equal(interp_kin_inverse(&k, &up, q), -ESRCH);
	assert_true(fabs(q[INTERP_C] - 33) < 1e-9);
	assert_true(fabs(q[INTERP_A]) < 1e-5);
}

static void a_direction_out_of_reach_is_refused(void **state)
{
	struct interp_kin_pose p = { { 0, 0, 0 }, { 1, 0, 0 } };
	double q[INTERP_NAXES] = { 5, 6, 7 };
	struct interp_kinematics k;

	(void)state;
	make(&k, chains[5]);
	assert_int_equal(interp_kin_inverse(&k, &p, q), -EDOM);
	make(&k, chains[4]);
	assert_int_equal(interp_kin_inverse(&k, &p, q), -EDOM);
	p.dir[0] = NAN;
	make(&k, chains[0]);
	assert_int_equal(interp_kin_inverse(&k, &p, q), -EDOM);
	assert_true(q[INTERP_X] == 5 && q[INTERP_Y] == 6 && q[INTERP_Z] == 7);
}

static const struct {
	const char *chain, *found, *wanted;
} bad[] = {
	{ "", "0 linear axes", "three linear axes" },
	{ "X Y", "2 linear axes", "three linear axes" },
	{ "X Y Z U", "a fourth one, U", "three linear axes" },
	{ "X Y Z X", "axis X a second time", "each axis once" },
	{ "C A B X Y Z", "a third rotary", "at most two" },
	{ "C(0 0) X Y Z", ") X Y Z", "three numbers" },
	{ "C(0 0 0 X Y Z", "X Y Z", "a )" },
	{ "C(0 0 0 / 0 0 0) X Y Z", "C without a direction", "a direction" },
	{ "C(0 0 nan) X Y Z", "C at no place", "numbers" },
	{ "Q X Y Z", "Q X Y Z at character 1", "from work to tool" },
	{ "X Y Z(0 0 0 / 1 0 0)", "one plane", "lie in one plane" },
	{ "A B(0 0 0 / 1 0 0) X Y Z", "the same one", "two directions" },
};

static void what_is_no_machine_is_refused_with_the_reason(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct interp_diag d = { 0 };
		struct interp_kinematics k;

		interp_kin_clear(&k);
		assert_int_equal(interp_kin_parse(&k, bad[i].chain, &d),
				 -EINVAL);
		if (!strstr(d.found, bad[i].found) ||
		    !strstr(d.wanted, bad[i].wanted))
			fail_msg("%s: %s; %s", bad[i].chain, d.found,
				 d.wanted);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(forward_of_a_trunnion_is_what_a_drawing_says),
		cmocka_unit_test(inverse_undoes_forward),
		cmocka_unit_test(of_two_solutions_the_nearer_is_taken),
		cmocka_unit_test(place_keeps_the_tip_while_the_rotaries_turn),
		cmocka_unit_test(a_tool_upright_on_a_trunnion_is_singular),
		cmocka_unit_test(a_direction_out_of_reach_is_refused),
		cmocka_unit_test(what_is_no_machine_is_refused_with_the_reason),
	};

	return cmocka_run_group_tests_name("interp/kinematics", tests, NULL,
					   NULL);
}
