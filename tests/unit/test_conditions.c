/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_conditions.c - conditions of a technology table in NC code
 */
#include "compile_help.h"

static const char table[] =
	"condition, servo_v, on_us, gap_mm, allowance_mm\n"
	"C120, 15, 40, 0.06, 0.1\nC110, 18, 20, 0.04, 0.05\n"
	"C100, 20, 8, 0.02, 0\nE001, 12, 5, -, -\n"
	"sequence Q1 = C120 C110 C100\nsequence Q7 = C110\n"
	"inline E = - on_us - servo_v*0.5\ninline S = - servo_v\n";

struct shop {
	struct compiled c;
	struct interp_tech_table *t;
	struct interp_tech machine;
};

static void shop_open(struct shop *s, const char *dialect)
{
	struct interp_diag d;

	s->c = compile_ready(dialect);
	s->t = NULL;
	assert_int_equal(interp_tech_read(&s->t, table, strlen(table), &d), 0);
	interp_tech_clear(&s->machine);
	s->machine.v[INTERP_TECH_SHORT_V] = 8;
	s->machine.v[INTERP_TECH_OPEN_V] = 60;
	s->c.o.nc.tech = s->t;
	s->c.o.nc.machine_tech = &s->machine;
	s->c.o.nc.feed_mm_s = 1;
}

static void shop_close(struct shop *s)
{
	interp_tech_table_destroy(s->t);
}

static double value(const struct shop *s, uint32_t seg, enum interp_tech_id id)
{
	const uint16_t i = compiled_seg(&s->c, seg)->cond;

	return s->c.p.conds[i].tech.v[id];
}

static uint32_t number(const struct shop *s, uint32_t seg)
{
	return s->c.p.conds[compiled_seg(&s->c, seg)->cond].number;
}

static void refuse(struct shop *s, const char *text, uint32_t line,
		   uint32_t column, const char *found)
{
	compile_bytes(&s->c, text, strlen(text));
	assert_refused(&s->c, line, column, found);
}

static void the_program_carries_what_the_table_gives(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "generic");
	compile(&s.c, "G1 X1 F60\nC120 X2\nE1 X3\nC120 X4\nM2\n");
	assert_true(isnan(value(&s, 0, INTERP_TECH_SERVO_V)));
	assert_true(value(&s, 1, INTERP_TECH_SERVO_V) == 15);
	assert_true(value(&s, 2, INTERP_TECH_SERVO_V) == 12);
	assert_true(isnan(value(&s, 2, INTERP_TECH_GAP_MM)));
	assert_int_equal(compiled_seg(&s.c, 1)->cond,
			 compiled_seg(&s.c, 3)->cond);
	assert_int_equal(s.c.p.head->nconds, 3);
	compile_done(&s.c);
	shop_close(&s);
}

static void a_condition_that_is_not_there_is_refused_with_the_nearest(void **st)
{
	struct shop s;

	(void)st;
	shop_open(&s, "generic");
	refuse(&s, "G1 X1 F60\nX2 C115\nM2\n", 2, 4,
	       "C115, which is not in the technology table");
	assert_non_null(strstr(s.c.diag.wanted, "C100, C110, C120"));
	refuse(&s, "E002 G1 X1 F60\n", 1, 1, "E002");
	/* Without a table it is taken as it comes. */
	s.c.o.nc.tech = NULL;
	compile(&s.c, "G1 X1 F60\nX2 C115\nM2\n");
	assert_int_equal(number(&s, 1), 115);
	assert_true(isnan(value(&s, 1, INTERP_TECH_SERVO_V)));
	compile_done(&s.c);
	shop_close(&s);
}

static void a_sequence_sinks_rough_to_fine_and_ends_at_the_end(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "generic");
	compile(&s.c, "G0 Z1\nF6\nG120 P1 Z-9\nG1 Z-9.5\nM2\n");
	assert_int_equal(compiled_count(&s.c), 5);
	/* 0.1 allowance, 0.06 - 0.02 gap; 0.05, 0.04 - 0.02; 0. */
	assert_near(compiled_end(&s.c, 1, INTERP_Z), -8.86);
	assert_near(compiled_end(&s.c, 2, INTERP_Z), -8.93);
	assert_near(compiled_end(&s.c, 3, INTERP_Z), -9);
	assert_int_equal(number(&s, 1), 120);
	assert_int_equal(number(&s, 2), 110);
	assert_int_equal(number(&s, 3), 100);
	/* What came last stays in force. */
	assert_int_equal(number(&s, 4), 100);
	assert_near(compiled_seg(&s.c, 1)->feed_mm_s, 0.1);
	compile_done(&s.c);
	shop_close(&s);
}

