/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nc_curves.c - G5 G5.1 G5.2 G5.3 and G6.2: what they make, what is
 * refused, and lines that are joined into curves
 */
#include "nc_read.h"

#include "interp/cursor.h"

#define ROOT	0.7071067811865476

static const char circle[] =
	"G17 F600 G0 X50\n"
	"G6.2 P3 K0 X50 Y0 R1\n"
	"K0 X50 Y50 R0.7071067811865476\n"
	"K0 X0 Y50\n"
	"K0.25 X-50 R0.7071067811865476\n"
	"K0.25 Y0\n"
	"(a comment between)\n"
	"N7\n"
	"K0.5 Y-50 R0.7071067811865476\n"
	"K0.5 X0\n"
	"K0.75 X50 R0.7071067811865476\n"
	"K0.75 Y0\n"
	"K1\nK1\nK1\n";

/* Every lattice point of a circle is one pulse or less from it. */
static void assert_round(const struct nc_read *n, double cx, double cy,
			 double r)
{
	struct interp_cursor c;

	assert_int_equal(interp_cursor_init(&c, &n->p), 0);
	for (;;) {
		interp_cursor_aim(&c, 1e9);
		while (interp_cursor_step(&c) == INTERP_MOVED) {
			const double x = c.pos[INTERP_X] * 0.001 - cx;
			const double y = c.pos[INTERP_Y] * 0.001 - cy;

			assert_true(c.seg.kind != INTERP_CURVE ||
				    fabs(hypot(x, y) - r) < 0.0008);
		}
		return;
	}
}

static void fanucs_circle_is_round(void **state)
{
	struct nc_read n = nc_read_text(circle);

	(void)state;
	assert_true(fabs(n.p.head->length_mm - 50 - 314.159265) < 1e-3);
	assert_int_equal(nc_seg(&n, 1)->kind, INTERP_CURVE);
	assert_int_equal(nc_seg(&n, 1)->line, 2);
	assert_in_range(nc_seg(&n, nc_count(&n) - 1)->line, 10, 11);
	assert_true(nc_seg(&n, 1)->feed_mm_s == 10);
	assert_round(&n, 0, 0, 50);
	nc_done(&n);
}

/* A quarter of a circle of radius 10, order 3, weights 1, root, 1. */
static void linuxcncs_conic_is_round(void **state)
{
	struct nc_read n = nc_read_text("F600 G0 X10\n"
		"G5.2 X10 Y10 P0.7071067811865476 L3\n"
		"X0 Y10 P1\n"
		"G5.3\nG1 X-5\n");

	(void)state;
	assert_round(&n, 0, 0, 10);
	assert_int_equal(nc_seg(&n, nc_count(&n) - 1)->kind, INTERP_LINE);
	assert_xyz(&n, nc_count(&n) - 1, -5, 10, 0);
	nc_done(&n);
}

/* Weighted as a whole, a curve is the same. */
static void the_first_weight_stands_alone(void **state)
{
	struct nc_read n = nc_read_text("F600 G0 X10\n"
		"G5.2 P2 L3\n"
		"X10 Y10 P1.4142135623730951\n"
		"X0 Y10 P2\n"
		"G5.3\n");

	(void)state;
	assert_round(&n, 0, 0, 10);
	nc_done(&n);
}

static void a_cubic_goes_on_from_the_last(void **state)
{
	struct nc_read a = nc_read_text("F600\n"
		"G5 X10 Y10 I3 J0 P-3 Q-1\nX20 Y0 P0 Q3\n");
	struct nc_read b = nc_read_text("F600\n"
		"G5 X10 Y10 I3 J0 P-3 Q-1\nX20 Y0 I3 J1 P0 Q3\n");

	(void)state;
	assert_true(a.p.head->length_mm > 28.3);
	assert_true(a.p.head->length_mm == b.p.head->length_mm);
	assert_xyz(&a, nc_count(&a) - 1, 20, 0, 0);
	nc_done(&a);
	nc_done(&b);
}

/* y = x*(20 - x)/20: its length is known. */
static void a_parabola_is_as_long_as_it_is(void **state)
{
	struct nc_read n = nc_read_text("F600\nG5.1 X20 Y0 I10 J10\n");
	const double length = 10 * (sqrt(2) + asinh(1));

	(void)state;
	assert_true(fabs(n.p.head->length_mm - length) < 1e-3);
	nc_done(&n);
}

