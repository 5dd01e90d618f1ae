/* SPDX-License-Identifier: Apache-2.0 */
/* test_threeb_refusals.c - which 3B and 4B is refused, and where */
#include "compile_help.h"

static const struct bad {
	const char *text;
	uint32_t line, column;
	const char *found;
} bads[] = {
	{ "9900 B0 B9900 GX L1", 1, 1, "9900 where a B should be" },
	{ "BBB5GXL1\nB9900 0 B9900 GX L1", 2, 7, "0 where a B should be" },
	{ "B9900 B0 9900 GX L1", 1, 10, "9900 where a B should be" },
	{ "B9900 B0 GX L1", 1, 10, "GX where a B should be" },
	{ "N7: 9900 B0 B9900 GX L1", 1, 5, "9900 where a B should be" },
	{ "BBB5GXL1 9900 B0 B9900 GX L1", 1, 10, "9900 where a B" },
	{ "X9900 B0 B9900 GX L1", 1, 1, "X9900 where a B" },
	{ "B9900 B0 B9900", 1, 15, "the end of the line where the counting" },
	{ "B9900 B0 B9900 L1", 1, 16, "L1 where the counting direction" },
	{ "B9900 B0 B9900 GZ L1", 1, 16, "GZ where the counting direction" },
	{ "B9900 B0 B9900 GX", 1, 18, "the end of the line where the instr" },
	{ "B9900 B0 B9900 GX L5", 1, 19, "L5 where the instruction" },
	{ "B9900 B0 B9900 GX L12", 1, 19, "L12 where the instruction" },
	{ "B9900 B0 B9900 GX NL1", 1, 19, "NL1 where the instruction" },
	{ "B9900 B0 B9900 GX R1", 1, 19, "R1 where the instruction" },
	{ "B-9900 B0 B9900 GX L1", 1, 2, "-9900" },
	{ "B9.9 B0 B9900 GX L1", 1, 2, "9.9" },
	{ "B99 B0 B9900000000 GX L1", 1, 9, "a number of 9900000000" },
	{ "B100 B0 B100 GY L1", 1, 10, "J 100, which no end point fits" },
	{ "B0 B100 B100 GX L1", 1, 10, "J 100, which no end point fits" },
	{ "B100 B50 B0 GX L1", 1, 11, "J 0, which no end point fits" },
	{ "B100 B50 B GX L1", 1, 12, "J 0, which no end point fits" },
	{ "B1000 B0 B4005 GY NR1", 1, 11, "J 4005, which no end point" },
	{ "B1000 B0 B0 GY NR1", 1, 11, "J 0, which no end point fits" },
	{ "\nB0 B0 B400 GY NR1", 2, 1, "an arc of radius 0" },
	{ "BBB5GXL1\nDD\nBBB5GXL1", 3, 1, "a record behind the end" },
	{ "BBB5GXL1\nrubbish", 2, 1, "rubbish" },
	{ "BBB5GXL1\n\n  XX9", 3, 3, "XX9" },
	{ "BBB5GXL1 and BBB5GXL1", 1, 10, "and where a B should be" },
	{ "+BBB5GXL1", 1, 1, "+BBB5GXL1 where a B should be" },
	{ "BBB5GXL1\r\nBBB250000GXL1", 2, 1, "X 250.0050 is beyond" },
	{ "", 1, 1, "empty program" },
	{ "DD\n", 1, 1, "empty program" },
	{ "; nothing\n", 1, 1, "empty program" },
};

static const struct bad bads_4b[] = {
	{ "B0 B5000 B10000 GX NR4", 1, 17, "GX where a B should be" },
	{ "B0 B5000 B10000 B5000 GX NR4", 1, 18, "an arc that is neither" },
	{ "B0 B5000 B10000 B4000 D GX NR4", 1, 18, "R 4000, where X and Y" },
	{ "B100 B0 B100 B0 D GX L1", 1, 15, "a radius on a line" },
	{ "B100 B0 B100 B7 GX L1", 1, 15, "a radius on a line" },
	{ "B0 B90 B180 B90 DD GX NR4", 1, 14, "an offset of 100 units insid" },
};

static void refuse_all(const char *dialect, const struct bad *b, size_t n)
{
	for (; n-- > 0; b++) {
		struct compiled c = compile_ready(dialect);

		c.o.threeb.offset_um = 100;
		compile_bytes(&c, b->text, strlen(b->text));
		if (c.rc != -EINVAL || c.diag.line != b->line ||
		    c.diag.column != b->column || !c.diag.wanted[0] ||
		    !strstr(c.diag.found, b->found))
			fail_msg("'%s': %d %u:%u: %s; %s", b->text, c.rc,
				 c.diag.line, c.diag.column, c.diag.found,
				 c.diag.wanted);
		compile_done(&c);
	}
}

static void bad_input_is_refused_at_its_place(void **state)
{
	(void)state;
	refuse_all("3b", bads, sizeof(bads) / sizeof(bads[0]));
	refuse_all("4b", bads_4b, sizeof(bads_4b) / sizeof(bads_4b[0]));
}

static void a_nul_is_refused_at_its_place(void **state)
{
	static const char text[] = "BBB5GXL1\r\n; a\0comment\n";
	struct compiled c = compile_ready("3b");

	(void)state;
	compile_bytes(&c, text, sizeof(text) - 1);
	assert_refused(&c, 2, 4, "byte 0x00");
	compile_done(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bad_input_is_refused_at_its_place),
		cmocka_unit_test(a_nul_is_refused_at_its_place),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
