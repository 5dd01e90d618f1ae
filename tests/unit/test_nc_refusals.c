/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nc_refusals.c - what the NC reader refuses, and the place it names
 */
#include "nc_read.h"

#include "interp/compile.h"

struct refusal {
	const char *text;
	uint32_t line, column;
	const char *found, *wanted;	/* parts of the two sentences */
};

static const struct refusal numbers[] = {
	{ "G0 X1e999",		1, 6,	"X1e999", "without exponent" },
	{ "G0 X1 Y-1.5E3",	1, 12,	"Y-1.5E3", "without exponent" },
	{ "G0 X--5",		1, 4,	"X--5", "a sign, digits" },
	{ "--5",		1, 1,	"--5 without a letter", "one of A B" },
	{ "nan",		1, 1,	"nan is not", "a sign, digits" },
	{ "G0 Xnan",		1, 4,	"Xnan is not", "a sign, digits" },
	{ "G0 Xinf",		1, 4,	"Xinf is not", "a sign, digits" },
	{ "G0 X1.2.3",		1, 8,	"X1.2.3 is not", "one decimal point" },
	{ "G0 X1-2",		1, 6,	"X1-2 is not", "a sign, digits" },
	{ "G0 X",		1, 4,	"X is not", "a sign, digits" },
	{ "G0 X-.",		1, 4,	"X-. is not", "digits" },
	{ "G0 X1 2",		1, 7,	"2 without a letter", "no blank" },
	{ "G",			1, 1,	"G is not", "digits" },
	{ "\nM-3",		2, 1,	"M-3 is not", "digits" },
	{ "E.5",		1, 1,	"E.5 is not a cond", "E001" },
	{ "G0 X1000000000",	1, 4,	"out of range", "999999999" },
	{ "G0 X99999999999999999999999", 1, 4, "out of range", "999999999" },
	{ "N1.5",		1, 1,	"N1.5 is not a whole", "0 to" },
	{ "S-1",		1, 1,	"S-1 is out of range", "0 to" },
	{ "O100000000",		1, 1,	"O100000000 is out", "0 to 99999" },
	{ "G1 F0 X1",		1, 4,	"F0 is out of range", "a feed of" },
	{ "G1 F-3 X1",		1, 4,	"F-3 is out of range", "a feed of" },
	{ "G4 P2000000",	1, 4,	"a dwell of 2000000 s", "1000000 s" },
	{ "G4 P1000000.4",	1, 4,	"a dwell of 1000000.4 s", "1000000 s" },
	{ "F1 G133 Z-5 R0.2 A89.0000001 Q0.05", 1, 18,
	  "a cone's wall at 89.0000001 degrees", "less than 89" },
	{ "F1 G130 Z-5 R0.2 P1.00000001", 1, 18, "1.00000001 turns",
	  "a whole number" },
};

