/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_threeb.c - records of 3B and 4B, read and written
 *
 * The published examples are: twelve blocks of one drawing, given as 3B and as
 * ISO code, and a circle of 10 mm that is cut 0.1 mm inside.
 */
#include "compile_help.h"


static const struct vector {
	const char *record;		/* as published but for blanks */
	double end_x, end_y;		/* from its start, um */
	double i, j;			/* centre from its start; 0 0: a line */
	bool clockwise;
} published[] = {
	{ "B9900 B0 B9900 GX L3", -9900, 0, 0, 0, false },
	{ "B0 B70100 B70100 GY L2", 0, 70100, 0, 0, false },
	{ "B55000 B0 B55000 GX L3", -55000, 0, 0, 0, false },
	{ "B50100 B100 B100000 GY NR1", -100200, 0, -50100, -100, false },
	{ "B54900 B0 B54900 GX L3", -54900, 0, 0, 0, false },
	{ "B0 B40100 B80100 GX NR2", -100, -80200, 0, -40100, false },
	{ "B0 B40000 B40000 GY L4", 0, -40000, 0, 0, false },
	{ "B60200 B0 B60200 GX L1", 60200, 0, 0, 0, false },
	{ "B39900 B100 B80000 GY SR3", 79800, 0, 39900, 100, true },
	{ "B70200 B0 B70200 GX L1", 70200, 0, 0, 0, false },
	{ "B0 B50100 B50100 GY L2", 0, 50100, 0, 0, false },
	{ "B9900 B0 B9900 GX L1", 9900, 0, 0, 0, false },
	{ "B9900 B0 B39600 GY NR1", 0, 0, -9900, 0, false },
};

#define NPUBLISHED	(sizeof(published) / sizeof(published[0]))

/* The whole drawing and the circle as published: blanks or none, many on a
 * line. */
static const char drawing[] =
	"B 9900B 0B 9900 GX L3 B 0B 70100B 70100 GY L2 B 55000B 0B 55000 GX "
	"L3 B 50100B 100B 100000 GY NR1B 54900B 0B 54900 GX L3 B 0B 40100B "
	"80100 GX NR2B 0B 40000B 40000 GY L4 B 60200B 0B 60200 GX L1 B 39900B "
	"100B 80000 GY SR3B 70200B 0B 70200 GX L1 B 0B 50100B 50100 GY L2 B "
	"9900B 0B 9900 GX L1\n"
	"B9900B0B39600GYNR1";

static void the_published_records_end_where_their_iso_code_does(void **state)
{
	struct compiled c = compile_ready("3b");
	double x = 0, y = 0;

	(void)state;
	compile(&c, drawing);
	assert_int_equal(compiled_count(&c), NPUBLISHED);
	for (uint32_t k = 0; k < NPUBLISHED; k++) {
		const struct vector *v = &published[k];
		const struct interp_seg *seg = compiled_seg(&c, k);

		if (v->i != 0 || v->j != 0) {
			const struct interp_arc *a = &c.p.arcs[seg->arg];

			assert_int_equal(seg->kind, INTERP_ARC);
			/* It is rounded, and so are the ends. */
			assert_true(fabs(a->a_mm - (x + v->i) / 1000) < .0015);
			assert_true(fabs(a->b_mm - (y + v->j) / 1000) < .0015);
			assert_true((a->sweep < 0) == v->clockwise);
			if (v->end_x == 0 && v->end_y == 0)
				assert_near(fabs(a->sweep), 2 * M_PI);
		} else {
			assert_int_equal(seg->kind, INTERP_LINE);
		}
		x += v->end_x;
		y += v->end_y;
		assert_near(compiled_end(&c, k, INTERP_X), x / 1000);
		assert_near(compiled_end(&c, k, INTERP_Y), y / 1000);
	}
	compile_done(&c);
}

