/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nc.c - what each word of the generic dialect means
 */
#include "nc_read.h"


static void a_line_ends_where_its_words_say(void **state)
{
	struct nc_read n = nc_read_text("G0 X1.5 Y-2\nG1 F60 Z.25\nX3\n");

	(void)state;
	assert_int_equal(nc_count(&n), 3);
	assert_xyz(&n, 0, 1.5, -2, 0);
	assert_xyz(&n, 1, 1.5, -2, .25);
	assert_xyz(&n, 2, 3, -2, .25);
	assert_int_equal(nc_seg(&n, 0)->flags, INTERP_SEG_RAPID);
	assert_int_equal(nc_seg(&n, 1)->flags, 0);
	assert_int_equal(nc_seg(&n, 2)->line, 3);
	assert_near(nc_seg(&n, 2)->feed_mm_s, 1);
	assert_int_equal(n.result.lines, 3);
	assert_int_equal(n.result.executed, 3);
	nc_done(&n);
}

static void blanks_case_and_line_ends_change_nothing(void **state)
{
	static const char *const forms[] = {
		"G1X1Y2F3\nG3X3I1.J0\n",
		" g 01 x + 1 \t y2 f3 (a) \r\ng3 x3.0 i 1.j0;b\r\n",
		"\xef\xbb\xbfN1 F3 Y2 X1 G1 (\xc3\xa9)\r\rN2 S5 J0 I1 X3 G3",
		"%\nO7 (main)\n/G0 X9 nonsense\nG1 X1 Y2 F3\nG3 X3 I1 J0\n%\n?",
	};
	struct nc_read a = nc_read_text(forms[0]);

	(void)state;
	for (size_t i = 1; i < sizeof(forms) / sizeof(forms[0]); i++) {
		struct nc_read b = nc_read_text(forms[i]);

		assert_same_path(&a, &b, 0);
		nc_done(&b);
	}
	nc_done(&a);
}

static void every_number_is_the_nearest_double(void **state)
{
	uint64_t seed = 20240601;
	char number[40], text[64];

	(void)state;
	print_message("seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < 20000; i++) {
		const int digits = (int)(nc_random(&seed) % 13);
		struct nc_read n = nc_ready();

		snprintf(number, sizeof(number), "%s%u.%0*llu",
			 nc_random(&seed) % 2 ? "-" : "",
			 nc_random(&seed) % 200, digits ? digits : 1,
			 digits ? (unsigned long long)
			 ((uint64_t)nc_random(&seed) << 20 |
			  nc_random(&seed) >> 11) % (unsigned long long)
			 pow(10, digits) : 0ull);
		snprintf(text, sizeof(text), "G0 X%s", number);
		nc_read(&n, text);
		assert_true(interp_build_here(n.build)[INTERP_X] ==
			    strtod(number, NULL));
		nc_done(&n);
	}
}

static void more_digits_than_a_double_has_do_no_harm(void **state)
{
	struct nc_read n = nc_read_text(
		"G0 X0.1000000000000000000000000000000000001\n"
		"X000000000000000000000000000000002.5 Y1.\n"
		"X.00000000000000000000000000000000001");

	(void)state;
	assert_xyz(&n, 0, .1, 0, 0);
	assert_xyz(&n, 1, 2.5, 1, 0);
	assert_xyz(&n, 2, 0, 1, 0);
	nc_done(&n);
}

#define POINTS	200

/* The same random walk over um points, written absolute and another way. */
static void write_walks(uint64_t seed, char *absolute, char *other,
			double per_unit, bool incremental)
{
	int32_t at[2] = { 0, 0 };

	absolute += sprintf(absolute, "G21 G90 G0 F1\n");
	other += sprintf(other, "%s %s G0 F1\n", per_unit != 1 ? "G20" : "G21",
			 incremental ? "G91" : "G90");
	for (int i = 0; i < POINTS; i++) {
		int32_t to[2], from[2] = { at[0], at[1] };

		for (int j = 0; j < 2; j++)
			to[j] = (int32_t)(nc_random(&seed) % 300001) - 150000;
		memcpy(at, to, sizeof(at));
		if (!incremental)
			from[0] = from[1] = 0;
		absolute += sprintf(absolute, "X%.3f Y%.3f A%.3f\n",
				    to[0] / 1e3, to[1] / 1e3, to[1] / 1e3);
		other += sprintf(other, "X%.12f Y%.12f A%.3f\n",
				 (to[0] - from[0]) / 1e3 / per_unit,
				 (to[1] - from[1]) / 1e3 / per_unit,
				 (to[1] - from[1]) / 1e3);
	}
}

