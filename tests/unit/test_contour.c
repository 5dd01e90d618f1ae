/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_contour.c - wire offset, taper, guides and corners, with programs
 * written by hand
 */
#include "wire_help.h"

#include "interp/compile.h"
#include "interp/cursor.h"

#define TENTH_DEG	"5.710593137499643"	/* its tangent is 0.1 */

static struct nc_read ready(const struct interp_wire *w)
{
	struct nc_read n = nc_ready();

	n.o.wire = w;
	n.o.offset_mm[1] = 0.11;
	n.o.offset_mm[2] = 0.2;
	return n;
}

struct at {
	double x, y, u, v;
};

/* The segments that move end at @want, in this order. */
static void assert_path(const struct interp_wire *w, const char *text,
			const struct at *want, uint32_t n)
{
	struct nc_read r = ready(w);
	uint32_t k = 0;

	nc_read(&r, text);
	for (uint32_t i = 0; i < nc_count(&r); i++) {
		const double at[] = {
			nc_end(&r, i, INTERP_X), nc_end(&r, i, INTERP_Y),
			nc_end(&r, i, INTERP_U), nc_end(&r, i, INTERP_V),
		};

		if (nc_seg(&r, i)->kind >= INTERP_BEGIN)
			continue;
		if (k >= n || hypot(at[0] - want[k].x, at[1] - want[k].y) >
		    1e-6 || hypot(at[2] - want[k].u, at[3] - want[k].v) > 1e-6)
			fail_msg("%s\nsegment %u at %.6f %.6f, %.6f %.6f", text,
				 k, at[0], at[1], at[2], at[3]);
		k++;
	}
	assert_int_equal(k, n);
	nc_done(&r);
}

static void assert_refused(const struct interp_wire *w, const char *text,
			   uint32_t line, const char *found)
{
	struct nc_read r = ready(w);

	nc_read_bytes(&r, text, strlen(text));
	if (r.rc != -EINVAL)
		fail_msg("taken: %s", text);
	if (r.diag.line != line || !strstr(r.diag.found, found))
		fail_msg("%s\n%u:%u: %s; %s", text, r.diag.line, r.diag.column,
			 r.diag.found, r.diag.wanted);
	assert_true(r.diag.wanted[0] != 0);
	nc_done(&r);
}

#define N(a)	(sizeof(a) / sizeof((a)[0]))

/* -- Offset --------------------------------------------------------------- */

#define SQUARE	"G1 X5 Y0\nX10\nY10\nX0\nY0\nX5\nG40 X5 Y-5\n"

