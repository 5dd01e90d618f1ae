/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_checkpoint.c - the place on the disk: written late, torn or foreign, and
 * how many bytes are written
 */
#include "checkpoint.h"
#include "folder_help.h"
#include "seed.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static struct checkpoint_base base_at(double far_mm, uint64_t cycles)
{
	struct checkpoint_base b;

	memset(&b, 0, sizeof(b));
	b.job.n = 7;
	b.job.begun = 1;
	b.utime = (int64_t)cycles * 1000;
	b.snap.state = SHM_ERODE;
	b.snap.loaded = true;
	b.snap.program = 7;
	b.snap.period_ns = 1000000;
	b.snap.far_mm = b.snap.place_mm = far_mm;
	b.snap.job_cycles = cycles;
	b.snap.override = 1;
	return b;
}

static void wait_written(struct checkpoint_file *f, uint64_t writes)
{
	struct checkpoint_stats s;

	do {
		usleep(1000);
		checkpoint_stats(f, &s);
	} while (s.writes < writes && !s.err);
	assert_int_equal(s.err, 0);
}

static struct checkpoint read_back(const char *machine)
{
	struct checkpoint_file *f;
	struct checkpoint c;

	assert_int_equal(checkpoint_open(&f, folder, machine, &c), 0);
	checkpoint_close(f);
	return c;
}

static void what_was_written_is_read(void **state)
{
	struct checkpoint_base b = base_at(1, 1000);
	struct checkpoint_file *f;
	struct checkpoint c;

	(void)state;
	assert_int_equal(checkpoint_open(&f, folder, "m", &c), 0);
	assert_false(c.there);
	checkpoint_look(f, &b, 1);
	wait_written(f, 1);
	b = base_at(1.5, 3000);
	b.snap.seg = 9;
	b.snap.pos[2] = -77;
	checkpoint_look(f, &b, 2);
	checkpoint_close(f);
	c = read_back("m");
	assert_true(c.there);
	assert_int_equal(c.base.job.n, 7);
	assert_true(c.base.snap.far_mm == 1.5);
	assert_int_equal(c.base.snap.seg, 9);
	assert_int_equal(c.base.snap.pos[2], -77);
	assert_int_equal(c.utime, 3000000);
	c = read_back("other");
	assert_false(c.there);
}

/* A block cut short at any byte, or with any byte turned, does not count; the
 * one before it does. */
static void a_torn_block_leaves_the_one_before(void **state)
{
	const uint64_t seed = seed_take();
	static const double expected_mm[] = { 1, 6, 5, 6 };
	union checkpoint_block *block = calloc(4, sizeof(*block));
	struct checkpoint_head head;
	struct checkpoint c;

	(void)state;
	srandom((unsigned int)seed);
	for (uint64_t n = 1; n <= 2; n++) {
		union checkpoint_block *b = &block[n & 1];

		b->head.kind = CHECKPOINT_BASE;
		b->head.sequence = n;
		strcpy(b->head.machine, "m");
		b->base = base_at((double)n, n * 1000);
		checkpoint_seal(b);
	}
	for (uint64_t n = 5; n <= 6; n++) {
		union checkpoint_block *b = &block[2 + (n & 1)];
		struct checkpoint_base at = base_at((double)n, n * 1000);

		b->head.kind = CHECKPOINT_PLACE;
		b->head.sequence = 2;
		b->head.count = n;
		strcpy(b->head.machine, "m");
		b->place = checkpoint_place_of(&at);
		checkpoint_seal(b);
	}
	checkpoint_choose(block, "m", &c, &head);
	assert_true(c.base.snap.far_mm == 6);
	for (int i = 0; i < 2000; i++) {
		const long which = random() % 4;
		union checkpoint_block kept = block[which];
		const long bytes = which < 2 ? CHECKPOINT_BLOCK :
					       CHECKPOINT_SECTOR;
		const long at = random() % bytes;

		if (i & 1)
			block[which].bytes[at] ^= (uint8_t)(1 + random() % 255);
		else
			memset(block[which].bytes + at, 0xa5,
			       (size_t)(bytes - at));
		checkpoint_choose(block, "m", &c, &head);
		assert_true(c.there);
		/* The base before, without a place; the place before. */
		assert_true(c.base.snap.far_mm == expected_mm[which]);
		block[which] = kept;
	}
	free(block);
}

