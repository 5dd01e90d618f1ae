/* SPDX-License-Identifier: Apache-2.0 */
/*
 * publish.c - snapshot, trace and events: one writer, any number of readers
 *
 * No reader can delay the writer.  A record may be overwritten while it is
 * read.  The sequence or the stamp, which is read before and after, shows that.
 */
#include "object.h"

#include <string.h>

/* Copying takes well below 1 us; a writer's period is 50 us or more. */
#define SNAPSHOT_TRIES	1000
#define RING_TRIES	16

/* A reader that was overtaken continues this far behind the writer. */
#define RING_MARGIN(slots)	((slots) - (slots) / 16)

/* Both rings in one form: a stamp, and behind it the words of the record. */
struct ring {
	void *slots;
	uint64_t *next;
	size_t count;			/* power of two */
	size_t slot_bytes;
};

static struct ring ring_of_trace(const struct shm_status *s)
{
	return (struct ring) {
		.slots = (void *)(uintptr_t)s->trace,
		.next = (uint64_t *)(uintptr_t)&s->trace_next,
		.count = SHM_TRACE_SLOTS,
		.slot_bytes = sizeof(s->trace[0]),
	};
}

static struct ring ring_of_events(const struct shm_status *s)
{
	return (struct ring) {
		.slots = (void *)(uintptr_t)s->event,
		.next = (uint64_t *)(uintptr_t)&s->event_next,
		.count = SHM_EVENT_SLOTS,
		.slot_bytes = sizeof(s->event[0]),
	};
}

/* There are two of them: if a writer is killed in one, the other is whole. */
static struct ring ring_of_sets(const struct shm_status *s)
{
	return (struct ring) {
		.slots = (void *)(uintptr_t)s->sets,
		.next = (uint64_t *)(uintptr_t)&s->sets_next,
		.count = 2,
		.slot_bytes = sizeof(s->sets[0]),
	};
}

static struct ring ring_of_done(const struct shm_status *s)
{
	return (struct ring) {
		.slots = (void *)(uintptr_t)s->done,
		.next = (uint64_t *)(uintptr_t)&s->done_next,
		.count = SHM_DONE_SLOTS,
		.slot_bytes = sizeof(s->done[0]),
	};
}

static struct ring ring_of_ended(const struct shm_status *s)
{
	return (struct ring) {
		.slots = (void *)(uintptr_t)s->ended,
		.next = (uint64_t *)(uintptr_t)&s->ended_next,
		.count = SHM_ENDED_SLOTS,
		.slot_bytes = sizeof(s->ended[0]),
	};
}

static uint64_t *ring_stamp(const struct ring *r, uint64_t n)
{
	return (uint64_t *)(void *)((char *)r->slots +
				    (n & (r->count - 1)) * r->slot_bytes);
}

static void ring_put(const struct ring *r, const void *record)
{
	uint64_t n = __atomic_load_n(r->next, __ATOMIC_RELAXED);
	uint64_t *stamp = ring_stamp(r, n);

	__atomic_store_n(stamp, 2 * n + 1, __ATOMIC_RELAXED);
	object_words_put(stamp + 1, record, r->slot_bytes - sizeof(*stamp));
	__atomic_store_n(stamp, 2 * n + 2, __ATOMIC_RELEASE);
	__atomic_store_n(r->next, n + 1, __ATOMIC_RELEASE);
}

/* Read record @n as a whole; false if it is gone. */
static bool ring_get(const struct ring *r, uint64_t n, void *ret)
{
	uint64_t *stamp = ring_stamp(r, n);

	if (__atomic_load_n(stamp, __ATOMIC_ACQUIRE) != 2 * n + 2)
		return false;
	object_words_get(ret, stamp + 1, r->slot_bytes - sizeof(*stamp));
	return __atomic_load_n(stamp, __ATOMIC_RELAXED) == 2 * n + 2;
}

static void follow_skip(struct shm_follow *f, uint64_t to)
{
	f->lost += to - f->next;
	f->next = to;
}