static void a_square_grows_by_the_offset_outside(void **st)
{
	static const struct at want[] = {
		{ 5, -5, 0, 0 }, { 5, -.11, 0, 0 }, { 10.11, -.11, 0, 0 },
		{ 10.11, 10.11, 0, 0 }, { -.11, 10.11, 0, 0 },
		{ -.11, -.11, 0, 0 }, { 5, -.11, 0, 0 }, { 5, -5, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G0 X5 Y-5\nG42 D1\n" SQUARE, want, N(want));
	assert_path(&no_guides, "F5 G0 X5 Y-5\nG42 H1 " SQUARE "M2\n", want,
		    N(want));
	/* Right of minus is left. */
	assert_path(&no_guides, "H7=-0.11 F5 G0 X5 Y-5\nG41 H7 " SQUARE, want,
		    N(want));
}

static void a_square_shrinks_by_the_offset_inside(void **st)
{
	static const struct at want[] = {
		{ 5, -5, 0, 0 }, { 5, .11, 0, 0 }, { 9.89, .11, 0, 0 },
		{ 9.89, 9.89, 0, 0 }, { .11, 9.89, 0, 0 }, { .11, .11, 0, 0 },
		{ 5, .11, 0, 0 }, { 5, -5, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G0 X5 Y-5\nG41 D1\n" SQUARE, want, N(want));
	assert_path(&no_guides, "F5 D3=0.11 G0 X5 Y-5\nG41 D3 " SQUARE, want,
		    N(want));
}

static void inches_hold_for_registers_too(void **st)
{
	static const struct at want[] = {
		{ 25.4, 0, 0, 0 }, { 50.8, 2.54, 0, 0 }, { 76.2, 2.54, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "G20\nH5=0.1 F5\nG1 X1\nG41 H5 X2\nX3\n", want,
		    N(want));
}

static void a_sharp_outer_corner_is_rounded(void **st)
{
	/* A turn by 135 degrees to the left, the wire on the right. */
	const double h = sqrt(0.5) * 0.11;
	const struct at want[] = {
		{ 10, -.11, 0, 0 }, { 20, -.11, 0, 0 }, { 20 + h, h, 0, 0 },
		{ 10 + h, 10 + h, 0, 0 },
	};
	struct nc_read r = ready(&no_guides);
	const char *text = "F5 G42 D1 G1 X10\nX20\nX10 Y10\n";

	(void)st;
	assert_path(&no_guides, text, want, N(want));
	nc_read(&r, text);
	assert_near(nc_arc_of(&r, 2)->a_mm, 20);
	assert_near(nc_arc_of(&r, 2)->r_mm, 0.11);
	assert_near(nc_arc_of(&r, 2)->sweep, 3 * acos(-1) / 4);
	nc_done(&r);
}

static void going_back_goes_round_the_end(void **st)
{
	static const struct at want[] = {
		{ 10, .11, 0, 0 }, { 20, .11, 0, 0 }, { 20, -.11, 0, 0 },
		{ 10, -.11, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G41 D1 G1 X10\nX20\nX10\n", want, N(want));
}

static void arcs_change_their_radius(void **st)
{
	struct nc_read r = ready(&no_guides);

	(void)st;
	/* Line, fillet of 2 inside, line: the wire inside. */
	nc_read(&r, "F5 G41 D1 G1 X5\nX8\nG3 X10 Y2 J2\nG1 Y9\nG40 X0\n");
	assert_near(nc_arc_of(&r, 2)->r_mm, 1.89);
	assert_xyz(&r, 1, 8, .11, 0);
	assert_xyz(&r, 2, 9.89, 2, 0);
	assert_xyz(&r, 3, 9.89, 9, 0);
	nc_done(&r);
	/* A whole circle, both sides. */
	r = ready(&no_guides);
	nc_read(&r, "F5 G42 D1 G1 X5\nG3 X5 I-5\nG40 G1 X9\n");
	assert_near(nc_arc_of(&r, 1)->r_mm, 5.11);
	assert_near(nc_arc_of(&r, 1)->sweep, 2 * acos(-1));
	assert_xyz(&r, 1, 5.11, 0, 0);
	nc_done(&r);
}

static void a_line_and_an_arc_meet_inside(void **st)
{
	struct nc_read r = ready(&no_guides);
	const double x = -sqrt(4.9 * 4.9 - 0.1 * 0.1);

	(void)st;
	/* Along the diameter, then the half circle above; the wire inside. */
	nc_read(&r, "H9=0.1 F5 G1 Y1\nG41 H9 Y0\nX5\nG3 X-5 I-5\nG1 X0\n");
	assert_xyz(&r, 2, -x, .1, 0);
	assert_xyz(&r, 3, x, .1, 0);
	assert_near(nc_arc_of(&r, 3)->r_mm, 4.9);
	nc_done(&r);
}

static void the_register_may_change_on_the_way(void **st)
{
	static const struct at want[] = {
		{ 5, .11, 0, 0 }, { 10, .11, 0, 0 }, { 10, .2, 0, 0 },
		{ 20, .2, 0, 0 }, { 30, .2, 0, 0 },
	};
	static const struct at corner[] = {
		{ 5, .11, 0, 0 }, { 9.8, .11, 0, 0 }, { 9.8, 8, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G41 D1 G1 X5\nX10\nD2 X20\nX30\n", want,
		    N(want));
	assert_path(&no_guides, "F5 G41 D1 G1 X5\nX10\nD2 Y8\n", corner,
		    N(corner));
}

static void what_the_wire_cannot_reach_is_refused_with_its_line(void **st)
{
	const struct interp_wire *w = &no_guides;

	(void)st;
	/* A step of 0.1 between two inner corners. */
	assert_refused(w, "F5 G41 D1\nG0 X2 Y3\nG1 Y0\nX10\nY0.1\nX5\nM2\n",
		       4, "a width of 0.1000 mm between the motions of lines 4 "
		       "and 6");
	/* A slot in the side of a plate. */
	assert_refused(w, "F5 G0 X5 Y-5\nG42 D1\nG1 Y0\nX10\nY5\nX10.2\nY0\n"
		       "X20\nM2\n", 5, "a width of 0.2000 mm between the "
		       "motions of lines 5 and 7");
	/* A neck within a curve: it has one line. */
	assert_refused(w, "F5 G41 D1 G1 X5\nX8\nG5 Y2 I6 J2.2 P6 Q-2.2\n"
		       "G1 Y5\nM2\n", 3, "between the motions of line 3");
	assert_refused(w, "F5\nG41 D1 G1 X.11\nX8\n", 2,
		       "a lead of 0.1100 mm for a change of offset of 0.1100");
	assert_refused(w, "F5 G41 D1 G1 X5\nX8\nG40 Y.05\n", 3, "a lead of");
	assert_refused(w, "F5 G0 X4.9 Y.1\nG41 D1 G3 X5 Y0 I.1\nG1 X8\n", 2,
		       "a lead on an arc of 0.1000 mm radius whose end the wire "
		       "passes at 0.1100 mm, by the contour of line 3");
	assert_refused(w, "F5 G41 D1 G1 X5\nG18 G2 X9 I2\n", 2, "plane XY");
	assert_refused(w, "F5 G41 D1 G1 X5\nX6\nZ4\nX9\n", 3, "another axis");
	assert_refused(w, "F5\nG41 G1 X5\n", 2,
		       "register 0, which is not defined");
	assert_refused(w, "F5\nG41 D1 H1 G1 X5\n", 2, "H on a line with D");
	assert_refused(w, "H1=160\n", 1, "an offset of 160 mm");
	assert_refused(w, "G20\nH1=4\n", 2, "an offset of 101.6 mm");
	assert_refused(w, "G20 H1=.004\n", 1,
		       "H1 on a line that changes the units");
	assert_refused(w, "H1000=1\n", 1, "out of range");
	assert_refused(w, "D1.5\n", 1, "not a whole");
}

/* One of 1 mm that touches the contour is one of 0.89 mm for the wire. */
static void a_lead_on_an_arc_keeps_its_centre(void **st)
{
	static const struct at want[] = {
		{ 4, 1, 0, 0 }, { 4.11, 1, 0, 0 }, { 5, .11, 0, 0 },
		{ 8, .11, 0, 0 }, { 8, 1.5, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G0 X4 Y1\nG41 D1 G3 X5 Y0 I1\nG1 X8\n"
		    "G40 Y1.5\n", want, N(want));
}

static void an_inside_radius_equal_to_the_offset_is_a_point(void **st)
{
	static const struct at want[] = {
		{ 5, .11, 0, 0 }, { 8, .11, 0, 0 }, { 8, 4, 0, 0 },
	};

	(void)st;
	assert_path(&no_guides, "F5 G41 D1 G1 X5\nX8\nG3 X8.11 Y.11 J.11\n"
		    "G1 Y4\n", want, N(want));
}

static void actions_stay_at_their_corner(void **st)
{
	struct nc_read r = ready(&no_guides);

	(void)st;
	nc_read(&r, "F5 G42 D1 G1 X5\nX10\nG4 P0.5\nM0\nX5 Y10\n");
	assert_int_equal(nc_seg(&r, 1)->kind, INTERP_LINE);
	assert_int_equal(nc_seg(&r, 2)->kind, INTERP_DWELL);
	assert_int_equal(nc_seg(&r, 3)->kind, INTERP_STOP);
	assert_int_equal(nc_seg(&r, 4)->kind, INTERP_ARC);
	assert_int_equal(nc_seg(&r, 5)->kind, INTERP_LINE);
	nc_done(&r);
}

/* -- Four axes in the dialects of wire machines --------------------------- */

static void assert_lean(const char *dialect, const char *text, double u,
			double v)
{
	struct nc_read r = ready(&guides);

	r.dialect = interp_dialect_by_name(dialect);
	nc_read(&r, text);
	/* The guides are 20 below and 40 above: twice the lean over the top. */
	assert_near(nc_end(&r, nc_count(&r) - 1, INTERP_U), u);
	assert_near(nc_end(&r, nc_count(&r) - 1, INTERP_V), v);
	nc_done(&r);
}

static void u_and_v_are_the_lean_in_the_dialects(void **st)
{
	(void)st;
	assert_lean("fanuc", "G90\nG01 X10. Y0. U1. V2.\nX20.\nM30\n", 22, 4);
	assert_lean("chmer", "G90\nG01 X10. Y0. U1.\nU-1.\nM30\n", 8, 0);
	assert_lean("robofil", "G91\nG01 X10. Y0. U1.\nX1. U1.\nM02\n", 15, 0);
	assert_lean("skd2", "G90\nG01 X10.0 U1.0\nM02\n", 12, 0);
	assert_lean("sodick", "G90\nG01 X10. Y0.:G01 X11. Y0.\nM02\n", 12, 0);
	/* A half circle over another, one mm to the side. */
	assert_lean("fanuc", "G90\nG01 X10. U1.\nG02 X20. I5. U1. K1.\nM30\n",
		    22, 0);
	assert_lean("robofil", "G90\nG01 X10. Y0. U1.\n"
		    "G02 X20. Y0. I15. J0. U1. K1. L0.\nM02\n", 22, 0);
	/* A cone: both centres are one, half a turn, lean 1 mm outward. */
	assert_lean("fanuc", "G90\nG01 X10. U1.\nG03 X-10. I-10. U-1. K0. L0.\n"
		    "M30\n", -12, 0);
}

static void a_leaning_arc_without_its_centre_is_refused(void **st)
{
	struct nc_read r = ready(&guides);
	const char *text = "G90\nG01 X10. Y0.\nG02 X20. I5. U1.\nM30\n";

	(void)st;
	r.dialect = interp_dialect_by_name("fanuc");
	nc_read_bytes(&r, text, strlen(text));
	assert_int_equal(r.rc, -EINVAL);
	assert_int_equal(r.diag.line, 3);
	assert_non_null(strstr(r.diag.found, "no centre of its top"));
	nc_done(&r);
}

/* -- Taper ---------------------------------------------------------------- */

#define GO_SQUARE "G1 X5 Y0\nX10\nY10\nX0\nY0\nX5\n"

/* To the right of a square cut counter-clockwise the top is 4 mm larger all
 * round: P (10, 0) under Q (14, -4), so the lower guide is at (8, 2) and the
 * upper at (18, -8). */
static void the_guides_of_a_tapered_square(void **st)
{
	static const struct at want[] = {
		{ 5, -5, 5, -5 }, { 5, 2, 5, -8 }, { 8, 2, 18, -8 },
		{ 8, 8, 18, 18 }, { 2, 8, -8, 18 }, { 2, 2, -8, -8 },
		{ 5, 2, 5, -8 }, { 5, -5, 5, -5 },
	};
	const char *text = "F5 G0 X5 Y-5\nG52 A" TENTH_DEG "\n" GO_SQUARE
			   "G50 X5 Y-5\n";

	(void)st;
	assert_path(&guides, text, want, N(want));
}

/* 14 mm round the axis at the top, 8 mm at the lower guide. */
static void the_feed_is_that_of_the_faster_contour(void **st)
{
	struct nc_read r = ready(&guides);

	(void)st;
	nc_read(&r, "F60 G0 X15\nG52 A" TENTH_DEG " G1 X10\nG3 X10 I-10\n");
	assert_near(nc_seg(&r, 2)->length_mm, 16 * acos(-1));
	assert_true(fabs(nc_seg(&r, 2)->feed_mm_s - 8.0 / 14) < 1e-6);
	nc_done(&r);
}

/* It has no direction to keep an offset from. */
static void a_motion_of_no_length_changes_nothing(void **st)
{
	static const char *const more[] = { "", "G1 X10 Y0 : X10 Y-2\n" };
	double length_mm[2];

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct nc_read r = ready(&guides);
		char text[200];

		snprintf(text, sizeof(text), "F6 G0 X10 Y-5\nG42 D1\n"
			 "G1 X10 Y0 : X10 Y-2\n%sM2\n", more[i]);
		nc_read(&r, text);
		length_mm[i] = nc_seg(&r, 1)->length_mm;
		assert_true(length_mm[i] > 1 && length_mm[i] < 20);
		nc_done(&r);
	}
	assert_near(length_mm[0], length_mm[1]);
}

/* A machine that stands with the wire aslant knows where it stands. */
static void the_start_of_the_guides_is_the_start_of_the_wire(void **st)
{
	struct nc_read n = ready(&guides);
	const struct interp_build_options bo = {
		.machine = &n.machine,
		.start_mm = { [INTERP_X] = 8, [INTERP_Y] = 2,
			      [INTERP_U] = 18, [INTERP_V] = -8 },
	};
	const char *text = "F5 G1 X10 Y0 U14 V-4\n";

	(void)st;
	n.o.machine = &n.machine;
	n.build = interp_build_create(&bo);
	assert_int_equal(interp_nc_compile(&(struct interp_text) {
			.at = text, .bytes = strlen(text) },
		&n.o, n.build, &n.result, &n.diag), 0);
	assert_near(interp_build_here(n.build)[INTERP_X], 8);
	assert_near(interp_build_here(n.build)[INTERP_V], -8);
	nc_done(&n);
}

/* -- The wire in the work ------------------------------------------------- */

/* 20 by 20 mm with corners of 3 mm, wire outside, 3 degrees, top smaller. */
static const char punch[] =
	"F6 G0 X10 Y-5\nG42 D1 G51 A3\nG1 X10 Y0\n"
	"X17\nG3 X20 Y3 J3\nG1 Y17\nG3 X17 Y20 I-3\nG1 X3\n"
	"G3 X0 Y17 J-3\nG1 Y3\nG3 X3 Y0 I3\nG1 X10\n"
	"G40 G50 X10 Y-5\n";

/* Off the outline of the punch, below 0 inside. */
static double off_punch(double x, double y)
{
	const double qx = fabs(x - 10) - 7, qy = fabs(y - 10) - 7;

	return hypot(fmax(qx, 0), fmax(qy, 0)) + fmin(fmax(qx, qy), 0) - 3;
}

/* The worst the wire is off either contour, pulses, guides 20 below and 40
 * above the planes: W(z) by similar triangles back from the guides. */
static void punch_errors(enum interp_strategy s, double ret[2])
{
	const double slope = tan(3 * acos(-1) / 180);
	const double d = 0.11 * sqrt(1 + slope * slope);
	const double want[2] = { d, d - 40 * slope };
	struct nc_read n = ready(&guides);
	const struct interp_build_options bo = { .machine = &n.machine,
						 .strategy = s };
	const struct interp_build_about about = { .lines = 13 };
	struct interp_cursor c;
	size_t bytes;

	n.o.machine = &n.machine;
	n.build = interp_build_create(&bo);
	assert_int_equal(interp_nc_compile(&(struct interp_text) {
			.at = punch, .bytes = sizeof(punch) - 1 },
		&n.o, n.build, &n.result, &n.diag), 0);
	n.block = interp_build_take(n.build, &about, &bytes);
	assert_int_equal(interp_program_map(&n.p, n.block, bytes), 0);
	assert_int_equal(interp_cursor_init(&c, &n.p), 0);
	interp_cursor_aim(&c, 1e9);
	ret[0] = ret[1] = 0;
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		for (int i = 0; i < 2 && c.seg.line > 3 && c.seg.line < 13;
		     i++) {
			const double k = i ? 0.6 : 0.2;
			const double x = c.pos[0] + k * (c.pos[6] - c.pos[0]);
			const double y = c.pos[1] + k * (c.pos[7] - c.pos[1]);
			const double off = off_punch(x * 0.001, y * 0.001);

			ret[i] = fmax(ret[i], fabs(off - want[i]) * 1000);
		}
	}
	nc_done(&n);
}

static void the_wire_is_on_both_contours_all_the_way_round(void **st)
{
	(void)st;
	for (int s = 0; s < 2; s++) {
		const double most = s == INTERP_SIMULTANEOUS ? 1.0 : 2.0;
		double off[2];

		punch_errors((enum interp_strategy)s, off);
		print_message("    %s: bottom %.2f, top %.2f pulses\n",
			      interp_strategy_name((enum interp_strategy)s),
			      off[0], off[1]);
		assert_true(off[0] <= most && off[1] <= most);
	}
}

/* -- Other guides --------------------------------------------------------- */

static void relative_upper_guides_move_by_the_difference(void **st)
{
	static const struct at want[] = {
		{ 5, -5, 0, 0 }, { 5, 2, 0, -10 }, { 8, 2, 10, -10 },
	};
	struct interp_wire w = guides;

	(void)st;
	w.guides = INTERP_GUIDES_RELATIVE;
	assert_path(&w, "F5 G0 X5 Y-5\nG52 A" TENTH_DEG " G1 X5 Y0\nX10\n"
		    "Y10\nM2\n", (const struct at[]) {
		    want[0], want[1], want[2], { 8, 10, 10, 0 } }, 4);
}

static const struct interp_couple *couple_of(const struct nc_read *r,
					     uint32_t i)
{
	assert_int_equal(nc_seg(r, i)->kind, INTERP_PAIR);
	return &r->p.couples[nc_seg(r, i)->arg];
}

static void the_guides_of_a_cone_go_round_its_axis(void **st)
{
	struct nc_read r = ready(&guides);

	(void)st;
	nc_read(&r, "F5 G0 X15\nG52 A" TENTH_DEG " G1 X10\nG3 X10 I-10\n"
		"G50 G1 X15\n");
	for (int i = 0; i < 2; i++) {
		const struct interp_arc *arc = &couple_of(&r, 2)->side[i];

		assert_near(arc->a_mm, 0);
		assert_near(arc->b_mm, 0);
		assert_near(arc->r_mm, i ? 18 : 8);
		assert_near(arc->sweep, 2 * acos(-1));
	}
	assert_xyz(&r, 2, 8, 0, 0);
	nc_done(&r);
	/* So steep that the lower guide goes round the far side of the axis:
	 * the top is larger by 22, 10 - 11 = -1 and 10 + 44 = 54. */
	r = ready(&guides);
	nc_read(&r, "F5 G0 X15\nG52 A28.810793742973065 G1 X10\n"
		"G3 X-10 I-10\n");
	assert_near(couple_of(&r, 2)->side[0].r_mm, 1);
	assert_near(couple_of(&r, 2)->side[1].r_mm, 54);
	assert_near(nc_end(&r, 2, INTERP_U), -54);
	assert_near(nc_end(&r, 2, INTERP_X), 1);
	nc_done(&r);
}

/* A leaning wire touches the face at D / cos A: 0.11 * sqrt(1.01). */
static void both_contours_have_the_offset_of_the_leaning_wire(void **st)
{
	const double d = 0.11 * sqrt(1.01), q = d + 4;
	const double low = d - 2, high = d + 8;
	const struct at want[] = {
		{ 5, low, 5, high }, { 10 - low, low, 10 - high, high },
		{ 10 - low, 30, 10 - high, 30 },
	};

	(void)st;
	assert_near(low, d - 0.5 * (q - d));
	assert_path(&guides, "F5 G41 D1 G51 A" TENTH_DEG " G1 X5\nX10\nY30\n",
		    want, N(want));
}

static void a_different_top_is_led_by_u_and_v(void **st)
{
	/* P (10, 0), Q (12, 4): lower (9, -2), upper (14, 8); then the top
	 * goes along, then alone. */
	static const struct at want[] = {
		{ 9, -2, 14, 8 }, { 9, 3, 14, 13 }, { 10, 5, 10, 5 },
	};

	(void)st;
	assert_path(&guides, "F5 G1 X10 U12 V4\nY5\nU10 V5\n", want, N(want));
}

/* Every point of the walk puts both contours within a pulse or two. */
static void an_arc_under_a_line_is_cut_within_a_pulse(void **st)
{
	const char *text = "F5 G1 X10 U10\nG3 X0 Y10 I-10 U0 V10\n";

	(void)st;
	for (int s = 0; s < 2; s++) {
		struct nc_read r = ready(&guides);
		struct interp_cursor c;
		uint32_t chords = 0;

		nc_read(&r, text);
		assert_int_equal(interp_cursor_init(&c, &r.p), 0);
		interp_cursor_aim(&c, 1e9);
		while (interp_cursor_step(&c) == INTERP_MOVED) {
			const double k = 1.0 / 5;
			const double x = c.pos[0] + k * (c.pos[6] - c.pos[0]);
			const double y = c.pos[1] + k * (c.pos[7] - c.pos[1]);

			if (c.seg.line != 2)
				continue;
			assert_true(fabs(hypot(x, y) - 10000) < 1.0);
		}
		for (uint32_t i = 0; i < nc_count(&r); i++)
			chords += nc_seg(&r, i)->line == 2;
		assert_in_range(chords, 100, 2000);
		assert_int_equal(c.pos[INTERP_X], 0);
		assert_int_equal(c.pos[INTERP_Y], 10000);
		nc_done(&r);
	}
}

/* Bottom and top on one line, a : between them. */
static void a_colon_gives_the_top_words_of_its_own(void **st)
{
	struct interp_wire w = guides;
	struct nc_read r;

	(void)st;
	w.z_lower_mm = w.z_program_mm;
	w.z_upper_mm = w.z_second_mm;
	r = ready(&w);
	nc_read(&r, "F5 G1 X10 : X10 Y0\nG3 X0 Y10 I-10 : G1 X0 Y12\n"
		"G1 X-9 : G3 X-12 Y0 J-12\nG3 X-10 Y9 J-1 : I-2 X-16 Y0\n");
	assert_near(couple_of(&r, 1)->side[0].r_mm, 10);
	assert_near(couple_of(&r, 1)->side[1].r_mm, 0);
	assert_near(nc_end(&r, 1, INTERP_V), 12);
	assert_near(couple_of(&r, 2)->side[0].r_mm, 0);
	assert_near(couple_of(&r, 2)->side[1].r_mm, 12);
	assert_near(couple_of(&r, 2)->side[1].b_mm, 0);
	assert_near(couple_of(&r, 3)->side[1].a_mm, -14);
	nc_done(&r);
	assert_refused(&w, "F5 G1 X1 : G4\n", 1, "G4 behind");
	assert_refused(&w, "F5 G1 X1 : Z4\n", 1, "Z4 behind");
	assert_refused(&w, "F5 G1 X1 : X4 : X5\n", 1, "a second :");
	assert_refused(&w, "F5 G1 X1 : G1 X4 I5\n", 1, "of a straight top");
	assert_refused(&w, "F5 G1 X1 : G2 X4\n", 1, "radius 0");
	assert_refused(&no_guides, "F5 G1 X1 : X4\n", 1, "without wire guides");
}

/* With the guides in the planes there is nothing to convert. */
static void guides_in_the_planes_walk_the_contours_themselves(void **st)
{
	struct interp_wire w = guides;
	struct nc_read r;

	(void)st;
	w.z_lower_mm = w.z_program_mm;
	w.z_upper_mm = w.z_second_mm;
	r = ready(&w);
	nc_read(&r, "F5 G1 X10 U10\nG3 X0 Y10 I-10 U0 V10\n");
	assert_near(couple_of(&r, nc_count(&r) - 1)->side[0].r_mm, 10);
	assert_near(couple_of(&r, nc_count(&r) - 1)->side[1].r_mm, 0);
	nc_done(&r);
}

static void a_lean_beyond_the_machine_is_refused(void **st)
{
	struct interp_wire w = guides;

	(void)st;
	assert_refused(&guides, "F5\nG51 A30.01\n", 2, "a taper of 30.01");
	assert_refused(&guides, "F5\nG1 X1\nX5 U50 V0\nX7\n", 3, "leans by");
	assert_refused(&guides, "F5\nG51\n", 2, "without A");
	assert_refused(&no_guides, "F5\nG51 A1\n", 2, "without wire guides");
	assert_refused(&guides, "G92 U0\n", 1, "G92 with U");
	/* At the square's edge both faces lean: atan(0.1 * sqrt(2)) = 8.05. */
	w.angle_max_deg = 7;
	assert_refused(&w, "F5 G0 X5 Y-5\nG52 A" TENTH_DEG "\n" GO_SQUARE
		       "G50 X5 Y-5\n", 4, "leans by 8.049 degrees");
}

static void an_outline_that_vanishes_above_is_refused(void **st)
{
	struct interp_wire w = guides;

	(void)st;
	w.z_second_mm = w.z_program_mm + 40;
	assert_refused(&w, "H1=0.248 F60 G0 X5.185 Y-2.821\n"
		       "G41 H1 G52 A6.88\n"
		       "G1 X2.093 Y-1.657\nX1.498 Y-3.237\nX-1.043 Y-3.593\n"
		       "X-2.972 Y-1.203\nX-2.268 Y1.886\nX-0.887 Y4.183\n"
		       "X2.575 Y2.480\nX2.688 Y-0.076\nX2.093 Y-1.657\n"
		       "G40 G50 X5.185 Y-2.821\n",
		       4, "the faces of lines 4 and 11");
}

/* -- Corners -------------------------------------------------------------- */

static void a_corner_is_approached_slowly_and_waited_on(void **st)
{
	struct interp_wire w = no_guides;
	struct nc_read r;

	(void)st;
	w.corner_angle_deg = 60;
	w.corner_feed_percent = 25;
	w.corner_before_mm = 0.5;
	w.corner_dwell_s = 0.25;
	r = ready(&w);
	/* 90 degrees is a corner, 45 is none. */
	nc_read(&r, "F60 G1 X10\nY10\nX0 Y20\n");
	assert_int_equal(nc_count(&r), 5);
	assert_xyz(&r, 0, 9.5, 0, 0);
	assert_near(nc_seg(&r, 0)->feed_mm_s, 1);
	assert_xyz(&r, 1, 10, 0, 0);
	assert_near(nc_seg(&r, 1)->feed_mm_s, 0.25);
	assert_int_equal(nc_seg(&r, 2)->kind, INTERP_DWELL);
	assert_int_equal(nc_seg(&r, 2)->arg, 250);
	assert_near(nc_seg(&r, 3)->feed_mm_s, 1);
	assert_xyz(&r, 3, 10, 10, 0);
	nc_done(&r);
}

static void a_short_motion_is_slow_as_a_whole(void **st)
{
	struct interp_wire w = guides;
	struct nc_read r;

	(void)st;
	w.corner_angle_deg = 60;
	w.corner_feed_percent = 50;
	w.corner_before_mm = 5;
	r = ready(&w);
	nc_read(&r, "F60 G1 X1\nG3 X1 I-1\nG1 Y5\nX5\n");
	assert_near(nc_seg(&r, 0)->feed_mm_s, 0.5);
	assert_near(nc_end(&r, 0, INTERP_U), 1);
	/* The circle leaves upward, and the line goes on so. */
	assert_near(nc_seg(&r, 1)->feed_mm_s, 1);
	assert_near(nc_seg(&r, 2)->feed_mm_s, 0.5);
	nc_done(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_square_grows_by_the_offset_outside),
		cmocka_unit_test(a_square_shrinks_by_the_offset_inside),
		cmocka_unit_test(a_motion_of_no_length_changes_nothing),
		cmocka_unit_test(inches_hold_for_registers_too),
		cmocka_unit_test(a_sharp_outer_corner_is_rounded),
		cmocka_unit_test(going_back_goes_round_the_end),
		cmocka_unit_test(arcs_change_their_radius),
		cmocka_unit_test(a_line_and_an_arc_meet_inside),
		cmocka_unit_test(the_register_may_change_on_the_way),
		cmocka_unit_test(what_the_wire_cannot_reach_is_refused_with_its_line),
		cmocka_unit_test(a_lead_on_an_arc_keeps_its_centre),
		cmocka_unit_test(an_inside_radius_equal_to_the_offset_is_a_point),
		cmocka_unit_test(u_and_v_are_the_lean_in_the_dialects),
		cmocka_unit_test(a_leaning_arc_without_its_centre_is_refused),
		cmocka_unit_test(actions_stay_at_their_corner),
		cmocka_unit_test(the_guides_of_a_tapered_square),
		cmocka_unit_test(relative_upper_guides_move_by_the_difference),
		cmocka_unit_test(the_feed_is_that_of_the_faster_contour),
		cmocka_unit_test(the_start_of_the_guides_is_the_start_of_the_wire),
		cmocka_unit_test(the_wire_is_on_both_contours_all_the_way_round),
		cmocka_unit_test(the_guides_of_a_cone_go_round_its_axis),
		cmocka_unit_test(both_contours_have_the_offset_of_the_leaning_wire),
		cmocka_unit_test(a_different_top_is_led_by_u_and_v),
		cmocka_unit_test(an_arc_under_a_line_is_cut_within_a_pulse),
		cmocka_unit_test(a_colon_gives_the_top_words_of_its_own),
		cmocka_unit_test(guides_in_the_planes_walk_the_contours_themselves),
		cmocka_unit_test(a_lean_beyond_the_machine_is_refused),
		cmocka_unit_test(an_outline_that_vanishes_above_is_refused),
		cmocka_unit_test(a_corner_is_approached_slowly_and_waited_on),
		cmocka_unit_test(a_short_motion_is_slow_as_a_whole),
	};

	return cmocka_run_group_tests_name("interp/contour", tests, NULL, NULL);
}