static const struct refusal words[] = {
	{ "G0 X1\n  W12",	2, 3,	"unknown word W12",
	  "one of A B C D E F G H I J K L M N O P Q R S T U V X Y Z" },
	{ "G34 X1",		1, 1,	"unknown word G34", "G160 ... G162" },
	{ "G33.1 X1",		1, 1,	"G33.1: it cuts", "no thread" },
	{ "M10",		1, 1,	"unknown word M10", "M30" },
	{ "M8",			1, 1,	"M8: coolant", "dialect linuxcnc" },
	{ "T123456",		1, 1,	"number 123456", "T9999" },
	{ "G10 X1",		1, 1,	"G10 without L", "G10 L2" },
	{ "G10 L1 P1",		1, 1,	"G10 L1", "L20" },
	{ "G10 L2 P10 X1",	1, 8,	"G10 with P10", "P0" },
	{ "G0 X1 $",		1, 7,	"'$'", "one of A" },
	{ "G0 X1 \xc3\xa9",	1, 7,	"byte 0xc3", "in comments only" },
	{ "G0 G1 X1",		1, 4,	"G1 on a line with G0", "modal group" },
	{ "M3 M5",		1, 4,	"M5 on a line with M3", "modal group" },
	{ "M0 M30",		1, 4,	"M30 on a line", "modal group" },
	{ "G0 X1 Y2 X3",	1, 10,	"a second word X3", "once" },
	{ "C100 E1",		1, 6,	"a second condition", "one cond" },
	{ "X5",			1, 1,	"X5 with no motion mode", "G0 G1" },
	{ "G0 X1 (abc\nX2)",	1, 7,	"comment without an end", "a )" },
	{ "G0 X1)",		1, 6,	"')'", "one of A" },
	{ "G0 X1 /X2",		1, 7,	"a / inside", "first character" },
	{ "G0 X1 %",		1, 7,	"% behind other words", "alone" },
	{ "G0 X1\n% G0 X2",	2, 1,	"words behind %", "alone" },
	{ "%\nG0 X1\n% G0 X2",	3, 1,	"words behind %", "alone" },
	{ "G0 X1 P4",		1, 7,	"P4 has no use", "M98 or M99" },
	{ "G1 F1 X1 R4",	1, 10,	"R4 has no use", "G2 or G3" },
	{ "G4 P1 Y1",		1, 7,	"Y1 has no use", "G28" },
	{ "G4",			1, 1,	"without a time", "G4 P0.5" },
	{ "G28 G0 X1",		1, 1,	"G28 on a line with", "their own" },
	{ "G28",		1, 1,	"before any motion", "G28 Z0" },
	{ "G92",		1, 1,	"without axis words", "G92.1" },
	{ "G53 G0",		1, 1,	"G53 without a motion", "G0 or G1" },
	{ "G53 G2 F1 X1 R1",	1, 1,	"G53 with an arc", "G0 or G1" },
	{ "H1=0.1\nG41 H1 G1 F1 X1\nX2\nG53 X9", 4, 1, "G53 under an offset",
	  "G40" },
	{ "H1=0.1\nG41 H1 G1 F1 X1\nX2\nG91 G28 Z0", 4, 5,
	  "G28 under an offset", "G40" },
	{ "G1 X1",		1, 1,	"no feed given", "F word" },
	{ "G0 X1\nY200.1",	2, 1,	"beyond the travel", "-200 to 200" },
	{ "G0 X1 Y-201 Z9",	1, 7,	"beyond the travel", "-200 to 200" },
	{ "G10 L2 P1 Y100\nG0 X1 Y150", 2, 7,
	  "Y 150.0000, which is 250.0000 in machine coordinates, is beyond",
	  "Y from -300 to 100 as the work counts, -200 to 200 in machine" },
};

static const struct refusal arcs[] = {
	{ "G2 F1 X10 I3",	1, 7,	"3 mm from its centre", "agree" },
	{ "G2 F1 X10",		1, 1,	"without a centre", "I and J, or R" },
	{ "G18 G2 F1 X10",	1, 5,	"without a centre", "I and K, or R" },
	{ "G2 F1 X10 R2",	1, 11,	"2 mm, too small", "at least 5 mm" },
	{ "G2 F1 X10 R0",	1, 11,	"radius 0", "above 0" },
	{ "G2 F1 Z10 R5",	1, 11,	"ends at its start", "I J K" },
	{ "G2 F1 X10 I0 J0",	1, 11,	"radius 0", "away from the start" },
	{ "G2 F1 X10 I5 K1",	1, 14,	"K1 for an arc", "I and J" },
	{ "G2 F1 X10 I5 R5",	1, 14,	"R beside a centre", "or R" },
	{ "G90.1 G2 F1 X9 I5",	1, 7,	"half a centre", "both words" },
	{ "G2 X10 R5",		1, 1,	"no feed given", "F word" },
	{ "G0 Y195\nG2 F1 X20 R10", 2, 7, "beyond the travel", "200" },
	{ "G10 L2 P1 Y100\nG0 Y95\nG2 F1 X20 R10", 3, 7, "Y 105.0000, which",
	  "100 as the work counts" },
};

