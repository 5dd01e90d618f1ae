/* SPDX-License-Identifier: Apache-2.0 */
/* plc_loop.c - the PLC in the loop: what it asks for, and what it is told */
#include "loop.h"

#include <math.h>
#include <string.h>

void loop_plc_read(struct loop *l)
{
	const uint16_t was = l->plc_in.program;

	plc_link_read(&l->plc, &l->plc_in);
	if (l->plc_in.program && l->plc_in.program != was)
		loop_event(l, SHM_EV_SELECT, 0, l->plc_in.program);
}

/* An edge is valid for one period, also when a simulation runs several. */
void loop_plc_input(struct loop *l, struct io_inputs *in)
{
	in->plc = l->plc_in;
	l->plc_in.start = false;
	l->plc_in.reset = false;
	l->plc_in.confirm = false;
}

static double whole(double x, double min, double max)
{
	return isfinite(x) ? fmin(fmax(round(x), min), max) : 0;
}

static uint8_t flags_of(const struct cycle *c)
{
	const bool flag[8] = {
		[1] = c->out.power,
		[2] = state_duty[c->state].running,
		[3] = c->state == STATE_HOLD,
		[4] = c->fault.first != FAULT_NONE,
		[5] = c->out.pump,
		[6] = c->loaded,
		[7] = io_is_negative(&c->out),
	};
	uint8_t ret = 0;

	for (int i = 0; i < 8; i++)
		ret = (uint8_t)(ret | flag[i] << i);
	return ret;
}

_Static_assert(PLC_SPARK == 1 << 1 && PLC_RUNS == 1 << 2 &&
	       PLC_HELD == 1 << 3 && PLC_FAULTY == 1 << 4 &&
	       PLC_PUMP == 1 << 5 && PLC_LOADED == 1 << 6 &&
	       PLC_NEGATIVE == 1 << 7, "flags_of()");

void loop_plc_write(struct loop *l)
{
	const struct cycle *c = &l->cycle;
	const struct stand_now stand = stand_now(c);
	struct plc_tell t = {
		.state = (uint8_t)c->state,
		.flags = flags_of(c),
		.fault = (uint8_t)c->fault.first,
		.mcode = c->mcode.number,
		.gap = (uint16_t)whole(c->gap_v * 100, 0, UINT16_MAX),
		.feed = (int16_t)whole(c->feed_mm_s * 1000, INT16_MIN,
				       INT16_MAX),
		.job = l->program ? l->program->n : 0,
		.line = l->program ? c->cursor.seg.line : 0,
		.stand = (uint8_t)stand.why,
		.stand_of = stand.of,
		.electrode = (uint16_t)c->job.electrode,
		.condition = (uint16_t)whole(c->out.cond_number, 0, UINT16_MAX),
		.letter = (uint8_t)c->out.cond_letter,
		.pulse = l->plc.plc.tell.pulse,	/* the generator's */
	};

	memcpy(t.pos, c->out.target, sizeof(t.pos));
	plc_link_write(&l->plc, &t);
}
