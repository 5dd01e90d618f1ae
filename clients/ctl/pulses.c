/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pulses.c - how fast a GPIO line of this board can be driven
 *
 * One output line, to which nothing may be connected, is written as the edge
 * thread of edmd would: at absolute times, without sleeping in between.  A
 * drive would notice a write that is late by more than half the time between
 * two writes.
 */
#include "ctl.h"

#include "clocks.h"
#include "lines.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sysexits.h>
#include <time.h>

#define WRITES		20000
#define TRIAL_NS	500000000LL
#define PRIORITY	79		/* of the edge thread, by default */

static const int64_t slots_ns[] = {
	100000, 50000, 25000, 12500, 10000, 6250, 5000, 2500
};

#define NSLOTS		(sizeof(slots_ns) / sizeof(slots_ns[0]))

static int by_size(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

/* "gpiochip0:5"; the chip is a name or a device file. */
static struct lines *line_open(const char *text, struct lines_chip **ret_chip)
{
	const char *colon = strrchr(text, ':');
	const uint8_t low = 0;
	struct lines_wanted w = { .value = &low, .n = 1, .output = true };
	struct lines *l = NULL;
	unsigned int offset;
	char path[96];
	int err;

	if (!colon || colon[1] < '0' || colon[1] > '9') {
		fprintf(stderr, "edmctl: '%s' is no line; CHIP:NUMBER, as "
			"gpiochip0:5\n", text);
		return NULL;
	}
	offset = (unsigned int)atoi(colon + 1);
	w.offset = &offset;
	snprintf(path, sizeof(path), "%s%.*s", *text == '/' ? "" : "/dev/",
		 (int)(colon - text), text);
	err = lines_chip_open(ret_chip, path);
	if (err == 0)
		err = lines_request(&l, *ret_chip, &w);
	if (err < 0)
		fprintf(stderr, "edmctl: %s: %s; a free line of a chip that "
			"gpiodetect lists, and the right to it\n", text,
			strerror(-err));
	return l;
}

/* Get the priority of the edge thread.  Return: false if that is refused. */
static bool be_real(void)
{
	const struct sched_param p = { .sched_priority = PRIORITY };

	mlockall(MCL_CURRENT | MCL_FUTURE);
	return sched_setscheduler(0, SCHED_FIFO, &p) == 0;
}

struct trial {
	int64_t slot_ns;
	int64_t *late_ns;		/* sorted */
	size_t n, bad;			/* writes; later than half a slot */
};

static void writes_time(struct lines *l, int64_t *took_ns)
{
	uint8_t level = 0;

	for (int i = 0; i < WRITES; i++) {
		const int64_t from = clock_ns(CLOCK_MONOTONIC);

		level = !level;
		lines_set(l, &level);
		took_ns[i] = clock_ns(CLOCK_MONOTONIC) - from;
	}
	qsort(took_ns, WRITES, sizeof(took_ns[0]), by_size);
}

/* A missed slot is not made up for. */
static void trial_run(struct lines *l, struct trial *t)
{
	int64_t at = clock_ns(CLOCK_MONOTONIC) + t->slot_ns, now;
	uint8_t level = 0;

	for (size_t i = 0; i < t->n; i++) {
		do
			now = clock_ns(CLOCK_MONOTONIC);
		while (now < at);
		level = !level;
		lines_set(l, &level);
		t->late_ns[i] = now - at;
		t->bad += t->late_ns[i] > t->slot_ns / 2;
		at += t->slot_ns;
		if (at < now)
			at = now + t->slot_ns;
	}
	qsort(t->late_ns, t->n, sizeof(t->late_ns[0]), by_size);
}

/* Return: the shortest time between two writes that was kept; 0: none was. */
static int64_t trials(struct lines *l, int64_t *room)
{
	int64_t best = 0;

	printf("\n%10s %10s %12s %10s %12s\n", "write each", "edges/s",
	       "late, 99.9 %", "worst", "too late");
	for (size_t i = 0; i < NSLOTS; i++) {
		struct trial t = {
			.slot_ns = slots_ns[i], .late_ns = room,
			.n = (size_t)(TRIAL_NS / slots_ns[i]),
		};

		trial_run(l, &t);
		printf("%7.2f us %10.0f %9.2f us %7.2f us %8zu of %zu\n",
		       (double)t.slot_ns / 1e3, 1e9 / (double)t.slot_ns,
		       (double)t.late_ns[t.n * 999 / 1000] / 1e3,
		       (double)t.late_ns[t.n - 1] / 1e3, t.bad, t.n);
		fflush(stdout);
		if (t.bad > 0)
			break;
		best = t.slot_ns;
	}
	return best;
}

static void advise(int64_t best, bool real)
{
	if (!real)
		printf("\nNot at real-time priority: figures of a thread that "
		       "others interrupt; run it as root.\n");
	if (best == 0)
		printf("\nNot even 100 us between two writes was kept: leave "
		       "edges_per_period = 1.\n");
	else
		printf("\nKept: a write each %g us.  [gpio] edges_per_period = "
		       "%.0f with period_us = 250, %.0f with 1000; with load, "
		       "measure again.\n", (double)best / 1e3,
		       250e3 / (double)best, 1e6 / (double)best);
}

int ctl_pulses(const char *line)
{
	const size_t most = (size_t)(TRIAL_NS / slots_ns[NSLOTS - 1]);
	int64_t *room = calloc(most, sizeof(*room));
	struct lines_chip *chip = NULL;
	struct lines *l = room ? line_open(line, &chip) : NULL;
	const uint8_t low = 0;

	if (l) {
		const bool real = be_real();

		writes_time(l, room);
		printf("a write takes %.2f us, 99.9 %% %.2f us, at most %.2f us"
		       "\n", (double)room[WRITES / 2] / 1e3,
		       (double)room[WRITES * 999 / 1000] / 1e3,
		       (double)room[WRITES - 1] / 1e3);
		advise(trials(l, room), real);
		lines_set(l, &low);
	}
	lines_release(l);
	if (chip)
		lines_chip_close(chip);
	free(room);
	return l ? EX_OK : EX_UNAVAILABLE;
}