/* From the published ISO geometry, exactly the published records. */
static void the_published_records_are_written(void **state)
{
	char text[4096] = "G91 F60\n", want[2048] = "";
	struct compiled c = compile_ready("generic");
	struct emitted e = { 0 };
	size_t n = strlen(text), m = 0;

	(void)state;
	for (size_t k = 0; k < NPUBLISHED; k++) {
		const struct vector *v = &published[k];

		n += (size_t)snprintf(text + n, sizeof(text) - n,
				      v->i != 0 || v->j != 0 ?
				      "G%d X%.4f Y%.4f I%.4f J%.4f\n" :
				      "G%d X%.4f Y%.4f\n",
				      v->i == 0 && v->j == 0 ? 1 :
				      v->clockwise ? 2 : 3, v->end_x / 1000,
				      v->end_y / 1000, v->i / 1000,
				      v->j / 1000);
		m += (size_t)snprintf(want + m, sizeof(want) - m, "%s\n",
				      v->record);
	}
	snprintf(want + m, sizeof(want) - m, "DD\n");
	compile(&c, text);
	emit_threeb(&e, &c);
	assert_int_equal(e.rc, 0);
	assert_string_equal(e.text, want);
	emit_done(&e);
	compile_done(&c);
}

/* Its centre is beyond any record; cut until short it was 4,096 lines. */
static void an_arc_too_flat_for_a_record_is_one_line(void **state)
{
	struct compiled c = compile_ready("3b");
	struct emitted e = { 0 };

	(void)state;
	compile(&c, "B990909900 B0 B39600 GY NR1\nDD\n");
	emit_threeb(&e, &c);
	assert_int_equal(e.rc, 0);
	assert_string_equal(e.text, "B1 B39600 B39600 GY L2\nDD\n");
	emit_done(&e);
	compile_done(&c);
}

/* -- How records are written ----------------------------------------------- */

static void each_form_of_a_record_is_the_same_record(void **state)
{
	static const char *const forms[] = {
		"B300 B400 B400 GY L1\nB0 B500 B500 GX NR2\nDD\n",
		"b300b400b400gyl1b b500b500gxnr2",
		"B 300 B 400 B 400 GY L1\r\nB0B500B500GXNR2\r\nE\r\n",
		"N1: B300 B400 B400 GY L1 ; 0.300 , 0.400\n"
		"N 2 :B B500 B500 G X N R 2 ; end\nN3: DD\n",
		"CAXAWEDM Version 2.0 , Name : part\n*****\n"
		"Start Point = 0.0 , 0.0 ; X , Y\n"
		"N1 B300 B400 B400 GY L1\tanything\nB0 B500 B500 GX NR2\n"
		"MJ\nthe end\n",
		"\xef\xbb\xbf\xef\xbc\xa2\xef\xbc\x93\xef\xbc\x90\xef\xbc\x90 "
		"\xef\xbc\xa2\xef\xbc\x94\xef\xbc\x90\xef\xbc\x90\xe3\x80\x80"
		"\xef\xbd\x82" "400 GY L1\nB0 B500 B500 GX NR\xef\xbc\x92\n",
		"; \xb5\xda\xd2\xbb\xb5\xb6 GX\r\xb5\xda\xb6\xfe\xb5\xb6\r"
		"B300 B400 B400 GY L1 \xb5\xda\xd2\xbb\xb5\xb6\r"
		"\xa3\xc2" "0 B500 B500 GX NR2",
		"B3 B4 B400 GY L1\nB0 B500 B500 GX NR2\n",
		"B300 B400 B300 GX L1\nB0 B500 B500 GX NR2\n",
		"B300 B400 B400 GY L1\nB0 B500 B500 GX NR1\n",
	};
	struct compiled a = compile_ready("3b");

	(void)state;
	compile(&a, forms[0]);
	assert_int_equal(compiled_count(&a), 2);
	assert_near(compiled_end(&a, 0, INTERP_X), .3);
	assert_near(compiled_end(&a, 0, INTERP_Y), .4);
	assert_near(compiled_end(&a, 1, INTERP_X), -.2);
	assert_near(compiled_end(&a, 1, INTERP_Y), -.1);
	for (size_t i = 1; i < sizeof(forms) / sizeof(forms[0]); i++) {
		struct compiled b = compile_ready("3b");

		compile(&b, forms[i]);
		assert_int_equal(compiled_count(&b), 2);
		for (uint32_t k = 0; k < 2; k++)
			assert_same_end(&a, k, &b, k, 0);
		compile_done(&b);
	}
	compile_done(&a);
}

