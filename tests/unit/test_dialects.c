/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_dialects.c - the dialects of wire machines, with small programs in each
 */
#include "compile_help.h"


static const char robofil[] =
	"%\r\nN10 G92 X1.0 Y0\r\nN20 G60\r\nN30 G38\r\nN40 G90\r\nN50 G40\r\n"
	"N60 G0 X-7.500 Y4.000\r\nN70 G1 X-4.500 Y4.000\r\n"
	"N80 G3 X-10.500 Y4.000 I-7.500 J4.000\r\n"
	"N90 G3 X-4.500 Y4.000 I-7.500 J4.000\r\nN100 G39\r\nN110 M00\r\n"
	"N120 G40\r\nN130 M02\r\n%\r\n";

static void robofil_has_centres_as_places(void **state)
{
	struct compiled c = compile_ready("robofil");

	(void)state;
	compile(&c, robofil);
	assert_int_equal(compiled_count(&c), 5);
	assert_near(compiled_end(&c, 0, INTERP_X), -8.5);
	assert_near(compiled_arc(&c, 2)->a_mm, -8.5);
	assert_near(compiled_arc(&c, 2)->r_mm, 3);
	assert_near(compiled_end(&c, 3, INTERP_X), -5.5);
	assert_int_equal(compiled_seg(&c, 4)->kind, INTERP_STOP);
	compile_done(&c);
}

/* As the post of a Robofil 440 writes it. */
static const char robofil_440[] =
	"%\nO1234\nG21\nG90\nM15 P0\nM24\nM28\nG92 X0.000 Y0.000\n/M60\n"
	"D0 S5\nG01 X5.000 Y0.000\nG03 X7.000 Y2.000 I0.000 J2.000\n"
	"/0 M00\n/M50\nM99\n%\n";

static void robofil_440_has_centres_from_the_start(void **state)
{
	struct compiled c = compile_ready("charmilles-robofil-440");

	(void)state;
	compile(&c, robofil_440);
	assert_int_equal(compiled_count(&c), 2);
	assert_near(compiled_end(&c, 0, INTERP_X), 5);
	assert_near(compiled_arc(&c, 1)->b_mm, 2);
	assert_near(compiled_arc(&c, 1)->r_mm, 2);
	assert_int_equal(c.p.conds[compiled_seg(&c, 0)->cond].letter, 'S');
	compile_done(&c);
}

/* As the post of a Makino U32K writes it; M6 and M7 are the wire. */
static void makino_threads_by_m6(void **state)
{
	struct compiled c = compile_ready("makino");

	(void)state;
	compile(&c, "N10 O0001 (MAKINO_U32K)\nN20 G00 G90\nN40 M06\n"
		"N50 M17\nN60 G01 X.3543 Y0.0\nN330 M07\nN1080 M30\n");
	assert_int_equal(compiled_count(&c), 3);
	assert_int_equal(compiled_seg(&c, 0)->kind, INTERP_STOP);
	assert_int_equal(compiled_seg(&c, 2)->kind, INTERP_STOP);
	compile_done(&c);
}

static const char skd2[] =
	"(MATERIAL: STEEL 20 mm)\n( W_Sp I_Max Pul_On P_Ratio Voltage)\n"
	"E001=   060    006    020    005    001    000    050\n"
	"E002=   040    003    010    005    001    000    080\n"
	"H001=0.000  H002=0\n   \n; Number : 1\nG92X1000Y0\nG90\n"
	"H001\nE001\nM98 P0001\nM00\n\nH002\nE002\nM98 P0001\nM00\n"
	"G01X1000Y0\nM02\n\nN0001\nG01X2000Y500\nG41\n"
	"G02X4000Y500I1000J0\nG50\nG40\nG01X1000Y0\nM99\n";

/* A table that says of the columns of definitions that they are not used. */
static struct compiled ready_with_columns(const char *dialect)
{
	static const char text[] =
		"condition, servo_v\nC999, 20\n"
		"inline C = - - - - - - - - - - -\ninline E = - - - - - - -\n"
		"inline S = - - - - - - - - - - - - -\n";
	static struct interp_tech_table *t;
	struct compiled c = compile_ready(dialect);
	struct interp_diag d;

