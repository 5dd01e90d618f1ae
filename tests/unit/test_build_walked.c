/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_build_walked.c - a text that has few lines and asks for days of walking
 *
 * What has to be walked point by point to build a program is counted over all
 * of it, not only in each curve and arc.
 */
#include "nc_read.h"

#include "interp/angle.h"
#include "interp/compile.h"

#define WALKED	20000u

struct text {
	enum interp_strategy strategy;
	const char *motion;		/* back where it began */
	bool refused;
};

/* 300 times some 600 points or more, each. */
static const struct text texts[] = {
	{ INTERP_SIMULTANEOUS, "G5 X0.3 Y0 I0.1 J0.2 P-0.1 Q0.2\nG1 X-0.3",
	  true },
	{ INTERP_POINT_BY_POINT, "G2 I0.1", true },
	{ INTERP_CENTRED, "G2 I0.1", true },
	{ INTERP_MIN_SWITCH, "G2 I0.1", true },
	{ INTERP_MIN_SWITCH, "G2 I0.1 Z0.1\nG1 Z-0.1", true },
	{ INTERP_MIN_SWITCH, "G1 X0.301 Y0.217 Z0.119\nX-0.301 Y-0.217 Z-0.119",
	  true },
	/* These are as quick as lines. */
	{ INTERP_SIMULTANEOUS, "G2 I0.1", false },
	{ INTERP_POINT_BY_POINT, "G1 X0.3 Y0.1\nX-0.3 Y-0.1", false },
};

struct try {
	const struct text *text;
	uint32_t walked_max, repeats;
	bool ahead;			/* the text may be read once more */
	struct interp_diag diag;
	size_t bytes;			/* of what was built */
};

static int compile_try(struct try *t)
{
	struct nc_read n = nc_ready();
	const struct interp_build_options o = {
		.machine = &n.machine, .strategy = t->text->strategy,
		.tolerance_milli = 2000, .walked_max = t->walked_max,
	};
	struct interp_build *b = interp_build_create(&o);
	struct interp_compile_options co;
	struct interp_text text;
	char words[256];
	uint32_t lines;
	int err;

	assert_non_null(b);
	text = (struct interp_text) {
		words, (size_t)snprintf(words, sizeof(words), "G91 F100\n"
					"M98 P1 L%u\nM2\nO1\n%s\nM99\n",
					t->repeats, t->text->motion), NULL
	};
	n.o.machine = &n.machine;
	co = (struct interp_compile_options) { .nc = n.o };
	err = t->ahead ? interp_compile(&text, &co, b, &lines, &t->diag) :
			 interp_nc_compile(&text, &n.o, b, &n.result,
					   &t->diag);
	t->bytes = interp_build_bytes(b);
	interp_build_destroy(b);
	return err;
}

static int compile(const struct text *t, uint32_t walked_max,
		   struct interp_diag *diag, uint32_t repeats)
{
	struct try try = { .text = t, .walked_max = walked_max,
			   .repeats = repeats };
	const int err = compile_try(&try);

	*diag = try.diag;
	return err;
}

static void what_is_walked_is_counted_over_the_text(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		const struct text *t = &texts[i];
		struct interp_diag diag = { 0 };

		assert_int_equal(compile(t, WALKED, &diag, 3), 0);
		assert_int_equal(compile(t, 0, &diag, 300), 0);
		assert_int_equal(compile(t, WALKED, &diag, 300),
				 t->refused ? -EINVAL : 0);
		if (!t->refused)
			continue;
		assert_non_null(strstr(diag.found, "more than 20000 lattice"));
		assert_in_range(diag.line, 5, 6);
	}
}

/* It is refused when a part of what is allowed was walked. */
static void too_much_is_told_early(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct try few = { &texts[i], WALKED, 3, true, { 0 }, 0 };
		struct try many = { &texts[i], WALKED, 300, true, { 0 }, 0 };

		assert_int_equal(compile_try(&few), 0);
		assert_int_equal(compile_try(&many),
				 texts[i].refused ? -EINVAL : 0);
		if (!texts[i].refused)
			continue;
		assert_non_null(strstr(many.diag.found, "more than 20000"));
		assert_in_range(many.diag.line, 5, 6);
		assert_true(many.bytes <= few.bytes);
	}
}

