/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edges.c - the edge thread
 *
 * The two threads exchange messages (common/stamped.h).  A reader may be
 * interrupted for so long that the writer comes round to its slot.  Then it
 * reads again, a few times, and if that fails it keeps the message before.
 */
#include "edges.h"
#include "clocks.h"
#include "stamped.h"
#include "thread.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SLOTS		8		/* a power of two */
#define TRIES		4
#define IDLE_NS		500000		/* before the first target */
#define QUICK_WRITES	32

/* The shortest of the last QUICK_WRITES times, or of twice as many. */
struct quickest {
	int64_t before_ns, since_ns;	/* of the last full row; of this row */
	int n;				/* times in this row */
};

struct edges {
	struct edges_config c;
	STAMPED_ROW(struct edges_told, told, told_next, SLOTS);
	STAMPED_ROW(struct edges_shown, shown, shown_next, SLOTS);
	struct edges_told last_told;	/* the cycle's and ... */
	struct edges_shown last_shown;	/* ... the thread's own copies */
	struct pulser pulser;
	int32_t from[IO_NAXES], to[IO_NAXES];	/* of the period played */
	int32_t held_at[IO_NAXES];	/* target when a stop was told */
	bool held;
	int64_t slot_at_ns;		/* the last slot began then or before */
	int64_t changed_ns;		/* slot_at_ns of the last change */
	int pin_err, rank_err;		/* errno of its rights */
	bool noted;
	sem_t ready;
	struct quickest quickest;	/* from waking to the end of a write */
	struct edges_shown seen;	/* by the cycle */
	pthread_t thread;
	_Atomic bool quit;
};

_Static_assert(sizeof(struct edges_told) % 8 == 0, "whole words");
_Static_assert(sizeof(struct edges_shown) % 8 == 0, "whole words");

/* -- Between the threads -------------------------------------------------- */

/* What the cycle told last; if nothing new can be read, @last stays. */
static void hear(struct edges *e, struct edges_told *last)
{
	const struct stamped r = STAMPED(e->told, e->told_next);
	struct edges_told t;

	if (stamped_last(&r, TRIES, &t))
		*last = t;
}

void edges_tell(struct edges *e, const struct edges_told *t)
{
	const struct stamped r = STAMPED(e->told, e->told_next);

	stamped_put(&r, t);
}

void edges_ask(struct edges *e, struct edges_shown *ret)
{
	const struct stamped r = STAMPED(e->shown, e->shown_next);
	struct edges_shown s;

	if (stamped_last(&r, TRIES, &s))
		e->seen = s;
	*ret = e->seen;
}

/* -- Time ----------------------------------------------------------------- */

static void sleep_until(int64_t ns)
{
	const struct timespec t = { ns / 1000000000, ns % 1000000000 };

	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) ==
	       EINTR)
		;
}

static int64_t wait_until(int64_t ns)
{
	int64_t now = clock_ns(CLOCK_MONOTONIC);

	if (ns - now > EDGES_SPIN_NS) {
		sleep_until(ns - EDGES_SPIN_NS / 2);
		now = clock_ns(CLOCK_MONOTONIC);
	}
	while (now < ns)
		now = clock_ns(CLOCK_MONOTONIC);
	return now;
}

/* -- The thread ----------------------------------------------------------- */

/* A stop holds from when it is told to the next target after it. */
static void heed_stop(struct edges *e)
{
	struct edges_told t = e->last_told;

	hear(e, &t);
	if (t.stop) {
		e->held = true;
		memcpy(e->held_at, t.target, sizeof(e->held_at));
	} else if (e->held && memcmp(e->held_at, t.target,
				     sizeof(e->held_at)) != 0) {
		e->held = false;
		memcpy(e->from, e->pulser.put, sizeof(e->from));
	}
}

/* Spread @way pulses evenly over the slots, rounded to the nearest. */
static int64_t part(int64_t way, uint32_t slot, uint32_t slots)
{
	const int64_t n = (2 * llabs(way) * (slot + 1) + slots) / (2 * slots);

	return way < 0 ? -n : n;
}

