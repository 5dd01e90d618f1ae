/* SPDX-License-Identifier: Apache-2.0 */
/* test_turn.c - a work system that is turned, and an electrode beside its
 * middle: where every place of a program is on the machine */
#include "wire_help.h"

#include "interp/turn.h"

#include <stdlib.h>

static const double origin[2] = { 12.5, -7.25 };

static double at(const struct nc_read *n, uint32_t node, int axis)
{
	const uint32_t axes = n->p.head->naxes;

	for (uint32_t j = 0; j < axes; j++)
		if (n->p.head->column[j] == axis)
			return (double)n->p.nodes[node * axes + j] /
			       INTERP_SUB * 0.001;
	return 0;
}

static struct nc_read turned(const char *text, double deg)
{
	struct nc_read n = nc_ready();

	n.o.work_offset_mm[0][INTERP_X] = origin[0];
	n.o.work_offset_mm[0][INTERP_Y] = origin[1];
	n.o.work_turn_deg[0] = deg;
	nc_read(&n, text);
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

/* Two places that are rounded to pulses, one of them turned. */
#define ROUNDED_MM	0.0014

/* Where (x, y) of a program is on the machine. */
static void assert_at(const struct nc_read *n, uint32_t seg, double deg,
		      double x, double y)
{
	const double c = cos(deg * M_PI / 180), s = sin(deg * M_PI / 180);

	assert_true(fabs(at(n, seg + 2, INTERP_X) -
			 (origin[0] + c * x - s * y)) < ROUNDED_MM);
	assert_true(fabs(at(n, seg + 2, INTERP_Y) -
			 (origin[1] + s * x + c * y)) < ROUNDED_MM);
}

/* Lines, arcs, helices, orbits: each node is that of the straight
 * system, turned about its origin. */
static void all_of_a_program_turns_about_the_origin(void **state)
{
	static const char text[] = "G0 X1 Y2 Z3\nG1 F60 X10 Y4\n"
		"G3 X14 Y8 I0 J4\nG2 X18 Y12 Z1 R4\nG91 G1 X3\nG1 Y-2.5 C30\n"
		"G90 X5 Y5\nG1 X1 Y1\nG0 Z5\n"
		"G130 Z2 R2\nG131 Z1 R2\n";
	const double deg[] = { 2, -35, 90, 180, 271.3 };
	struct nc_read straight = turned(text, 0);

	(void)state;
	for (size_t k = 0; k < sizeof(deg) / sizeof(deg[0]); k++) {
		struct nc_read n = turned(text, deg[k]);

		assert_int_equal(n.p.head->nsegs, straight.p.head->nsegs);
		for (uint32_t i = 1; i + 2 < n.p.head->nsegs; i++) {
			assert_at(&n, i - 1, deg[k],
				  at(&straight, i + 1, INTERP_X) - origin[0],
				  at(&straight, i + 1, INTERP_Y) - origin[1]);
			assert_true(fabs(at(&n, i + 1, INTERP_Z) -
					 at(&straight, i + 1, INTERP_Z)) <
				    1e-9);
			assert_int_equal(n.p.segs[i].kind,
					 straight.p.segs[i].kind);
		}
		nc_done(&n);
	}
	nc_done(&straight);
}

/* Its segments end elsewhere, as other axes limit it, so it is compared by its
 * points. */
static void a_curve_turns_by_its_points(void **state)
{
	static const char text[] = "G0 X5 Y5\nG5 F9 I1 J1 P-1 Q-1 X9 Y7\n";
	struct nc_read a = turned(text, 0), b = turned(text, 40);
	struct interp_nurbs from, to;

	(void)state;
	assert_true(interp_program_curve(&a.p, 0, &from));
	assert_true(interp_program_curve(&b.p, 0, &to));
	assert_int_equal(from.npoints, to.npoints);
	for (uint32_t i = 0; i < from.npoints; i++) {
		const double *p = from.points + i * (from.naxes + 1);
		const double *q = to.points + i * (to.naxes + 1);
		const double x = p[0] - origin[0], y = p[1] - origin[1];
		const double c = cos(40 * M_PI / 180), s = sin(40 * M_PI / 180);

		assert_true(fabs(q[0] - origin[0] - c * x + s * y) <
			    ROUNDED_MM);
		assert_true(fabs(q[1] - origin[1] - s * x - c * y) <
			    ROUNDED_MM);
	}
	nc_done(&a);
	nc_done(&b);
}

static void places_of_the_machine_stay_those_of_the_machine(void **state)
{
	struct nc_read n = turned("G0 X10 Y0\nG53 G0 X3\nG53 G0 Y4\nG0 X1 Y0\n"
				  "G92 X0 Y0\nG0 X2 Y1\nG92.1\nG91 G28 Y0\n",
				  30);

	(void)state;
	assert_at(&n, 0, 30, 10, 0);
	assert_true(fabs(at(&n, 3, INTERP_X) - 3) < 0.0011);
	assert_true(fabs(at(&n, 3, INTERP_Y) - at(&n, 2, INTERP_Y)) < 0.0011);
	assert_true(fabs(at(&n, 4, INTERP_X) - 3) < 0.0011);
	assert_true(fabs(at(&n, 4, INTERP_Y) - 4) < 0.0011);
	assert_at(&n, 3, 30, 1, 0);
	/* G92 counts along the turned axes. */
	assert_at(&n, 4, 30, 3, 1);
	assert_true(fabs(at(&n, 7, INTERP_Y)) < 0.0011);
	assert_true(fabs(at(&n, 7, INTERP_X) - at(&n, 6, INTERP_X)) < 0.0011);
	nc_done(&n);
}

/* G10 L20 gives a place its number by the turn of that system. */
static void g10_writes_and_turns(void **state)
{
	struct nc_read n = turned("G10 L2 P0 R90\nG0 X10 Y0\nG10 L2 P0 R0\n"
				  "G0 X0 Y0\nG10 L2 P2 X5 Y5 R90\n"
				  "G10 L20 P2 X1 Y2\nG55 G0 X2 Y2\n", 0);

	(void)state;
	assert_at(&n, 0, 90, 10, 0);
	assert_at(&n, 1, 0, 0, 0);
	/* Where it stood is X1 Y2: one farther along X is along Y+. */
	assert_true(fabs(at(&n, 4, INTERP_X) - origin[0]) < 0.0011);
	assert_true(fabs(at(&n, 4, INTERP_Y) - origin[1] - 1) < 0.0011);
	nc_done(&n);
}

static void what_cannot_be_turned_is_refused(void **state)
{
	static const struct { const char *text, *says; } rows[] = {
		/* The first leaves another way on the machine. */
		{ "G5 F9 I1 J0 P-1 Q0 X5 Y0\nG55\nG5 P0 Q1 X5 Y5\n",
		  "G5 without I and J" },
		{ "G0 X0 Y0\nG18 G2 F9 X2 Z0 R1\n", "beside the plane" },
		{ "G0 Z1\nG18 G130 Y-1 R2 F9\n", "an orbit in the plane" },
		{ "G80 X-5 F9\n", "feels along one" },
		{ "G0 X900\n", "beyond the travel" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct nc_read n = nc_ready();

		n.o.work_turn_deg[0] = 3;
		nc_read_bytes(&n, rows[i].text, strlen(rows[i].text));
		assert_int_equal(n.rc, -EINVAL);
		if (!strstr(n.diag.found, rows[i].says))
			fail_msg("%s: %s", rows[i].text, n.diag.found);
		nc_done(&n);
	}
}

static void each_segment_knows_what_it_counts_from(void **state)
{
	struct nc_read n = turned("G0 X1\nG55 X1\nG92 X0\nX2\nG54 X1\n", 30);
	const struct interp_origin *o = interp_program_origin(&n.p, 1);

	(void)state;
	assert_int_equal(o->work, 0);
	assert_true(o->turn_deg == 30);
	o = interp_program_origin(&n.p, 2);
	assert_int_equal(o->work, 1);
	assert_true(o->turn_deg == 0 && o->mm[INTERP_X] == 0);
	o = interp_program_origin(&n.p, 3);
	assert_int_equal(o->work, 1);
	assert_true(fabs(o->mm[INTERP_X] - 1) < 1e-9);
	o = interp_program_origin(&n.p, 4);
	assert_int_equal(o->work, 0);
	nc_done(&n);
}

/* Along a turned axis both of the machine's move, so G28 without words sends
 * both home. */
static void all_that_moved_goes_home(void **state)
{
	static const char *const texts[] = {
		"G0 X10\nG28\n", "G0 Y10\nG28\n", "G91 G0 Y10 Z1\nG28\n",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct nc_read n = turned(texts[i], 30);
		const uint32_t last = n.p.head->nsegs;

		assert_true(fabs(at(&n, last - 2, INTERP_X)) > 1);
		assert_true(fabs(at(&n, last - 2, INTERP_Y)) > 1);
		assert_true(fabs(at(&n, last, INTERP_X)) < 0.0011);
		assert_true(fabs(at(&n, last, INTERP_Y)) < 0.0011);
		nc_done(&n);
	}
}

/* Each pass of a contour says which one it is, and how far the wire is beside
 * it; G41 and G42 say it too. */
static void each_pass_of_a_wire_knows_which_it_is(void **state)
{
	static const char text[] = "G90 F180\nH1=0.2 H2=0.15\nH3=0.12\n"
		"G150 H1 F180\nG150 H2 F300\nG150 H3 F400\n"
		"G151 P100 X10 Y10\nG152\n"
		"G42 H1 G1 X20 Y5\nX20 Y15\nG40 X25\nM30\n"
		"O100\nG41 G1 X10 Y5\nX15\nY15\nX5\nY5\nX10\n"
		"G40 Y10\nM99\n";
	static const double wire_mm[] = { 0, 0.2, 0.15, 0.12 };
	uint32_t passes = 0, last = 0;
	bool right = false;
	struct nc_read n = nc_ready();

	(void)state;
	n.o.wire = &guides;
	nc_read(&n, text);
	for (uint32_t i = 1; i + 1 < n.p.head->nsegs; i++) {
		const struct interp_origin *o = interp_program_origin(&n.p, i);

		assert_true(o && o->pass <= 3);
		if (o->pass) {
			assert_int_equal(o->npasses, 3);
			assert_true(fabs(o->wire_mm - wire_mm[o->pass]) <
				    1e-9);
			assert_true(o->pass >= last);
			last = o->pass;
			passes |= 1u << o->pass;
		}
		right = right || (!o->pass && fabs(o->wire_mm + 0.2) < 1e-9);
	}
	assert_int_equal(passes, 0xe);
	assert_true(right);
	nc_done(&n);
}

/* -- The electrode --------------------------------------------------------- */

static struct nc_read beside_on(const char *text,
				const struct interp_kinematics *k)
{
	/* A table cannot give it a turn. */
	const bool table = k && interp_kin_turns_work(k, INTERP_C);
	const struct interp_electrode one = {
		3, { [INTERP_X] = 0.5, [INTERP_Y] = -0.25, [INTERP_Z] = 4,
		     [INTERP_C] = table ? 0 : 10 },
	};
	const struct interp_electrodes all = {
		.at = &one, .n = 1, .held = 3,
	};
	struct nc_read n = nc_ready();

	n.o.electrodes = &all;
	n.o.kinematics = k;
	nc_read_bytes(&n, text, strlen(text));
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

static struct nc_read beside(const char *text)
{
	return beside_on(text, NULL);
}

/* X Y of the machine where the middle is over (x, y). */
static void assert_middle(const struct nc_read *n, uint32_t node, double x,
			  double y)
{
	const double deg = at(n, node, INTERP_C) * M_PI / 180;
	const double c = cos(deg), s = sin(deg);

	assert_true(fabs(at(n, node, INTERP_X) - x - c * 0.5 - s * 0.25) <
		    0.0021);
	assert_true(fabs(at(n, node, INTERP_Y) - y - s * 0.5 + c * 0.25) <
		    0.0021);
}

static void its_middle_stays_over_the_place_as_c_turns(void **state)
{
	struct nc_read n = beside("G0 X1 Y2 Z3 C0\nG0 C90\nG91 G0 C-30\n"
				  "G90 G1 F9 X4\nG0 C200 X7 Y8\n");

	(void)state;
	assert_int_equal(n.rc, 0);
	for (uint32_t node = 3, k = 0; node < 8; node++, k++) {
		static const double xy[5][2] = {
			{ 1, 2 }, { 1, 2 }, { 1, 2 }, { 4, 2 }, { 7, 8 },
		};

		assert_middle(&n, node, xy[k][0], xy[k][1]);
	}
	assert_true(fabs(at(&n, 4, INTERP_C) - 100) < 1e-9);
	assert_true(fabs(at(&n, 3, INTERP_Z) - 7) < 1e-9);
	nc_done(&n);
}

/* A C in the table turns the work: the electrode stays as it is, X Y stay, and
 * a cut may turn C. */
static void a_table_does_not_turn_the_electrode(void **state)
{
	static const struct { const char *chain; bool table; } rows[] = {
		{ "C(0 0 -120) A(0 15 -80) X Y Z", true },
		{ "C X Y Z", true }, { "X Y Z C", false },
		{ "A(0 15 -80) X Y Z C", false }, { "A X Y Z", false },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct interp_kinematics k;
		struct interp_diag d;
		struct nc_read n;

		interp_kin_clear(&k);
		assert_int_equal(interp_kin_parse(&k, rows[i].chain, &d), 0);
		n = beside_on("G0 X1 Y2 C0\nG0 C90\nG1 F9 X4\n", &k);
		assert_int_equal(n.rc, 0);
		if (rows[i].table) {
			assert_true(fabs(at(&n, 4, INTERP_X) - 1.5) < 1e-9);
			assert_true(fabs(at(&n, 4, INTERP_Y) - 1.75) < 1e-9);
		} else {
			assert_middle(&n, 4, 1, 2);
		}
		nc_done(&n);
		n = beside_on("G0 X1\nG1 F9 C5\n", &k);
		assert_int_equal(n.rc, rows[i].table ? 0 : -EINVAL);
		nc_done(&n);
	}
}

static void no_cut_turns_c_with_it(void **state)
{
	static const char *const texts[] = {
		"G0 X1 Y2\nG1 F9 C5\n", "G0 X1\nG2 F9 X3 R1 C5\n",
		"G0 Z5\nG86 F9 Z1 C9\n", "G5 F9 I1 J1 P-1 Q-1 X9 Y7 C3\n",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct nc_read n = beside(texts[i]);

		assert_int_equal(n.rc, -EINVAL);
		nc_done(&n);
	}
}

/* To the machine and back is where it was; no turn is no arithmetic. */
static void a_turn_has_its_inverse(void **state)
{
	(void)state;
	srand(1);
	for (int i = 0; i < 2000; i++) {
		const struct interp_turn t =
			interp_turn_of(i ? rand() % 7200 / 10.0 - 360 : 0,
				       false);
		double a[INTERP_NAXES], b[INTERP_NAXES];

		for (int k = 0; k < INTERP_NAXES; k++)
			a[k] = rand() % 400000 / 1000.0 - 200;
		interp_turn_to(&t, a, b);
		assert_true(i || memcmp(a, b, sizeof(a)) == 0);
		interp_turn_back(&t, b, b);
		for (int k = 0; k < INTERP_NAXES; k++)
			assert_true(fabs(a[k] - b[k]) < 1e-9);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_of_a_program_turns_about_the_origin),
		cmocka_unit_test(a_curve_turns_by_its_points),
		cmocka_unit_test(places_of_the_machine_stay_those_of_the_machine),
		cmocka_unit_test(g10_writes_and_turns),
		cmocka_unit_test(what_cannot_be_turned_is_refused),
		cmocka_unit_test(all_that_moved_goes_home),
		cmocka_unit_test(each_segment_knows_what_it_counts_from),
		cmocka_unit_test(each_pass_of_a_wire_knows_which_it_is),
		cmocka_unit_test(its_middle_stays_over_the_place_as_c_turns),
		cmocka_unit_test(a_table_does_not_turn_the_electrode),
		cmocka_unit_test(no_cut_turns_c_with_it),
		cmocka_unit_test(a_turn_has_its_inverse),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