static void a_sequence_goes_obliquely_and_skips_what_has_no_way(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "generic");
	compile(&s.c, "G91 G120 P1 X-0.06 Z-0.08 F6\nM2\n");
	/* A way of 0.1: C120 stops 0.14 before its end, so it has none. */
	assert_int_equal(compiled_count(&s.c), 2);
	assert_int_equal(number(&s, 0), 110);
	assert_near(compiled_end(&s.c, 0, INTERP_X), -0.018);
	assert_near(compiled_end(&s.c, 0, INTERP_Z), -0.024);
	assert_near(compiled_end(&s.c, 1, INTERP_X), -0.06);
	assert_near(compiled_end(&s.c, 1, INTERP_Z), -0.08);
	compile_done(&s.c);
	shop_close(&s);
}

static void a_sequence_that_cannot_be_is_refused_at_its_place(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "generic");
	refuse(&s, "G120 Z-1\n", 1, 1, "G120 without P");
	refuse(&s, "G120 P2 Z-1\n", 1, 6, "G120 with P2");
	refuse(&s, "G120 P1.5 Z-1\n", 1, 6, "G120 with P1.5");
	refuse(&s, "G120 P1 Z0\n", 1, 1, "without a way");
	refuse(&s, "G120 P1\n", 1, 1, "without a way");
	refuse(&s, "G1 G120 P1 Z-1 F1\n", 1, 4, "a motion word");
	refuse(&s, "G120 P1 Z-999\n", 1, 9, "beyond the travel");
	s.c.o.nc.feed_mm_s = 0;
	refuse(&s, "G120 P1 Z-1\n", 1, 1, "no feed given yet");
	s.c.o.nc.tech = NULL;
	refuse(&s, "G120 P1 Z-1 F1\n", 1, 1, "without a technology table");
	shop_close(&s);
}

static void a_definition_means_what_the_inline_line_says(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "skd2");
	compile(&s.c, "E001= 060 020 9 30\nE001\nG01 X1.\n"
		"E001= 060 021 9 30\nG01 X2.\nE001\nG01 X3.\nM02\n");
	assert_true(value(&s, 0, INTERP_TECH_ON_US) == 20);
	assert_true(value(&s, 0, INTERP_TECH_SERVO_V) == 15);
	/* Called again, not before, it has its new values. */
	assert_true(value(&s, 1, INTERP_TECH_ON_US) == 20);
	assert_true(value(&s, 2, INTERP_TECH_ON_US) == 21);
	compile_done(&s.c);
	/* What the columns do not give, the table's row does. */
	s.t->inlined[1].column[3].id = -1;
	compile(&s.c, "E001= 060 020 9 30\nE001\nG01 X1.\nM02\n");
	assert_true(value(&s, 0, INTERP_TECH_ON_US) == 20);
	assert_true(value(&s, 0, INTERP_TECH_SERVO_V) == 12);
	compile_done(&s.c);
	shop_close(&s);

	shop_open(&s, "chmer");
	compile(&s.c, "SC0100= 1 40\nS100 G01 X1.\nM02\n");
	assert_true(value(&s, 0, INTERP_TECH_SERVO_V) == 40);
	compile_done(&s.c);
	shop_close(&s);
}

static void a_definition_that_cannot_be_is_refused_at_its_place(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, "skd2");
	refuse(&s, "E001= 060 020 9\nM02\n", 1, 1, "of 3 numbers, not 4");
	refuse(&s, "E001= 060 020 9 9 9\nM02\n", 1, 1, "of 5 numbers, not 4");
	refuse(&s, "E001= 060 0 9 30\nM02\n", 1, 11, "on_us 0");
	refuse(&s, "E001= 060 1 9 14\nM02\n", 1, 1, "short_v 8 V of the "
	       "machine is not below servo_v 7");
	/* Defined is enough to be called; neither is not. */
	compile(&s.c, "E009= 60 1 1 30\nE009\nG01 X1.\nM02\n");
	compile_done(&s.c);
	refuse(&s, "E008\nG01 X1.\nM02\n", 1, 1, "E008");
	shop_close(&s);
}

static void so_many_definitions_end_somewhere(void **state)
{
	static char text[300 * 24 + 64];
	struct shop s;
	size_t n = 0;

	(void)state;
	shop_open(&s, "skd2");
	for (int i = 0; i < 300; i++)
		n += (size_t)snprintf(text + n, sizeof(text) - n,
				      "E%d= 1 %d 1 30\n", i, i + 1);
	refuse(&s, text, 257, 1, "a definition too many");
	shop_close(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_program_carries_what_the_table_gives),
		cmocka_unit_test(a_condition_that_is_not_there_is_refused_with_the_nearest),
		cmocka_unit_test(a_sequence_sinks_rough_to_fine_and_ends_at_the_end),
		cmocka_unit_test(a_sequence_goes_obliquely_and_skips_what_has_no_way),
		cmocka_unit_test(a_sequence_that_cannot_be_is_refused_at_its_place),
		cmocka_unit_test(a_definition_means_what_the_inline_line_says),
		cmocka_unit_test(a_definition_that_cannot_be_is_refused_at_its_place),
		cmocka_unit_test(so_many_definitions_end_somewhere),
	};

	return cmocka_run_group_tests_name("conditions", tests, NULL, NULL);
}