static void aim(const struct edges *e, uint32_t slot, int32_t ret[IO_NAXES])
{
	for (int i = 0; i < IO_NAXES; i++) {
		const int64_t way = (int64_t)e->to[i] - e->from[i];

		/* Half the time of a pulse is left at both ends. */
		ret[i] = e->held ? e->pulser.put[i] :
			 (int32_t)(e->from[i] + part(way, slot, e->c.slots));
	}
}

/* Have all pulses begun?  The last one may end in the next period. */
static bool is_put(const struct edges *e)
{
	return memcmp(e->pulser.put, e->to, sizeof(e->to)) == 0;
}

/* Pulses of the axis that has most to go. */
static uint32_t left(const struct edges *e)
{
	int64_t most = 0;

	for (int i = 0; i < IO_NAXES; i++) {
		const int64_t n = llabs((int64_t)e->to[i] - e->pulser.put[i]);

		most = n > most ? n : most;
	}
	return (uint32_t)most;
}

static bool is_still(const struct edges *e)
{
	return is_put(e) && !pulser_busy(&e->pulser);
}

static void show(struct edges *e, bool end)
{
	const struct stamped r = STAMPED(e->shown, e->shown_next);
	struct edges_shown *s = &e->last_shown;

	memcpy(s->put, e->pulser.put, sizeof(s->put));
	if (end) {
		s->busy = left(e) > e->c.slots /
				    (4 * pulser_periods(&e->c.pulser));
		s->periods++;
	}
	stamped_put(&r, s);
}

