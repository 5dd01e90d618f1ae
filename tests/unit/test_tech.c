/* SPDX-License-Identifier: Apache-2.0 */
/* test_tech.c - technology tables: reading, refusing, writing, finding */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "interp/tech_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HEAD	"condition, servo_v [V], on_us [us], allowance_mm\n"

struct text {
	char at[16384];
	size_t n;
};

static int put(void *arg, const char *text, size_t bytes)
{
	struct text *t = arg;

	assert_true(t->n + bytes < sizeof(t->at));
	memcpy(t->at + t->n, text, bytes);
	t->n += bytes;
	t->at[t->n] = '\0';
	return 0;
}

static void write_out(const struct interp_tech_table *t, struct text *ret)
{
	const struct interp_sink to = { put, ret };

	ret->n = 0;
	assert_int_equal(interp_tech_write(t, &to), 0);
}

static struct interp_tech_table *taken(const char *text)
{
	struct interp_tech_table *t = NULL;
	struct interp_diag d;

	if (interp_tech_read(&t, text, strlen(text), &d))
		fail_msg("%s\n%u:%u: %s; %s", text, d.line, d.column, d.found,
			 d.wanted);
	return t;
}

static double value(const struct interp_tech_table *t, char letter,
		    uint32_t number, enum interp_tech_id id)
{
	const struct interp_tech_row *r = interp_tech_row(t, letter, number);

	assert_non_null(r);
	return r->tech.v[id];
}

static void a_row_gives_what_its_cells_give(void **state)
{
	struct interp_tech_table *t = taken(
		"# a comment, with = and commas\n\nelectrode = copper,,,\n"
		"note = for the test # and a comment\n" HEAD
		"C120, 15.5, 40, 0.08\nE001,-,,\n S7 ; 20\t0.1 ; 0,,\r\n");

	(void)state;
	assert_string_equal(t->electrode, "copper");
	assert_string_equal(t->note[0], "for the test");
	assert_true(value(t, 'C', 120, INTERP_TECH_SERVO_V) == 15.5);
	assert_true(value(t, 'C', 120, INTERP_TECH_ALLOWANCE_MM) == 0.08);
	assert_true(isnan(value(t, 'C', 120, INTERP_TECH_PEAK_A)));
	assert_true(isnan(value(t, 'E', 1, INTERP_TECH_SERVO_V)));
	assert_true(isnan(value(t, 'E', 1, INTERP_TECH_ALLOWANCE_MM)));
	assert_true(value(t, 'S', 7, INTERP_TECH_ON_US) == 0.1);
	assert_null(interp_tech_row(t, 'C', 121));
	assert_null(interp_tech_row(t, 'E', 120));
	interp_tech_table_destroy(t);
}

static void sequences_and_inline_columns_are_kept_in_order(void **state)
{
	struct interp_tech_table *t = taken(
		"sequence Q2 = C3 C2\n" HEAD "C2,20,8,0\nC3,15,40,0.1\n"
		"sequence Q1=C3\ninline E = - on_us*0.5 servo_v\n");
	const struct interp_tech_sequence *s = interp_tech_sequence(t, 2);
	const struct interp_tech_inline *in = interp_tech_inline(t, 'E');

	(void)state;
	assert_non_null(s);
	assert_int_equal(s->nsteps, 2);
	assert_int_equal(s->step[0].number, 3);
	assert_int_equal(interp_tech_sequence(t, 1)->nsteps, 1);
	assert_null(interp_tech_sequence(t, 3));
	assert_int_equal(in->ncolumns, 3);
	assert_int_equal(in->column[0].id, -1);
	assert_int_equal(in->column[1].id, INTERP_TECH_ON_US);
	assert_true(in->column[1].factor == 0.5);
	assert_int_equal(interp_tech_inline(t, 'C')->ncolumns, 0);
	interp_tech_table_destroy(t);
}

