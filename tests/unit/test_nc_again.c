/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_nc_again.c - a line with the same words as the line before it is read in
 * a way of its own (scan_again.c); it must be the same as if it were any line
 *
 * A comment behind the words changes nothing, but such lines are never read in
 * that way.  So each text is read with and without comments.  (It makes a line
 * with variables count as more lines, so no such line may be long.)
 */
#include "nc_read.h"

#include "interp/compile.h"
#include "seed.h"

#define TEXT_MAX	20000

/* So near the end of the text each line is read as any line. */
#define REST	"(it is not the last line)\n"

/* @text with a comment at the end of each line. */
static void put_comments(const char *text, char *to)
{
	for (char last = '\0'; *text; last = *text, *to++ = *text++) {
		if (*text == '\r' || (*text == '\n' && last != '\r'))
			to += sprintf(to, " ()");
	}
	*to = '\0';
}

static void assert_same(const char *text, const struct nc_read *a,
			const struct nc_read *b)
{
	if (a->rc != b->rc || a->diag.line != b->diag.line ||
	    a->diag.column != b->diag.column ||
	    strcmp(a->diag.found, b->diag.found) != 0 ||
	    strcmp(a->diag.wanted, b->diag.wanted) != 0)
		fail_msg("%s\n%d, %u:%u: %s; %s\n%d, %u:%u: %s; %s", text,
			 a->rc, a->diag.line, a->diag.column, a->diag.found,
			 a->diag.wanted, b->rc, b->diag.line, b->diag.column,
			 b->diag.found, b->diag.wanted);
	if (a->rc)
		return;
	if (a->result.lines != b->result.lines ||
	    a->result.executed != b->result.executed ||
	    a->p.head->bytes != b->p.head->bytes ||
	    memcmp(a->block, b->block, a->p.head->bytes) != 0)
		fail_msg("%s\nanother program", text);
}

/* Return: was it taken? */
static bool check(const char *text, const char *dialect)
{
	char plain[TEXT_MAX], with[2 * TEXT_MAX];
	struct nc_read a = nc_ready(), b = nc_ready();
	bool taken;

	a.o.feed_mm_s = b.o.feed_mm_s = 1;
	a.dialect = b.dialect = interp_dialect_by_name(dialect);
	snprintf(plain, sizeof(plain), "%s" REST, text);
	put_comments(plain, with);
	nc_read_bytes(&a, plain, strlen(plain));
	nc_read_bytes(&b, with, strlen(with));
	assert_same(text, &a, &b);
	taken = a.rc == 0;
	nc_done(&a);
	nc_done(&b);
	return taken;
}

/* What differs from the line before in more than its numbers, or in numbers
 * that make another word of it. */
#define ZEROS20		"00000000000000000000"
#define LONG(word)	word ZEROS20 ZEROS20 ZEROS20 ZEROS20 "\n"