static void units_offsets_and_increments_count(void **state)
{
	struct nc_read a = nc_read_text("F600 G0 X25.4 Y0\n"
		"G5.2 X50.8 Y0 L3\nX50.8 Y25.4\nX76.2 Y25.4\nG5.3\n");
	struct nc_read b = nc_read_text("G20 F24 G92 X-1\nG0 X0 Y0\n"
		"G91 G5.2 X1 L3\nY1\nX1\nG5.3\n");

	(void)state;
	assert_true(fabs(a.p.head->length_mm - b.p.head->length_mm) < 1e-3);
	assert_xyz(&a, nc_count(&a) - 1, 76.2, 25.4, 0);
	assert_xyz(&b, nc_count(&b) - 1, 76.2, 25.4, 0);
	nc_done(&a);
	nc_done(&b);
}

/* Where it turns back: y is (1 - t/u)^2, and x as a cube.  At u = 0.5 a look at
 * the curve may be just there. */
static void at_a_cusp_a_piece_ends_and_is_slow(void **state)
{
	static const struct {
		const char *text;
		double x, y;
	} row[] = {
		{ "X10 Y10 L4\nX0 Y10\nX10 Y0\n", 5, 7.5 },
		{ "X3.333333 Y-3.333333 L4\nX2.222222 Y-4.444444\n"
		  "X2.592593 Y-3.333333\n", 2.5, -3.75 },
		{ "X3.333333 Y-3.333333 L4\nX-20.433604 Y6.883469\n"
		  "X149.026594 Y30.650406\n", 0.41, -0.615 },
	};

	(void)state;
	for (int i = 0; i < 3; i++) {
		char text[160];
		struct nc_read n;
		int there = 0;

		snprintf(text, sizeof(text), "F6000\nG5.2 %sG5.3\n",
			 row[i].text);
		n = nc_read_text(text);
		for (uint32_t k = 0; k + 1 < nc_count(&n); k++) {
			const double off = hypot(
				nc_end(&n, k, INTERP_X) - row[i].x,
				nc_end(&n, k, INTERP_Y) - row[i].y);

			if (fminf(nc_seg(&n, k)->node_mm_s,
				  nc_seg(&n, k)->feed_max_mm_s) > 1)
				continue;
			assert_true(off < 0.1);
			there += off < 1e-4;
		}
		assert_int_equal(there, 1);
		nc_done(&n);
	}
}

/* The slowest speed is for bends that no axis notices; a slow axis is slower.
 * The last curve is straight. */