	if (!t)
		assert_int_equal(interp_tech_read(&t, text, sizeof(text) - 1,
						  &d), 0);
	c.o.nc.tech = t;
	return c;
}

static void skd2_counts_micrometres_and_calls_by_n(void **state)
{
	struct compiled c = ready_with_columns("skd2");

	(void)state;
	compile(&c, skd2);
	assert_int_equal(compiled_count(&c), 8);
	assert_near(compiled_end(&c, 0, INTERP_X), 1);
	assert_near(compiled_end(&c, 0, INTERP_Y), .5);
	assert_near(compiled_arc(&c, 1)->r_mm, 1);
	assert_near(compiled_end(&c, 2, INTERP_X), 0);
	assert_int_equal(compiled_seg(&c, 3)->kind, INTERP_STOP);
	assert_int_equal(c.p.conds[compiled_seg(&c, 1)->cond].number, 1);
	assert_int_equal(c.p.conds[compiled_seg(&c, 5)->cond].number, 2);
	assert_int_equal(c.p.conds[compiled_seg(&c, 5)->cond].letter, 'E');
	compile_done(&c);

	c = compile_ready("skd2");
	compile(&c, "G01X1.5Y-1500\nM02\n");
	assert_near(compiled_end(&c, 0, INTERP_X), 1.5);
	assert_near(compiled_end(&c, 0, INTERP_Y), -1.5);
	compile_done(&c);
}

static const char sodick[] =
	"(PUNCH);\nC001= 010 015 2215 000 240 030 8 2 0 055 000;\n"
	"H000= 0.0;\nG54;\nG90;\nG92 X0 Y0;\nT84;\nT80;\nC001;\nH000;\n"
	"M98 P0010;\nT85;\nM02;\nN0010;\nG41 G01 X5.0;\n"
	"G03 X5.0 Y4.0 I0 J2.0;\nG40 G01 X0 Y0 (BACK);\nM99;\n";

static void sodick_ends_blocks_by_semicolons(void **state)
{
	struct compiled c = ready_with_columns("sodick");

	(void)state;
	compile(&c, sodick);
	assert_int_equal(compiled_count(&c), 5);
	assert_int_equal(compiled_seg(&c, 0)->arg, INTERP_AUX_PUMP_ON);
	assert_near(compiled_end(&c, 1, INTERP_X), 5);
	assert_near(compiled_arc(&c, 2)->sweep, M_PI);
	assert_int_equal(c.p.conds[compiled_seg(&c, 2)->cond].letter, 'C');
	compile_done(&c);
}

static const char chmer[] =
	"(TEST)\n;SC****= OV PW ON OFF AN AFF SV FR WF WT WL FM F\n"
	"SC0100= 004 010 005 0008 002 0010 040 015 008 009 006 000 0.0000\n"
	"H011=0.000\nG90 G54\nG0 X0.635 Y-0.635\nS100 H011\n"
	"G01 G41 X0.0 Y0.0\nX-25.4\nG40 X-26.035 Y-0.635\nM02\n";

static void chmer_calls_conditions_by_s(void **state)
{
	struct compiled c = ready_with_columns("chmer");

	(void)state;
	compile(&c, chmer);
	assert_int_equal(compiled_count(&c), 4);
	assert_near(compiled_end(&c, 3, INTERP_X), -26.035);
	assert_int_equal(c.p.conds[compiled_seg(&c, 0)->cond].letter, 0);
	assert_int_equal(c.p.conds[compiled_seg(&c, 1)->cond].letter, 'S');
	assert_int_equal(c.p.conds[compiled_seg(&c, 1)->cond].number, 100);
	compile_done(&c);
}

