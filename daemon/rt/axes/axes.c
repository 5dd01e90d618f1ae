/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.c - axes under power: asked for, awaited, lost
 */
#include "axes/axes.h"

#include "cycle.h"
#include "path/walk.h"

static enum cycle_fault fault_of(enum io_trouble t)
{
	static const enum cycle_fault faults[IO_NTROUBLES] = {
		[IO_WELL]	= FAULT_NONE,
		[IO_DRIVE]	= FAULT_DRIVE,
		[IO_FOLLOWING]	= FAULT_FOLLOWING,
		[IO_BUS]	= FAULT_BUS,
	};

	return t < IO_NTROUBLES ? faults[t] : FAULT_IO_LOST;
}

static bool in_motion(const struct cycle *c)
{
	return state_duty[c->state].running || c->mover.v_mm_s != 0 ||
	       c->moving || c->state == STATE_JOG || c->state == STATE_HOME;
}

void axes_guard(struct cycle *c, const struct io_inputs *in)
{
	c->axes.starting = in->starting;
	c->axes.off = in->axes_off;
	/* A reset goes out at the end of this cycle: what is told is old. */
	if (in->trouble != IO_WELL && !c->out.reset)
		cycle_fail(c, fault_of(in->trouble));
	if (in->axes_off && !c->axes.awaited && in_motion(c))
		cycle_fail(c, FAULT_DRIVE);
}

bool axes_want(struct cycle *c, bool start)
{
	struct axes *a = &c->axes;

	c->out.enable = true;
	if (!a->awaited)
		a->waited = 0;
	a->awaited = a->off;
	a->start = a->off && start;
	return !a->off;
}

void axes_forget(struct cycle *c)
{
	c->axes.awaited = false;
	c->axes.start = false;
}

enum axes_await axes_await(struct cycle *c)
{
	struct axes *a = &c->axes;
	const bool start = a->start;

	if (!a->awaited)
		return AXES_READY;
	if (!a->off) {
		axes_forget(c);
		return start ? AXES_START : AXES_READY;
	}
	if (a->waited++ >= c->config.axes_wait_cycles)
		cycle_fail(c, FAULT_DRIVE);
	return AXES_AWAITED;
}
