/* SPDX-License-Identifier: Apache-2.0 */
/* link.c - watches edmd through its shared memory, and sends it commands */
#include "link.h"

#include "jobs_log.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define STALE_US	500000		/* if the cycle counter stands so long,
					 * edmd is lost */
#define LOOK_US		100000		/* between two checks of a process that
					 * was there */
#define TAKE_US		1500000		/* a command that comes later is not
					 * taken */
#define ANSWER_US	500000		/* after it took one: it answers within
					 * a cycle */

const char *link_state_name(enum link_state s)
{
	return s == LINK_OK ? "ok" : s == LINK_LOST ? "lost" : "absent";
}

void link_init(struct link *l, const char *machine,
	       const struct link_handlers *h)
{
	*l = (struct link) {
		.state = LINK_ABSENT, .handlers = *h, .commands = -1,
	};
	snprintf(l->machine, sizeof(l->machine), "%s", machine);
	/* The answers to an earlier service may still be in the ring. */
	randombytes_buf(&l->next_id, sizeof(l->next_id));
}

static void link_unmap(struct link *l)
{
	shm_close(l->status, sizeof(*l->status));
	if (l->commands >= 0)
		close(l->commands);
	l->status = NULL;
	l->commands = -1;
}

static void pending_end(struct link_pending *p, int code)
{
	struct link_pending was = *p;

	p->id = 0;
	if (was.answer)
		was.answer(was.arg, code);
}

void link_fini(struct link *l)
{
	for (int i = 0; i < LINK_PENDING; i++)
		if (l->pending[i].id)
			pending_end(&l->pending[i], -ESHUTDOWN);
	link_unmap(l);
}

static uint32_t instance_of(const struct link *l)
{
	return __atomic_load_n(&l->status->head.instance, __ATOMIC_RELAXED);
}

/*
 * The snapshot of a predecessor stays until edmd publishes its own.  So edmd
 * counts as running only after a cycle has passed.
 */
static int link_open(struct link *l, int64_t now_us)
{
	uint32_t instance;
	int err = shm_status_open(&l->status, l->machine);

	if (err < 0)
		return err;
	if (!shm_alive(l->status)) {
		link_unmap(l);
		return -ENOENT;
	}
	err = shm_command_open(&l->commands, l->machine, &instance);
	if (err == 0 && instance != instance_of(l))
		err = -ENOENT;
	if (err < 0) {
		link_unmap(l);
		return err;
	}
	l->instance = instance_of(l);
	l->events = (struct shm_follow) { .next = 0 };
	l->events_before = __atomic_load_n(&l->status->event_next,
					   __ATOMIC_ACQUIRE);
	l->moved = false;
	l->ended = false;
	l->moved_us = now_us;
	shm_snapshot(l->status, &l->snap);
	return 0;
}

/* Whoever waits for edmd waits for this, so it is tried each time.  What is
 * wrong is said once. */
static void link_try(struct link *l, int64_t now_us)
{
	const int err = link_open(l, now_us), was = l->wrong;

	l->looked_us = now_us;
	l->wrong = err;
	if (err == was)
		return;
	if (err == -EPROTO)
		log_error("link: edmd's shared memory is of another layout; "
			  "install edmd and edmd-jobs of one version");
	else if (err == -EACCES)
		log_error("link: edmd takes no commands of this user; it must "
			  "be edm-jobs, root, or edmd's own");
	else if (err < 0 && err != -ENOENT && err != -EAGAIN)
		log_error("link: cannot reach edmd: %s", strerror(-err));
}

static void link_set(struct link *l, enum link_state state)
{
	if (l->state == state)
		return;
	l->state = state;
	l->handlers.changed(l->handlers.arg);
}

/* Find out what became of the commands that an edmd left behind.  Its record
 * says so. */
static void pending_settle(struct link *l, int64_t now_us, int otherwise)
{
	for (int i = 0; i < LINK_PENDING; i++) {
		struct link_pending *p = &l->pending[i];
		struct shm_done d;

		if (!p->id || (now_us && now_us <= p->until_us))
			continue;
		if (!l->status || !shm_done(l->status, p->id, &d))
			pending_end(p, otherwise);
		else if (d.code != SHM_TAKEN)
			pending_end(p, d.code);
		else
			pending_end(p, now_us ? SHM_TAKEN : SHM_CUT_SHORT);
	}
}

static void link_drop(struct link *l)
{
	pending_settle(l, 0, -ENOTCONN);
	link_unmap(l);
	if (l->state == LINK_OK)
		link_set(l, LINK_LOST);
}