static const struct {
	const char *text;
	uint32_t line, column;
	const char *found, *wanted;
} refused[] = {
	{ "", 1, 1, "without conditions", "C120" },
	{ HEAD, 1, 1, "without conditions", "C120" },
	{ "C120, 15\n", 1, 1, "'C120'", "condition, servo_v, ..." },
	{ "condition\n", 1, 1, "without fields", "at least one" },
	{ "condition, servo_x\n", 1, 12, "unknown column 'servo_x'",
	  "servo_v" },
	{ "condition, on_us [ns]\n", 1, 18, "on_us in the unit [ns]",
	  "on_us [us]" },
	{ "condition, iso [A]\n", 1, 16, "iso in the unit", "no unit" },
	{ "condition, on_us,on_us [us]\n", 1, 18, "on_us again", "once" },
	{ HEAD HEAD, 2, 1, "second head, the first is in line 1", "one head" },
	{ HEAD "C1,15,40\n", 2, 9, "2 values under a head of 3, "
	  "allowance_mm is missing", "for each" },
	{ HEAD "C1,15,40,0,7\n", 2, 12, "too many, '7'", "no more" },
	{ HEAD "D1,15,40,0\n", 2, 1, "'D1' is no condition", "C, E or S" },
	{ HEAD "C1x,15,40,0\n", 2, 1, "'C1x'", "C120" },
	{ HEAD "C1,15,40,0\nC2,1,1,1\nC001,15,40,0\n", 4, 1,
	  "C001 again, first in line 2", "once" },
	{ "condition,gain_mm_s_v\nC1,0\n", 2, 4,
	  "gain_mm_s_v '0' is out of range", "from 0.000001" },
	{ HEAD "C1,1500,40,0\n", 2, 4, "servo_v '1500' is out of range",
	  "from 0.1 to 500 V" },
	{ HEAD "C1,15, -3,0\n", 2, 8, "on_us '-3'", "0.1 to 100000 us" },
	{ HEAD "C1,nan,40,0\n", 2, 4, "not a decimal", "from 0" },
	{ HEAD "C1,1e2,40,0\n", 2, 4, "'1e2' is not a decimal", "from 0" },
	{ HEAD "C1,1 5,40,0\n", 2, 4, "'1 5' is not a decimal", "from 0" },
	{ "condition,polarity\nC1,0\n", 2, 4, "polarity '0'", "1 or -1" },
	{ "condition,iso\nC1,0.5\n", 2, 4, "iso '0.5'", "whole number" },
	{ "condition,window_low_v,window_high_v\nC1,40,30\n", 2, 1,
	  "C001: window_low_v 40 V is not at most window_high_v 30 V",
	  "window_low_v at most" },
	{ "condition,short_v,servo_v\nC2,5,9\nC1,20,20\n", 3, 1,
	  "short_v 20 V is not below servo_v", "short_v below" },
	{ "condition,window_low_v,servo_v\nC1,40,30\n", 2, 1,
	  "C001: window_low_v 40 V is not at most servo_v", "window_low_v at" },
	{ "condition,open_v,ignition_v\nC1,90,80\n", 2, 1,
	  "C001: open_v 90 V is not below ignition_v 80 V", "open_v below" },
	{ "material = steel\n", 1, 1, "unknown key 'material'", "electrode" },
	{ "note = a\nelectrode = a\nelectrode = b\n", 3, 1,
	  "electrode again", "once" },
	{ "sequence S1 = C1\n", 1, 10, "called 'S1'", "Q1 to" },
	{ "sequence Q1 =\n", 1, 10, "empty sequence", "rough" },
	{ "sequence Q1 = C1, C2\n", 1, 15, "'C1,' in a sequence", "C120" },
	{ HEAD "C1,15,40,0\nC3,15,40,0\nsequence Q1 = C1 C2\n", 4, 1,
	  "Q1: C002, which is not in the table", "C001, C003" },
	{ HEAD "C1,15,40,0.1\nC2,15,40,0.2\nC3,1,1,0\n"
	  "sequence Q1 = C1 C2 C3\n", 5, 1, "step 2 stops 0.2 mm before",
	  "fall along" },
	{ "inline X = -\n", 1, 8, "inline 'X'", "C, E or S" },
	{ "inline E = - foo\n", 1, 14, "unknown field 'foo'", "a field" },
	{ "inline E = on_us*0\n", 1, 12, "'on_us*0'", "above 0" },
	{ "condition, on_us\nC1, 5\001\n", 2, 6, "byte 0x01", "text" },
};

static void what_is_wrong_is_refused_at_its_place(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(refused) / sizeof(refused[0]); i++) {
		struct interp_tech_table *t = NULL;
		struct interp_diag d = { 0 };
		const int rc = interp_tech_read(&t, refused[i].text,
						strlen(refused[i].text), &d);

		if (rc == -EINVAL && !t && d.line == refused[i].line &&
		    d.column == refused[i].column &&
		    strstr(d.found, refused[i].found) &&
		    strstr(d.wanted, refused[i].wanted))
			continue;
		fail_msg("%s\n%d, %u:%u: %s; %s", refused[i].text, rc, d.line,
			 d.column, d.found, d.wanted);
	}
}