static bool ring_follow(const struct ring *r, struct shm_follow *f, void *ret)
{
	for (int i = 0; i < RING_TRIES; i++) {
		uint64_t end = __atomic_load_n(r->next, __ATOMIC_ACQUIRE);

		if (f->next >= end)
			return false;
		if (end - f->next > r->count)
			follow_skip(f, end - RING_MARGIN(r->count));
		if (ring_get(r, f->next, ret)) {
			f->next++;
			return true;
		}
		follow_skip(f, f->next + 1);
	}
	return false;
}

void shm_snapshot_put(struct shm_status *s, const struct shm_snapshot *snap)
{
	uint64_t n = __atomic_load_n(&s->snap_next, __ATOMIC_RELAXED);
	struct shm_snap *to = &s->snap[n & 1];

	ck_sequence_write_begin(&to->seq);
	object_words_put(&to->s, snap, sizeof(to->s));
	ck_sequence_write_end(&to->seq);
	__atomic_store_n(&s->snap_next, n + 1, __ATOMIC_RELEASE);
}

void shm_trace_put(struct shm_status *s, const struct shm_trace *t)
{
	struct ring r = ring_of_trace(s);

	ring_put(&r, t);
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
	struct ring r = ring_of_events(s);

	ring_put(&r, e);
}

void shm_sets_put(struct shm_status *s, const struct shm_sets *sets)
{
	struct ring r = ring_of_sets(s);

	ring_put(&r, sets);
}

bool shm_sets(const struct shm_status *s, struct shm_sets *ret)
{
	struct ring r = ring_of_sets(s);
	uint64_t n = __atomic_load_n(r.next, __ATOMIC_ACQUIRE);

	return n > 0 && ring_get(&r, n - 1, ret);
}

/*
 * ck_sequence_read_begin() waits until the sequence is even.  It never becomes
 * even if the writer was killed inside, so look only once.
 */
static bool snap_get(const struct shm_snap *from, struct shm_snapshot *ret)
{
	unsigned int version = ck_pr_load_uint(&from->seq.sequence);

	ck_pr_fence_load();
	if (version & 1)
		return false;
	object_words_get(ret, &from->s, sizeof(*ret));
	return !ck_sequence_read_retry(&from->seq, version);
}

bool shm_snapshot(const struct shm_status *s, struct shm_snapshot *ret)
{
	struct shm_snapshot got;

	for (int i = 0; i < SNAPSHOT_TRIES; i++) {
		uint64_t n = __atomic_load_n(&s->snap_next, __ATOMIC_ACQUIRE);

		if (n == 0)
			return false;
		if (snap_get(&s->snap[(n - 1) & 1], &got)) {
			*ret = got;
			return true;
		}
	}
	return false;
}

bool shm_trace_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_trace *ret)
{
	struct ring r = ring_of_trace(s);

	return ring_follow(&r, f, ret);
}

bool shm_event_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_event *ret)
{
	struct ring r = ring_of_events(s);

	return ring_follow(&r, f, ret);
}

void shm_ended_put(struct shm_status *s, const struct shm_ended *e)
{
	struct ring r = ring_of_ended(s);

	ring_put(&r, e);
}

bool shm_ended_next(const struct shm_status *s, struct shm_follow *f,
		    struct shm_ended *ret)
{
	struct ring r = ring_of_ended(s);

	return ring_follow(&r, f, ret);
}

/* Search from the newest.  A torn record belongs to a command that nobody has
 * begun to carry out. */
static bool done_find(const struct ring *r, uint64_t id, uint64_t *ret_n,
		      struct shm_done *ret)
{
	uint64_t end = __atomic_load_n(r->next, __ATOMIC_ACQUIRE);

	for (uint64_t i = 1; i <= r->count && i <= end; i++) {
		if (!ring_get(r, end - i, ret) || ret->id != id)
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
	struct ring r = ring_of_done(s);

	ring_put(&r, &d);
}

void shm_done_end(struct shm_status *s, uint64_t id, int32_t code)
{
	struct ring r = ring_of_done(s);
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
	struct ring r = ring_of_done(s);
	uint64_t n;

	return done_find(&r, id, &n, ret);
}
