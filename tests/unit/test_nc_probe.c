/* SPDX-License-Identifier: Apache-2.0 */
/* test_nc_probe.c - what G38.2, G80 ...  G82 and G160 ...  G162 become */
#include "interp/compile.h"
#include "nc_read.h"

/* The i-th motion, actions left out. */
static uint32_t motion(const struct nc_read *n, uint32_t i)
{
	for (uint32_t k = 0; k < nc_count(n); k++) {
		if (nc_seg(n, k)->kind < INTERP_BEGIN && i-- == 0)
			return k;
	}
	fail_msg("no such motion");
	return 0;
}

static void assert_motion(const struct nc_read *n, uint32_t i,
			  uint8_t ends, double length_mm)
{
	const struct interp_seg *s = nc_seg(n, motion(n, i));

	assert_int_equal(s->flags & INTERP_SEG_SENSED, ends);
	assert_near(s->length_mm, length_mm);
}

static void a_direction_goes_as_far_as_there_is_travel(void **state)
{
	struct nc_read n = nc_read_text("G80 X-\nG81 Z+\nM2\n");

	(void)state;
	assert_motion(&n, 0, INTERP_SEG_PROBE, 400);
	assert_motion(&n, 1, INTERP_SEG_LIMIT, 400);
	assert_near(nc_end(&n, motion(&n, 0), INTERP_X), -400);
	assert_near(nc_end(&n, motion(&n, 1), INTERP_Z), 400);
	nc_done(&n);
}

static void a_place_is_as_far_as_it_goes(void **state)
{
	struct nc_read n = nc_read_text("G80 X-5\nG92 X0\nG91 G80 Y2\n"
					"G20 G80 Z1\n");

	(void)state;
	assert_motion(&n, 0, INTERP_SEG_PROBE, 5);
	assert_motion(&n, 1, INTERP_SEG_PROBE, 2);
	assert_motion(&n, 2, INTERP_SEG_PROBE, 25.4);
	nc_done(&n);
}

static void g38_2_keeps_to_the_feed_and_g80_does_not(void **state)
{
	struct nc_read n = nc_read_text("G38.2 X-5 F6\nG91 G80 X-5\n");

	(void)state;
	assert_near(nc_seg(&n, motion(&n, 0))->feed_mm_s, 0.1f);
	assert_false(nc_seg(&n, motion(&n, 0))->flags & INTERP_SEG_RAPID);
	assert_true(nc_seg(&n, motion(&n, 1))->feed_mm_s > 999);
	nc_done(&n);
}

static void what_is_named_after_probing_counts_from_there(void **state)
{
	struct nc_read n = nc_read_text("G80 X-\nG92 X3\nG0 X10\nG91 G0 X-250\n"
					"G0 Y5\n");

	(void)state;
	assert_near(nc_end(&n, motion(&n, 1), INTERP_X), -393);
	/* Beyond the travel, as the program sees it. */
	assert_near(nc_end(&n, motion(&n, 2), INTERP_X), -643);
	nc_done(&n);
}

static void a_half_is_tried_both_ways(void **state)
{
	struct nc_read n = nc_read_text("G80 X-5\nG91 G0 X1\nG80 X9\nG82 X\n");

	(void)state;
	assert_motion(&n, 3, INTERP_SEG_HALF, 400);
	assert_motion(&n, 4, INTERP_SEG_HALF, 400);
	assert_near(nc_end(&n, motion(&n, 4), INTERP_X),
		    nc_end(&n, motion(&n, 2), INTERP_X));
	nc_done(&n);
}

static void every_one_has_a_stop_in_front(void **state)
{
	struct nc_read n = nc_read_text("G0 X1\nG160 R20 Q0.5 L2\n");
	uint32_t sensed = 0;

	(void)state;
	for (uint32_t i = 0; i < nc_count(&n); i++) {
		if (!(nc_seg(&n, i)->flags & INTERP_SEG_SENSED))
			continue;
		sensed++;
		assert_int_equal(nc_seg(&n, i - 1)->kind, INTERP_DWELL);
	}
	assert_int_equal(sensed, 2 * 2 * 4);
	nc_done(&n);
}

static void a_hole_is_probed_from_wall_to_wall(void **state)
{
	struct nc_read n = nc_read_text("G160 R20 Q0.5\n");

	(void)state;
	assert_motion(&n, 0, INTERP_SEG_PROBE, 20);
	assert_motion(&n, 1, 0, 0.5);
	assert_motion(&n, 2, INTERP_SEG_PROBE, 20);
	assert_motion(&n, 3, INTERP_SEG_HALF, 400);
	assert_motion(&n, 5, INTERP_SEG_PROBE, 20);
	nc_done(&n);
}

static void a_pillar_is_gone_round_over_its_top(void **state)
{
	struct nc_read n = nc_read_text("G161 I15 K8\n");

	(void)state;
	assert_motion(&n, 0, 0, 15);
	assert_motion(&n, 1, 0, 8);
	assert_motion(&n, 2, INTERP_SEG_PROBE, 15);
	assert_motion(&n, 3, 0, 0.1);
	assert_motion(&n, 4, 0, 8);
	assert_motion(&n, 5, 0, 30.1);
	assert_motion(&n, 7, INTERP_SEG_PROBE, 30);
	assert_motion(&n, 10, INTERP_SEG_HALF, 400);
	nc_done(&n);
}

/* -- Refusals ------------------------------------------------------------- */

