/* SPDX-License-Identifier: Apache-2.0 */
/* test_share.c - whoever comes gets a share, whatever a crowd holds */
#include "share.h"
#include "seed.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define KIND	SHARE_UPLOAD		/* the scarcest: 4 */
#define MOST	4
#define PEERS	6
#define ITEMS	600

struct item {
	struct share share;
	int peer, rank;
	bool held;
};

static struct shares *all;
static struct item item[ITEMS];
static struct item *ended;		/* the last one that made room */

static void on_end(void *arg, const char *why)
{
	assert_non_null(why);
	ended = arg;
	ended->held = false;
}

static int setup(void **state)
{
	(void)state;
	all = shares_create();
	memset(item, 0, sizeof(item));
	ended = NULL;
	return all ? 0 : -1;
}

static int teardown(void **state)
{
	(void)state;
	for (int i = 0; i < ITEMS; i++)
		share_give(&item[i].share);
	for (int k = 0; k < SHARE_NKINDS; k++)
		assert_int_equal(share_held(all, (enum share_kind)k), 0);
	shares_destroy(all);
	return 0;
}

static int take(struct item *t, enum share_kind kind, int peer, int rank)
{
	struct share_who who = { .rank = rank };
	int err;

	snprintf(who.peer, sizeof(who.peer), "peer %d", peer);
	t->share.kind = kind;
	t->share.end = on_end;
	t->share.arg = t;
	t->peer = peer;
	t->rank = rank;
	ended = NULL;
	err = share_take(all, &t->share, &who);
	t->held = err == 0;
	return err;
}

static int held_by(int peer)
{
	int n = 0;

	for (int i = 0; i < ITEMS; i++)
		n += item[i].held && item[i].peer == peer;
	return n;
}

static void a_crowd_keeps_nobody_out(void **state)
{
	(void)state;
	for (int kind = 0; kind < SHARE_NKINDS; kind++) {
		int n = 0;

		teardown(NULL);
		setup(NULL);
		while (take(&item[n], (enum share_kind)kind, 0, 1) == 0)
			n++;
		assert_null(ended);
		/* A stranger like them, and then somebody with more rights. */
		assert_int_equal(take(&item[n + 1], (enum share_kind)kind, 1,
				      1), 0);
		assert_int_equal(ended->peer, 0);
		assert_int_equal(take(&item[n + 2], (enum share_kind)kind, 2,
				      2), 0);
		assert_int_equal(ended->peer, 0);
		/* What was lost is not to be had back. */
		assert_int_equal(take(&item[n + 3], (enum share_kind)kind, 0,
				      1), -EBUSY);
	}
}

static void who_has_more_rights_gets_all_of_it(void **state)
{
	(void)state;
	for (int i = 0; i < MOST; i++)
		assert_int_equal(take(&item[i], KIND, i, 1), 0);
	for (int i = 0; i < MOST; i++)
		assert_int_equal(take(&item[10 + i], KIND, 9, 2), 0);
	assert_int_equal(take(&item[0], KIND, 0, 1), -EBUSY);
	/* Of one's own nothing goes that is under way. */
	assert_int_equal(take(&item[20], KIND, 9, 2), -EBUSY);
	item[11].share.idle = true;
	assert_int_equal(take(&item[20], KIND, 9, 2), 0);
	assert_ptr_equal(ended, &item[11]);
}

static void nobody_takes_to_and_fro(void **state)
{
	int taken = 0;

	(void)state;
	for (int i = 0; i < MOST; i++)
		take(&item[i], KIND, 0, 1);
	for (int round = 0; round < 100; round++) {
		for (int peer = 0; peer < 3; peer++) {
			int i = 0;

			while (item[i].held)
				i++;
			take(&item[i], KIND, peer, 1);
			taken += ended != NULL;
		}
	}
	/* 2, 1, 1: nothing more equal can be had. */
	assert_int_equal(taken, 2);
}

static void the_oldest_idle_one_goes_first(void **state)
{
	(void)state;
	for (int i = 0; i < MOST; i++) {
		item[i].share.idle = true;
		take(&item[i], KIND, 0, 1);
		item[i].share.used_ms = i;
	}
	item[0].share.used_ms = 100;
	item[1].share.idle = false;
	assert_int_equal(take(&item[9], KIND, 1, 1), 0);
	assert_ptr_equal(ended, &item[2]);
}

static void what_lasts_too_long_ends(void **state)
{
	(void)state;
	for (int i = 0; i < MOST; i++)
		take(&item[i], KIND, i, 1);
	share_limit(&item[1].share, 1);
	share_limit(&item[2].share, 60);
	shares_look(all);
	assert_int_equal(share_held(all, KIND), MOST);
	item[1].share.until_ms = 1;
	shares_look(all);
	assert_int_equal(share_held(all, KIND), MOST - 1);
	assert_ptr_equal(ended, &item[1]);
}

/* What may go for @t; the numbers are those before. */
static void check_ended(const struct item *t, const int had[PEERS])
{
	if (!ended || ended->rank < t->rank)
		return;
	assert_int_equal(ended->rank, t->rank);
	if (ended->peer == t->peer)
		assert_true(ended->share.idle);
	else if (ended->share.idle)
		assert_true(had[ended->peer] > had[t->peer]);
	else
		assert_true(had[ended->peer] > had[t->peer] + 1);
}

/* A refusal is right if nobody of a lower rank holds one, and nobody of the
 * same rank so many more. */
static void check_refused(const struct item *t, const int had[PEERS])
{
	for (int i = 0; i < ITEMS; i++) {
		if (!item[i].held)
			continue;
		assert_true(item[i].rank >= t->rank);
		if (item[i].rank == t->rank)
			assert_true(had[item[i].peer] <= had[t->peer] + 1);
	}
}

static void random_takers_get_what_is_theirs(void **state)
{
	(void)state;
	srand((unsigned int)seed_take());
	for (int round = 0; round < SEED_ROUNDS(200000); round++) {
		struct item *t = &item[rand() % 12];
		int had[PEERS];

		if (t->held) {
			share_give(&t->share);
			t->held = false;
			continue;
		}
		for (int p = 0; p < PEERS; p++)
			had[p] = held_by(p);
		t->share.idle = rand() % 2;
		if (take(t, KIND, rand() % PEERS, rand() % 3) == 0)
			check_ended(t, had);
		else
			check_refused(t, had);
		assert_true(share_held(all, KIND) <= MOST);
	}
}

#define T(f)	cmocka_unit_test_setup_teardown(f, setup, teardown)

int main(void)
{
	const struct CMUnitTest tests[] = {
		T(a_crowd_keeps_nobody_out),
		T(who_has_more_rights_gets_all_of_it),
		T(nobody_takes_to_and_fro),
		T(the_oldest_idle_one_goes_first),
		T(what_lasts_too_long_ends),
		T(random_takers_get_what_is_theirs),
	};

	return cmocka_run_group_tests_name("panel/share", tests, NULL, NULL);
}