static const struct {
	const char *dialect, *text;
	bool taken;
} cases[] = {
	{ "generic", "G1 X1\nG1 X2\nG1 X3\nG0 X4\nG1 X5\nX6\nG1 X7\n", true },
	{ "generic", "G1\nX1 Y1\nX2 Y2\nX3 Y300\nX4 Y4\n", false },
	{ "generic", "G1X1\nG1X2\nG1X300\n", false },
	{ "generic", "G1\nX1\nX2\nX3.5.5\n", false },
	{ "generic", "G1\nX1\nX2\nX3Y4\nX5Z6\nX7X8\n", false },
	{ "generic", "G1\nX1\nX2\nX9999999999\n", false },
	{ "generic", "G1\nX1.5\nX2.5\nX3.5\nX4.5\nX5,5\n", false },
	{ "generic", "G1\nX1.5\nX2.5\nX3.5\nX4.5\nX5-5\n", false },
	{ "generic", "G1\nX15\nX25\nX35\nX45\nX5:\n", false },
	{ "generic", "G1\nX15\nX25\nX35\nX45\nX5/\n", false },
	{ "generic", "G1\nX15\nX25\nX35\nX45\nX.5\nX5.\nX5\n", true },
	{ "generic", "G1\nX1\nX2\nX00000001\nX00000002\nX3\n", true },
	{ "generic", "G1\nX1\nX2\nX0000.003\nX0000.004\nX5\n", true },
	{ "generic", "G1\nX1\nX2\nX00000.006\nX00000.007\nX8\n", true },
	{ "generic", "G1\nX1\nX2\nX\n", false },
	{ "generic", "G1\nX1\nX2\nX3E4\n", false },
	{ "generic", "G1\nC10.\nC20.\nC120.\nC30\nC120\nC1\n", true },
	{ "generic", "G1\nX1 F1\nX2 F2\nX3 F3\nX4 F4\nX5 F6\nX7 F0\n", false },
	{ "generic", "G1\nN1 X1\nN2 X2\nN3 X3\nN4.5 X4\n", false },
	{ "generic", "G1\nN1 X1\nN2 X2\nN3 X3\nN4 X4\nN-3 X3\n", false },
	{ "generic", "G1 X1\nG1 X2\nG1 X3\nG91 X4\nX5\nX6\nG90\nX7\n", true },
	{ "generic", "G1 X1\nX2\nX3\nG20 X1\nX2\nX3\nG92 X1\nX2\nX3\n", true },
	{ "generic", "G2 X2 I1\nX4 I1\nX6 I1\nX8 I1\nX9 I1\n", false },
	{ "generic", "G3 X2 I1 F5\nX4 I1 F6\nX6 I1 F6\nX8 I1 F6\n", true },
	{ "generic", "G1\nX1 Q1\n", false },
	{ "generic", "G1\n" LONG("X1.") LONG("X2.") LONG("X3."), true },
	{ "generic", "G1\nA1 U1\nA2 U2\nA3 U3\n", true },
	{ "generic", "G1\nx1 y1\nX2 Y2\nx3 y3\nx 4 y-5\nx+6 y 7\n", true },
	{ "generic", "%\nG1\nX1\n/X2\nX3\n\nX4\n%\nX5\n", true },
	{ "generic", "G1\nX1;\nX2;\nX3;\n", true },
	{ "generic", "G1\r\nX1 \r\nX2 \r\nX3\r\nX4\r\nX5\r\nM2\r\n", true },
	{ "generic", "M98 P7 L3\nM2\nO7\nG91 G1\nX1\nX1\nX1\nM99\n", true },
	{ "generic", "G38.2 Z-1\nG1\nX1\nX2\nX3\n", true },
	{ "generic", "G43.4\nG1\nX1\nX2\nX3\n", false },
	{ "linuxcnc", "G1 F9\nX1\nX2\nX3\n#1=4\nX#1\nX5\nX6\nX[7]\n", true },
	{ "linuxcnc", "G1 F9 X1 M8\nX2 M8\nX3 M8\nG64 X4\nG64 X5\n", true },
	{ "fanuc-sinker", "G1 X1.\nX2.\nX3.\nX0\nX-0.5\n", true },
	{ "sodick-wire", "G1 X1.\nX2.\nX3.\nX0\nX4\nX5.\n", false },
	{ "skd2", "G1 X1.\nX2.\nX3.\nX4\nX0\nX5.\nX-6\n", true },
	{ "fanuc-wire", "G1 X1.\nX2.\nX3.\nX0\nX5.\nX-6\n", false },
};

static void words_that_only_look_the_same(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		if (check(cases[i].text, cases[i].dialect) != cases[i].taken)
			fail_msg("%s: %s", cases[i].dialect, cases[i].text);
	}
}

/* -- At random ------------------------------------------------------------ */

static uint64_t seed;

static uint32_t any(uint32_t n)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(seed >> 33) % n;
}

