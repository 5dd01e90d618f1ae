/* SPDX-License-Identifier: Apache-2.0 */
/* queue.c - follows the job that is in the machine */
#include "inside.h"
#include "faults.h"
#include "hunting.h"
#include "process.h"
#include "interrupt.h"
#include "jobs.h"
#include "offset.h"

#include "interp/tech_table.h"
#include "jobs_log.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MISSING_US	500000		/* time that edmd gets to come back */
#define ANEW_US		100000		/* one that is new takes a program up
					 * before its first cycle or never; its
					 * events are read meanwhile */
#define AGAIN_US	1000000

bool queue_is_leaving(const struct queue *q)
{
	return q->job.n && (q->job.state == JOB_DONE ||
			    q->job.state == JOB_STOPPED);
}

void queue_recount(struct jobs *j)
{
	j->queue.behind = store_waiting(j->store);
	j->queue.behind_s = store_waiting_s(j->store, &j->queue.untold);
	j->forecaster.looks = j->forecaster.looks_later = true;
}

static void set_waiting(struct jobs *j, bool waiting)
{
	/* Nothing begins until a person has seen what is not certain. */
	waiting = waiting || j->unseen;
	if (j->queue.waiting == waiting)
		return;
	j->queue.waiting = waiting;
	store_set_number(j->store, "waiting", waiting);
}

void queue_go(struct jobs *j)
{
	set_waiting(j, false);
}

bool queue_has_begun(const struct jobs *j)
{
	return j->queue.job.begun_us || j->queue.snap.job_cycles ||
	       !j->queue.job.n;
}

int queue_promise(struct jobs *j)
{
	int err;

	if (queue_has_begun(j))
		return 0;
	err = store_may_begin(j->store, j->queue.job.n);
	if (err == 0)
		j->queue.promised = j->queue.job.n;
	return err;
}

/* The job did not begin, so the store is told that it has not begun. */
void queue_unpromise(struct jobs *j)
{
	if (j->queue.promised)
		store_may_begin(j->store, 0);
	j->queue.promised = 0;
}

void queue_started(struct jobs *j, int code)
{
	struct queue *q = &j->queue;

	/* Unless the answer is a clear no, the command may have been carried
	 * out. */
	if (code > 0 && code != SHM_CUT_SHORT && code != SHM_DONE)
		queue_unpromise(j);
	if (code != SHM_DONE)
		return;
	/* Who starts has seen where the axes stand.  Without that no job
	 * goes. */
	interrupt_answered(j);
	queue_go(j);
	if (!q->job.n || !q->job.hold)
		return;
	q->job.hold = false;
	store_set_hold(j->store, q->job.n, false);
}

const char *queue_unready(const struct jobs *j)
{
	if (j->link.state != LINK_OK)
		return "edmd is not there";
	if (queue_is_faulted(j))
		return "a fault is latched: reset it";
	if (*j->interrupted)
		return "a job was interrupted, and its work may still be "
		       "there: resume it or remove it first";
	if (j->config->require_home && j->link.snap.unhomed)
		return "an axis is not homed: home it";
	if (*j->electrode.why)
		return j->electrode.why;
	return NULL;
}

/* Ask edmd's memory itself: the last snapshot may be older than the fault. */
bool queue_is_faulted(const struct jobs *j)
{
	struct shm_snapshot s;

	return j->link.status && shm_snapshot(j->link.status, &s) &&
	       s.state == SHM_FAULT;
}

void queue_wait(struct jobs *j)
{
	set_waiting(j, true);
}

/* A job that has not begun, whether it is loaded or not. */
static bool is_to_begin(const struct jobs *j)
{
	const struct queue *q = &j->queue;

	return q->job.n && !queue_is_leaving(q) ? !queue_has_begun(j) :
						  q->behind > 0;
}

void queue_keep(struct jobs *j)
{
	if (is_to_begin(j))
		queue_wait(j);
}

bool queue_is_kept(const struct jobs *j)
{
	return j->queue.waiting && is_to_begin(j);
}

static void set_state(struct jobs *j, enum job_state state)
{
	struct queue *q = &j->queue;

	if (q->job.state == state)
		return;
	log_info("queue: job %s %s, was %s, at %.3f mm", q->job.id,
		 store_state_name(state), store_state_name(q->job.state),
		 q->snap.place_mm);
	q->job.state = state;
	store_set_state(j->store, q->job.n, state);
}

