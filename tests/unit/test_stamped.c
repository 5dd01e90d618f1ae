/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_stamped.c - records from one writer to readers that it overtakes
 */
#include "stamped.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#include "seed.h"

#define WORDS		12
#define SLOTS		4
#define READERS		2

struct slot {
	uint64_t stamp;
	uint64_t word[WORDS];
};

struct row {
	struct slot slot[SLOTS];
	uint64_t next;
	struct stamped r;
	uint64_t records;
	bool over;
};

static void row_init(struct row *w, size_t count)
{
	memset(w, 0, sizeof(*w));
	w->r = (struct stamped) { w->slot, &w->next, count,
				  sizeof(w->slot[0]) };
}

/* Each word of record @n is n. */
static void put(const struct row *w, uint64_t n)
{
	uint64_t word[WORDS];

	for (int i = 0; i < WORDS; i++)
		word[i] = n;
	stamped_put(&w->r, word);
}

static bool last(const struct row *w, uint64_t *ret)
{
	uint64_t word[WORDS];

	if (!stamped_last(&w->r, 4, word))
		return false;
	for (int i = 0; i < WORDS; i++)
		if (word[i] != word[0])
			fail_msg("record %llu has a word of %llu",
				 (unsigned long long)word[0],
				 (unsigned long long)word[i]);
	*ret = word[0];
	return true;
}

static void nothing_is_read_before_the_first_record(void **state)
{
	struct row w;
	uint64_t n;

	(void)state;
	row_init(&w, SLOTS);
	assert_false(last(&w, &n));
	put(&w, 7);
	assert_true(last(&w, &n));
	assert_int_equal(n, 7);
}

static void a_record_is_there_until_its_slot_is_needed(void **state)
{
	uint64_t word[WORDS];
	struct row w;

	(void)state;
	row_init(&w, SLOTS);
	for (uint64_t n = 0; n < 100; n++) {
		put(&w, n);
		for (uint64_t i = 0; i <= n; i++) {
			const bool there = i + SLOTS > n;

			assert_int_equal(stamped_get(&w.r, i, word), there);
			if (there)
				assert_int_equal(word[WORDS - 1], i);
		}
	}
}

/* Killed at each word of a record: the one before is whole, and the next writer
 * goes on. */
static void a_killed_writer_leaves_the_record_before(void **state)
{
	struct row w, half;
	uint64_t n;

	(void)state;
	for (int cut = 0; cut <= WORDS; cut++) {
		row_init(&w, 2);
		put(&w, 1);
		put(&w, 2);
		half = w;
		half.slot[0].stamp = 2 * 2 + 1;
		for (int i = 0; i < cut; i++)
			half.slot[0].word[i] = 3;
		half.r.slots = half.slot;
		half.r.next = &half.next;
		assert_true(last(&half, &n));
		assert_int_equal(n, 2);
		put(&half, 4);
		assert_true(last(&half, &n));
		assert_int_equal(n, 4);
	}
}

static void *write_all(void *arg)
{
	struct row *w = arg;

	for (uint64_t n = 1; n <= w->records; n++)
		put(w, n);
	__atomic_store_n(&w->over, true, __ATOMIC_RELEASE);
	return NULL;
}

static void *read_all(void *arg)
{
	struct row *w = arg;
	uint64_t n, before = 0;
	bool over;

	do {
		over = __atomic_load_n(&w->over, __ATOMIC_ACQUIRE);
		if (!last(w, &n))
			continue;
		if (n < before)
			return (void *)"an older record came later";
		before = n;
	} while (!over);
	return before == w->records ? NULL : (void *)"the last was not read";
}

/* The writer never waits, so it comes round while they read. */
static void what_is_read_is_whole_and_never_older(void **state)
{
	pthread_t writer, reader[READERS];
	struct row w;
	void *wrong;

	(void)state;
	for (size_t count = 2; count <= SLOTS; count *= 2) {
		row_init(&w, count);
		w.records = (uint64_t)SEED_ROUNDS(2000000);
		for (int i = 0; i < READERS; i++)
			assert_int_equal(pthread_create(&reader[i], NULL,
							read_all, &w), 0);
		assert_int_equal(pthread_create(&writer, NULL, write_all, &w),
				 0);
		for (int i = 0; i < READERS; i++) {
			pthread_join(reader[i], &wrong);
			if (wrong)
				fail_msg("%s", (char *)wrong);
		}
		pthread_join(writer, NULL);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_is_read_before_the_first_record),
		cmocka_unit_test(a_record_is_there_until_its_slot_is_needed),
		cmocka_unit_test(a_killed_writer_leaves_the_record_before),
		cmocka_unit_test(what_is_read_is_whole_and_never_older),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