static void a_wire_program_needs_no_feed(void **state)
{
	static const char *const names[] = { "robofil", "skd2", "sodick",
					     "chmer" };

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		struct compiled c = compile_ready(names[i]);

		c.machine.axis[INTERP_X].v_max_mm_s = 8;
		compile(&c, "G01 X1.0\nX2.0 F60\nM02");
		assert_near(compiled_seg(&c, 0)->feed_mm_s, 8);
		assert_near(compiled_seg(&c, 1)->feed_mm_s, 1);
		compile_done(&c);
	}
}

static void taper_and_offset_that_are_none_are_taken(void **state)
{
	struct compiled c = compile_ready("chmer");

	(void)state;
	compile(&c, "H1=0 H2=0.0\nG50 G40\nG51 A0\nG01 X1.0\nG52 A0.0\nH1\n"
		"G42 X2.0\nH2\nX3.0\nM30\n");
	assert_int_equal(compiled_count(&c), 3);
	compile_done(&c);
}

/* As the post of Fusion for AgieVision writes it. */
static const char agie[] =
	"N100 G70 ;\n\nN110 G00 X1.0 Y0.5 ;\nN120 G90 ;\n"
	"N130 G01 X2.0 Y0.5 ;\nN140 G03 X2.0 Y1.5 I0.0 J0.5 ;\nN150 M02 ;\n";

static void agie_counts_inches_by_g70(void **state)
{
	struct compiled c = compile_ready("agie");

	(void)state;
	compile(&c, agie);
	assert_int_equal(compiled_count(&c), 3);
	assert_near(compiled_end(&c, 0, INTERP_X), 25.4);
	assert_near(compiled_end(&c, 1, INTERP_X), 50.8);
	assert_near(compiled_arc(&c, 2)->r_mm, 12.7);
	compile_done(&c);
}

/* The places on their lines must not become motions. */
static void an_ignored_word_takes_its_letters_with_it(void **state)
{
	static const char *const texts[][2] = {
		{ "fanuc-sinker", "G1 X5. F10\nG50.1 X0 Y0\n"
		  "G22 X9. Y9. Z9. I1. J1. K1.\nM30" },
		{ "makino", "G1 X5.\nG22 X9. Y9. I1. J1.\nM30" },
		{ "mastercam-wire", "G1 X5.\nG28 X9. Y9.\nM30" },
	};

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		struct compiled c = compile_ready(texts[i][0]);

		compile(&c, texts[i][1]);
		assert_int_equal(compiled_count(&c), 1);
		compile_done(&c);
	}
}

static void g91_moves_an_origin_in_fanuc_and_not_in_linuxcnc(void **state)
{
	static const struct {
		const char *dialect;
		double x_mm;
	} each[] = { { "generic", 10 }, { "fanuc-sinker", 10 },
		     { "linuxcnc", 5 }, { "heekscnc", 5 } };

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		struct compiled c = compile_ready(each[i].dialect);

		compile(&c, "G91\nG10 L2 P1 X5.\nG10 L2 P1 X5.\nG90\n"
			"G0 X0\nM30");
		assert_near(compiled_end(&c, 0, INTERP_X), each[i].x_mm);
		compile_done(&c);
	}
}

/* As rs274 has it; G92 in force on an axis is the one thing that differs from
 * Fanuc. */
static void g52_shifts_all_work_offsets(void **state)
{
	static const char *const names[] = { "fanuc-sinker", "linuxcnc" };

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct compiled c = compile_ready(names[i]);

		compile(&c, "G10 L2 P2 Y2.\nG52 X5. Y0 Z0\nG0 X1.\n"
			"G55 G0 Y1.\nG53 G0 X3.\nG92 X1.\nG0 X2.\n"
			"G92.1\nG52 X-1.\nG0 X1.\nG52 X0\nG0 X1.\nM30");
		assert_near(compiled_end(&c, 0, INTERP_X), 6);
		assert_near(compiled_end(&c, 1, INTERP_Y), 3);
		assert_near(compiled_end(&c, 2, INTERP_X), 3);
		assert_near(compiled_end(&c, 3, INTERP_X), 4);
		assert_near(compiled_end(&c, 4, INTERP_X), 0);
		assert_near(compiled_end(&c, 5, INTERP_X), 1);
		compile_done(&c);
	}
}

