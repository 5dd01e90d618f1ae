/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loop.c - the real-time thread
 */
#include "loop.h"
#include "clocks.h"
#include "thread.h"

#include <errno.h>
#include <time.h>

/* Percentage of a period that the simulated periods may take. */
#define SPEED_SHARE	75

bool loop_stands(const struct loop *l)
{
	const struct cycle *c = &l->cycle;

	return (c->state == STATE_IDLE || c->state == STATE_HOLD ||
		c->state == STATE_FAULT) &&
	       c->feed_mm_s == 0 && !c->hold.moving;
}

static void count_one(uint32_t *bin)
{
	__atomic_store_n(bin, *bin + 1, __ATOMIC_RELAXED);
}

static void count_latency(struct loop *l, int64_t late_ns)
{
	count_one(&l->status->latency_us[setup_latency_bin(late_ns,
							   SHM_LATENCY_BINS)]);
	l->timing.late_ns = late_ns;
	if (late_ns > l->timing.late_max_ns)
		l->timing.late_max_ns = late_ns;
}

static void count_took(struct loop *l, int64_t took_ns)
{
	const int64_t part = took_ns * SHM_TOOK_PARTS / l->clock.period_ns;

	count_one(&l->status->took[part < SHM_TOOK_BINS ? part :
				   SHM_TOOK_BINS - 1]);
	l->timing.took_ns = took_ns;
	if (took_ns > l->timing.took_max_ns)
		l->timing.took_max_ns = took_ns;
}

/*
 * At another speed than 1 a missed period only means a slower picture.  It does
 * not happen to the simulated machine.
 */
static void tell_missed(struct loop *l, uint64_t missed)
{
	uint32_t told = missed < UINT32_MAX ? (uint32_t)missed : UINT32_MAX;

	if (l->speed == 1 && missed > 0)
		cycle_overrun(&l->cycle, told);
}

static void step(struct loop *l)
{
	struct io_inputs in;
	struct shm_trace t;

	l->io.read(l->io.self, &in);
	loop_plc_input(l, &in);
	cycle_step(&l->cycle, &in, &l->given);
	l->io.write(l->io.self, &l->given);
	loop_trace(l, &in, &t);
	shm_trace_put(l->status, &t);
	loop_notice(l);
}

/* As many periods as the speed says, or as many as there is time for. */
static void steps(struct loop *l, int64_t woke_ns)
{
	int64_t until_ns = woke_ns + l->clock.period_ns * SPEED_SHARE / 100;

	for (uint32_t i = 0; i < l->speed; i++) {
		step(l);
		if (l->speed > 1 && clock_ns(CLOCK_MONOTONIC) >= until_ns)
			break;
	}
}

/* Stop all motion, and let nothing start it again. */
static void end_if_asked(struct loop *l)
{
	static const struct cycle_command hold = { .verb = CYCLE_HOLD };

	if (l->ending || !crossing_flag(&l->crossing.hold))
		return;
	l->ending = true;
	if (!loop_stands(l))
		cycle_command(&l->cycle, &hold);
}

static void period(struct loop *l, const struct setup_wake *w)
{
	struct crossing *x = &l->crossing;
	struct shm_snapshot s;

	l->time_ns = clock_ns(CLOCK_REALTIME);
	count_latency(l, w->late_ns);
	tell_missed(l, w->missed);
	end_if_asked(l);
	loop_commands(l);
	loop_replies(l);
	loop_plc_read(l);
	steps(l, w->woke_ns);
	loop_plc_write(l);
	loop_drives(l);

	count_took(l, clock_ns(CLOCK_MONOTONIC) - w->woke_ns);
	loop_snapshot(l, &s);
	shm_snapshot_put(l->status, &s);
	crossing_flag_set(&x->stands, l->ending && loop_stands(l));
	__atomic_store_n(&x->beats, x->beats + 1, __ATOMIC_RELAXED);
}

/* Power and pump off; the axes stay where they are and lose their power. */
static void outputs_safe(struct loop *l)
{
	struct io_outputs out = l->given;

	/* Before the first period the axes were given no targets. */
	if (l->cycle.count == 0)
		return;
	out.power = false;
	out.pump = false;
	out.enable = false;
	l->io.write(l->io.self, &out);
}

static void *run(void *arg)
{
	struct loop *l = arg;

	setup_thread(l->report, &l->wanted);
	sem_post(&l->ready);
	setup_clock_start(&l->clock, l->cycle.config.period_ns);
	while (!crossing_flag(&l->crossing.quit)) {
		struct setup_wake w = setup_clock_wait(&l->clock);

		period(l, &w);
	}
	outputs_safe(l);
	return NULL;
}

int loop_start(struct loop *l, struct setup_report *report)
{
	int err;

	l->report = report;
	l->told = (struct loop_told) {
		.state = l->cycle.state,
		.outcome = l->cycle.outcome,
	};
	sem_init(&l->ready, 0, 0);
	err = thread_start(&l->thread, &(struct thread) {
		.name = "edmd-cycle", .run = run, .arg = l,
		.stack_bytes = SETUP_STACK_BYTES,
	});
	while (err == 0 && sem_wait(&l->ready) < 0 && errno == EINTR)
		;
	sem_destroy(&l->ready);
	return err;
}

void loop_stop(struct loop *l)
{
	crossing_flag_set(&l->crossing.quit, true);
	pthread_join(l->thread, NULL);
}