static void read_start(struct jobs *j)
{
	struct interp_program p;
	const void *block;
	size_t bytes;

	if (shm_program_read(&block, &bytes, j->machine, j->queue.job.n) < 0)
		return;
	if (interp_program_map(&p, block, bytes) == 0)
		memcpy(j->queue.start_pulses, p.head->start_pulses,
		       sizeof(j->queue.start_pulses));
	shm_program_unmap(block, bytes);
}

int queue_init(struct jobs *j)
{
	static struct inside a;
	struct queue *q = &j->queue;
	int err = store_loaded(j->store, &q->job);

	if (err < 0 && err != -ENOENT)
		return err;
	q->waiting = store_number(j->store, "waiting", 0) != 0;
	queue_recount(j);
	if (q->job.n && inside_read(j, q->job.n, &a) == 0)
		q->run = a.run;
	if (!q->job.n)
		return 0;
	log_notice("queue: job %s was %s when last seen", q->job.id,
		   store_state_name(q->job.state));
	/* Its whole program is read for these.  Nobody waits yet, and edmd may
	 * be about to read it, too. */
	read_start(j);
	electrode_take(j);
	return 0;
}

void queue_drop(struct jobs *j, bool again)
{
	struct queue *q = &j->queue;

	if (again) {
		set_state(j, JOB_QUEUED);
		queue_unpromise(j);
	}
	q->promised = 0;
	shm_program_remove(j->machine, q->job.n);
	store_set_loaded(j->store, q->job.n, false);
	tally_forget(j);
	electrode_forget(j);
	q->job = (struct store_job) { .n = 0 };
	q->snap = (struct shm_snapshot) { .program = 0 };
	q->depth_mm = 0;
	q->ended = SHM_OUTCOME_NONE;
	q->missing_us = 0;
	q->anew = false;
	queue_recount(j);
}

void queue_attach(struct jobs *j)
{
	struct queue *q = &j->queue;
	bool anew = store_number(j->store, "instance", 0) != j->link.instance;

	q->missing_us = 0;
	q->again_us = 0;
	settle_ended(j);
	q->anew = anew && q->job.n;
	if (!anew)
		return;
	store_set_number(j->store, "instance", j->link.instance);
	interrupt_attach(j);
	if (q->job.n || q->behind) {
		log_notice("queue: edmd was started anew; nothing moves until "
			   "start");
		set_waiting(j, true);
	}
}

/* Write what edmd says of conditions and sets into the history of the job. */
static void follow_change(struct jobs *j, const struct shm_event *e)
{
	struct store_change c = {
		.was = e->was, .now = e->now, .place_mm = e->place_mm,
		.time_ns = e->time_ns,
	};
	struct call call = {
		.place_mm = e->place_mm, .time_ns = e->time_ns,
	};
	char name[16];

	if (!j->queue.job.n || e->program != j->queue.job.n)
		return;
	if (e->kind == SHM_EV_CONDITION) {
		snprintf(call.condition, sizeof(call.condition), "%s",
			 interp_tech_name((char)e->id, (uint32_t)e->code, name,
					  sizeof(name)));
		calls_add(j, j->queue.job.n, &call);
		return;
	}
	if (e->kind == SHM_EV_SET && e->id < INTERP_NTECH)
		c.field = interp_tech_field[e->id].name;
	else
		return;
	store_change(j->store, j->queue.job.n, &c);
}

/* A job that has not begun is put back: another one is wanted, or nothing may
 * begin because it cannot be stored. */
static void give_back(struct jobs *j)
{
	load_send(j, SHM_UNLOAD, j->queue.job.n, jobs_now_us());
	queue_drop(j, true);
}

/* The PLC selects a job.  A job that has begun stays.  One that has not begun
 * is put back. */
static void follow_select(struct jobs *j, uint32_t n)
{
	struct queue *q = &j->queue;

	store_set_number(j->store, "selected", n);
	log_notice("queue: job %u is selected to be next", n);
	if (!q->job.n || q->job.n == n || q->job.begun_us || q->loading ||
	    q->snap.job_cycles)
		return;
	give_back(j);
}

/* The cut goes on, but a person should look at it. */
static void follow_hunting(struct jobs *j, const struct shm_event *e)
{
	struct queue *q = &j->queue;

	if (!q->job.n || e->program != q->job.n)
		return;
	jobs_note(j, &(struct jobs_note) {
		.kind = "warning", .job = q->job.id, .outcome = "hunting",
		.place_mm = e->place_mm,
	}, "job %s: " HUNTING_WHAT "; " HUNTING_ADVICE, q->job.name, e->code);
}