static void assert_walks_agree(uint64_t seed, double per_unit,
			       bool incremental, int64_t off_sub)
{
	static char absolute[POINTS * 80], other[POINTS * 80];
	struct nc_read a, b;

	print_message("seed %llu\n", (unsigned long long)seed);
	write_walks(seed, absolute, other, per_unit, incremental);
	a = nc_read_text(absolute);
	b = nc_read_text(other);
	assert_int_equal(nc_count(&a), POINTS);
	assert_same_path(&a, &b, off_sub);
	nc_done(&a);
	nc_done(&b);
}

static void incremental_equals_absolute(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed <= 20; seed++)
		assert_walks_agree(seed, 1, true, 0);
}

static void inches_equal_millimetres_and_degrees_stay_degrees(void **state)
{
	(void)state;
	for (uint64_t seed = 101; seed <= 120; seed++)
		assert_walks_agree(seed, 25.4, false, 1);
}

/* Write what was read as NC code again: absolute lines, arcs by I J. */
static void write_back(const struct nc_read *n, char *text)
{
	text += sprintf(text, "F1\n");
	for (uint32_t i = 0; i < nc_count(n); i++) {
		const struct interp_seg *s = nc_seg(n, i);

		if (s->kind == INTERP_ARC) {
			const struct interp_arc *arc = nc_arc_of(n, i);

			text += sprintf(text, "G%d G90.1 I%.12f J%.12f ",
					arc->sweep > 0 ? 3 : 2, arc->a_mm,
					arc->b_mm);
		} else {
			text += sprintf(text, "G%d ",
					s->flags & INTERP_SEG_RAPID ? 0 : 1);
		}
		text += sprintf(text, "X%.10f Y%.10f Z%.10f\n",
				nc_end(n, i, INTERP_X), nc_end(n, i, INTERP_Y),
				nc_end(n, i, INTERP_Z));
	}
}

static double around(uint64_t *seed, double range)
{
	return (nc_random(seed) % 2000001 / 1e6 - 1) * range;
}

static void write_random(uint64_t seed, char *text)
{
	text += sprintf(text, "F1 G0 X%.4f\n", around(&seed, 10));
	for (int i = 0; i < POINTS; i++) {
		const double x = around(&seed, 40), y = around(&seed, 40);

		switch (nc_random(&seed) % 4) {
		case 0:
			text += sprintf(text, "G1 X%.4f Y%.4f\n", x, y);
			break;
		case 1:
			text += sprintf(text, "G0 Z%.4f\n", x);
			break;
		case 2:
			text += sprintf(text, "G%d X%.4f Y%.4f R%.4f\n",
					2 + (int)(nc_random(&seed) % 2), x, y,
					around(&seed, 1) < 0 ? -60. : 60.);
			break;
		default:
			text += sprintf(text, "G3 I%.3f J%.3f Z%.4f\n",
					x / 2, 20.0, y);
		}
	}
}

static void a_program_written_back_reads_the_same(void **state)
{
	static char text[POINTS * 90], again[POINTS * 90];

	(void)state;
	for (uint64_t seed = 201; seed <= 220; seed++) {
		struct nc_read a, b;

		print_message("seed %llu\n", (unsigned long long)seed);
		write_random(seed, text);
		a = nc_read_text(text);
		write_back(&a, again);
		b = nc_read_text(again);
		assert_same_path(&a, &b, 0);
		nc_done(&a);
		nc_done(&b);
	}
}