/* What is counted ahead is no more than what is walked. */
static void nothing_else_is_refused_early(void **state)
{
	uint32_t taken = 0;

	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		for (uint32_t max = 1000; max < 60000; max += max / 40) {
			struct try a = { &texts[i], max, 30, false, { 0 }, 0 };
			struct try b = { &texts[i], max, 30, true, { 0 }, 0 };
			const int err = compile_try(&a);

			assert_int_equal(compile_try(&b), err);
			taken += texts[i].refused && err == 0;
		}
	}
	assert_in_range(taken, 100, 1000);
}

/* A circle that touches the travel is looked at closely, by any strategy. */
static void so_is_the_end_of_the_travel(void **state)
{
	const struct text touching = { INTERP_SIMULTANEOUS, "G2 I100", true };
	struct interp_diag diag = { 0 };

	(void)state;
	assert_int_equal(compile(&touching, WALKED, &diag, 3), 0);
	assert_int_equal(compile(&touching, WALKED, &diag, 9), -EINVAL);
	assert_non_null(strstr(diag.found, "lattice points"));
}

/* What is too long is told by its own length, before it is walked. */
static void one_arc_is_counted_before_it_is_walked(void **state)
{
	const struct text large = { INTERP_POINT_BY_POINT, "G2 I20", true };
	struct interp_diag diag = { 0 };

	(void)state;
	assert_int_equal(compile(&large, WALKED, &diag, 1), -EINVAL);
	assert_non_null(strstr(diag.found, "more than 20000 lattice"));
}

/* Its bursts are as few as a plan, but the plan has to be made to know that: so
 * many such lines take as long as others. */
static void a_line_is_counted_before_it_is_planned(void **state)
{
	const struct text even = {
		INTERP_MIN_SWITCH, "G1 X10 Y10\nX-10 Y-10", true
	};
	struct try many = { &even, 2 * WALKED, 300, true, { 0 }, 0 };
	struct interp_diag diag = { 0 };

	(void)state;
	assert_int_equal(compile(&even, 2 * WALKED, &diag, 1), 0);
	assert_int_equal(compile(&even, WALKED - 1000, &diag, 1), -EINVAL);
	assert_non_null(strstr(diag.found, "more than 19000 lattice"));
	assert_int_equal(compile(&even, 2 * WALKED, &diag, 2), -EINVAL);
	assert_int_equal(compile_try(&many), -EINVAL);
	assert_non_null(strstr(many.diag.found, "lines by min-switch that are "
						"more than 40000 lattice"));
}

/* Two circles of 5 * 10^8 pulses each: the sum has too many for a segment, and
 * no place for its bits is taken. */
static void so_are_two_contours(void **state)
{
	const double r_mm = 80000, end_mm[INTERP_NAXES] = { 0 };
	const struct interp_build_contour circle[2] = {
		{ .arc = true, .sweep = ANGLE_TURN, .centre_mm = { r_mm, 0 } },
		{ .arc = true, .sweep = ANGLE_TURN, .centre_mm = { r_mm, 0 } },
	};
	const struct interp_build_word w = { .line = 5, .feed_mm_s = 1 };
	struct nc_read n = nc_ready();
	struct interp_diag diag = { 0 };
	struct interp_build *b;

	(void)state;
	for (int i = 0; i < INTERP_NAXES; i++) {
		n.machine.axis[i].travel_min_mm = -4 * r_mm;
		n.machine.axis[i].travel_max_mm = 4 * r_mm;
	}
	b = interp_build_create(&(struct interp_build_options) {
		.machine = &n.machine, .strategy = INTERP_POINT_BY_POINT,
		.walked_max = WALKED,
	});
	assert_non_null(b);
	assert_int_equal(interp_build_pair(b, end_mm, circle, &w, &diag),
			 -EINVAL);
	assert_non_null(strstr(diag.found, "more than 20000 lattice"));
	interp_build_destroy(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_walked_is_counted_over_the_text),
		cmocka_unit_test(too_much_is_told_early),
		cmocka_unit_test(nothing_else_is_refused_early),
		cmocka_unit_test(so_is_the_end_of_the_travel),
		cmocka_unit_test(one_arc_is_counted_before_it_is_walked),
		cmocka_unit_test(a_line_is_counted_before_it_is_planned),
		cmocka_unit_test(so_are_two_contours),
	};

	return cmocka_run_group_tests_name("path/build", tests, NULL, NULL);
}