/* A service that has come, or finds another edmd, reads all events again.  Most
 * are known by their time in the store; these are by their number in the object
 * that one edmd hands to the next. */
static bool is_old(struct jobs *j)
{
	const struct link *l = &j->link;
	const int64_t number = (int64_t)l->events.next;
	const int64_t born = (int64_t)l->status->born;

	if (link_is_repeat(l) &&
	    store_number(j->store, "followed_of", -1) == born &&
	    store_number(j->store, "followed", 0) >= number)
		return true;
	store_set_number(j->store, "followed_of", born);
	store_set_number(j->store, "followed", number);
	return false;
}

void queue_event(struct jobs *j, const struct shm_event *e)
{
	struct queue *q = &j->queue;

	follow_change(j, e);
	tally_event(j, e, link_is_repeat(&j->link));
	if (e->kind == SHM_EV_HUNTING && !is_old(j))
		follow_hunting(j, e);
	if (e->kind == SHM_EV_STAND && !is_old(j))
		asks_event(j, e);
	if (e->kind == SHM_EV_SELECT && !is_old(j))
		follow_select(j, (uint32_t)e->code);
	queue_ended_event(q, e);
}

/* " (3 no water)", if the generator says so itself; else "". */
static const char *own_fault(const struct jobs *j, char *to, size_t size)
{
	const struct shm_snapshot *s = &j->link.snap;
	char text[CONFIG_FAULT_MAX];

	config_fault_text(j->config->generator.fault_words,
			  s->told[PROCESS_FAULT], text, sizeof(text));
	snprintf(to, size, *text ? " (%s)" : "%s", text);
	return to;
}

static void follow_fault(struct jobs *j)
{
	struct queue *q = &j->queue;
	const char *fault = fault_name(q->snap.fault);
	char own[CONFIG_FAULT_MAX + 3];

	if (q->job.state == JOB_FAULT)
		return;
	queue_record(j, JOB_FAULT, fault);
	jobs_note(j, &(struct jobs_note) {
		.kind = "alarm", .job = q->job.id, .outcome = fault,
		.place_mm = q->snap.place_mm,
	}, "job %s: fault %s%s in line %u; reset, then start goes on, stop "
		  "ends it", q->job.name, fault, own_fault(j, own, sizeof(own)),
		  q->snap.line);
	/* A reset alone must not start the job. */
	set_waiting(j, true);
}

/* It may be held, or over, before it was ever seen to run. */
static void follow_begin(struct jobs *j)
{
	struct queue *q = &j->queue;

	if (q->job.begun_us)
		return;
	q->job.begun_us = jobs_utime();
	jobs_with_note(j);
	store_begin(j->store, q->job.n, q->job.begun_us);
	queue_unpromise(j);
	interrupt_answered(j);
	jobs_note(j, &(struct jobs_note) {
		.kind = "begun", .job = q->job.id,
	}, "job %s begun", q->job.name);
}

static void follow_running(struct jobs *j)
{
	set_state(j, JOB_RUNNING);
	j->queue.ended = SHM_OUTCOME_NONE;
	follow_begin(j);
}

static void follow_hold(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;

	if (q->job.begun_us) {
		set_state(j, JOB_HELD);
		return;
	}
	set_state(j, JOB_READY);
	if (q->promised == q->job.n)
		return;
	if (*store_why(j->store)) {
		give_back(j);
		return;
	}
	if (q->job.hold || q->waiting || q->asked || q->loading ||
	    now_us < q->again_us)
		return;
	/* Start it only once.  If it was refused, or the service was killed
	 * over it, the job waits for a person. */
	if (store_number(j->store, "started", 0) == q->job.n) {
		log_notice("queue: job %s was to start when this service "
			   "ended; it waits for start", q->job.id);
		set_waiting(j, true);
		return;
	}
	if (queue_promise(j) < 0 || load_send(j, SHM_DO_START, 0, now_us) < 0) {
		queue_unpromise(j);
		q->again_us = now_us + AGAIN_US;
	}
}

static void follow_ended(struct jobs *j, uint32_t outcome)
{
	if (outcome == SHM_OUTCOME_DONE)
		queue_end(j, JOB_DONE, "");
	else if (outcome == SHM_OUTCOME_STOPPED)
		queue_end(j, JOB_STOPPED, "by command");
	else if (outcome == SHM_OUTCOME_FAULT)
		queue_end(j, JOB_STOPPED, "after a fault");
}

static void follow_leaving(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;

	if (q->asked || now_us < q->again_us)
		return;
	q->again_us = now_us + AGAIN_US;
	load_send(j, SHM_UNLOAD, q->job.n, now_us);
}

