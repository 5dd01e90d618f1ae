/* SPDX-License-Identifier: Apache-2.0 */
/* timed.c - a part of the program that may end by time as well as by depth */
#include "path/timed.h"
#include "cycle.h"

#include <string.h>

void timed_begin(struct cycle *c, uint32_t end)
{
	const uint64_t ms = c->cursor.p.segs[end].arg;

	if (c->cursor.p.segs[end].kind != INTERP_TIMED_END) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return;
	}
	c->timed.end = end;
	c->timed.left = ms * 1000000 / (uint64_t)c->config.period_ns;
	c->timed.from_mm = interp_cursor_place_mm(&c->cursor);
}

void timed_count(struct cycle *c)
{
	if (c->timed.left > 0)
		c->timed.left--;
}

void timed_over(struct cycle *c, uint32_t end)
{
	if (!c->config.dry_run)
		c->back_mm = c->cursor.p.segs[end].s_mm;
	if (end == c->timed.end)
		c->timed.end = 0;
}

/* To tick 0 a seek takes no steps. */
void timed_skip(struct cycle *c)
{
	struct interp_cursor end = c->cursor;

	if (interp_cursor_seek(&end, c->timed.end, 0) < 0 ||
	    memcmp(end.pos, c->cursor.pos, sizeof(end.pos)) != 0) {
		fault_latch(&c->fault, FAULT_PROGRAM);
		return;
	}
	c->cursor = end;
	c->job.action_done = c->timed.end > c->job.action_done ? c->timed.end :
							 c->job.action_done;
	c->far_mm = interp_cursor_place_mm(&end);
	c->out.path++;
	timed_over(c, c->timed.end);
	c->job.dwelling = false;
	c->lift.leaving = false;
}