static void a_positive_radius_is_the_shorter_arc(void **state)
{
	static const struct {
		const char *text;
		double a, b, sweep;
	} arcs[] = {
		{ "G3 F1 X10 Y10 R10",	0, 10, M_PI / 2 },
		{ "G2 F1 X10 Y10 R10",	10, 0, -M_PI / 2 },
		{ "G3 F1 X10 Y10 R-10",	10, 0, 3 * M_PI / 2 },
		{ "G2 F1 X10 Y10 R-10",	0, 10, -3 * M_PI / 2 },
		{ "G2 F1 X10 R5",	5, 0, -M_PI },
		{ "G2 F1 X10 R4.9999",	5, 0, -M_PI },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(arcs) / sizeof(arcs[0]); i++) {
		struct nc_read n = nc_read_text(arcs[i].text);
		const struct interp_arc *arc = nc_arc_of(&n, 0);

		assert_near(arc->a_mm, arcs[i].a);
		assert_near(arc->b_mm, arcs[i].b);
		assert_near(arc->sweep, arcs[i].sweep);
		nc_done(&n);
	}
}

static void a_centre_may_be_a_distance_or_a_place(void **state)
{
	struct nc_read n = nc_read_text(
		"G92 X100 Y100\nG1 F1 X110 Y105\n"
		"G3 X115 Y110 I0 J5\n"
		"G90.1 G2 X110 Y105 I115 J105\n"
		"G91.1 G3 I-3 Z1\n");

	(void)state;
	assert_near(nc_arc_of(&n, 1)->a_mm, 10);
	assert_near(nc_arc_of(&n, 1)->b_mm, 10);
	assert_near(nc_arc_of(&n, 1)->sweep, M_PI / 2);
	assert_near(nc_arc_of(&n, 2)->a_mm, 15);
	assert_near(nc_arc_of(&n, 2)->b_mm, 5);
	assert_near(nc_arc_of(&n, 2)->sweep, -3 * M_PI / 2);
	assert_near(nc_arc_of(&n, 3)->sweep, 2 * M_PI);
	assert_xyz(&n, 3, 10, 5, 1);
	nc_done(&n);
}

static void a_plane_turns_its_first_axis_toward_its_second(void **state)
{
	struct nc_read n = nc_read_text("F1 G18 G3 Z5 X5 K0 I5\n"
					"G19 G3 Y5 Z10 K5\n");

	(void)state;
	assert_int_equal(nc_arc_of(&n, 0)->axis_a, INTERP_Z);
	assert_int_equal(nc_arc_of(&n, 0)->axis_b, INTERP_X);
	assert_near(nc_arc_of(&n, 0)->sweep, M_PI / 2);
	assert_int_equal(nc_arc_of(&n, 1)->axis_a, INTERP_Y);
	assert_int_equal(nc_arc_of(&n, 1)->axis_b, INTERP_Z);
	assert_near(nc_arc_of(&n, 1)->sweep, M_PI / 2);
	nc_done(&n);
}

static void offsets_add_up_and_g53_sees_none(void **state)
{
	struct nc_read n = nc_ready();

	(void)state;
	n.o.work_offset_mm[1][INTERP_X] = 10;
	nc_read(&n, "G0 X1\nG55 X1\nG92 X0\nX2\nG53 X3\nG91 G53 X4\nG90 X1\n"
		    "G54 X1\nG92.1\nX1\n");
	assert_xyz(&n, 0, 1, 0, 0);
	assert_xyz(&n, 1, 11, 0, 0);
	assert_xyz(&n, 2, 13, 0, 0);
	assert_xyz(&n, 3, 3, 0, 0);
	assert_xyz(&n, 4, 4, 0, 0);
	assert_xyz(&n, 5, 12, 0, 0);
	assert_xyz(&n, 6, 2, 0, 0);
	assert_xyz(&n, 7, 1, 0, 0);
	nc_done(&n);
}