static void a_table_written_and_read_is_the_same_table(void **state)
{
	struct interp_tech_table *a = taken(
		"workpiece = steel\nnote = one\nnote = two\n"
		"condition, feed_max_mm_s, servo_v, polarity, abort_count\n"
		"E1,0.000001,15.123456789,-1,1000000000\nC9,0.1,-,,\n"
		"sequence Q1 = C9 E1\ninline S = - on_us*0.05\n");
	struct interp_tech_table *b;
	struct text once, twice;

	(void)state;
	write_out(a, &once);
	b = taken(once.at);
	write_out(b, &twice);
	assert_string_equal(once.at, twice.at);
	assert_int_equal(a->nrows, b->nrows);
	for (uint32_t i = 0; i < a->nrows; i++) {
		assert_int_equal(a->row[i].number, b->row[i].number);
		assert_memory_equal(&a->row[i].tech, &b->row[i].tech,
				    sizeof(a->row[i].tech));
	}
	assert_memory_equal(a->inlined, b->inlined, sizeof(a->inlined));
	assert_string_equal(b->note[1], "two");
	interp_tech_table_destroy(a);
	interp_tech_table_destroy(b);
}

static void a_table_that_gives_nothing_is_taken_again(void **state)
{
	struct interp_tech_table *a = taken("condition, servo_v\nE2,\n"), *b;
	struct text text;

	(void)state;
	write_out(a, &text);
	b = taken(text.at);
	assert_int_equal(b->nrows, 1);
	assert_int_equal(b->row[0].number, 2);
	interp_tech_table_destroy(a);
	interp_tech_table_destroy(b);
}

static void every_value_of_every_field_comes_back(void **state)
{
	struct interp_tech_table *t, *u;
	static char text[INTERP_NTECH * 64 + 64];
	struct text out;

	(void)state;
	srand(1);
	for (int i = 0; i < INTERP_NTECH; i++) {
		const struct interp_tech_field *f = &interp_tech_field[i];
		char number[32];
		double v = f->min + (f->max - f->min) * rand() / RAND_MAX;

		/* 15 digits, as many as the reader takes for sure. */
		snprintf(number, sizeof(number), "%.6f", f->whole ? f->max : v);
		snprintf(text, sizeof(text), "condition,%s\nC1,%s\n", f->name,
			 number);
		t = taken(text);
		write_out(t, &out);
		u = taken(out.at);
		assert_true(value(t, 'C', 1, (enum interp_tech_id)i) ==
			    strtod(number, NULL));
		assert_true(value(t, 'C', 1, (enum interp_tech_id)i) ==
			    value(u, 'C', 1, (enum interp_tech_id)i));
		interp_tech_table_destroy(t);
		interp_tech_table_destroy(u);
	}
}

static struct interp_tech_table *enc(const char *text, struct interp_diag *d)
{
	struct interp_tech_table *t = NULL;

	if (interp_tech_read_enc(&t, text, strlen(text), d))
		return NULL;
	return t;
}

static void an_enc_row_becomes_a_condition(void **state)
{
	struct interp_diag d;
	struct interp_tech_table *t = enc(
		"NR IP P HV GVHI GVLO TON TOF ISO AJD ET CB RAD SPA\n"
		"25 80 0 0 40 30 440 212 0 2.0 3.0 10 0.508 0.0\n"
		"10 6 0 120 40 30 8 20 1 1.0 0 10 0.6 5.0 1 2 3\n", &d);

	(void)state;
	assert_non_null(t);
	assert_true(value(t, 'C', 25, INTERP_TECH_PEAK_A) == 80);
	assert_true(isnan(value(t, 'C', 25, INTERP_TECH_IGNITION_V)));
	assert_true(isnan(value(t, 'C', 25, INTERP_TECH_POLARITY)));
	assert_true(value(t, 'C', 25, INTERP_TECH_WINDOW_HIGH_V) == 40);
	assert_true(value(t, 'C', 25, INTERP_TECH_WINDOW_LOW_V) == 30);
	assert_true(value(t, 'C', 25, INTERP_TECH_SERVO_V) == 35);
	assert_true(value(t, 'C', 25, INTERP_TECH_OFF_US) == 212);
	assert_true(value(t, 'C', 25, INTERP_TECH_JUMP_MM) == 2);
	assert_true(value(t, 'C', 25, INTERP_TECH_JUMP_EVERY_S) == 3);
	assert_true(value(t, 'C', 25, INTERP_TECH_ABORT_COUNT) == 10);
	assert_true(value(t, 'C', 25, INTERP_TECH_ORBIT_MM) == 0.508);
	assert_true(value(t, 'C', 10, INTERP_TECH_IGNITION_V) == 120);
	assert_true(isnan(value(t, 'C', 10, INTERP_TECH_JUMP_EVERY_S)));
	assert_true(isnan(value(t, 'C', 10, INTERP_TECH_ROUGHNESS_UM)));
	assert_true(t->nnotes == 1);
	interp_tech_table_destroy(t);
}

