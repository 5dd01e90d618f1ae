/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_mcodes.c - M codes of the machine, from the text to the program
 */
#include "nc_read.h"

#include "interp/compile.h"

static const struct interp_mcode table[INTERP_NMCODES] = {
	[8]   = { INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP },
	[60]  = { INTERP_MCODE_BEFORE, INTERP_MCODE_SKIP },
	[61]  = { INTERP_MCODE_BEFORE, INTERP_MCODE_REDO },
	[70]  = { INTERP_MCODE_AFTER, INTERP_MCODE_STOP },
	[71]  = { INTERP_MCODE_AFTER, INTERP_MCODE_SKIP },
	[255] = { INTERP_MCODE_FREE, INTERP_MCODE_SKIP },
};

static struct nc_read read_in(const char *dialect, const char *text)
{
	struct nc_read n = nc_ready();

	n.dialect = interp_dialect_by_name(dialect);
	n.o.mcode = table;
	nc_read_bytes(&n, text, strlen(text));
	interp_build_destroy(n.build);
	n.build = NULL;
	return n;
}

static struct nc_read read_text(const char *text)
{
	return read_in("generic", text);
}

static void assert_mcode(const struct nc_read *n, uint32_t i, uint8_t number)
{
	const uint32_t arg = nc_seg(n, i)->arg;

	assert_int_equal(nc_seg(n, i)->kind, INTERP_MCODE);
	assert_true(interp_mcode_ok(arg));
	assert_int_equal(interp_mcode_number(arg), number);
	assert_int_equal(interp_mcode_sync(arg), table[number].sync);
	assert_int_equal(interp_mcode_back(arg), table[number].back);
}

static void a_code_stands_on_its_side_of_the_motion(void **state)
{
	struct nc_read n = read_text("G0 M70 X1 M60\nM255 X2\n");

	(void)state;
	assert_int_equal(n.rc, 0);
	assert_int_equal(nc_count(&n), 5);
	assert_mcode(&n, 0, 60);
	assert_int_equal(nc_seg(&n, 1)->kind, INTERP_LINE);
	assert_mcode(&n, 2, 70);
	assert_mcode(&n, 3, 255);
	assert_int_equal(nc_seg(&n, 4)->kind, INTERP_LINE);
	nc_done(&n);
}

static void a_code_alone_is_an_action(void **state)
{
	struct nc_read n = read_text("M61\nM071\n");

	(void)state;
	assert_int_equal(n.rc, 0);
	assert_int_equal(nc_count(&n), 2);
	assert_mcode(&n, 0, 61);
	assert_mcode(&n, 1, 71);
	nc_done(&n);
}

/* Whoever lists M60 in the machine file has a PLC that threads the wire; and
 * M8, that has the pump. */
static void a_code_is_the_plcs_in_all_dialects(void **state)
{
	static const char *const dialects[] = {
		"fanuc-wire", "makino", "mastercam-wire", "agievision",
		"charmilles-robofil-440", "linuxcnc", "heekscnc", "generic",
		"sodick-wire", "fanuc-sinker",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(dialects) / sizeof(dialects[0]); i++) {
		struct nc_read n = read_in(dialects[i], "M60\nM0\nM8\n");

		assert_int_equal(n.rc, 0);
		assert_int_equal(nc_count(&n), 3);
		assert_mcode(&n, 0, 60);
		assert_int_equal(nc_seg(&n, 1)->kind, INTERP_STOP);
		assert_mcode(&n, 2, 8);
		nc_done(&n);
	}
}

static void assert_refused(const char *text, uint32_t column,
			   const char *found, const char *wanted)
{
	struct nc_read n = read_text(text);

	assert_int_equal(n.rc, -EINVAL);
	assert_int_equal(n.diag.column, column);
	if (!strstr(n.diag.found, found) || !strstr(n.diag.wanted, wanted))
		fail_msg("%s: %s; %s", text, n.diag.found, n.diag.wanted);
	nc_done(&n);
}

static void what_is_not_in_the_table_is_refused(void **state)
{
	(void)state;
	assert_refused("M69", 1, "unknown word M69", "m_before");
	assert_refused("M256", 1, "unknown word M256", "m_free");
	assert_refused("G63", 1, "unknown word G63", "G120");
}

static void two_of_a_side_on_a_line_are_refused(void **state)
{
	(void)state;
	assert_refused("M60 M61", 5, "M61 on a line with M60", "modal group");
	assert_refused("M60 M255", 5, "M255 on a line with M60", "modal");
	assert_refused("M70 M71", 5, "M71 on a line with M70", "modal group");
}

static void without_a_table_there_are_none(void **state)
{
	struct nc_read n = nc_ready();

	(void)state;
	nc_read_bytes(&n, "M60", 3);
	assert_int_equal(n.rc, -EINVAL);
	nc_done(&n);
}

static void a_program_with_a_broken_code_is_not_walked(void **state)
{
	static const uint32_t broken[] = {
		0, 60, 60 | 4 << 8, 60 | 1 << 8 | 3 << 16,
		60 | 1 << 8 | 1 << 24, 1 << 8,
	};
	struct nc_read n = read_text("M60\n");
	struct interp_seg s = *nc_seg(&n, 0);

	(void)state;
	assert_true(interp_program_seg_ok(&n.p, 1, &s));
	for (size_t i = 0; i < sizeof(broken) / sizeof(broken[0]); i++) {
		s.arg = broken[i];
		assert_false(interp_program_seg_ok(&n.p, 1, &s));
	}
	nc_done(&n);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_code_stands_on_its_side_of_the_motion),
		cmocka_unit_test(a_code_alone_is_an_action),
		cmocka_unit_test(a_code_is_the_plcs_in_all_dialects),
		cmocka_unit_test(what_is_not_in_the_table_is_refused),
		cmocka_unit_test(two_of_a_side_on_a_line_are_refused),
		cmocka_unit_test(without_a_table_there_are_none),
		cmocka_unit_test(a_program_with_a_broken_code_is_not_walked),
	};

	return cmocka_run_group_tests_name("code/mcode", tests, NULL, NULL);
}