static void g28_goes_through_a_point_to_machine_zero(void **state)
{
	struct nc_read n = nc_read_text("G0 X5 Y5 Z-5\nG92 Z0\nG28 Z8\n"
					"G91 G1 F1 Z2\nG28 X0\nG28\n");

	(void)state;
	assert_int_equal(nc_count(&n), 6);
	assert_xyz(&n, 1, 5, 5, 3);
	assert_xyz(&n, 2, 5, 5, 0);
	assert_xyz(&n, 3, 5, 5, 2);
	assert_xyz(&n, 4, 0, 5, 2);
	assert_xyz(&n, 5, 0, 0, 0);
	assert_int_equal(nc_seg(&n, 5)->flags, INTERP_SEG_RAPID);
	nc_done(&n);
}

static void inches_per_minute_but_degrees_per_minute(void **state)
{
	struct nc_read n = nc_read_text("G20 G1 F60 X1\nA10\nG21 F30 X0\nA0\n");

	(void)state;
	assert_near(nc_seg(&n, 0)->feed_mm_s, (double)25.4f);
	assert_near(nc_seg(&n, 1)->feed_mm_s, 1);
	assert_near(nc_seg(&n, 2)->feed_mm_s, .5);
	assert_near(nc_seg(&n, 3)->feed_mm_s, .5);
	nc_done(&n);
}

/* A whole circle ends where it began, but goes far.  Where X is next to nothing
 * beside C, its F of 25.4 is along 0.00254 mm. */
static void f_is_along_linear_axes_whatever_the_length_is(void **state)
{
	struct nc_read n = nc_read_text("G20 G1 F60 X1\nG2 I1 C10\n"
					"G1 F0.0001 X1.0001 C80\n"
					"F60 X1.1 C90\n");

	(void)state;
	assert_near(nc_seg(&n, 1)->feed_mm_s, (double)25.4f);
	assert_float_equal(nc_seg(&n, 2)->feed_mm_s, 70. / 60, 1e-4);
	assert_float_equal(nc_seg(&n, 2)->length_mm, 70, 1e-9);
	assert_near(nc_seg(&n, 3)->feed_mm_s, (double)25.4f);
	nc_done(&n);
}

static void a_given_feed_stands_in_for_the_first_f(void **state)
{
	struct nc_read n = nc_ready();

	(void)state;
	n.o.feed_mm_s = 2;
	nc_read(&n, "G1 X1\nF60 X2\n");
	assert_near(nc_seg(&n, 0)->feed_mm_s, 2);
	assert_near(nc_seg(&n, 1)->feed_mm_s, 1);
	nc_done(&n);
}

static void assert_cond(const struct nc_read *n, uint32_t i, char letter,
			uint32_t number)
{
	const struct interp_cond *c = &n->p.conds[nc_seg(n, i)->cond];

	assert_int_equal(c->letter, letter);
	assert_int_equal(c->number, number);
}

static void c_and_three_digits_call_a_condition(void **state)
{
	struct nc_read n = nc_read_text("G0 X1\nC120 X2 C12\nX3\nX4 e001\n"
					"C 120.\nC+100\nC090 M3\n");

	(void)state;
	assert_cond(&n, 0, 0, 0);
	assert_cond(&n, 1, 'C', 120);
	assert_cond(&n, 2, 'C', 120);
	assert_cond(&n, 3, 'E', 1);
	assert_cond(&n, 5, 'E', 1);
	assert_cond(&n, 6, 'C', 90);
	assert_near(nc_end(&n, 1, INTERP_C), 12);
	assert_near(nc_end(&n, 4, INTERP_C), 120);
	assert_near(nc_end(&n, 5, INTERP_C), 100);
	nc_done(&n);
}