static void an_enc_row_that_is_none_is_refused(void **state)
{
	struct interp_diag d;

	(void)state;
	assert_null(enc("25 80 0 0 40 30 440 212 0 2.0\n", &d));
	assert_true(d.line == 1 && d.column == 30);
	assert_non_null(strstr(d.found, "10 numbers, ET is missing"));
	assert_null(enc("25 80 0 0 30 40 440 212 0 2 3 10 0.5 0\n", &d));
	assert_non_null(strstr(d.found, "window_low_v 40"));
	assert_null(enc("25 80 0 0 0 0 440 212 0 2 3 10 0.5 0\n", &d));
	assert_non_null(strstr(d.found, "midway from GVLO to GVHI"));
	assert_non_null(strstr(d.wanted, "from 0.1"));
	assert_null(enc("25 80 0 0 40 30 -1 212 0 2 3 10 0.5 0\n", &d));
	assert_true(d.line == 1 && d.column == 17);
	assert_null(enc("25.5 8 0 0 40 30 4 212 0 2 3 10 0.5 0\n", &d));
	assert_non_null(strstr(d.found, "stage"));
	assert_null(enc("2 8 x 0 40 30 4 212 0 2 3 10 0.5 0\n", &d));
	assert_non_null(strstr(d.found, "P 'x'"));
	assert_null(enc("2 8 0 0 40 30 4 212 0 2 3 10 0.5 0 1 1 1 1\n", &d));
	assert_non_null(strstr(d.found, "too many"));
}

static void a_row_must_go_over_the_machines_values(void **state)
{
	struct interp_tech_table *t =
		taken("condition,servo_v\nC1,20\nC2,70\n");
	struct interp_diag d = { 0 };
	struct interp_tech base;

	(void)state;
	interp_tech_clear(&base);
	base.v[INTERP_TECH_SHORT_V] = 8;
	base.v[INTERP_TECH_OPEN_V] = 100;
	assert_int_equal(interp_tech_table_fits(t, &base, &d), 0);
	base.v[INTERP_TECH_OPEN_V] = 60;
	assert_int_equal(interp_tech_table_fits(t, &base, &d), -EINVAL);
	assert_int_equal(d.line, 3);
	assert_non_null(strstr(d.found, "C002: servo_v 70 V is not below "
			       "open_v 60 V of the machine"));
	interp_tech_table_destroy(t);
}

static void the_nearest_conditions_are_named(void **state)
{
	struct interp_tech_table *t = taken("condition,servo_v\nC100,\nC110,\n"
					    "C120,\nC200,\nE001,\n");
	char buf[64];

	(void)state;
	assert_string_equal(interp_tech_near(t, 'C', 115, buf, sizeof(buf)),
			    "C100, C110, C120, C200");
	assert_string_equal(interp_tech_near(t, 'C', 1, buf, sizeof(buf)),
			    "C100, C110");
	assert_string_equal(interp_tech_near(t, 'S', 1, buf, sizeof(buf)),
			    "C200, E001");
	interp_tech_table_destroy(t);
}

static void a_pass_stops_short_by_gap_and_allowance(void **s)
{
	struct interp_tech t, last;

	(void)s;
	interp_tech_clear(&t);
	interp_tech_clear(&last);
	t.v[INTERP_TECH_GAP_MM] = 0.06;
	t.v[INTERP_TECH_ALLOWANCE_MM] = 0.04;
	assert_true(fabs(interp_tech_short_of_mm(&t, &last) - 0.04) < 1e-12);
	last.v[INTERP_TECH_GAP_MM] = 0.02;
	assert_true(fabs(interp_tech_short_of_mm(&t, &last) - 0.08) < 1e-12);
	last.v[INTERP_TECH_GAP_MM] = 0.2;
	assert_true(interp_tech_short_of_mm(&t, &last) == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_row_gives_what_its_cells_give),
		cmocka_unit_test(sequences_and_inline_columns_are_kept_in_order),
		cmocka_unit_test(what_is_wrong_is_refused_at_its_place),
		cmocka_unit_test(a_table_written_and_read_is_the_same_table),
		cmocka_unit_test(a_table_that_gives_nothing_is_taken_again),
		cmocka_unit_test(every_value_of_every_field_comes_back),
		cmocka_unit_test(an_enc_row_becomes_a_condition),
		cmocka_unit_test(an_enc_row_that_is_none_is_refused),
		cmocka_unit_test(a_row_must_go_over_the_machines_values),
		cmocka_unit_test(the_nearest_conditions_are_named),
		cmocka_unit_test(a_pass_stops_short_by_gap_and_allowance),
	};

	return cmocka_run_group_tests_name("tech", tests, NULL, NULL);
}