static const struct bad {
	const char *dialect, *text;
	uint32_t line, column;
	const char *found;
} bads[] = {
	{ "robofil", "G21\nM02", 1, 1, "G21: a Robofil rejects it" },
	{ "robofil", "G17\nM02", 1, 1, "G17: a Robofil rejects it" },
	{ "robofil", "G90 G54\nM02", 1, 5, "G54: a Robofil rejects it" },
	{ "robofil", "G1 X1.0\nM30", 2, 1, "M30: a Robofil rejects it" },
	{ "robofil", "G1 X1.0\n", 1, 1, "the end of the text without M02" },
	{ "robofil", "G1 X10\nM02", 1, 4, "X10 without a decimal point" },
	{ "robofil", "G41 D0\nM02", 1, 1,
	  "an offset by register 0, which is not defined" },
	{ "robofil", "G3 X1.0 I.5\nM02", 1, 1, "half a centre" },
	{ "robofil", "G1 X1. U1.\nM02", 1, 8, "U1. on a machine without" },
	{ "robofil", "E001\nM02", 1, 1, "unknown word E001" },
	{ "robofil-440", "G2 X2. I1. K0. L0.\nM02", 1, 12, "K0.: no program" },
	{ "robofil", "G91\nG3 X1. I0. J.5\nM02", 2, 1, "an arc under G91" },
	{ "robofil-440", "M98 P1\nM02", 1, 1, "M98: M99 ends a program" },
	{ "makino", "G53\nM02", 1, 1, "G53: machine coordinates" },
	{ "agievision", "G1 X10\nG29 X20\nM02", 2, 5, "X20 beside G29" },
	{ "sodick", "G29 X1.\nM02", 1, 5, "X1. beside G29" },
	{ "linuxcnc", "G0 X5\nG43.1 Z5\nM2", 2, 1, "G43.1: a length by" },
	{ "fanuc-sinker", "G0 C90\nM30", 1, 4, "C90 without a decimal" },
	{ "fanuc-sinker", "G0 X1.\nG92 X0\nG52 X1.\nM30", 3, 5,
	  "G52 X where G92 is in force" },
	{ "linuxcnc", "G91 G52 X1\nM2", 1, 5, "G52 under G91" },
	{ "linuxcnc", "G52\nM2", 1, 1, "G52 without axis words" },
	{ "sodick-sinker", "G0 C45\nM02", 1, 4, "C45 without a decimal" },
	{ "fanuc-wire", "G2 X1. I.5 K1\nM02", 1, 12, "K1 without a decimal" },
	{ "skd2", "H001=110\nG41H001\nG01X100Y0\nM02", 3, 4,
	  "a lead of 0.1000 mm for a change of offset of 0.1100 mm" },
	{ "skd2", "H001=0\nH001\nG41\nH002\nM02", 4, 1,
	  "an offset by register 2, which is not defined" },
	{ "skd2", "G51 A1.5\nM02", 1, 1, "G51 on a machine without" },
	{ "skd2", "G52\nM02", 1, 1, "G52 on a machine without" },
	{ "skd2", "E001=\nM02", 1, 1, "a definition without a number" },
	{ "skd2", "E001=60 6\nE001\nG1 X1\nM02", 2, 1,
	  "E001, which the program defines by numbers that mean nothing here" },
	{ "sodick-wire", "C001 = 60 6\nG1 X1. C001\nM02", 2, 8,
	  "C001, which the program defines" },
	{ "skd2", "H001= X\nM02", 1, 7, "a definition without a number" },
	{ "skd2", "H1000=5\nM02", 1, 1, "H1000 is out of range" },
	{ "skd2", "H001=500.0\nM02", 1, 1, "an offset of 500 mm" },
	{ "skd2", "M98 P7\nM02", 1, 5, "a call of N7, which is not there" },
	{ "skd2", "M98 P7\nM02\nN7\nM99\nN0007\nM99", 1, 5,
	  "a call of N7, which lines 3 and 5 have" },
	{ "skd2", "G4 P1\nM02", 1, 1, "unknown word G4" },
	{ "skd2", "A5\nM02", 1, 1, "A5 has no use on this line" },
	{ "sodick", "G54; G90;\nM02;", 1, 6, "words behind the ;" },
	{ "sodick", "G01 X5;\nM02;", 1, 5, "X5 without a decimal point" },
	{ "sodick", "G28 X0;\nM02;", 1, 1, "G28: it goes to the start" },
	{ "sodick", "M05;\nM02;", 1, 1, "M05: discharge, or a contact" },
	{ "sodick", "G00 X2.0 R1.0;\nM02;", 1, 10, "R1.0 has no use" },
	{ "chmer", "SC0100 004\nM02", 1, 1, "SC without a =" },
	{ "chmer", "G1 G41 X1.0\nM02", 1, 4, "an offset by register 0" },
	{ "chmer", "Z1.0\nM02", 1, 1, "unknown word Z1.0" },
	{ "agie", "G01 X5 ;\nM02 ;", 1, 5, "X5 without a decimal point" },
	{ "agie", "G20 ;\nM02 ;", 1, 1, "unknown word G20" },
	{ "generic", "E001=5\n", 1, 5, "'=', which begins no word" },
};