static void no_axis_is_too_slow_for_a_curve(void **state)
{
	static const struct {
		const char *text;
		double x_mm_s, c_mm_s, c_deg;
	} row[] = {
		{ "G5.1 X20 Y0 I10 J10\n", 0.01, 1000, 1 },
		{ "G5.1 X20 Y0 I10 J10\n", 1, 1000, 1 },
		{ "G6.2 K0 X0 C0.\nK0 X0.1 C40.\nK0 X0.2 C80.\n"
		  "K0 X0.3 C120.\nK1\nK1\nK1\nK1\n", 1000, 0.05, 120 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct nc_read n = nc_ready();
		char text[160];
		double most;

		n.machine.axis[INTERP_X].v_max_mm_s = row[i].x_mm_s;
		n.machine.axis[INTERP_X].pulse_mm = 0.01;
		n.machine.axis[INTERP_Y].pulse_mm = 0.01;
		n.machine.axis[INTERP_C].v_max_mm_s = row[i].c_mm_s;
		snprintf(text, sizeof(text), "F6000\n%s", row[i].text);
		nc_read(&n, text);
		/* X goes 1 of 1.41 mm at least. */
		most = fmin(row[i].x_mm_s * M_SQRT2, row[i].c_mm_s *
			    n.p.head->length_mm / row[i].c_deg);
		for (uint32_t k = 0; k < nc_count(&n); k++)
			if (nc_seg(&n, k)->feed_max_mm_s > 1.001 * most)
				fail_msg("%s: %g mm/s, %g at most",
					 row[i].text,
					 (double)nc_seg(&n, k)->feed_max_mm_s,
					 most);
		nc_done(&n);
	}
}

/* A bend of five pulses, where the axes have 1 mm/s2. */
static void nor_is_its_acceleration(void **state)
{
	struct nc_read n = nc_ready();
	float least = INFINITY;

	(void)state;
	for (int i = INTERP_X; i <= INTERP_Y; i++) {
		n.machine.axis[i].a_max_mm_s2 = 1;
		n.machine.axis[i].pulse_mm = 0.01;
	}
	nc_read(&n, "F600\nG5.1 X0 Y1.4 I10 J0.7\n");
	for (uint32_t k = 0; k < nc_count(&n); k++)
		least = fminf(least, nc_seg(&n, k)->feed_max_mm_s);
	assert_true((double)(least * least) / 0.05 <= 1);
	nc_done(&n);
}

/* X Z and C turn together. */
static void fanucs_curve_may_have_any_axes(void **state)
{
	struct nc_read n = nc_read_text("F600\n"
		"G6.2 K0 X0 Z0 C0.\nK0 X10 C30.\nK0 Z5 C60.\n"
		"K0 X20 Z0 C90.\nK1\nK1\nK1\nK1\n");

	(void)state;
	assert_xyz(&n, nc_count(&n) - 1, 20, 0, 0);
	assert_near(nc_end(&n, nc_count(&n) - 1, INTERP_C), 90);
	nc_done(&n);
}

/* -- Refusals ------------------------------------------------------------- */

static const struct nc_refusal refusals[] = {
	{ "F1\nG6.2 P11 K0 X1", 2, 6, "order 11", "2 to 10" },
	{ "F1\nG6.2 P2.5 K0 X1", 2, 6, "order 2.5", "2 to 10" },
	{ "F1\nG6.2 X0 Y0", 2, 1, "without a knot", "K and" },
	{ "F1\nG6.2 K0 X0\nK1 X1\nK0.5 X2", 4, 1, "knot 0.5 behind knot 1",
	  "do not fall" },
	{ "F1\nG6.2 P2 K0 X0\nK0 X1\nK0 X2", 4, 1, "knot 0 a 3th time",
	  "the order" },
	{ "F1\nG6.2 K0 X0\nK0 X1 R0", 3, 7, "a weight of 0", "above 0" },
	{ "F1\nG6.2 K0 X0\nK0 X1 R-2", 3, 7, "a weight of -2", "above 0" },
	{ "F1\nG6.2 K0 X0\nP3 K0 X1", 3, 1, "a second order", "first block" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X1\nK0\nK1\nK1 X5", 6, 1,
	  "behind knots of their own", "alone" },
	{ "F1\nG6.2 K0 X0\nK0 X1\nG1 X5", 4, 1,
	  "G1 in a curve of 2 knots for 2 control points of order 4: it takes 6",
	  "K alone" },
	{ "F1\nG6.2 K0 X0\nK0 X1 M3", 3, 7, "M3 in a curve of 1 knots for 1",
	  "K alone" },
	{ "F1\nG6.2 K0 X0\nK0 X1\nM2", 4, 1, "2 knots", "K alone" },
	{ "F1\nG6.2 K0 X0\nK0 X1\n", 2, 0, "does not end", "knots" },
	{ "F1\nG6.2 P3 K0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1", 2, 0,
	  "not where the program stands", "last motion" },
	/* Far away, and refused before any of it is cut up. */
	{ "F600\nG5.2 L2 X-50 Y5 P1\nX8.428 Y0.001 P1\n"
	  "X200 Y0.001 P0.1\nX-50 Y100000000 P1000\nG5.3\n",
	  4, 0, "beyond the travel", "Y from -200 to 200" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X900\nK0 X3\nK1\nK1\nK1", 2, 0,
	  "beyond the travel", "X from -200 to 200" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X2\nK1\nK1\nK1", 6, 1,
	  "2 control points for a curve of order 3", "as many as the order" },
	/* Read as 0: it says so with the word. */
	{ "F1\nG6.2 K0 X0\nK0 X1 R0.00000000000000000000000000001", 3, 7,
	  "R0.0000", "0.000000001 or more" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X1 R0.00001\nK0 X3\nK1\nK1\nK1", 3, 0,
	  "more than 10000 times another, number 2", "factor of 10000" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X1\nK0 X3\nK1\nK1.000000000000001\nK1.1", 7, 1,
	  "too near to the one before it, number 5", "1e-9" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X1\nK0 X3\n"
	  "K0.00000000000000000000000000001",
	  5, 1, "knot 0 a 4th time", "1e-9" },
	{ "F1\nG6.2 P3 K0 X0\nK0.1 X1\nK0.2 X3\nK1\nK1\nK1", 2, 0,
	  "begins at X", "a first knot that stands as often as the order" },
	{ "F1\nG5.2 X1 Y1 P0", 2, 12, "a weight of 0", "above 0" },
	{ "F1\nG5.2 X1 Y1 L11", 2, 12, "order 11", "2 to 10" },
	{ "F1\nG5.2 X1 Y1\nG5.3", 3, 1,
	  "2 control points for a curve of order 3", "as many" },
	{ "F1\nG5.2 X1 Y1\nG1 X2", 3, 1, "inside a curve begun in line 2",
	  "G5.3" },
	{ "F1\nG5.2 X1 Y1\nM2", 3, 1, "inside a curve", "G5.3" },
	{ "F1\nG5.2 X1 Y1", 2, 0, "does not end", "G5.3" },
	{ "F1\nG5.3", 2, 1, "G5.3 without", "G5.2" },
	{ "F1\nG5.2 X1 Z1", 2, 9, "Z1 has no use", "axis word" },
	{ "F1 G18\nG5.2 X1 Y1", 2, 1, "outside the plane", "G17" },
	{ "F1\nG5 X1 Y1 I1 J1", 2, 1, "without P and Q", "P and Q" },
	{ "F1\nG5 X1 Y1 P1 Q1", 2, 1, "without I and J", "none of them" },
	{ "F1\nG5 X1 Y1 I1 P1 Q1", 2, 1, "with I and no J", "I and J" },
	{ "F1\nG5 X1 Y1 I1 J1 P0 Q-1\nG1 X5\nG5 X9 P1 Q1", 4, 1,
	  "without I and J", "another G5" },
	{ "F1\nG5 X1 Y1 I1 J1 P0 Q-1\nG28 X5\nG5 X9 P1 Q1", 4, 1,
	  "without I and J", "another G5" },
	{ "F1\nG5 X1 Y1 I1 J1 P0 Q-1\nG130 Z-1 R1\nG5 X9 P1 Q1", 4, 1,
	  "without I and J", "another G5" },
	{ "F1\nG6.2 P3 K0 X0\nK0 X2\nK0 X4\nK1 X6\nK2\nK3\nK4", 8, 1,
	  "ends at X 5.0000, not at its last control point: 6.0000",
	  "as often as the order" },
	{ "F1\nG5.1 X1 Y1", 2, 1, "without I and J", "I or J" },
	{ "G5.1 X1 Y1 I1", 1, 1, "no feed given", "F word" },
	{ "G4 P-1", 1, 4, "a dwell of -1", "0 to" },
	{ "M98 P-1", 1, 5, "names no subprogram", "M98" },
};

static void what_is_wrong_is_refused_where_it_stands(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(refusals) / sizeof(refusals[0]); i++)
		nc_check_refusal(&refusals[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(fanucs_circle_is_round),
		cmocka_unit_test(linuxcncs_conic_is_round),
		cmocka_unit_test(the_first_weight_stands_alone),
		cmocka_unit_test(a_cubic_goes_on_from_the_last),
		cmocka_unit_test(a_parabola_is_as_long_as_it_is),
		cmocka_unit_test(units_offsets_and_increments_count),
		cmocka_unit_test(at_a_cusp_a_piece_ends_and_is_slow),
		cmocka_unit_test(no_axis_is_too_slow_for_a_curve),
		cmocka_unit_test(nor_is_its_acceleration),
		cmocka_unit_test(fanucs_curve_may_have_any_axes),
		cmocka_unit_test(what_is_wrong_is_refused_where_it_stands),
	};

	return cmocka_run_group_tests_name("code/nurbs", tests, NULL, NULL);
}
