/* SPDX-License-Identifier: Apache-2.0 */
/* test_nc_electrode.c - T words: what they shift, where they stop, the wear */
#include "nc_read.h"

#include "interp/compile.h"
#include "interp/cursor.h"
#include "interp/wear.h"

static const struct interp_electrode four[] = {
	{ 1, { 0, 0, 0 } }, { 2, { 0, 0, -0.125 } }, { 3, { 0, 0, 0.0304 } },
	{ 7, { 0, 0, -0.0996 } },
};

static struct interp_electrodes table = { .at = four, .n = 4 };

static struct nc_read read_with(const char *text, uint32_t held,
				uint32_t chosen)
{
	struct nc_read n = nc_ready();

	table.held = held;
	table.chosen = chosen;
	n.o.electrodes = &table;
	nc_read(&n, text);
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

static struct nc_read refused_with(const char *text)
{
	struct nc_read n = nc_ready();

	table.held = table.chosen = 0;
	n.o.electrodes = &table;
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, -EINVAL);
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

/* Every lattice point, one after the other. */
static size_t walk(const struct nc_read *n, int32_t (*to)[INTERP_NAXES],
		   size_t room)
{
	struct interp_cursor c;
	size_t k = 0;

	assert_int_equal(interp_cursor_init(&c, &n->p), 0);
	for (;;) {
		enum interp_step s;

		interp_cursor_aim(&c, 100);
		s = interp_cursor_step(&c);
		assert_int_not_equal(s, INTERP_BAD_SEGMENT);
		if (s == INTERP_AT_END)
			return k;
		if (s == INTERP_AT_ACTION)
			interp_cursor_pass(&c);
		if (s != INTERP_MOVED)
			continue;
		assert_true(k < room);
		memcpy(to[k++], c.pos, sizeof(c.pos));
	}
}

static const struct interp_seg *seg(const struct nc_read *n, uint32_t i)
{
	return &n->p.segs[i];
}

static double z_mm(const struct nc_read *n, uint32_t node)
{
	const uint32_t axes = n->p.head->naxes;

	for (uint32_t j = 0; j < axes; j++)
		if (n->p.head->column[j] == INTERP_Z)
			return (double)n->p.nodes[node * axes + j] /
			       INTERP_SUB * 0.001;
	fail();
	return 0;
}

/* -- What is shifted ------------------------------------------------------ */

#define WORK \
	"G0 Z5\nG0 X3 Y1\nG1 Z0 F60\nG1 X7.0005 Y2 Z-1.2345\n" \
	"G3 X7 Y4 I0 J1\nG2 X3 Y4 Z-2 R2.5\nG5 X5 Y1 I1 J1 P-1 Q1\n" \
	"G130 Z-3 R0.5 Q0.3\nG91 G1 Z-0.01\nG90 G1 Z-3.1\nG0 Z5\nM2\n"

#define ROOM	400000

static void every_lattice_point_is_moved_by_the_shift(void **state)
{
	static int32_t plain[ROOM][INTERP_NAXES], moved[ROOM][INTERP_NAXES];
	static const struct {
		uint32_t number;
		int32_t pulses;
	} cases[] = { { 2, -125 }, { 3, 30 }, { 7, -100 } };
	struct nc_read n = read_with(WORK, 1, 0);
	const size_t np = walk(&n, plain, ROOM);

	(void)state;
	nc_done(&n);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const int32_t d = cases[i].pulses;
		size_t nm;

		n = read_with(WORK, cases[i].number, 0);
		nm = walk(&n, moved, ROOM);
		nc_done(&n);
		/* The first motion leads to Z5, by so much more or less. */
		assert_int_equal((int64_t)nm - (int64_t)np, d);
		for (size_t k = 5000; k < np; k++) {
			plain[k][INTERP_Z] += d;
			assert_memory_equal(moved[(int64_t)k + d], plain[k],
					    sizeof(plain[k]));
			plain[k][INTERP_Z] -= d;
		}
	}
}

static void the_place_of_a_contact_holds_whatever_the_wear_was(void **state)
{
	static const char *const texts[] = {
		"G0 Z5\nG92 Z0\nG1 Z-1 F60\n",
		"G0 Z5\nG10 L20 P1 Z0\nG1 Z-1 F60\n",
		"G0 Z7\nG92 Z2\nG92 Z3\nG1 Z1 F60\n",
	};

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		struct nc_read a = read_with(texts[i], 1, 0);
		struct nc_read b = read_with(texts[i], 2, 0);
		const uint32_t last = a.p.head->nsegs;

		assert_int_equal(llround(1000 * z_mm(&b, last)),
				 llround(1000 * z_mm(&a, last)) - 125);
		/* Cut from the contact: 1 mm and 2 mm, with both. */
		assert_true(fabs(z_mm(&b, last - 2) - z_mm(&b, last) -
				 (i == 2 ? 2 : 1)) < 1e-6);
		nc_done(&a);
		nc_done(&b);
	}
}