static const struct refusal flow[] = {
	{ "M98",		1, 1,	"without P", "M98 P1000" },
	{ "M98 P7",		1, 5,	"O7, which is not there", "O word" },
	{ "M98 P.5",		1, 5,	"P.5 names no", "M98 P1000" },
	{ "M98 P10000",		1, 5,	"P10000 names no", "M98 P1000" },
	{ "M98 P7 L0\nM2\nO7 M99", 1, 8, "L0 is out of", "1 to 9999" },
	{ "M98 P7\nM2\nO7\nM98 P7\nM99",
				4, 5,	"recursion: O7", "other" },
	{ "M98 P7\nM2\nO7\nM98 P8\nM99\nO8\n  M98 P7\nM99",
				7, 7,	"recursion: O7", "other" },
	{ "O1 G0 X1\nM98 P1",	2, 5,	"recursion: O1", "other" },
	{ "M98 P7\nM2\nO7 G0 X1", 3, 0,	"end of the text inside O7", "M99" },
	{ "M98 P7\nM2\nO7\nO8\nM99", 4, 1, "the next program, O8", "M99" },
	{ "G0 X1\nO7\nM99",	2, 1,	"the next program, O7", "M2 or M30" },
	{ "M98 P7\nM2\nO7\nM99\nN1 O7\nM99", 5, 4, "a second O7", "once" },
	{ "G0 O7",		1, 4,	"O7 behind other words", "first" },
	{ "G0 X1\nM99",		2, 1,	"M99 outside", "M2 or M30" },
	{ "",			0, 0,	"empty program", "at least one" },
	{ "%\n\n(x)\nG21 F3 C120\nM30\n%", 0, 0, "empty program", "at least" },
};

static void assert_refused(const struct refusal *want, size_t n)
{
	for (; n-- > 0; want++) {
		struct nc_read r = nc_ready();

		nc_read_bytes(&r, want->text, strlen(want->text));
		if (r.rc != -EINVAL)
			fail_msg("taken: %s", want->text);
		if (r.diag.line != want->line ||
		    r.diag.column != want->column ||
		    !strstr(r.diag.found, want->found) ||
		    !strstr(r.diag.wanted, want->wanted))
			fail_msg("%s\n%u:%u: %s; %s", want->text, r.diag.line,
				 r.diag.column, r.diag.found, r.diag.wanted);
		if (strlen(r.diag.wanted) + 1 == sizeof(r.diag.wanted))
			fail_msg("cut off: %s", r.diag.wanted);
		nc_done(&r);
	}
}

#define assert_all_refused(table) \
	assert_refused(table, sizeof(table) / sizeof(table[0]))

static void a_bad_number_is_refused_at_its_place(void **state)
{
	(void)state;
	assert_all_refused(numbers);
}

static void a_word_without_sense_is_refused_at_its_place(void **state)
{
	(void)state;
	assert_all_refused(words);
}

static void an_arc_that_is_none_is_refused_with_its_numbers(void **state)
{
	(void)state;
	assert_all_refused(arcs);
}

static void a_program_that_goes_astray_is_refused(void **state)
{
	(void)state;
	assert_all_refused(flow);
}

static void a_ninth_call_inside_the_others_is_refused(void **state)
{
	char text[512], *at = text;
	struct nc_read n = nc_ready();

	(void)state;
	at += sprintf(at, "M98 P1\nM2\n");
	for (int i = 1; i <= INTERP_NC_DEPTH_MAX; i++)
		at += sprintf(at, "O%d\nM98 P%d\nM99\n", i, i + 1);
	sprintf(at, "O%d G0 X1 M99\n", INTERP_NC_DEPTH_MAX + 1);
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, -EINVAL);
	assert_non_null(strstr(n.diag.found, "inside 8 others"));
	nc_done(&n);
}

static void an_axis_the_machine_has_not_is_refused(void **state)
{
	struct nc_read n = nc_ready();

	(void)state;
	n.machine.present = 7;
	nc_read_bytes(&n, "G0 X1 U2", 8);
	assert_int_equal(n.rc, -EINVAL);
	assert_int_equal(n.diag.column, 7);
	assert_string_equal(n.diag.found,
			    "axis U, which this machine has not");
	assert_string_equal(n.diag.wanted, "one of X Y Z");
	nc_done(&n);
}

static void a_nul_byte_is_refused_even_in_a_comment(void **state)
{
	static const char *const texts[] = {
		"G0 X1\0X2", "G0 X1(\0)", "G0 X1;\0\nX2", "/abc \0\nX2",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		struct nc_read n = nc_ready();

		nc_read_bytes(&n, texts[i], strlen(texts[i]) + 3);
		assert_int_equal(n.rc, -EINVAL);
		assert_int_equal(n.diag.column, strlen(texts[i]) + 1);
		assert_string_equal(n.diag.found, "byte 0x00");
		nc_done(&n);
	}
}