static int64_t shorter(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

static int64_t quickest_of(struct quickest *q, int64_t ns)
{
	if (q->n == QUICK_WRITES)
		*q = (struct quickest) { q->since_ns, INT64_MAX, 0 };
	q->since_ns = shorter(q->since_ns, ns);
	q->n++;
	return shorter(q->before_ns, q->since_ns);
}

/*
 * The thread may lose its processor between waking and the change of the
 * lines. Lines that are known to be written at the end of the call changed no
 * later than the quickest write would have changed them, had it ended then.
 */
static bool write_lines(struct edges *e, int64_t woke_ns)
{
	const bool ok = e->c.write(e->c.arg, e->pulser.step, e->pulser.dir);
	const int64_t end_ns = clock_ns(CLOCK_MONOTONIC);

	e->slot_at_ns = end_ns - quickest_of(&e->quickest, end_ns - woke_ns);
	e->changed_ns = e->slot_at_ns;
	return ok;
}

/* Levels that the lines have already, to see how quick a write can be. */
static void learn_quickest(struct edges *e)
{
	e->quickest = (struct quickest) { INT64_MAX, INT64_MAX, 0 };
	for (int i = 0; i < QUICK_WRITES && !e->last_shown.lost; i++)
		e->last_shown.lost = !write_lines(e, clock_ns(CLOCK_MONOTONIC));
}

/* The lines keep each level for a slot at least, however late it came. */
static void play_slot(struct edges *e, uint32_t slot, int64_t at_ns)
{
	const int64_t slot_ns = e->c.period_ns / e->c.slots;
	const uint32_t step = e->pulser.step, dir = e->pulser.dir;
	int32_t target[IO_NAXES];
	int64_t woke;

	if (at_ns < e->slot_at_ns + slot_ns)
		at_ns = e->slot_at_ns + slot_ns;
	if (at_ns < e->changed_ns + pulser_level_ns(&e->pulser))
		at_ns = e->changed_ns + pulser_level_ns(&e->pulser);
	woke = wait_until(at_ns);
	e->last_shown.late += woke - at_ns > slot_ns;
	heed_stop(e);
	aim(e, slot, target);
	pulser_period(&e->pulser, target);
	e->slot_at_ns = woke;
	if (step == e->pulser.step && dir == e->pulser.dir)
		return;
	if (!write_lines(e, woke))
		e->last_shown.lost = 1;
	show(e, false);
}

/*
 * The thread sleeps through a period that has nothing to do.  A late slot may
 * be played after the end of its period: the next one keeps its distance.
 */
static void play(struct edges *e, int64_t from_ns)
{
	const int64_t slot_ns = e->c.period_ns / e->c.slots;
	const int64_t until_ns = from_ns + e->c.period_ns - slot_ns / 2;

	hear(e, &e->last_told);
	memcpy(e->from, e->held ? e->pulser.put : e->to, sizeof(e->from));
	memcpy(e->to, e->last_told.target, sizeof(e->to));
	heed_stop(e);
	for (uint32_t s = 0; s < e->c.slots && !e->last_shown.lost &&
	     !is_still(e) && e->slot_at_ns < until_ns; s++)
		play_slot(e, s, from_ns + (int64_t)s * e->c.period_ns /
					  e->c.slots);
	show(e, true);
}

static void be_real(struct edges *e)
{
	const struct edges_config *c = &e->c;
	const struct sched_param p = { .sched_priority = c->priority };
	cpu_set_t set;

	if (c->cpu >= 0) {
		CPU_ZERO(&set);
		CPU_SET((size_t)c->cpu, &set);
		e->pin_err = pthread_setaffinity_np(pthread_self(),
						    sizeof(set), &set);
	}
	if (c->priority > 0)
		e->rank_err = pthread_setschedparam(pthread_self(), SCHED_FIFO,
						    &p);
}

int64_t edges_next_ns(int64_t now_ns, int64_t period_ns)
{
	return now_ns - now_ns % period_ns + period_ns;
}

static void *run(void *arg)
{
	struct edges *e = arg;
	const struct stamped told = STAMPED(e->told, e->told_next);
	struct edges_told first;
	int64_t next;

	be_real(e);
	sem_post(&e->ready);
	learn_quickest(e);
	while (!atomic_load(&e->quit) && !stamped_last(&told, 1, &first))
		sleep_until(clock_ns(CLOCK_MONOTONIC) + IDLE_NS);
	/* The cycle wakes half a period before; daemon/setup/clock.h. */
	next = edges_next_ns(clock_ns(CLOCK_MONOTONIC), e->c.period_ns);
	while (!atomic_load(&e->quit)) {
		const int64_t late = clock_ns(CLOCK_MONOTONIC) - next;

		/* Periods that were missed are left out. */
		if (late > e->c.period_ns)
			next += late / e->c.period_ns * e->c.period_ns;
		sleep_until(next);
		play(e, next);
		next += e->c.period_ns;
	}
	while (e->pulser.phase == PULSER_HIGH && !e->last_shown.lost) {
		e->held = true;
		play_slot(e, 0, clock_ns(CLOCK_MONOTONIC));
	}
	return NULL;
}

int edges_start(struct edges **ret, const struct edges_config *c)
{
	struct edges *e = calloc(1, sizeof(*e));
	int err;

	if (!e)
		return -ENOMEM;
	e->c = *c;
	pulser_init(&e->pulser, &c->pulser);
	sem_init(&e->ready, 0, 0);
	err = thread_start(&e->thread, &(struct thread) {
		.name = "edmd-edges", .run = run, .arg = e });
	if (err) {
		free(e);
		return err;
	}
	while (sem_wait(&e->ready) < 0 && errno == EINTR)
		;
	*ret = e;
	return 0;
}

bool edges_note(struct edges *e, char *buf, size_t size)
{
	if (!e || e->noted || !(e->pin_err || e->rank_err))
		return false;
	e->noted = true;
	snprintf(buf, size, "edge thread: %s: %s; pulses come late under load: "
		 "%s", e->pin_err ? "core of its own" : "real-time priority",
		 strerror(e->pin_err ? e->pin_err : e->rank_err),
		 e->pin_err ? "[gpio] edges_cpu = a core that is online" :
			      "LimitRTPRIO=99 in edmd.service");
	return true;
}

void edges_end(struct edges *e)
{
	if (!e)
		return;
	atomic_store(&e->quit, true);
	pthread_join(e->thread, NULL);
	free(e);
}