static void actions_come_in_the_order_of_the_table(void **state)
{
	static const struct {
		uint8_t kind;
		uint32_t arg;
	} want[] = {
		{ INTERP_AUX, INTERP_AUX_POWER_POSITIVE },
		{ INTERP_AUX, INTERP_AUX_PUMP_ON },
		{ INTERP_LINE, 0 },
		{ INTERP_STOP, 0 },
		{ INTERP_AUX, INTERP_AUX_POWER_NEGATIVE },
		{ INTERP_DWELL, 1500 },
		{ INTERP_DWELL, 250 },
		{ INTERP_AUX, INTERP_AUX_POWER_OFF },
		{ INTERP_AUX, INTERP_AUX_PUMP_OFF },
		{ INTERP_OPTIONAL_STOP, 0 },
	};
	struct nc_read n = nc_read_text("M0 G0 X1 T84 M3\nM4 G4 P1.5\n"
					"G4 X.25\nM1 T85 M5\nM2\nnonsense\n");

	(void)state;
	assert_int_equal(nc_count(&n), sizeof(want) / sizeof(want[0]));
	for (uint32_t i = 0; i < nc_count(&n); i++) {
		assert_int_equal(nc_seg(&n, i)->kind, want[i].kind);
		assert_int_equal(want[i].kind == INTERP_AUX ?
				 INTERP_AUX_OF(nc_seg(&n, i)->arg) :
				 nc_seg(&n, i)->arg, want[i].arg);
	}
	assert_int_equal(n.p.segs[nc_count(&n) + 1].line, 5);
	assert_int_equal(n.result.lines, 6);
	assert_int_equal(n.result.executed, 5);
	nc_done(&n);
}

static void a_subprogram_is_repeated_and_comes_back(void **state)
{
	struct nc_read n = nc_read_text(
		"O1\nG91 G0\nM98 P1000 L3\nM98 P20200 Z1\nX.5\nM30\n"
		"O1000\nX1\nM98 P200\nM99\n"
		"(a) N5 o200 Y1\nM99\n");
	static const uint32_t lines[] = { 8, 11, 8, 11, 8, 11, 4, 11, 11, 5 };

	(void)state;
	assert_int_equal(nc_count(&n), 10);
	for (uint32_t i = 0; i < 10; i++)
		assert_int_equal(nc_seg(&n, i)->line, lines[i]);
	assert_xyz(&n, 9, 3.5, 5, 1);
	assert_int_equal(n.result.lines, 12);
	assert_int_equal(n.result.executed, 6 + 3 * 6 + 2 * 2);
	nc_done(&n);
}

static void subprograms_nest_eight_deep(void **state)
{
	char text[512], *at = text;
	struct nc_read n;

	(void)state;
	at += sprintf(at, "G91 G0\nM98 P1\nM2\n");
	for (int i = 1; i < INTERP_NC_DEPTH_MAX; i++)
		at += sprintf(at, "O%d X1\nM98 P%d\nM99\n", i, i + 1);
	sprintf(at, "O%d X1 M99\n", INTERP_NC_DEPTH_MAX);
	n = nc_read_text(text);
	assert_int_equal(nc_count(&n), INTERP_NC_DEPTH_MAX);
	nc_done(&n);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_line_ends_where_its_words_say),
		cmocka_unit_test(blanks_case_and_line_ends_change_nothing),
		cmocka_unit_test(every_number_is_the_nearest_double),
		cmocka_unit_test(more_digits_than_a_double_has_do_no_harm),
		cmocka_unit_test(incremental_equals_absolute),
		cmocka_unit_test(inches_equal_millimetres_and_degrees_stay_degrees),
		cmocka_unit_test(a_program_written_back_reads_the_same),
		cmocka_unit_test(a_positive_radius_is_the_shorter_arc),
		cmocka_unit_test(a_centre_may_be_a_distance_or_a_place),
		cmocka_unit_test(a_plane_turns_its_first_axis_toward_its_second),
		cmocka_unit_test(offsets_add_up_and_g53_sees_none),
		cmocka_unit_test(g28_goes_through_a_point_to_machine_zero),
		cmocka_unit_test(inches_per_minute_but_degrees_per_minute),
		cmocka_unit_test(f_is_along_linear_axes_whatever_the_length_is),
		cmocka_unit_test(a_given_feed_stands_in_for_the_first_f),
		cmocka_unit_test(c_and_three_digits_call_a_condition),
		cmocka_unit_test(actions_come_in_the_order_of_the_table),
		cmocka_unit_test(a_subprogram_is_repeated_and_comes_back),
		cmocka_unit_test(subprograms_nest_eight_deep),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
