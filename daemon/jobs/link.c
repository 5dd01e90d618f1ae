/* SPDX-License-Identifier: Apache-2.0 */
/*
 * link.c - follow edmd through its shared memory, and command it
 */
#include "link.h"

#include "jobs_log.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#define STALE_US	500000		/* the cycle counter stands */
#define LOOK_US		100000		/* between looks at the process */
#define ANSWER_US	2000000		/* edmd answers within a cycle */

const char *link_state_name(enum link_state s)
{
	return s == LINK_OK ? "ok" : s == LINK_LOST ? "lost" : "absent";
}

void link_init(struct link *l, const char *machine,
	       const struct link_handlers *h)
{
	*l = (struct link) { .state = LINK_ABSENT, .handlers = *h };
	snprintf(l->machine, sizeof(l->machine), "%s", machine);
	/* Another start's answers may still lie in the ring. */
	l->next_id = randombytes_random() | 1;
}

static void link_unmap(struct link *l)
{
	shm_close(l->status, sizeof(*l->status));
	shm_close(l->ring, sizeof(*l->ring));
	l->status = NULL;
	l->ring = NULL;
}

static void pending_end(struct link_pending *p, int code)
{
	struct link_pending was = *p;

	p->id = 0;
	if (was.answer)
		was.answer(was.arg, code);
}

static void pending_end_all(struct link *l, int code)
{
	for (int i = 0; i < LINK_PENDING; i++)
		if (l->pending[i].id)
			pending_end(&l->pending[i], code);
}

void link_fini(struct link *l)
{
	pending_end_all(l, -ENOTCONN);
	link_unmap(l);
}

static uint32_t instance_of(const struct link *l)
{
	return __atomic_load_n(&l->status->head.instance, __ATOMIC_RELAXED);
}

/*
 * A predecessor's snapshot stays until edmd's first own, so edmd is there
 * only when a cycle was seen to pass.
 */
static int link_open(struct link *l, int64_t now_us)
{
	int err = shm_status_open(&l->status, l->machine);

	if (err < 0)
		return err;
	if (!shm_alive(l->status)) {
		link_unmap(l);
		return -ENOENT;
	}
	err = shm_command_open(&l->ring, l->machine);
	if (err == 0 && l->ring->head.instance != instance_of(l))
		err = -ENOENT;
	if (err < 0) {
		link_unmap(l);
		return err;
	}
	l->instance = instance_of(l);
	l->events = (struct shm_follow) { .next = 0 };
	l->moved = false;
	l->moved_us = now_us;
	shm_snapshot(l->status, &l->snap);
	return 0;
}

static void link_try(struct link *l, int64_t now_us)
{
	int err;

	if (now_us - l->looked_us < LOOK_US)
		return;
	l->looked_us = now_us;
	err = link_open(l, now_us);
	if (err == -EPROTO)
		log_error("link: edmd's shared memory is of another layout; "
			  "install edmd and edmd-jobs of one version");
	else if (err < 0 && err != -ENOENT)
		log_error("link: cannot open edmd's shared memory: %s",
			  strerror(-err));
}

static void link_set(struct link *l, enum link_state state)
{
	if (l->state == state)
		return;
	l->state = state;
	l->handlers.changed(l->handlers.arg);
}

static void link_drop(struct link *l)
{
	link_unmap(l);
	pending_end_all(l, -ENOTCONN);
	if (l->state == LINK_OK)
		link_set(l, LINK_LOST);
}

static bool link_is_gone(struct link *l, int64_t now_us)
{
	if (instance_of(l) != l->instance)
		return true;
	if (now_us - l->looked_us < LOOK_US)
		return false;
	l->looked_us = now_us;
	return !shm_alive(l->status);
}

static void take_answer(struct link *l, const struct shm_event *e)
{
	for (int i = 0; i < LINK_PENDING; i++)
		if (l->pending[i].id == e->id && e->id)
			pending_end(&l->pending[i], e->code);
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

static void expire_pending(struct link *l, int64_t now_us)
{
	for (int i = 0; i < LINK_PENDING; i++)
		if (l->pending[i].id && now_us > l->pending[i].until_us)
			pending_end(&l->pending[i], -ETIMEDOUT);
}

void link_poll(struct link *l, int64_t now_us)
{
	if (l->status && link_is_gone(l, now_us))
		link_drop(l);
	if (!l->status)
		link_try(l, now_us);
	if (!l->status)
		return;

	/* Events before the snapshot: what ended is known before it is gone. */
	if (l->state == LINK_OK)
		take_events(l);
	take_snapshot(l, now_us);
	if (l->moved && now_us - l->moved_us < STALE_US)
		link_set(l, LINK_OK);
	else if (l->state == LINK_OK)
		link_set(l, LINK_LOST);
	expire_pending(l, now_us);
}

int link_send(struct link *l, const struct link_command *c, int64_t now_us)
{
	struct shm_command m = {
		.id = l->next_id, .verb = c->verb, .arg = c->arg,
		.instance = l->instance, .arg_mm = c->arg_mm,
	};
	int i = 0, err;

	if (l->state != LINK_OK)
		return -ENOTCONN;
	while (i < LINK_PENDING && l->pending[i].id)
		i++;
	if (i == LINK_PENDING)
		return -EAGAIN;
	err = shm_command_put(l->ring, &m);
	if (err < 0)
		return err;
	l->next_id = l->next_id + 1 ? l->next_id + 1 : 1;
	l->pending[i] = (struct link_pending) {
		.id = m.id, .until_us = now_us + ANSWER_US,
		.answer = c->answer, .arg = c->answer_arg,
	};
	return 0;
}