static void follow_state(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;

	if (q->snap.job_cycles)
		follow_begin(j);
	switch (q->snap.state) {
	case SHM_IDLE:
		follow_ended(j, q->snap.outcome);
		break;
	case SHM_HOLD:
		follow_hold(j, now_us);
		break;
	case SHM_FAULT:
		follow_fault(j);
		break;
	default:
		follow_running(j);
		break;
	}
}

/* A start was handed over, and nobody is left who knows what became of it. */
static bool may_have_begun(struct jobs *j)
{
	return j->queue.job.begun_us || interrupt_saw_begin(j) ||
	       store_number(j->store, "started", 0) == j->queue.job.n;
}

/* edmd has another program, or none.  Is that only for a moment, or for
 * good? */
static void follow_missing(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;

	if (queue_is_leaving(q)) {
		queue_drop(j, false);
	} else if (q->ended) {
		follow_ended(j, q->ended);
	} else if (!q->missing_us) {
		q->missing_us = now_us;
	} else if (now_us - q->missing_us > (q->anew ? ANEW_US : MISSING_US) &&
		   !q->loading) {
		if (may_have_begun(j))
			interrupt_take(j);
		else
			set_waiting(j, true);
		queue_drop(j, q->job.state == JOB_QUEUED ||
			      q->job.state == JOB_READY);
	}
}

/* edmd has a program that this service did not load, or has forgotten. */
static void unload_stranger(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;
	uint32_t n = j->link.snap.program;

	if (q->asked || now_us < q->again_us)
		return;
	q->again_us = now_us + AGAIN_US;
	if (j->link.snap.state == SHM_IDLE) {
		log_notice("queue: edmd has program %u, which is no job here; "
			   "unloading it", n);
		load_send(j, SHM_UNLOAD, n, now_us);
		shm_program_remove(j->machine, n);
	}
}

/* A fault in a jog, in homing, or while the machine was idle. */
static void fault_without_job(struct jobs *j)
{
	struct queue *q = &j->queue;
	const char *fault = fault_name(j->link.snap.fault);
	char own[CONFIG_FAULT_MAX + 3];

	/* A reset alone must not start anything. */
	set_waiting(j, q->waiting || q->behind > 0);
	if (q->fault_told == j->link.snap.fault)
		return;
	q->fault_told = j->link.snap.fault;
	jobs_note(j, &(struct jobs_note) {
		.kind = "alarm", .outcome = fault,
	}, "fault %s%s without a job; reset leaves it", fault,
		  own_fault(j, own, sizeof(own)));
}

/* A path cannot begin while an axis moves, nor where an axis is not homed but
 * must be, nor where a drive has lost its place. */
static bool may_load(const struct jobs *j)
{
	return j->link.snap.state == SHM_IDLE && !j->link.snap.unplaced &&
	       !*store_why(j->store) && !*j->interrupted &&
	       !(j->config->require_home && j->link.snap.unhomed);
}

void queue_step(struct jobs *j, int64_t now_us)
{
	struct queue *q = &j->queue;
	const struct shm_snapshot *s = &j->link.snap;

	if (s->state != SHM_FAULT)
		q->fault_told = 0;
	else
		upload_hold_all(&j->uploads);
	early_step(j, now_us);
	if (q->job.n && s->program == q->job.n) {
		q->missing_us = 0;
		q->snap = *s;
		q->depth_mm = fmax(q->depth_mm, s->depth_far_mm);
		tally_look(j, now_us);
		electrode_follow(j);
		if (queue_is_leaving(q))
			follow_leaving(j, now_us);
		else
			follow_state(j, now_us);
	} else if (q->job.n) {
		follow_missing(j, now_us);
	} else if (s->program) {
		unload_stranger(j, now_us);
	} else if (s->state == SHM_FAULT) {
		fault_without_job(j);
	} else if (!q->compile && now_us >= q->again_us && may_load(j) &&
		   !electrode_waits(j)) {
		load_begin(j, now_us);
	}
	forecaster_step(j);
}

void queue_fini(struct jobs *j)
{
	struct queue *q = &j->queue;

	calls_write(j);
	load_fini(j);
	early_fini(j);
	forecaster_fini(j);
	offset_fini(j);
	if (!q->job.n || (q->job.begun_us && !queue_is_leaving(q)))
		return;
	load_send(j, SHM_UNLOAD, q->job.n, jobs_now_us());
	queue_drop(j, !queue_is_leaving(q));
}
