/* SPDX-License-Identifier: Apache-2.0 */
/*
 * serve.c - the event loop of the main thread
 *
 * The cycle makes no system call to wake anyone.  So this loop looks every few
 * milliseconds.
 */
#include "serve.h"

#include "clock.h"
#include "clocks.h"
#include "log.h"
#include "programs.h"

#include <signal.h>
#include <string.h>
#include <systemd/sd-event.h>

#define LOOK_US		10000
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
	log_line(LOG_WARNING, "edmd: no stand within 1 s; ending");
	return true;
}

/*
 * A multiple of LOOK_US, where ticks of the kernel are too.  The cycle wakes in
 * the middle of its period, so neither is in its way.
 */
static uint64_t next_look(void)
{
	const uint64_t now_us = (uint64_t)clock_ns(CLOCK_MONOTONIC) / 1000;

	return (now_us / LOOK_US + 1) * LOOK_US;
}

static int on_look(sd_event_source *src, uint64_t usec, void *arg)
{
	struct server *s = arg;
	char note[160];

	(void)usec;
	programs_serve(&s->loop->crossing, s->config);
	report_notes(&s->loop->io);
	report_events(&s->report, s->loop->status);
	while (plc_link_note(&s->loop->plc, note, sizeof(note)))
		log_line(LOG_WARNING, "%s", note);
	report_watchdog(&s->report, beats(s->loop));
	if (end_is_due(s))
		return sd_event_exit(sd_event_source_get_event(src), 0);
	return sd_event_source_set_time(src, next_look());
}

static int on_signal(sd_event_source *src, const struct signalfd_siginfo *si,
		     void *arg)
{
	struct server *s = arg;

	if (s->end_by_ns != 0)
		return sd_event_exit(sd_event_source_get_event(src), 0);
	log_line(LOG_INFO, "edmd: %s: hold, then end",
		 si->ssi_signo == SIGINT ? "interrupt" : "terminated");
	report_stopping();
	crossing_flag_set(&s->loop->crossing.hold, true);
	s->end_by_ns = clock_ns(CLOCK_MONOTONIC) + STAND_NS;
	return 0;
}

static int sources_add(sd_event *e, struct server *s)
{
	sd_event_source *look = NULL;
	int err = sd_event_add_signal(e, NULL, SIGTERM, on_signal, s);

	if (err >= 0)
		err = sd_event_add_signal(e, NULL, SIGINT, on_signal, s);
	if (err >= 0)
		err = sd_event_add_time(e, &look, CLOCK_MONOTONIC,
					next_look(), 1, on_look, s);
	if (err >= 0)
		err = sd_event_source_set_enabled(look, SD_EVENT_ON);
	return err;
}

int serve(struct server *s)
{
	sd_event *e = NULL;
	int err = sd_event_default(&e);

	if (err >= 0)
		err = sources_add(e, s);
	if (err >= 0)
		err = sd_event_loop(e);
	if (err < 0)
		log_line(LOG_ERROR, "edmd: event loop: %s", strerror(-err));
	report_notes(&s->loop->io);
	report_events(&s->report, s->loop->status);
	sd_event_unref(e);
	return err;
}