/* An hour of virtual time of a cut with jumps: how late, and how much. */
static void lateness_and_load_are_bounded(void **state)
{
	const double hours = 2, feed_mm_s = 0.006;
	double far_mm = 0, worst_mm = 0, worst_s = 0, day_bytes;
	struct checkpoint_base b = base_at(0, 0), last = b;
	struct checkpoint_stats s, was = { .writes = 0 };
	struct checkpoint_file *f;
	struct checkpoint c;

	(void)state;
	assert_int_equal(checkpoint_open(&f, folder, "m", &c), 0);
	for (int64_t us = 0; us < (int64_t)(hours * 3600e6); us += 20000) {
		far_mm += feed_mm_s * 0.02;
		b = base_at(far_mm, (uint64_t)us / 1000);
		/* A jump every two seconds. */
		b.snap.state = us / 1000000 % 2 ? SHM_JUMP : SHM_ERODE;
		b.utime = us;
		checkpoint_look(f, &b, us + 1);
		checkpoint_stats(f, &s);
		if (s.handed != was.handed)
			last = b;
		was = s;
		worst_mm = fmax(worst_mm, far_mm - last.snap.far_mm);
		worst_s = fmax(worst_s, (double)(us - last.utime) / 1e6);
	}
	checkpoint_close(f);
	day_bytes = (double)s.handed_bytes * 24 / hours;
	print_message(
		"%g h of a cut with a jump each second: %llu writes, %.1f "
		"MB a day; late by %.2f s and %.4f mm at most\n",
		hours, (unsigned long long)s.handed, day_bytes / 1e6, worst_s,
		worst_mm);
	assert_true(day_bytes <= CHECKPOINT_DAY_BYTES);
	/* Where the disk takes sectors. */
	if (s.handed_bytes < s.handed * CHECKPOINT_BLOCK / 2)
		assert_true(worst_s <= 1 && worst_mm <= 0.05);
}

/* A machine that changes all the time must not wear its card out. */
static void the_worst_load_is_within_its_budget(void **state)
{
	struct checkpoint_file *f;
	struct checkpoint_stats s;
	struct checkpoint c;

	(void)state;
	assert_int_equal(checkpoint_open(&f, folder, "m", &c), 0);
	for (int64_t us = 0; us < (int64_t)3600e6; us += 20000) {
		struct checkpoint_base b = base_at((double)us, (uint64_t)us);

		b.snap.override = (double)(us % 7);
		checkpoint_look(f, &b, us + 1);
	}
	checkpoint_stats(f, &s);
	checkpoint_close(f);
	print_message("all changes all the time: %.1f MB a day\n",
		      (double)s.handed_bytes * 24 / 1e6);
	/* And what was saved up before, once. */
	assert_true((double)s.handed_bytes <=
		    CHECKPOINT_DAY_BYTES / 24 + 1.1e6);
}

static void one_that_stands_writes_nothing(void **state)
{
	struct checkpoint_base b = base_at(1, 1000);
	struct checkpoint_file *f;
	struct checkpoint_stats s;
	struct checkpoint c;

	(void)state;
	b.snap.state = SHM_IDLE;
	assert_int_equal(checkpoint_open(&f, folder, "m", &c), 0);
	for (int64_t us = 0; us < (int64_t)600e6; us += 20000) {
		b.utime = us;
		b.snap.cycle = (uint64_t)us;
		b.snap.gap_v = (double)us;
		checkpoint_look(f, &b, us + 1);
	}
	wait_written(f, 1);
	checkpoint_stats(f, &s);
	assert_int_equal(s.writes, 1);
	checkpoint_close(f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
#define T(f)	cmocka_unit_test_setup_teardown(f, folder_make, folder_remove)
		T(what_was_written_is_read),
		T(a_torn_block_leaves_the_one_before),
		T(lateness_and_load_are_bounded),
		T(the_worst_load_is_within_its_budget),
		T(one_that_stands_writes_nothing),
	};

	if (sodium_init() < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
