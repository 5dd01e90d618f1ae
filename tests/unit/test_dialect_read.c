/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_dialect_read.c - dialects as files: those that are built in, and one of
 * a user
 */
#include "compile_help.h"

#include "code/dialect.h"

static struct interp_diag diag;

static int read_text(const char *text, struct interp_dialect **ret)
{
	const struct interp_text t = { text, strlen(text), NULL };

	return interp_dialect_read(ret, "mine", &t, &diag);
}

static void every_file_that_is_built_in_is_read(void **state)
{
	struct interp_dialect *d;
	int n = 0;

	(void)state;
	for (; nc_dialect_files[n].name; n++) {
		if (read_text(nc_dialect_files[n].text, &d))
			fail_msg("%s.ini:%u:%u: %s; %s",
				 nc_dialect_files[n].name, diag.line,
				 diag.column, diag.found, diag.wanted);
		interp_dialect_free(d);
	}
	assert_int_equal(n, 19);
	assert_ptr_equal(interp_dialect_by_name("sodick"),
			 interp_dialect_by_name("sodick-wire"));
}

/* Behind a comment, all of such a file would be one. */
static void lines_may_end_in_cr_alone(void **state)
{
	static const char *const end[] = { "\n", "\r\n", "\r" };
	struct interp_dialect *d;
	char text[120];

	(void)state;
	for (size_t i = 0; i < sizeof(end) / sizeof(end[0]); i++) {
		snprintf(text, sizeof(text), "# a comment%s%s[dialect]%s"
			 "base = generic%snonsense%s", end[i], end[i], end[i],
			 end[i], end[i]);
		assert_int_equal(read_text(text, &d), -EINVAL);
		assert_int_equal(diag.line, 5);
		assert_int_equal(diag.column, 1);
	}
}

/* A text read in a dialect of one's own, which begins from generic. */
static void take(struct compiled *c, const char *dialect, const char *text)
{
	struct interp_dialect *d = NULL;
	char whole[512];

	snprintf(whole, sizeof(whole), "[dialect]\nbase = generic\n%s",
		 dialect);
	if (read_text(whole, &d))
		fail_msg("%u:%u: %s; %s", diag.line, diag.column, diag.found,
			 diag.wanted);
	c->dialect = d;
	compile_bytes(c, text, strlen(text));
	interp_dialect_free(d);
}

static void assert_taken(const char *dialect, const char *text,
			 uint32_t segments)
{
	struct compiled c = compile_ready("generic");

	take(&c, dialect, text);
	if (c.rc)
		fail_msg("%s: %u:%u: %s; %s", text, c.diag.line,
			 c.diag.column, c.diag.found, c.diag.wanted);
	assert_int_equal(c.p.head->nsegs, segments);
	compile_done(&c);
}

static void refuse_in(const char *dialect, const char *text,
			   const char *found, const char *wanted)
{
	struct compiled c = compile_ready("generic");

	take(&c, dialect, text);
	assert_int_equal(c.rc, -EINVAL);
	assert_string_equal(c.diag.found, found);
	assert_string_equal(c.diag.wanted, wanted);
	compile_done(&c);
}

static void a_word_does_what_its_file_says(void **state)
{
	(void)state;
	assert_taken("[words]\nG188.5 M345 = rapid\n", "G188.5 X1\nM345 X2\n",
		     4);
}

static void an_ignored_word_takes_its_letters_along(void **state)
{
	const char *const d = "[words]\nG43 = ignore H: no tools\n"
			      "T* M6 = ignore: no tools\n";

	(void)state;
	assert_taken(d, "T12 M6\nG43 H9 G0 X1\n", 3);
	assert_taken(d, "T1234567\nG0 X1\n", 3);
	refuse_in(d, "G43 H1 G0 R2 X1", "R2 has no use on this line",
		       "R goes with G2 or G3, a curve, or G0 and G1 under "
		       "G43.5");
}