static void a_line_on_an_axis_needs_no_x_and_y(void **state)
{
	static const struct {
		const char *text;
		double x, y;
	} lines[] = {
		{ "BBB700GXL1", .7, 0 }, { "BBB700GYL2", 0, .7 },
		{ "BBB700GXL3", -.7, 0 }, { "BBB700GYL4", 0, -.7 },
		{ "BBB700GYL1", 0, .7 }, { "BBB700GXL2", -.7, 0 },
		{ "B9B0B700GXL4", .7, 0 }, { "B1B3B300GYL3", -.1, -.3 },
		{ "B1B3B100GXL3", -.1, -.3 }, { "B7B7B50GXL2", -.05, .05 },
		{ "B7B7B50GYL2", -.05, .05 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
		struct compiled c = compile_ready("3b");

		compile(&c, lines[i].text);
		assert_near(compiled_end(&c, 0, INTERP_X), lines[i].x);
		assert_near(compiled_end(&c, 0, INTERP_Y), lines[i].y);
		compile_done(&c);
	}
}

static void a_record_of_no_length_is_no_segment(void **state)
{
	struct compiled c = compile_ready("3b");

	(void)state;
	compile(&c, "B0 B0 B0 GX L1\nBBBGYL2\nBBB5GXL1\n");
	assert_int_equal(compiled_count(&c), 1);
	compile_done(&c);
}

static void the_unit_scales_every_length(void **state)
{
	static const double units[] = { 0.1, 1, 10 };

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		struct compiled c = compile_ready("3b");

		c.o.threeb.unit_um = units[i];
		compile(&c, "B300 B400 B400 GY L1\nB0 B500 B500 GX NR2");
		assert_near(compiled_end(&c, 0, INTERP_X), .3 * units[i]);
		assert_near(compiled_end(&c, 1, INTERP_Y), -.1 * units[i]);
		compile_done(&c);
	}
}

static void a_program_starts_where_the_machine_stands(void **state)
{
	struct compiled c = compile_ready("3b");

	(void)state;
	c.bo.start_mm[INTERP_X] = 12.5;
	c.bo.start_mm[INTERP_Z] = -3;
	compile(&c, "BBB500GXL1");
	assert_near(compiled_end(&c, 0, INTERP_X), 13);
	assert_int_equal(c.p.head->start_pulses[INTERP_Z], -3000);
	compile_done(&c);
}

static void d_pauses_unless_it_ends(void **state)
{
	static const char text[] = "BBB500GXL1\nD\nBBB500GXL3\nDD\n";
	struct compiled c = compile_ready("3b");

	(void)state;
	compile(&c, text);
	assert_int_equal(compiled_count(&c), 3);
	assert_int_equal(compiled_seg(&c, 1)->kind, INTERP_STOP);
	compile_done(&c);

	c = compile_ready("3b");
	c.o.threeb.d_ends = true;
	compile_bytes(&c, text, strlen(text));
	assert_refused(&c, 3, 1, "a record behind the end");
	compile_done(&c);
}

static void an_end_code_that_is_not_known_is_refused(void **state)
{
	static const char text[] = "BBB500GXL1\nMJ\n";
	struct compiled c = compile_ready("3b");

	(void)state;
	c.o.threeb.ends = INTERP_THREEB_DD;
	compile_bytes(&c, text, strlen(text));
	assert_refused(&c, 2, 1, "MJ");
	compile_done(&c);
}

