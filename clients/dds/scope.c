/* SPDX-License-Identifier: Apache-2.0 */
/* scope.c - each cycle of a machine over DDS, while somebody reads it */
#include "scope.h"

#include <stdio.h>
#include <string.h>

int scope_open(struct scope *s, dds_entity_t part)
{
	s->writer = topic_writer_create(part, TOPIC_SCOPE);
	return s->writer < 0 ? s->writer : 0;
}

static bool is_read(const struct scope *s)
{
	dds_publication_matched_status_t m;

	return dds_get_publication_matched_status(s->writer, &m) == 0 &&
	       m.current_count > 0;
}

static void fill_row(edm_ScopeRow *row, const struct shm_trace *t)
{
	*row = (edm_ScopeRow) {
		.cycle = t->cycle, .place_mm = t->place_mm,
		.feed_mm_s = (float)t->feed_mm_s, .gap_v = (float)t->gap_v,
		.line = t->line, .state = t->state,
	};
	memcpy(row->position, t->pos, sizeof(row->position));
	memcpy(row->actual, t->actual, sizeof(row->actual));
}

static uint32_t fill_rows(struct scope *s, const struct watch *w)
{
	struct shm_trace t;
	uint32_t n = 0;

	while (n < SCOPE_ROWS && shm_trace_next(w->status, &s->trace, &t))
		fill_row(&s->row[n++], &t);
	return n;
}

static void write_rows(const struct scope *s, const struct watch *w,
		       const struct shm_snapshot *about, uint32_t n)
{
	edm_Scope m = {
		.period_s = (double)about->period_ns * 1e-9,
		.rows = { ._length = n, ._maximum = n,
			  ._buffer = (edm_ScopeRow *)(uintptr_t)s->row },
	};

	snprintf(m.machine, sizeof(m.machine), "%s", w->machine);
	memcpy(m.pulse_mm, about->pulse_mm, sizeof(m.pulse_mm));
	dds_write(s->writer, &m);
}

void scope_step(struct scope *s, const struct watch *w)
{
	const bool was = s->is_read;
	struct shm_snapshot about;
	uint32_t n = SCOPE_ROWS, instance;

	s->is_read = s->writer > 0 && w->status && is_read(s);
	if (!s->is_read || !shm_snapshot(w->status, &about))
		return;
	instance = w->status->head.instance;
	if (!was || s->instance != instance)
		s->trace.next = __atomic_load_n(&w->status->trace_next,
						__ATOMIC_ACQUIRE);
	s->instance = instance;
	for (int left = SHM_TRACE_SLOTS; n == SCOPE_ROWS && left > 0;
	     left -= SCOPE_ROWS) {
		n = fill_rows(s, w);
		if (n > 0)
			write_rows(s, w, &about, n);
	}
}