static void a_refused_word_says_what_it_means_elsewhere(void **state)
{
	(void)state;
	refuse_in("[words]\nG7 = refuse: a diameter; a radius\n", "G7",
		       "G7: a diameter", "a radius");
	refuse_in("[letters]\nW = refuse: a slide; Z\n", "G0 W2.5",
		       "W2.5: a slide", "Z");
}

static void a_rule_changes_what_numbers_mean(void **state)
{
	struct compiled c = compile_ready("generic");

	(void)state;
	take(&c, "[rules]\nlength_without_point = last-decimal\n",
	     "G0 X1500 Y1.5\n");
	assert_int_equal(c.rc, 0);
	assert_int_equal(c.p.head->length_mm * 1e6, hypot(1.5, 1.5) * 1e6);
	compile_done(&c);
	refuse_in("[rules]\nlength_without_point = refused\n", "G0 X15",
		       "X15 without a decimal point",
		       "a decimal point, as in X10.0: without one some "
		       "controls read thousandths");
}

static const struct {
	const char *text, *found;
	uint32_t line, column;
} bads[] = {
	{ "x = 1", "line x = 1", 1, 1 },
	{ "[word]", "section [word]", 1, 1 },
	{ "[words]\nG1", "line G1", 2, 1 },
	{ "[words]\nG1 = lin", "no word means lin", 2, 6 },
	{ "[words]\nG200 = line", "no word G200", 2, 1 },
	{ "[words]\nG1 G1.12 = line", "no word G1.12", 2, 4 },
	{ "[words]\nX1 = line", "no word X1", 2, 1 },
	{ "[words]\nG7 = refuse: a\x1b[2J; b", "a control character behind a",
	  2, 15 },
	{ "[words]\nG7 = refuse: nothing", "not enough in refuse: nothing",
	  2, 6 },
	{ "[words]\nG7 = refuse: why ; ", "not enough in refuse: why ;", 2, 6 },
	{ "[letters]\nW = refuse: why;", "not enough in refuse: why;", 2, 5 },
	{ "[words]\nG7 = ignore h: why", "letter h", 2, 13 },
	{ "[words]\nG7 = line H", "behind a meaning: H", 2, 11 },
	{ "[dialect]\nbase = mine", "no base mine", 2, 8 },
	{ "[dialect]\nbase = 3b", "no base 3b", 2, 8 },
	{ "[rules]\ncentre = here", "a rule that is here", 2, 10 },
	{ "[rules]\n\n# x\nfoo = bar", "rule foo", 4, 1 },
	{ "[letters]\nx = condition", "letter x", 2, 1 },
	{ "[letters]\nX = X", "a letter cannot be X", 2, 5 },
	{ "[letters]\nvalues = X YZ", "letter YZ", 2, 12 },
};

static void a_mistake_in_a_file_is_refused_at_its_place(void **state)
{
	struct interp_dialect *d;

	(void)state;
	for (size_t i = 0; i < sizeof(bads) / sizeof(bads[0]); i++) {
		const int rc = read_text(bads[i].text, &d);

		if (rc != -EINVAL || diag.line != bads[i].line ||
		    diag.column != bads[i].column ||
		    strcmp(diag.found, bads[i].found) != 0 ||
		    !diag.wanted[0])
			fail_msg("'%s': %d %u:%u %s", bads[i].text, rc,
				 diag.line, diag.column, diag.found);
	}
}

/* What is noted, one after the other. */
static void note(void *arg, uint32_t line, const char *text)
{
	char *all = arg;
	const size_t n = strlen(all);

	snprintf(all + n, 512 - n, "%u %.20s|", line, text);
}

static void check_notes(const char *dialect, const char *text,
			const char *wanted)
{
	struct compiled c = compile_ready(dialect);
	char all[512] = "";
	const struct interp_notes notes = { note, all, false };

	c.o.nc.notes = &notes;
	compile_bytes(&c, text, strlen(text));
	assert_int_equal(c.rc, 0);
	assert_string_equal(all, wanted);
	compile_done(&c);
}