/* One that ends in order takes its memory with it.  What it wrote last is read
 * once more before the memory is dropped. */
static bool link_is_gone(struct link *l, int64_t now_us)
{
	if (instance_of(l) != l->instance || l->ended)
		return true;
	if (now_us - l->looked_us < LOOK_US)
		return false;
	l->looked_us = now_us;
	l->ended = !shm_alive(l->status);
	return false;
}

/* Who hears that the state refuses is told the state.  The snapshot may be
 * older than the command before this one, so the answer waits for a newer
 * one. */
static void take_answer(struct link *l, const struct shm_event *e)
{
	for (int i = 0; i < LINK_PENDING; i++) {
		struct link_pending *p = &l->pending[i];

		if (p->id != e->id || !e->id)
			continue;
		if (e->code == SHM_WRONG_STATE && l->snap.cycle <= e->cycle)
			p->refused = e->cycle + 1;
		else
			pending_end(p, e->code);
	}
}

static void tell_refused(struct link *l)
{
	for (int i = 0; i < LINK_PENDING; i++) {
		struct link_pending *p = &l->pending[i];

		if (p->id && p->refused && l->snap.cycle >= p->refused)
			pending_end(p, SHM_WRONG_STATE);
	}
}

bool link_is_repeat(const struct link *l)
{
	return l->events.next <= l->events_before;
}

static void take_events(struct link *l)
{
	struct shm_event e;

	while (l->status && shm_event_next(l->status, &l->events, &e)) {
		if (e.kind == SHM_EV_ANSWER)
			take_answer(l, &e);
		else
			l->handlers.event(l->handlers.arg, &e);
	}
}

static void take_snapshot(struct link *l, int64_t now_us)
{
	uint64_t before = l->snap.cycle;

	if (!shm_snapshot(l->status, &l->snap) || l->snap.cycle == before)
		return;
	l->moved = true;
	l->moved_us = now_us;
}

void link_poll(struct link *l, int64_t now_us)
{
	if (l->status && link_is_gone(l, now_us))
		link_drop(l);
	if (!l->status)
		link_try(l, now_us);
	if (!l->status)
		return;

	/* Events come before the snapshot: then the end of a job is known
	 * before the job disappears. */
	if (l->state == LINK_OK)
		take_events(l);
	take_snapshot(l, now_us);
	tell_refused(l);
	if (l->moved && now_us - l->moved_us < STALE_US)
		link_set(l, LINK_OK);
	else if (l->state == LINK_OK)
		link_set(l, LINK_LOST);
	pending_settle(l, now_us, -ETIMEDOUT);
}

void link_ended(struct link *l,
		void (*each)(void *arg, const struct shm_ended *e), void *arg)
{
	struct shm_follow all = { .next = 0 };
	struct shm_ended e;

	while (l->status && shm_ended_next(l->status, &all, &e))
		each(arg, &e);
}

static struct link_pending *pending_room(struct link *l)
{
	for (int i = 0; i < LINK_PENDING; i++)
		if (l->pending[i].id == 0)
			return &l->pending[i];
	return NULL;
}

static void pending_begin(struct link_pending *p, uint64_t id,
			  const struct link_command *c, int64_t now_us)
{
	*p = (struct link_pending) {
		.id = id,
		.until_us = now_us + (c->take_us ? c->take_us : TAKE_US) +
			    (c->answer_us ? c->answer_us : ANSWER_US),
		.answer = c->answer, .arg = c->answer_arg,
	};
}

int link_await(struct link *l, const struct link_command *c, int64_t now_us)
{
	struct link_pending *room = pending_room(l);

	if (!room)
		return -EAGAIN;
	pending_begin(room, c->id, c, now_us);
	return 0;
}

int link_send(struct link *l, const struct link_command *c, int64_t now_us)
{
	struct shm_command m = {
		.id = c->id, .verb = c->verb, .arg = c->arg,
		.instance = l->instance, .arg_mm = c->arg_mm,
		.until_ns = (now_us + (c->take_us ? c->take_us : TAKE_US)) *
			    1000,
	};
	struct link_pending *room = pending_room(l);
	int err;

	if (l->state != LINK_OK)
		return -ENOTCONN;
	if (!room)
		return -EAGAIN;
	while (m.id == 0)
		m.id = l->next_id++;
	err = shm_command_put(l->commands, &m);
	if (err == 0)
		pending_begin(room, m.id, c, now_us);
	else if (err == -ENOTCONN)
		link_drop(l);
	return err;
}