static void random_bytes_are_refused_at_a_place(void **state)
{
	static char bytes[1 << 16];

	(void)state;
	for (uint64_t first = 1; first <= 200; first++) {
		struct nc_read n = nc_ready();
		uint64_t seed = first;

		for (size_t i = 0; i < sizeof(bytes); i++)
			bytes[i] = (char)nc_random(&seed);
		nc_read_bytes(&n, bytes, sizeof(bytes));
		if (n.rc != -EINVAL || n.diag.line < 1 || n.diag.column < 1 ||
		    !n.diag.found[0] || !n.diag.wanted[0])
			fail_msg("seed %llu", (unsigned long long)first);
		nc_done(&n);
	}
}

/* Damage a good program at random: taken or refused, but never mistaken for
 * something a segment cannot be. */
static void a_damaged_program_is_sound_or_refused(void **state)
{
	static const char good[] =
		"%\nO1 N1 G21 G90\nG0 X1 Y2\nG1 F5 Z-.5 C120\n"
		"G2 X2 Y3 I1 J0\nG3 X1 R2\nM98 P2 L3\nG4 P.5\nG28 Z0\n"
		"M30\nO2 G91 X.1\nG90 M99\n%\n";
	char text[sizeof(good)];
	uint64_t seed = 31;
	int taken = 0;

	(void)state;
	print_message("seed %llu\n", (unsigned long long)seed);
	for (int k = 0; k < 5000; k++) {
		struct nc_read n = nc_ready();

		memcpy(text, good, sizeof(good));
		for (uint32_t i = nc_random(&seed) % 3; i < 3; i++)
			text[nc_random(&seed) % (sizeof(good) - 1)] =
				good[nc_random(&seed) % (sizeof(good) - 1)];
		nc_read_bytes(&n, text, sizeof(good) - 1);
		for (uint32_t i = 0; !n.rc && i < n.p.head->nsegs; i++)
			assert_true(interp_program_seg_ok(&n.p, i,
							  &n.p.segs[i]));
		if (n.rc)
			assert_true(n.diag.found[0] && n.diag.wanted[0]);
		else
			taken++;
		nc_done(&n);
	}
	assert_in_range(taken, 1, 4999);
}

static void a_line_of_a_megabyte_is_refused(void **state)
{
	static const char *const fillings[] = { " ", "(", ";", "/" };
	static char text[1 << 20];

	(void)state;
	for (size_t i = 0; i < sizeof(fillings) / sizeof(fillings[0]); i++) {
		struct nc_read n = nc_ready();

		memset(text, i ? 'x' : ' ', sizeof(text));
		memcpy(text, "\n\n", 2);
		text[2] = fillings[i][0];
		nc_read_bytes(&n, text, sizeof(text));
		assert_int_equal(n.rc, -EINVAL);
		assert_int_equal(n.diag.line, 3);
		assert_int_equal(n.diag.column, INTERP_NC_LINE_MAX + 1);
		assert_non_null(strstr(n.diag.found, "longer than 4096"));
		nc_done(&n);
	}
}

static void a_line_of_just_the_limit_is_taken(void **state)
{
	static char text[INTERP_NC_LINE_MAX + 4];
	struct nc_read n = nc_ready();

	(void)state;
	memset(text, ' ', INTERP_NC_LINE_MAX);
	memcpy(text, "G0X1", 4);
	memcpy(text + INTERP_NC_LINE_MAX - 2, "Y2\nM2", 5);
	nc_read_bytes(&n, text, INTERP_NC_LINE_MAX + 3);
	assert_int_equal(n.rc, 0);
	assert_xyz(&n, 0, 1, 2, 0);
	nc_done(&n);
}

static void runaway_repeats_are_bounded(void **state)
{
	static const char text[] =
		"M98 P1 L9999\nM2\nO1 M98 P2 L9999\nM99\n"
		"O2 M98 P3 L9999\nM99\nO3\nM99\n";
	static const char moving[] =
		"G91 G0\nM98 P1 L9999\nM2\nO1 X1\nX-1\nM99\n";
	struct nc_read n = nc_ready();

	(void)state;
	n.o.executed_max = 100000;
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, -EINVAL);
	assert_string_equal(n.diag.found, "more than 100000 lines carried out");
	nc_done(&n);

	n.o.segs_max = 1000;
	nc_read_bytes(&n, moving, strlen(moving));
	assert_int_equal(n.rc, -EINVAL);
	assert_string_equal(n.diag.found, "more than 1000 segments in all");
	assert_int_equal(n.diag.line, 4);
	nc_done(&n);
}