static void what_is_ignored_is_noted_once(void **state)
{
	(void)state;
	check_notes("linuxcnc", "G64 P.1\nG64\nG80 G0 X1\nG80 X2\n",
		    "1 G64 is ignored: ever|3 G80 is ignored: ther|");
}

/* M6 beside its T word is part of it: what is noted of T is true of both. */
static void m6_beside_its_t_word_is_not_noted(void **state)
{
	(void)state;
	check_notes("generic", "T3 M6\nG0 X1\nM6\nM30\n",
		    "1 T3 shifts nothing: t|3 M6 changes nothing: |");
}

/* A % ends the text, but only where it is alone. */
static void words_behind_the_end_are_noted(void **state)
{
	static const struct {
		const char *text, *noted;
	} row[] = {
		{ "%\nG0 X1.\nM2\n%\nrubbish\n", "5 nothing behind the %|" },
		{ "%\nG0 X1.\nM2\n% (end)\nrubbish\n",
		  "5 nothing behind the %|" },
		{ "%\nG0 X1.\nM2\nrubbish\n", "4 nothing behind the e|" },
		{ "%\nG0 X1.\nM2\n%junk\nrubbish\n",
		  "4 nothing behind the e|" },
		{ "%title\nG0 X1.\nM2\n", "1 % begins the text; w|" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(row) / sizeof(row[0]); i++) {
		struct compiled c = compile_ready("generic");
		char all[512] = "";
		const struct interp_notes notes = { note, all, false };

		c.o.nc.notes = &notes;
		compile_bytes(&c, row[i].text, strlen(row[i].text));
		assert_int_equal(c.rc, 0);
		assert_string_equal(all, row[i].noted);
		compile_done(&c);
	}
}

static void what_others_read_otherwise_is_noted_before_a_run(void **state)
{
	static const char text[] = "G20\nG0 X1 C120\nG0 X1.\nG4 P500\n";
	struct compiled c = compile_ready("generic");
	char all[512] = "";
	const struct interp_notes notes = { note, all, true };

	(void)state;
	c.o.nc.notes = &notes;
	compile_bytes(&c, text, sizeof(text) - 1);
	assert_int_equal(c.rc, 0);
	assert_string_equal(all,
			    "1 lengths and feeds ar|2 X1 has no decimal po|"
			    "2 C120 calls a conditi|4 a dwell of 500 s: P |");
	compile_done(&c);
}

static void a_work_offset_is_written_by_the_program(void **state)
{
	struct compiled c = compile_ready("generic");
	static const char text[] = "G10 L2 P9 X10\nG59.3 G0 X0\n"
				   "G10 L20 P0 X5\nG0 X5\nG0 X6\n";

	(void)state;
	compile_bytes(&c, text, sizeof(text) - 1);
	assert_int_equal(c.rc, 0);
	/* To 10, nowhere, to 11. */
	assert_int_equal(c.p.head->length_mm * 1000 + .5, 11000);
	compile_done(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_file_that_is_built_in_is_read),
		cmocka_unit_test(lines_may_end_in_cr_alone),
		cmocka_unit_test(a_word_does_what_its_file_says),
		cmocka_unit_test(an_ignored_word_takes_its_letters_along),
		cmocka_unit_test(a_refused_word_says_what_it_means_elsewhere),
		cmocka_unit_test(a_rule_changes_what_numbers_mean),
		cmocka_unit_test(a_mistake_in_a_file_is_refused_at_its_place),
		cmocka_unit_test(what_is_ignored_is_noted_once),
		cmocka_unit_test(m6_beside_its_t_word_is_not_noted),
		cmocka_unit_test(words_behind_the_end_are_noted),
		cmocka_unit_test(what_others_read_otherwise_is_noted_before_a_run),
		cmocka_unit_test(a_work_offset_is_written_by_the_program),
	};

	return cmocka_run_group_tests_name("interp/dialect_read", tests, NULL,
					   NULL);
}
