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
	c->axes.powerless = in->powerless;
	c->manual.unplaced |= in->unplaced;
	c->manual.homed &= ~in->unplaced;
	c->manual.aimed &= ~in->unplaced;
	/* A reset goes out at the end of this cycle, so what the drives report
	 * now is old. */
	if (in->trouble != IO_WELL && !c->out.reset)
		fault_note(&c->fault, fault_of(in->trouble));
	if (in->axes_off && !axes_awaits(&c->axes) && cycle_moves(c))
		fault_latch(&c->fault, FAULT_DRIVE);
	resync_look(c, in);
}

void axes_forget(struct cycle *c)
{
	c->axes.phase = AXES_FREE;
	c->axes.then = NULL;
}

void axes_want(struct cycle *c, axes_then_fn *then, double arg_mm)
{
	struct axes *a = &c->axes;

	if (!a->off && !resync_is_off(c)) {
		/* Power came in this cycle; what waited for it is replaced. */
		axes_forget(c);
		c->out.enable = true;
		if (then)
			then(c, arg_mm);
		return;
	}
	a->then = then;
	a->then_mm = arg_mm;
	if (a->phase != AXES_FREE)
		return;
	a->waited = 0;
	a->phase = c->loaded ? AXES_SEARCH : AXES_POWER;
	if (c->loaded)
		resync_search(c);
	else
		c->out.enable = true;
}

/* An axis that was moved far by hand gets no power. */
static void search(struct cycle *c)
{
	const enum resync_answer a = resync_seek(c);

	if (a == RESYNC_TOO_FAR)
		fault_latch(&c->fault, FAULT_FOLLOWING);
	if (a != RESYNC_DONE)
		return;
	c->out.enable = true;
	c->axes.phase = AXES_POWER;
}

static void wait_for_power(struct cycle *c)
{
	struct axes *a = &c->axes;

	if (a->off) {
		if (a->waited++ >= c->config.axes_wait_cycles)
			fault_latch(&c->fault, FAULT_DRIVE);
		return;
	}
	a->phase = AXES_BACK;
	if (c->loaded)
		resync_leave(c);
	else
		resync_settle(c);
}

/* Return: may anything move? */
static bool go_back(struct cycle *c)
{
	const struct axes a = c->axes;
	const enum resync_answer answer = c->loaded ? resync_go(c) :
						      RESYNC_DONE;

	if (answer == RESYNC_BUSY)
		return false;
	if (answer == RESYNC_WALKS)
		return true;
	axes_forget(c);
	if (answer == RESYNC_DONE && a.then)
		a.then(c, a.then_mm);
	return true;
}

bool axes_await(struct cycle *c)
{
	struct axes *a = &c->axes;

	if (a->phase == AXES_SEARCH)
		search(c);
	if (a->phase == AXES_POWER)
		wait_for_power(c);
	if (a->phase == AXES_BACK)
		return go_back(c);
	return a->phase == AXES_FREE;
}