static void machine_coordinates_and_distances_are_not_shifted(void **state)
{
	struct nc_read n = read_with("G53 G0 Z4\nG91 G0 Z1\nG90 G28 Z2\n",
				     2, 0);

	(void)state;
	assert_true(fabs(z_mm(&n, 3) - 4) < 1e-6);
	assert_true(fabs(z_mm(&n, 4) - 5) < 1e-6);
	assert_true(fabs(z_mm(&n, 5) - (2 - 0.125)) < 1e-6);
	assert_true(fabs(z_mm(&n, 6)) < 1e-6);
	nc_done(&n);
}

/* -- Where it stops ------------------------------------------------------- */

static uint32_t changes(const struct nc_read *n, uint32_t *to)
{
	uint32_t k = 0;

	for (uint32_t i = 0; i < n->p.head->nsegs; i++)
		if (seg(n, i)->kind == INTERP_ELECTRODE)
			to[k++] = seg(n, i)->arg;
	return k;
}

static void it_stops_for_another_electrode_and_for_no_other_reason(void **state)
{
	const uint32_t stop = INTERP_ELECTRODE_STOP;
	static const char text[] = "T1\nG0 Z5\nT1\nT2\nG0 Z4\nT2 M6\nG0 Z3\n"
				   "T0\nG0 Z2\n";
	struct nc_read n = read_with(text, 1, 0);
	uint32_t c[8];

	(void)state;
	assert_int_equal(changes(&n, c), 3);
	assert_int_equal(c[0], 1);
	assert_int_equal(c[1], stop | 2);
	assert_int_equal(c[2], stop | 0);
	assert_true(fabs(z_mm(&n, 3) - 5) < 1e-6);
	assert_true(fabs(z_mm(&n, 5) - 3.875) < 1e-6);
	assert_true(fabs(z_mm(&n, 6) - 2.875) < 1e-6);
	assert_true(fabs(z_mm(&n, 8) - 2) < 1e-6);
	nc_done(&n);
	/* With another one in the holder, and with another one chosen. */
	n = read_with(text, 3, 0);
	assert_int_equal(changes(&n, c), 4);
	assert_int_equal(c[0], 3);
	assert_int_equal(c[1], stop | 1);
	nc_done(&n);
	n = read_with("G0 Z5\n", 3, 2);
	assert_int_equal(changes(&n, c), 1);
	assert_int_equal(c[0], stop | 2);
	nc_done(&n);
	n = read_with("G0 Z5\n", 0, 0);
	assert_int_equal(changes(&n, c), 1);
	assert_int_equal(c[0], 0);
	nc_done(&n);
}

