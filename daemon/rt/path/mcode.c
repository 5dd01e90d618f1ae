/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mcode.c - tell an M code, wait for its answer
 */
#include "path/mcode.h"
#include "cycle.h"

#include <math.h>

void mcode_begin(struct cycle *c, uint32_t index)
{
	c->mcode = (struct mcode) { .back_to = index };
}

/* A PLC that is gone says nothing, not even that its answer is withdrawn. */
void mcode_hear(struct cycle *c)
{
	struct mcode *m = &c->mcode;

	m->waits = false;
	if (!c->plc.present || !c->plc.alive)
		return;
	m->busy = c->plc.mcode_done != 0;
	if (m->number != 0 && c->plc.mcode_done == m->number) {
		m->number = 0;
		m->done = true;
	}
}

void mcode_follow(struct cycle *c)
{
	if (c->state != STATE_JUMP && c->cursor.index < c->mcode.back_to)
		c->mcode.back_to = c->cursor.index;
}

bool mcode_again(const struct cycle *c, uint32_t i, uint32_t arg)
{
	return c->plc.present && c->state != STATE_JUMP &&
	       interp_mcode_back(arg) == INTERP_MCODE_REDO &&
	       i > c->mcode.back_to;
}

static bool stay(struct cycle *c)
{
	struct mcode *m = &c->mcode;

	m->waits = true;
	if (c->config.mcode_cycles && ++m->waited > c->config.mcode_cycles) {
		m->waited = 0;
		fault_latch(&c->fault, FAULT_MCODE);
	}
	return false;
}

void mcode_over(struct cycle *c, uint32_t i)
{
	const struct interp_seg s = c->cursor.p.segs[i];

	if (c->plc.present && interp_mcode_back(s.arg) == INTERP_MCODE_STOP)
		c->back_mm = fmax(c->back_mm, s.s_mm);
}

static void pass(struct cycle *c, uint32_t next)
{
	struct mcode *m = &c->mcode;

	m->at = 0;
	m->back_to = next;
	m->waited = 0;
	mcode_over(c, next);
}

bool mcode_meet(struct cycle *c, uint32_t next, uint32_t arg)
{
	struct mcode *m = &c->mcode;

	if (!c->plc.present ||
	    (next <= c->job.action_done && !mcode_again(c, next, arg)))
		return true;
	if (m->at != next) {
		if (m->number != 0 || m->busy)
			return stay(c);
		m->at = next;
		m->number = interp_mcode_number(arg);
		m->done = false;
		m->waited = 0;
	}
	if (interp_mcode_sync(arg) != INTERP_MCODE_FREE && !m->done)
		return stay(c);
	pass(c, next);
	return true;
}

uint32_t mcode_line(const struct cycle *c)
{
	return c->mcode.waits && c->mcode.at ?
	       c->cursor.p.segs[c->mcode.at].line : c->cursor.seg.line;
}
