/* SPDX-License-Identifier: Apache-2.0 */
/* report.c - events as lines of the log */
#include "report.h"

#include "clock.h"
#include "clocks.h"
#include "cycle.h"
#include "hunting.h"
#include "process.h"
#include "log.h"
#include "stands.h"

#include <systemd/sd-daemon.h>

#define NS_PER_S	1000000000LL

/* In a bad gap its states come and go many times a second. */
#define GAP_LINES_A_SECOND	10

#define NOTES_A_LOOK	32

void report_init(struct report *r, const struct shm_status *s)
{
	*r = (struct report) { .window_ns = clock_ns(CLOCK_MONOTONIC) };
	r->follow.next = __atomic_load_n(&s->event_next, __ATOMIC_ACQUIRE);
	if (sd_watchdog_enabled(0, &r->watchdog_us) <= 0)
		r->watchdog_us = 0;
}

void report_setup(const struct setup_report *r)
{
	for (int i = 0; i < SETUP_NITEMS; i++) {
		const struct setup_item *item = &r->item[i];

		if (item->wanted && !item->got)
			log_line(LOG_WARNING, "setup: no %s: %s; mend: %s",
				 item->what, item->why, item->mend);
	}
}

void report_ready(void)
{
	sd_notify(0, "READY=1");
}

void report_stopping(void)
{
	sd_notify(0, "STOPPING=1\nSTATUS=stopping");
}

static bool is_gap_state(int32_t state)
{
	return state == SHM_APPROACH || state == SHM_ERODE ||
	       state == SHM_RETRACT || state == SHM_JUMP;
}

/* Begin a new second.  Say how many lines the last one left out. */
static void window_turn(struct report *r)
{
	int64_t now_ns = clock_ns(CLOCK_MONOTONIC);

	if (now_ns - r->window_ns < NS_PER_S)
		return;
	if (r->unsaid)
		log_line(LOG_INFO, "cycle: %u more changes between gap states",
			 r->unsaid);
	r->window_ns = now_ns;
	r->in_window = 0;
	r->unsaid = 0;
}

static void tell_state(struct report *r, const struct shm_event *e)
{
	if (is_gap_state(e->code) && r->in_window++ >= GAP_LINES_A_SECOND) {
		r->unsaid++;
		return;
	}
	log_line(LOG_INFO, "cycle: %s at %.3f mm",
		 shm_state_name((uint32_t)e->code), e->place_mm);
}

static void tell_status(const struct shm_status *s)
{
	struct shm_snapshot now;

	if (!shm_snapshot(s, &now))
		return;
	sd_notifyf(0, "STATUS=%s%s%s, program %u, line %u, %.3f of %.3f mm",
		   shm_state_name(now.state), now.fault ? " " : "",
		   now.fault ? fault_name(now.fault) : "", now.program,
		   now.line, now.place_mm, now.length_mm);
}

static const char *answer_text(int32_t code)
{
	if (code == SHM_LATE)
		return "it came too late";
	if (code == SHM_CUT_SHORT)
		return "edmd ended before it answered";
	return cycle_answer_text((enum cycle_answer)code);
}

static void tell_stand(const struct shm_event *e)
{
	const struct stand_row *row = stand_row((uint32_t)e->code);

	if (row->ends != STAND_BY_ITSELF)
		log_line(row->ends == STAND_BY_CONFIRM ? LOG_WARNING : LOG_INFO,
			 "cycle: line %u: %s; %s", e->line, row->what,
			 row->asks);
}

static void tell(struct report *r, const struct shm_event *e)
{
	switch (e->kind) {
	case SHM_EV_STATE:
		tell_state(r, e);
		break;
	case SHM_EV_FAULT:
		log_line(LOG_ERROR, "cycle: fault %s at %.3f mm; power is off; "
			 "reset, then start goes on",
			 fault_name((uint32_t)e->code), e->place_mm);
		break;
	case SHM_EV_LOADED:
		log_line(LOG_INFO, "cycle: program %d loaded", e->code);
		break;
	case SHM_EV_ENDED:
		log_line(LOG_INFO, "cycle: program %u ended: %s", e->program,
			 cycle_outcome_name((enum cycle_outcome)e->code));
		break;
	case SHM_EV_HUNTING:
		log_line(LOG_WARNING, "cycle: " HUNTING_WHAT " at %.3f mm; "
			 HUNTING_ADVICE, e->code, e->place_mm);
		break;
	case SHM_EV_STAND:
		tell_stand(e);
		break;
	case SHM_EV_ANSWER:
		if (e->code != ANSWER_DONE)
			log_line(LOG_WARNING, "command: %016llx refused: %s",
				 (unsigned long long)e->id,
				 answer_text(e->code));
		break;
	}
}

void report_notes(const struct io_machine *m)
{
	char text[160];

	for (int i = 0; m->note && i < NOTES_A_LOOK; i++) {
		if (!m->note(m->self, text, sizeof(text)))
			return;
		log_line(LOG_WARNING, "%s: %s", m->name, text);
	}
}

void report_events(struct report *r, const struct shm_status *s)
{
	uint64_t lost = r->follow.lost;
	struct shm_event e;
	bool any = false;

	window_turn(r);
	while (shm_event_next(s, &r->follow, &e)) {
		tell(r, &e);
		any = true;
	}
	if (r->follow.lost != lost)
		log_line(LOG_WARNING, "cycle: %llu events went by unseen",
			 (unsigned long long)(r->follow.lost - lost));
	if (any)
		tell_status(s);
}

void report_watchdog(struct report *r, uint64_t beats)
{
	int64_t now_ns = clock_ns(CLOCK_MONOTONIC);

	if (r->watchdog_us == 0 || now_ns < r->watchdog_due_ns)
		return;
	r->watchdog_due_ns = now_ns + (int64_t)r->watchdog_us * 1000 / 3;
	if (beats != r->beats)
		sd_notify(0, "WATCHDOG=1");
	r->beats = beats;
}