static struct nc_read read_in(const char *dialect, const char *text,
			      const struct interp_mcode *mcode)
{
	struct nc_read n = nc_ready();

	table.held = table.n ? 1 : 0;
	table.chosen = 0;
	n.o.electrodes = &table;
	n.o.mcode = mcode;
	n.dialect = interp_dialect_by_name(dialect);
	assert_non_null(n.dialect);
	nc_read(&n, text);
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

static void in_linuxcnc_t_names_it_and_m6_changes_it(void **state)
{
	struct nc_read n = read_in("linuxcnc", "T2\nG0 Z5\nM6\nT3\nG0 Z4\n"
				   "M6 T7\nG0 Z3\n", NULL);
	uint32_t c[8];

	(void)state;
	assert_int_equal(changes(&n, c), 3);
	assert_int_equal(c[1], INTERP_ELECTRODE_STOP | 2);
	assert_int_equal(c[2], INTERP_ELECTRODE_STOP | 7);
	assert_true(fabs(z_mm(&n, 3) - 5) < 1e-6);
	assert_true(fabs(z_mm(&n, 5) - 3.875) < 1e-6);
	assert_true(fabs(z_mm(&n, 7) - 2.9) < 1e-6);
	nc_done(&n);
}

static void a_plc_that_has_m6_changes_it_without_a_stop(void **state)
{
	static const char *const dialects[] = { "generic", "linuxcnc" };
	struct interp_mcode m[INTERP_NMCODES] = { 0 };
	uint32_t c[8];

	(void)state;
	m[6].sync = INTERP_MCODE_BEFORE;
	for (int i = 0; i < 2; i++) {
		struct nc_read n = read_in(dialects[i],
					   "T2\nG0 Z5\nM6\nG0 Z4\n", m);

		assert_int_equal(changes(&n, c), 2);
		assert_int_equal(c[1], 2);
		assert_int_equal(seg(&n, 3)->kind, INTERP_MCODE);
		assert_int_equal(seg(&n, 4)->kind, INTERP_ELECTRODE);
		assert_true(fabs(z_mm(&n, 3) - 5) < 1e-6);
		assert_true(fabs(z_mm(&n, 6) - 3.875) < 1e-6);
		nc_done(&n);
	}
}

static void what_is_not_in_the_table_is_refused_with_what_is(void **state)
{
	struct nc_read n = refused_with("G0 Z1\nT9\n");
	char many[2000] = "";

	(void)state;
	assert_int_equal(n.diag.line, 2);
	assert_int_equal(n.diag.column, 1);
	assert_non_null(strstr(n.diag.found, "electrode 9"));
	assert_non_null(strstr(n.diag.wanted, "T1 T2 T3 T7"));
	n = refused_with("T18446744073709551616\n");
	n = refused_with("G0 Z1 T10000\n");
	assert_non_null(strstr(n.diag.wanted, "T9999"));
	for (int i = 0; i < 64; i++)
		strcat(many, i % 2 ? "T1\n" : "T2\n");
	n = refused_with(many);
	assert_int_equal(n.diag.line, 64);
	assert_non_null(strstr(n.diag.found, "more than 63"));
	table.n = 0;
	n = refused_with("T1\n");
	assert_non_null(strstr(n.diag.wanted, "the table is empty"));
	/* The posts of mills have T words, which did nothing so far. */
	n = read_in("linuxcnc", "T1 M6\nG0 Z1\n", NULL);
	assert_int_equal(n.p.head->nsegs, 3);
	nc_done(&n);
	table.n = 4;
}

/* -- How it sits in the holder ------------------------------------------- */

static const struct interp_electrode seats[] = {
	{ 1, { 0.5, 0, 10, [INTERP_C] = 0 } },
	{ 2, { -0.25, 1, 20, [INTERP_C] = 0 } },
	{ 3, { -0.25, 1, 20, [INTERP_C] = 5 } },
};

static int read_seats(const char *text, struct nc_read *n)
{
	static struct interp_electrodes t = { .at = seats, .n = 3, .held = 1 };

	*n = nc_ready();
	n->o.electrodes = &t;
	nc_read_bytes(n, text, strlen(text));
	interp_build_destroy(n->build);
	n->build = NULL;
	return n->rc;
}

static void a_cut_waits_until_another_electrode_is_at_its_place(void **state)
{
	static const struct {
		const char *text, *wanted;	/* NULL: it is taken */
	} c[] = {
		{ "G0 X1 Y1 Z5\nT2\nG0 Z1\nG1 Z0 F5\n", "X Y before" },
		{ "G0 X1 Y1 Z5\nT2\nG0 X1\nG1 Z0 F5\n", "X Y before" },
		{ "G0 X1 Y1 Z5\nT2\nG91 G0 X1 Y1\nG1 Z-1 F5\n", "G90" },
		{ "G0 X1 Y1 Z5\nT2\nG53 G0 X1 Y1\nG1 Z0 F5\n", "X Y before" },
		{ "G0 X1 Y1 Z5\nT2\nG1 X1 Y1 F5\n", NULL },
		{ "G0 X1 Y1 Z5\nT2\nG0 X1 Y1\nG91 G1 Z-1 F5\n", NULL },
		{ "G0 X1 Y1 Z5\nT2\nG92 X0 Y0\nG1 Z0 F5\n", NULL },
		{ "G0 X1 Y1 Z5\nT2\nG10 L20 P1 X0 Y0\nG1 Z0 F5\n", NULL },
		{ "G0 X1 Y1 Z5\nT3\nG0 X1 Y1\nG1 Z0 F5\n", "and C" },
		{ "G0 X1 Y1 Z5\nT2\nG0 X1 Y1\nT3\nG1 Z0 F5\n", "and C" },
		{ "G0 X1 Y1 Z5\nT3\nG0 X1 Y1 C0\nG1 Z0 F5\n", NULL },
		{ "G1 Z0 F5\n", NULL },	/* it stands where it stands */
	};

	(void)state;
	for (size_t i = 0; i < sizeof(c) / sizeof(c[0]); i++) {
		struct nc_read n;
		const int rc = read_seats(c[i].text, &n);

		if (rc != (c[i].wanted ? -EINVAL : 0) ||
		    (c[i].wanted && !strstr(n.diag.wanted, c[i].wanted)))
			fail_msg("%s: %d %s; %s", c[i].text, rc, n.diag.found,
				 n.diag.wanted);
		if (rc == 0)
			nc_done(&n);
	}
}

static void its_middle_comes_to_the_place_of_the_one_before(void **state)
{
	struct nc_read n;
	int64_t first[2];

	(void)state;
	assert_int_equal(read_seats("G0 X7 Y2\nT2\nG0 X7 Y2\nM2\n", &n), 0);
	for (int i = 0; i < 2; i++)
		first[i] = n.p.nodes[3 * n.p.head->naxes + (uint32_t)i];
	/* From 0.5 0 to -0.25 1. */
	assert_int_equal(n.p.nodes[5 * n.p.head->naxes] - first[0],
			 -750 * INTERP_SUB);
	assert_int_equal(n.p.nodes[5 * n.p.head->naxes + 1] - first[1],
			 1000 * INTERP_SUB);
	nc_done(&n);
}

static void a_turn_of_the_electrode_needs_a_c_that_turns_it(void **state)
{
	static const struct interp_kinematics table_c = {
		.njoints = 1, .joint[0].axis = INTERP_C,
	};
	static struct interp_electrodes t = { .at = seats, .n = 3, .held = 2 };
	struct nc_read n = nc_ready();
	const char *text = "G0 X1\nT3\n";

	(void)state;
	n.o.electrodes = &t;
	n.o.kinematics = &table_c;
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, -EINVAL);
	assert_non_null(strstr(n.diag.found, "C does not turn it"));
	interp_build_destroy(n.build);
}