static const struct nc_refusal refusals[] = {
	{ "G80",		1, 1, "G80 without an axis", "G80 X-" },
	{ "G80 X- Y-",		1, 1, "G80 along several axes", "one of X" },
	{ "G80 X",		1, 5, "X without a sign", "G80 X-" },
	{ "G38.2 X- F5",	1, 7, "X- without a place", "G38.2 X-5" },
	{ "G38.2 X-5",		1, 1, "no feed given", "an F word" },
	{ "G80 X0",		1, 5, "without a way to go", "G80 X-" },
	{ "G80 A5",		1, 5, "A5 has no use", "" },
	{ "G81 X5",		1, 5, "X5 is not a sign alone", "G81 X-" },
	{ "G82 X-",		1, 5, "X- is not an axis alone", "G82 X" },
	{ "G82 X",		1, 1, "with no probing motion along X",
	  "two probing" },
	{ "G80 X-5\nG91 G0 X1\nG82 X", 3, 1, "with one probing motion along X",
	  "two probing" },
	{ "G0 X-",		1, 4, "X- is not a word", "a sign, digits" },
	{ "G1 F1 X",		1, 7, "X is not a word", "a sign, digits" },
	{ "G92 X",		1, 5, "X is not a word", "a sign, digits" },
	{ "G80 X- G0",		1, 1, "with another G word", "of its own" },
	{ "G80 X- G130 R1",	1, 8, "with another G word", "of its own" },
	{ "G80 X-\nG0 X5",	2, 4, "X5 after a probing motion", "G92 X" },
	{ "G80 X-\nG0 Y5 X5",	2, 7, "X5 after a probing motion", "G92 X" },
	{ "G80 X-5\nG80 X5",	2, 5, "X5 after a probing motion", "G92 X" },
	{ "G81 Z+\nG0 Z5",	2, 4, "Z5 after a probing motion", "G92 Z" },
	{ "G80 X-\nG92 X0\nG92.1\nG0 X5", 4, 4, "X5 after", "G92 X" },
	{ "G80 X-\nG92 X0\nG53 G0 X5", 3, 1, "G53 after a probing", "contact" },
	{ "G80 X-\nG92 X0\nG28", 3, 1, "G28 after a probing", "contact" },
	{ "G80 X-\nG92 X0\nG28 X0", 3, 1, "G28 after a probing", "contact" },
	{ "D1=0.1\nG41 D1\nG80 X-", 3, 1, "under an offset", "G40" },
	{ "G160 X3",		1, 6, "X3 has no use", "" },
	{ "G160 R0",		1, 6, "R0 is not above 0", "above 0" },
	{ "G160 Q0",		1, 6, "Q0 is no way off", "a pulse" },
	{ "G161 K5",		1, 1, "without I and J", "how far" },
	{ "G161 I5",		1, 1, "without K", "how far" },
	{ "G161 I-5 K1",	1, 6, "I-5 is not above 0", "above 0" },
	{ "G162 X+",		1, 1, "without the ways", "G162 X+ Y-" },
	{ "G162 X+ Y",		1, 1, "without the ways", "G162 X+ Y-" },
	{ "G38.3 X-5 F5",	1, 1, "unknown word G38.3", "G38.2" },
};

static void what_is_no_probing_is_refused_at_its_place(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(refusals) / sizeof(refusals[0]); i++)
		nc_check_refusal(&refusals[i]);
}

static void other_places_go_on_after_probing(void **state)
{
	struct nc_read n = nc_read_text("G80 X-\nG0 Y5\nG53 G0 Z1\nG28 Z0\n"
					"G4 X0.1\n");

	(void)state;
	assert_near(nc_end(&n, motion(&n, 1), INTERP_Y), 5);
	nc_done(&n);
}

static int rc_in(const char *dialect, const char *text)
{
	struct nc_read n = nc_ready();

	n.dialect = interp_dialect_by_name(dialect);
	nc_read_bytes(&n, text, strlen(text));
	interp_build_destroy(n.build);
	free(n.block);
	return n.rc;
}

static void only_dialects_that_are_known_to_have_them_take_them(void **state)
{
	static const char *const none[] = { "robofil", "skd2", "chmer" };

	(void)state;
	assert_int_equal(rc_in("sodick", "G80 X-\nG92 X0\nM02\n"), 0);
	assert_int_equal(rc_in("sodick", "G80 X-\nG91 G00 X1.0\nG80 X+\n"
					 "G82 X\nM02\n"), 0);
	assert_int_equal(rc_in("sodick", "G00 X-\nM02\n"), -EINVAL);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(rc_in(none[i], "G80 X-1.0\nM02\n"), -EINVAL);
		assert_int_equal(rc_in(none[i], "G80 X-\nM02\n"), -EINVAL);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_direction_goes_as_far_as_there_is_travel),
		cmocka_unit_test(a_place_is_as_far_as_it_goes),
		cmocka_unit_test(g38_2_keeps_to_the_feed_and_g80_does_not),
		cmocka_unit_test(what_is_named_after_probing_counts_from_there),
		cmocka_unit_test(a_half_is_tried_both_ways),
		cmocka_unit_test(every_one_has_a_stop_in_front),
		cmocka_unit_test(a_hole_is_probed_from_wall_to_wall),
		cmocka_unit_test(a_pillar_is_gone_round_over_its_top),
		cmocka_unit_test(what_is_no_probing_is_refused_at_its_place),
		cmocka_unit_test(other_places_go_on_after_probing),
		cmocka_unit_test(only_dialects_that_are_known_to_have_them_take_them),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