/* How much is read is bounded, not only how many lines. */
static void a_long_line_counts_as_many(void **state)
{
	static const char calls[] =
		"M98 P1 L9999\nM2\nO1\n(%0*d)\nG4 P0\nM99\n";
	struct nc_read n = nc_ready();
	char text[5000];

	(void)state;
	n.o.executed_max = 100000;
	snprintf(text, sizeof(text), calls, 10, 0);
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, 0);
	nc_done(&n);
	n.o.executed_max = 100000;
	snprintf(text, sizeof(text), calls, 4000, 0);
	nc_read_bytes(&n, text, strlen(text));
	assert_int_equal(n.rc, -EINVAL);
	assert_string_equal(n.diag.found, "more than 100000 lines carried out");
	assert_non_null(strstr(n.diag.wanted, "for each 64 bytes"));
	nc_done(&n);
}

/* A value costs more than a comment: it is four times as soon over. */
static void a_long_expression_counts_as_more(void **state)
{
	static const char *const lines[] = { "(%0*d)", "#1=[%0*d]" };
	struct nc_read n = nc_ready();
	char format[100], text[5000];

	(void)state;
	n.dialect = interp_dialect_by_name("fanuc-sinker");
	for (int i = 0; i < 2; i++) {
		n.o.executed_max = 100000;
		snprintf(format, sizeof(format), "M98 P1 L1000\nM2\nO1\n%s\n"
			 "G4 P0\nM99\n", lines[i]);
		snprintf(text, sizeof(text), format, 4000, 0);
		nc_read_bytes(&n, text, strlen(text));
		assert_int_equal(n.rc, i == 0 ? 0 : -EINVAL);
		nc_done(&n);
	}
}

/* Also where it is searched for a label, and where variables are in it. */
static void a_long_line_of_a_loop_counts_as_many(void **state)
{
	static const char *const loops[] = {
		"N1 G4 P0.\nGOTO 2\n(%0*d)\nN2 GOTO 1\n",
		"N1 G4 P0.\n#1=[%0*d]\nGOTO 1\n",
		"N1 G4 P[%0*d]\nGOTO 1\n",
	};
	struct nc_read n = nc_ready();
	char text[5000];

	(void)state;
	n.dialect = interp_dialect_by_name("fanuc-sinker");
	n.o.executed_max = 100000;
	for (size_t i = 0; i < sizeof(loops) / sizeof(loops[0]); i++) {
		snprintf(text, sizeof(text), loops[i], 4000, 0);
		nc_read_bytes(&n, text, strlen(text));
		assert_int_equal(n.rc, -EINVAL);
		assert_int_equal(strncmp(n.diag.found, "more than 100000 lines",
					 22), 0);
		nc_done(&n);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bad_number_is_refused_at_its_place),
		cmocka_unit_test(a_word_without_sense_is_refused_at_its_place),
		cmocka_unit_test(an_arc_that_is_none_is_refused_with_its_numbers),
		cmocka_unit_test(a_program_that_goes_astray_is_refused),
		cmocka_unit_test(a_ninth_call_inside_the_others_is_refused),
		cmocka_unit_test(an_axis_the_machine_has_not_is_refused),
		cmocka_unit_test(a_nul_byte_is_refused_even_in_a_comment),
		cmocka_unit_test(random_bytes_are_refused_at_a_place),
		cmocka_unit_test(a_damaged_program_is_sound_or_refused),
		cmocka_unit_test(a_line_of_a_megabyte_is_refused),
		cmocka_unit_test(a_line_of_just_the_limit_is_taken),
		cmocka_unit_test(runaway_repeats_are_bounded),
		cmocka_unit_test(a_long_line_counts_as_many),
		cmocka_unit_test(a_long_expression_counts_as_more),
		cmocka_unit_test(a_long_line_of_a_loop_counts_as_many),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