static void what_a_dialect_has_not_is_refused_at_its_place(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(bads) / sizeof(bads[0]); i++) {
		const struct bad *b = &bads[i];
		struct compiled c = compile_ready(b->dialect);

		compile_bytes(&c, b->text, strlen(b->text));
		if (c.rc != -EINVAL || c.diag.line != b->line ||
		    c.diag.column != b->column || !c.diag.wanted[0] ||
		    !strstr(c.diag.found, b->found))
			fail_msg("%s '%s': %d %u:%u: %s; %s", b->dialect,
				 b->text, c.rc, c.diag.line, c.diag.column,
				 c.diag.found, c.diag.wanted);
		if (strlen(c.diag.wanted) + 1 == sizeof(c.diag.wanted))
			fail_msg("cut off: %s", c.diag.wanted);
		compile_done(&c);
	}
}

static void a_dialect_is_found_by_name_and_by_file(void **state)
{
	static const char *const names[][2] = {
		{ "part.3b", "3b" }, { "PART.3B", "3b" }, { "a/b.4b", "4b" },
		{ ".3b", "3b" },
	};
	static const char *const others[] = { "part.ngc", "part.iso", "3b",
					      "-", "" };

	(void)state;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		assert_non_null(interp_dialect_by_name(names[i][1]));
		assert_ptr_equal(interp_dialect_by_suffix(names[i][0]),
				 interp_dialect_by_name(names[i][1]));
	}
	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		assert_null(interp_dialect_by_suffix(others[i]));
	assert_null(interp_dialect_by_name("3B "));
	assert_null(interp_dialect_by_name(""));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(robofil_has_centres_as_places),
		cmocka_unit_test(robofil_440_has_centres_from_the_start),
		cmocka_unit_test(an_ignored_word_takes_its_letters_with_it),
		cmocka_unit_test(g52_shifts_all_work_offsets),
		cmocka_unit_test(g91_moves_an_origin_in_fanuc_and_not_in_linuxcnc),
		cmocka_unit_test(makino_threads_by_m6),
		cmocka_unit_test(skd2_counts_micrometres_and_calls_by_n),
		cmocka_unit_test(sodick_ends_blocks_by_semicolons),
		cmocka_unit_test(chmer_calls_conditions_by_s),
		cmocka_unit_test(agie_counts_inches_by_g70),
		cmocka_unit_test(a_wire_program_needs_no_feed),
		cmocka_unit_test(taper_and_offset_that_are_none_are_taken),
		cmocka_unit_test(what_a_dialect_has_not_is_refused_at_its_place),
		cmocka_unit_test(a_dialect_is_found_by_name_and_by_file),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
