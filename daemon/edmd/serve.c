/* SPDX-License-Identifier: Apache-2.0 */
/*
 * serve.c - the loop of the main thread
 *
 * The cycle makes no system call to wake anyone.  So this loop looks every few
 * milliseconds.  A signal and the time of the next look are waited for by one
 * system call.
 */
#include "serve.h"

#include "clock.h"
#include "clocks.h"
#include "log.h"
#include "programs.h"

#include <signal.h>
#include <sys/prctl.h>

#define LOOK_NS		10000000LL
#define STAND_NS	1000000000LL	/* time that the machine gets to stop */

static uint64_t beats(const struct loop *l)
{
	return __atomic_load_n(&l->crossing.beats, __ATOMIC_RELAXED);
}

/* With the hold, power goes off at once; the motion ends within its limits. */
static bool end_is_due(const struct server *s)
{
	if (s->end_by_ns == 0)
		return false;
	if (crossing_flag(&s->loop->crossing.stands))
		return true;
	if (clock_ns(CLOCK_MONOTONIC) < s->end_by_ns)
		return false;
	log_line(LOG_WARNING, "edmd: the axes did not stop within 1 s; "
		 "edmd ends while they move");
	return true;
}

/*
 * Until a multiple of LOOK_NS, where ticks of the kernel are too.  The cycle
 * wakes in the middle of its period, so neither is in its way.
 *
 * Return: the signal that came before that; or -1.
 */
static int wait_for_look(const sigset_t *ends)
{
	const struct timespec left = {
		.tv_nsec = LOOK_NS - clock_ns(CLOCK_MONOTONIC) % LOOK_NS,
	};

	return sigtimedwait(ends, NULL, &left);
}

static void look(struct server *s)
{
	char note[160];

	programs_serve(&s->loop->crossing, s->config, &s->ahead);
	report_notes(&s->loop->io);
	report_events(&s->report, s->loop->status);
	while (plc_link_note(&s->loop->plc, note, sizeof(note)))
		log_line(LOG_WARNING, "%s", note);
	report_watchdog(&s->report, beats(s->loop));
}

static void begin_end(struct server *s, int signal)
{
	log_line(LOG_INFO, "edmd: %s: hold, then end",
		 signal == SIGINT ? "interrupt" : "terminated");
	report_stopping();
	crossing_flag_set(&s->loop->crossing.hold, true);
	s->end_by_ns = clock_ns(CLOCK_MONOTONIC) + STAND_NS;
}

void serve_signals(sigset_t *ret)
{
	sigemptyset(ret);
	sigaddset(ret, SIGTERM);
	sigaddset(ret, SIGINT);
}

void serve(struct server *s)
{
	bool over = false;
	sigset_t ends;

	serve_signals(&ends);
	/* Otherwise a look may come 50 us late, where a cycle wakes. */
	prctl(PR_SET_TIMERSLACK, 1);
	while (!over) {
		const int signal = wait_for_look(&ends);

		if (signal < 0) {
			look(s);
			over = end_is_due(s);
		} else if (s->end_by_ns == 0) {
			begin_end(s, signal);
		} else {
			over = true;
		}
	}
	program_close(s->ahead);
	report_notes(&s->loop->io);
	report_events(&s->report, s->loop->status);
}