static void put_number(char **to, char letter)
{
	static const char *const odd[] = {
		"", "-", "+1", "- 2", " 3", ".5", "-.5", "1.", "00001.5", "-0",
		"0", "120", "1234567.8", "0.123456789", "12345678", "1e5",
		"1.2.3", "1,5", "99999999999", "-0.00000001", "100",
	};

	if (any(200) == 0)
		*to += sprintf(*to, "%s", odd[any(sizeof(odd) / sizeof(*odd))]);
	else if (letter == 'N')
		*to += sprintf(*to, "%u", any(100000));
	else if (letter == 'F')
		*to += sprintf(*to, "%u", 1 + any(900));
	else if (letter == 'R')
		*to += sprintf(*to, "%u.%u", 200 + any(90), any(10));
	else
		*to += sprintf(*to, "%.*f", any(8) ? 3 : (int)any(5),
			       any(100000) / 1000.0 - 50);
}

/* A line of these words, and lines like it. */
static void put_lines(char **to, const char *words)
{
	const char *blank = any(2) ? " " : "";

	for (uint32_t n = 1 + any(9); n; n--) {
		for (const char *p = words; *p; p++) {
			*to += sprintf(*to, "%c", *p);
			if (*p == 'G')
				*to += sprintf(*to, "%c", *++p);
			else
				put_number(to, *p);
			*to += sprintf(*to, "%s", p[1] ? blank : "");
		}
		*to += sprintf(*to, "%s", any(9) ? "\n" : " \n");
	}
}

static void put_random(char *to)
{
	static const char *const shapes[] = {
		"X", "XY", "XYZ", "G1XYZ", "NXY", "NG1XY", "G0XZ", "YX", "XYC",
		"G1XYF", "XYZF", "G1", "G2XYR", "NG3XYR", "XU", "xyz", "g1xy",
	};
	static const char *const others[] = {
		"G90", "G91", "G90", "F100", "M3", "M5", "G21", "G17", "G40",
		"G1", "G1 X1", "(a)", ";b", "", "G54", "G55", "G92 X0", "G49",
		"G4 P1", "M8", "G64", "C120", "X1 M3", "X1 (a) Y1", "/X1",
		"G1 X1 Y1 Z1", "G28 Z0", "G53 G0 X1", "#1=1",
	};

	to += sprintf(to, "G21 G90 G1 F90\n");
	for (uint32_t n = 1 + any(12); n; n--) {
		if (any(3) == 0)
			to += sprintf(to, "%s\n", others[any(
				      sizeof(others) / sizeof(*others))]);
		put_lines(&to, shapes[any(sizeof(shapes) / sizeof(*shapes))]);
		if (any(8))
			to += sprintf(to, "G1\n");
	}
}

static void random_lines(void **state)
{
	static const char *const dialects[] = {
		"generic", "generic", "generic", "linuxcnc", "fanuc-sinker",
		"sodick-wire", "skd2",
	};
	char text[TEXT_MAX];
	uint32_t taken = 0;

	(void)state;
	seed = seed_take();
	for (int i = 0; i < SEED_ROUNDS(3000); i++) {
		put_random(text);
		taken += check(text, dialects[any(sizeof(dialects) /
						  sizeof(*dialects))]);
	}
	assert_true((int)taken > SEED_ROUNDS(3000) / 10);
}

/* The end of the text is the end of the line, and nothing behind it is read. */
static void a_text_ends_without_the_end_of_its_line(void **st)
{
	static const char text[] = "G1 F60\nX1\nX2.25";
	const size_t bytes = sizeof(text) - 1;

	(void)st;
	for (size_t n = 0; n <= bytes; n++) {
		struct nc_read a = nc_ready();

		nc_read_bytes(&a, text, n);
		if (n == bytes) {
			assert_int_equal(a.rc, 0);
			assert_int_equal(a.result.lines, 3);
		}
		nc_done(&a);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_text_ends_without_the_end_of_its_line),
		cmocka_unit_test(words_that_only_look_the_same),
		cmocka_unit_test(random_lines),
	};

	return cmocka_run_group_tests_name("nc_again", tests, NULL, NULL);
}
