/* SPDX-License-Identifier: Apache-2.0 */
/* axes.c - the power of the axes: asked for, awaited, lost */
#include "axes/axes.h"

#include "cycle.h"

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

uint64_t axes_faults(void)
{
	return fault_bit(FAULT_DRIVE) | fault_bit(FAULT_FOLLOWING) |
	       fault_bit(FAULT_BUS);
}

void axes_guard(struct cycle *c, const struct io_inputs *in)
{
	c->axes.starting = in->starting;
	c->axes.off = in->axes_off;
	c->axes.steers = in->steers;
	c->manual.unplaced |= in->unplaced;
	c->manual.homed &= ~in->unplaced;
	/* A reset goes out at the end of this cycle, so what the drives report
	 * now is old. */
	if (in->trouble != IO_WELL && !c->out.reset)
		fault_note(&c->fault, fault_of(in->trouble));
	if (in->axes_off && !c->axes.awaited && cycle_moves(c))
		fault_latch(&c->fault, FAULT_DRIVE);
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
		fault_latch(&c->fault, FAULT_DRIVE);
	return AXES_AWAITED;
}
