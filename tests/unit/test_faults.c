/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_faults.c - promises of the table of faults and of the latch
 */
#include "cycle_help.h"

#include "fault.h"

#include <ctype.h>
#include <string.h>

#define EACH_FAULT(f) \
	for (enum cycle_fault f = FAULT_NONE + 1; f < CYCLE_NFAULTS; f++)

/* -- The table ------------------------------------------------------------ */

static void is_a_sentence(const char *text)
{
	const size_t n = text ? strlen(text) : 0;

	assert_true(n > 2);
	assert_true(text[n - 1] != '.' && text[n - 1] != ' ');
	assert_null(strstr(text, "  "));
}

static void every_fault_has_words(void **st)
{
	(void)st;
	EACH_FAULT(f) {
		const struct fault_row *row = &fault_table[f];

		is_a_sentence(row->name);
		is_a_sentence(row->what);
		is_a_sentence(row->why);
		is_a_sentence(row->clear);
		is_a_sentence(fault_motion_text(f));
		is_a_sentence(fault_scope_text(f));
		for (const char *c = row->name; *c; c++)
			assert_true(islower((unsigned char)*c) || *c == '-');
	}
	assert_string_equal(fault_name(FAULT_NONE), "none");
	assert_string_equal(fault_name(CYCLE_NFAULTS), "?");
}

static void no_two_faults_have_the_same_words(void **st)
{
	(void)st;
	EACH_FAULT(f)
		EACH_FAULT(g) {
			if (f == g)
				continue;
			assert_string_not_equal(fault_table[f].name,
						fault_table[g].name);
			assert_string_not_equal(fault_table[f].what,
						fault_table[g].what);
		}
}

/* Clients copy a name into a word of theirs, and a set into a line. */
static void names_and_their_list_fit_where_they_go(void **st)
{
	char all[512], some[16];

	(void)st;
	EACH_FAULT(f)
		assert_true(strlen(fault_table[f].name) < 32);
	fault_list(UINT64_MAX, all, sizeof(all));
	EACH_FAULT(f)
		assert_non_null(strstr(all, fault_table[f].name));
	assert_string_equal(fault_list(0, all, sizeof(all)), "");
	assert_string_equal(fault_list(fault_bit(FAULT_BUS) |
				       fault_bit(FAULT_ESTOP), all,
				       sizeof(all)), "e-stop bus");
	assert_true(strlen(fault_list(UINT64_MAX, some, sizeof(some))) <
		    sizeof(some));
}

/* An axis in trouble leaves others that can brake; no other fault does. */
static void power_is_taken_after_braking_only_from_axes_in_trouble(void **st)
{
	(void)st;
	EACH_FAULT(f)
		if (fault_table[f].disables)
			assert_int_equal(fault_table[f].motion,
					 f == FAULT_DRIVE ||
					 f == FAULT_FOLLOWING ? FAULT_BRAKES :
								FAULT_ENDS);
}

/* -- The latch ------------------------------------------------------------- */

static void the_first_is_kept_and_the_worst_is_known(void **st)
{
	struct fault s = { FAULT_NONE };

	(void)st;
	fault_latch(&s, FAULT_CONTACT);
	fault_latch(&s, FAULT_DOOR);
	assert_int_equal(s.first, FAULT_CONTACT);
	assert_int_equal(s.worst, FAULT_CONTACT);
	fault_latch(&s, FAULT_LIMIT_SWITCH);
	assert_int_equal(s.worst, FAULT_LIMIT_SWITCH);
	fault_latch(&s, FAULT_ESTOP);
	fault_latch(&s, FAULT_BUS);
	assert_int_equal(s.first, FAULT_CONTACT);
	assert_int_equal(s.worst, FAULT_ESTOP);
	assert_int_equal(__builtin_popcountll(s.latched), 5);
	assert_true(s.fresh == s.latched && s.untold == s.latched);
}

static void one_that_is_latched_is_not_fresh_again(void **st)
{
	struct fault s = { FAULT_NONE };

	(void)st;
	fault_latch(&s, FAULT_DOOR);
	s.fresh = s.untold = 0;
	fault_latch(&s, FAULT_DOOR);
	assert_true(s.fresh == 0 && s.untold == 0);
	fault_clear(&s);
	assert_int_equal(s.first, FAULT_NONE);
	fault_latch(&s, FAULT_DOOR);
	assert_true(s.fresh && s.untold);
}

static void what_is_seen_counts_by_what_the_machine_does(void **st)
{
	(void)st;
	for (int i = FAULT_IN_POWER; i <= FAULT_ALWAYS; i++) {
		for (int moves = 0; moves < 2; moves++) {
			for (int sparks = 0; sparks <= moves; sparks++) {
				struct fault s = { FAULT_NONE };

				fault_note_in(&s, FAULT_DOOR,
					   (enum fault_scope)i);
				fault_judge(&s, moves, sparks);
				assert_int_equal(s.latched != 0,
					i == FAULT_ALWAYS ||
					(i == FAULT_IN_MOTION && moves) ||
					(i == FAULT_IN_POWER && sparks));
			}
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_fault_has_words),
		cmocka_unit_test(no_two_faults_have_the_same_words),
		cmocka_unit_test(names_and_their_list_fit_where_they_go),
		cmocka_unit_test(power_is_taken_after_braking_only_from_axes_in_trouble),
		cmocka_unit_test(the_first_is_kept_and_the_worst_is_known),
		cmocka_unit_test(one_that_is_latched_is_not_fresh_again),
		cmocka_unit_test(what_is_seen_counts_by_what_the_machine_does),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