/* -- The wear ------------------------------------------------------------- */

static void wear_is_the_ratio_times_the_way_down(void **state)
{
	static const char tech[] = "condition, wear\nC100, 0.1\nC200, 0.01\n"
				   "C300, -\n";
	struct nc_read n = nc_ready();
	struct interp_tech_table *t = NULL;
	struct interp_diag d;
	struct interp_wear w;

	(void)state;
	assert_int_equal(interp_tech_read(&t, tech, strlen(tech), &d), 0);
	n.o.tech = t;
	n.o.electrodes = &table;
	table.held = 1;
	table.chosen = 0;
	/* path:   5 rapid   1 at 0.1   2 sideways   1 at 0.01   1 up
	 *	   2 unknown   1 without power */
	nc_read(&n, "G0 Z5\nC100 G1 Z4 F60\nX2\nT2\nC200 G1 Z2.875\n"
		    "G91 Z1\nC300 Z-2\nM5 Z-1\nM2\n");
	assert_int_equal(interp_wear_measure(&w, &n.p), 0);
	assert_int_equal(w.nchanges, 2);
	assert_int_equal(w.change[0].number, 1);
	assert_false(w.change[0].stops);
	assert_int_equal(w.change[1].number, 2);
	assert_true(w.change[1].stops);
	assert_true(fabs(w.change[1].s_mm - 8) < 1e-9);
	assert_true(interp_wear_at(&w, -1).wear_mm == 0);
	assert_true(interp_wear_at(&w, 5).wear_mm == 0);
	assert_true(fabs(interp_wear_at(&w, 5.5).wear_mm - 0.05) < 1e-9);
	assert_true(fabs(interp_wear_at(&w, 6).wear_mm - 0.1) < 1e-9);
	assert_true(fabs(interp_wear_at(&w, 8).wear_mm - 0.1) < 1e-9);
	/* T2 is 0.125 mm shorter: 1.25 mm down. */
	assert_true(fabs(interp_wear_at(&w, 9.25).wear_mm - 0.1125) < 1e-9);
	assert_true(fabs(interp_wear_at(&w, 99).wear_mm - 0.1125) < 1e-9);
	assert_true(interp_wear_at(&w, 10.25).unknown_mm < 1e-9);
	assert_true(fabs(interp_wear_at(&w, 99).unknown_mm - 2) < 1e-9);
	interp_wear_free(&w);
	interp_build_destroy(n.build);
	n.build = NULL;
	nc_done(&n);
	interp_tech_table_destroy(t);
}

#define T(f)	cmocka_unit_test(f)

int main(void)
{
	const struct CMUnitTest tests[] = {
		T(every_lattice_point_is_moved_by_the_shift),
		T(the_place_of_a_contact_holds_whatever_the_wear_was),
		T(machine_coordinates_and_distances_are_not_shifted),
		T(it_stops_for_another_electrode_and_for_no_other_reason),
		T(in_linuxcnc_t_names_it_and_m6_changes_it),
		T(a_plc_that_has_m6_changes_it_without_a_stop),
		T(what_is_not_in_the_table_is_refused_with_what_is),
		T(a_cut_waits_until_another_electrode_is_at_its_place),
		T(its_middle_comes_to_the_place_of_the_one_before),
		T(a_turn_of_the_electrode_needs_a_c_that_turns_it),
		T(wear_is_the_ratio_times_the_way_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