static void a_feed_is_the_options_or_the_fastest(void **state)
{
	struct compiled c = compile_ready("3b");

	(void)state;
	c.machine.axis[INTERP_Y].v_max_mm_s = 7;
	compile(&c, "BBB500GXL1");
	assert_near(compiled_seg(&c, 0)->feed_mm_s, 7);
	compile_done(&c);
	c = compile_ready("3b");
	c.o.nc.feed_mm_s = 2;
	compile(&c, "BBB500GXL1");
	assert_near(compiled_seg(&c, 0)->feed_mm_s, 2);
	compile_done(&c);
}

/* -- Arcs ------------------------------------------------------------------ */

/* Every start quadrant, both senses, both counting directions: the end that J
 * was computed for, by adding up small steps, comes back. */
static void an_arc_of_any_start_sense_and_direction_comes_back(void **state)
{
	uint64_t seed = 4711;
	int tried = 0;

	(void)state;
	print_message("seed %llu\n", (unsigned long long)seed);
	for (int k = 0; k < 4000; k++) {
		static const char *const sense[] = { "NR", "SR" };
		const int cw = (int)(nc_random(&seed) % 2);
		const double r = 2000 + nc_random(&seed) % 20000;
		const double from = nc_random(&seed) % 36000 * M_PI / 18000;
		const double sweep = (.02 + nc_random(&seed) % 600 / 100.0) *
				     (cw ? -1 : 1);
		const long x = lround(r * cos(from)), y = lround(r * sin(from));
		const double rr = hypot((double)x, (double)y);
		const double f = atan2((double)y, (double)x);
		const double ex = rr * cos(f + sweep), ey = rr * sin(f + sweep);
		const bool gy = fabs(ex) > fabs(ey);
		struct compiled c = compile_ready("3b");
		double j = 0;
		char text[80];
		int quad = x >= 0 ? (y >= 0 ? 1 : 4) : y >= 0 ? 2 : 3;

		for (int i = 0; i < 20000; i++) {
			const double a = f + sweep * i / 20000;
			const double b = f + sweep * (i + 1) / 20000;

			j += gy ? fabs(rr * (sin(b) - sin(a))) :
				  fabs(rr * (cos(b) - cos(a)));
		}
		if (x == 0 || y == 0 || 4 * rr - j < 8)
			continue;
		snprintf(text, sizeof(text), "B%ld B%ld B%.0f G%c %s%d",
			 labs(x), labs(y), j, gy ? 'Y' : 'X', sense[cw], quad);
		compile(&c, text);
		const uint32_t last = compiled_count(&c) - 1;
		double swept = compiled_arc(&c, 0)->sweep;

		/* Nearly a circle: in two halves. */
		if (last)
			swept += compiled_arc(&c, last)->sweep;
		if (fabs(compiled_end(&c, last, INTERP_X) * 1000 + (double)x -
			 ex) > 2 ||
		    fabs(compiled_end(&c, last, INTERP_Y) * 1000 + (double)y -
			 ey) > 2)
			fail_msg("%s from %g by %g", text, f, sweep);
		assert_true(fabs(swept - sweep) < .01);
		tried++;
		compile_done(&c);
	}
	assert_true(tried > 3000);
}

static void a_circle_of_an_irrational_radius_closes(void **state)
{
	uint64_t seed = 12;

	(void)state;
	for (int k = 0; k < 500; k++) {
		const long x = 20 + nc_random(&seed) % 30000;
		const long y = 20 + nc_random(&seed) % 30000;
		const double true_r = hypot((double)x, (double)y) +
				      (nc_random(&seed) % 100 / 100.0 - .5);
		struct compiled c = compile_ready("3b");
		char text[80];

		snprintf(text, sizeof(text), "B%ld B%ld B%.0f GX NR1", x, y,
			 4 * true_r);
		compile(&c, text);
		assert_int_equal(compiled_count(&c), 1);
		assert_near(compiled_arc(&c, 0)->sweep, 2 * M_PI);
		assert_int_equal(compiled_end_sub(&c, 0, INTERP_X), 0);
		assert_int_equal(compiled_end_sub(&c, 0, INTERP_Y), 0);
		compile_done(&c);
	}
}

