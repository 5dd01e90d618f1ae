/* SPDX-License-Identifier: Apache-2.0 */
/*
 * publish.c - snapshot, trace and events: one writer, any number of readers
 *
 * No reader can delay the writer.  A record may be overwritten while it is
 * read.  The sequence or the stamp, which is read before and after, shows that.
 */
#include "object.h"
#include "stamped.h"

#include <string.h>

/* Copying takes well below 1 us; a writer's period is 50 us or more. */
#define LAST_TRIES	1000
#define RING_TRIES	16

/* A reader that was overtaken continues this far behind the writer. */
#define RING_MARGIN(slots)	((slots) - (slots) / 16)

static struct stamped ring_of_trace(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->trace,
		.next = (uint64_t *)(uintptr_t)&s->trace_next,
		.count = SHM_TRACE_SLOTS,
		.slot_bytes = sizeof(s->trace[0]),
	};
}

static struct stamped ring_of_events(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->event,
		.next = (uint64_t *)(uintptr_t)&s->event_next,
		.count = SHM_EVENT_SLOTS,
		.slot_bytes = sizeof(s->event[0]),
	};
}

/* There are two of them: if a writer is killed in one, the other is whole. */
static struct stamped ring_of_sets(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->sets,
		.next = (uint64_t *)(uintptr_t)&s->sets_next,
		.count = 2,
		.slot_bytes = sizeof(s->sets[0]),
	};
}

static struct stamped ring_of_drives(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->drives,
		.next = (uint64_t *)(uintptr_t)&s->drives_next,
		.count = 2,
		.slot_bytes = sizeof(s->drives[0]),
	};
}

static struct stamped ring_of_done(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->done,
		.next = (uint64_t *)(uintptr_t)&s->done_next,
		.count = SHM_DONE_SLOTS,
		.slot_bytes = sizeof(s->done[0]),
	};
}

static struct stamped ring_of_ended(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->ended,
		.next = (uint64_t *)(uintptr_t)&s->ended_next,
		.count = SHM_ENDED_SLOTS,
		.slot_bytes = sizeof(s->ended[0]),
	};
}

static void follow_skip(struct shm_follow *f, uint64_t to)
{
	f->lost += to - f->next;
	f->next = to;
}

static bool ring_follow(const struct stamped *r, struct shm_follow *f,
			void *ret)
{
	for (int i = 0; i < RING_TRIES; i++) {
		uint64_t end = __atomic_load_n(r->next, __ATOMIC_ACQUIRE);

		if (f->next >= end)
			return false;
		if (end - f->next > r->count)
			follow_skip(f, end - RING_MARGIN(r->count));
		if (stamped_get(r, f->next, ret)) {
			f->next++;
			return true;
		}
		follow_skip(f, f->next + 1);
	}
	return false;
}

/* The last snapshot is whole even if its writer was killed in the next one. */
static struct stamped ring_of_snaps(const struct shm_status *s)
{
	return (struct stamped) {
		.slots = (void *)(uintptr_t)s->snap,
		.next = (uint64_t *)(uintptr_t)&s->snap_next,
		.count = 2,
		.slot_bytes = sizeof(s->snap[0]),
	};
}

void shm_snapshot_put(struct shm_status *s, const struct shm_snapshot *snap)
{
	struct stamped r = ring_of_snaps(s);

	stamped_put(&r, snap);
}

void shm_trace_put(struct shm_status *s, const struct shm_trace *t)
{
	struct stamped r = ring_of_trace(s);

	stamped_put(&r, t);
}

void shm_publish(struct shm_status *s, const struct shm_snapshot *snap)
{
	struct shm_trace t = {
		.cycle = snap->cycle,
		.place_mm = snap->place_mm,
		.feed_mm_s = snap->feed_mm_s,
		.gap_v = snap->gap_v,
		.line = snap->line,
		.state = snap->state,
	};

	memcpy(t.pos, snap->pos, sizeof(t.pos));
	memcpy(t.actual, snap->pos, sizeof(t.actual));
	shm_snapshot_put(s, snap);
	shm_trace_put(s, &t);
}

void shm_event(struct shm_status *s, const struct shm_event *e)
{
	struct stamped r = ring_of_events(s);

	stamped_put(&r, e);
}

void shm_sets_put(struct shm_status *s, const struct shm_sets *sets)
{
	struct stamped r = ring_of_sets(s);

	stamped_put(&r, sets);
}

bool shm_sets(const struct shm_status *s, struct shm_sets *ret)
{
	struct stamped r = ring_of_sets(s);

	return stamped_last(&r, 1, ret);
}

void shm_drives_put(struct shm_status *s, const struct cia402_told *told)
{
	struct stamped r = ring_of_drives(s);

	stamped_put(&r, told);
}

bool shm_drives(const struct shm_status *s, struct cia402_told *ret)
{
	struct stamped r = ring_of_drives(s);

	return stamped_last(&r, LAST_TRIES, ret);
}

bool shm_snapshot(const struct shm_status *s, struct shm_snapshot *ret)
{
	struct stamped r = ring_of_snaps(s);
	struct shm_snapshot got;

	if (!stamped_last(&r, LAST_TRIES, &got))
		return false;
	*ret = got;
	return true;
}

bool shm_trace_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_trace *ret)
{
	struct stamped r = ring_of_trace(s);

	return ring_follow(&r, f, ret);
}

bool shm_event_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_event *ret)
{
	struct stamped r = ring_of_events(s);

	return ring_follow(&r, f, ret);
}

void shm_ended_put(struct shm_status *s, const struct shm_ended *e)
{
	struct stamped r = ring_of_ended(s);

	stamped_put(&r, e);
}

bool shm_ended_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_ended *ret)
{
	struct stamped r = ring_of_ended(s);

	return ring_follow(&r, f, ret);
}

/* Search from the newest.  A torn record belongs to a command that nobody has
 * begun to carry out. */
static bool done_find(const struct stamped *r, uint64_t id, uint64_t *ret_n,
		      struct shm_done *ret)
{
	uint64_t end = __atomic_load_n(r->next, __ATOMIC_ACQUIRE);

	for (uint64_t i = 1; i <= r->count && i <= end; i++) {
		if (!stamped_get(r, end - i, ret) || ret->id != id)
			continue;
		*ret_n = end - i;
		return true;
	}
	return false;
}

void shm_done_begin(struct shm_status *s, uint64_t id)
{
	const struct shm_done d = {
		.id = id, .code = SHM_TAKEN, .instance = s->head.instance,
	};
	struct stamped r = ring_of_done(s);

	stamped_put(&r, &d);
}

void shm_done_end(struct shm_status *s, uint64_t id, int32_t code)
{
	struct stamped r = ring_of_done(s);
	struct shm_done d;
	uint64_t n;

	if (!done_find(&r, id, &n, &d) || d.code != SHM_TAKEN)
		return;
	/* A single store: if edmd is killed here, the command is answered or
	 * not, but never lost. */
	__atomic_store_n(&s->done[n % SHM_DONE_SLOTS].record.code, code,
			 __ATOMIC_RELEASE);
}

bool shm_done(const struct shm_status *s, uint64_t id, struct shm_done *ret)
{
	struct stamped r = ring_of_done(s);
	uint64_t n;

	return done_find(&r, id, &n, ret);
}