/* Ends off the circle by a unit, on a machine of finer pulses. */
static void radii_off_by_a_unit_are_taken_with_fine_pulses(void **state)
{
	uint64_t seed = 77;

	(void)state;
	for (int k = 0; k < 2000; k++) {
		const long x = 3 + nc_random(&seed) % 200;
		const long y = nc_random(&seed) % 200;
		const double r = hypot((double)x, (double)y);
		struct compiled c = compile_ready("3b");
		char text[80];

		c.machine.axis[INTERP_X].pulse_mm = .0001;
		c.machine.axis[INTERP_Y].pulse_mm = .0001;
		snprintf(text, sizeof(text), "B%ld B%ld B%ld G%c %s1", x, y,
			 1 + (long)(nc_random(&seed) % (unsigned)(3.99 * r)),
			 nc_random(&seed) % 2 ? 'X' : 'Y',
			 nc_random(&seed) % 2 ? "NR" : "SR");
		compile_bytes(&c, text, strlen(text));
		if (c.rc)
			fail_msg("%s: %s; %s", text, c.diag.found,
				 c.diag.wanted);
		compile_done(&c);
	}
}

/* -- 4B -------------------------------------------------------------------- */

/* A slot with round ends: 10 mm of line, half circles of 5 mm. */
static const char slot[] =
	"B10000 B0 B10000 B0 GX L1\n"
	"B0 B5000 B10000 B5000 D GX NR4\n"
	"B10000 B0 B10000 B0 GX L3\n"
	"B0 B5000 B10000 B5000 D GX NR2\n";

static void an_offset_of_4b_alters_arcs_and_closes(void **state)
{
	static const struct {
		const char *signs;
		double radius_mm;
	} cases[] = { { "+", 5.1 }, { "", 5.1 }, { "-", 4.9 } };

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		struct compiled c = compile_ready("4b");
		char text[400] = "";
		const char *p = slot;

		while (*p) {
			const char *end = strchr(p, '\n') + 1;

			strcat(text, cases[i].signs);
			strncat(text, p, (size_t)(end - p));
			p = end;
		}
		c.o.threeb.offset_um = 100;
		compile(&c, text);
		assert_int_equal(compiled_count(&c), 4);
		assert_near(compiled_arc(&c, 1)->r_mm, cases[i].radius_mm);
		assert_near(compiled_end(&c, 1, INTERP_Y),
			    2 * cases[i].radius_mm);
		assert_near(compiled_end(&c, 3, INTERP_X), 0);
		assert_near(compiled_end(&c, 3, INTERP_Y), 0);
		compile_done(&c);
	}
}

static void a_concave_arc_shrinks(void **state)
{
	struct compiled c = compile_ready("4b");

	(void)state;
	c.o.threeb.offset_um = 100;
	compile(&c, "B0 B5000 B10000 B5000 DD GX NR4");
	assert_near(compiled_arc(&c, 0)->r_mm, 4.9);
	compile_done(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_published_records_end_where_their_iso_code_does),
		cmocka_unit_test(the_published_records_are_written),
		cmocka_unit_test(an_arc_too_flat_for_a_record_is_one_line),
		cmocka_unit_test(each_form_of_a_record_is_the_same_record),
		cmocka_unit_test(a_line_on_an_axis_needs_no_x_and_y),
		cmocka_unit_test(a_record_of_no_length_is_no_segment),
		cmocka_unit_test(the_unit_scales_every_length),
		cmocka_unit_test(a_program_starts_where_the_machine_stands),
		cmocka_unit_test(d_pauses_unless_it_ends),
		cmocka_unit_test(an_end_code_that_is_not_known_is_refused),
		cmocka_unit_test(a_feed_is_the_options_or_the_fastest),
		cmocka_unit_test(an_arc_of_any_start_sense_and_direction_comes_back),
		cmocka_unit_test(a_circle_of_an_irrational_radius_closes),
		cmocka_unit_test(radii_off_by_a_unit_are_taken_with_fine_pulses),
		cmocka_unit_test(an_offset_of_4b_alters_arcs_and_closes),
		cmocka_unit_test(a_concave_arc_shrinks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
