/* SPDX-License-Identifier: Apache-2.0 */
/*
 * guard.c - the guards: they look at the inputs in every period, before
 * anything moves
 */
#include "guard.h"

#include "path/walk.h"

/* A cut that is about to begin needs a wire, and so does the way back out of a
 * cut: without a wire it could not feel the gap. */
static void watch_wire(struct cycle *c)
{
	if (c->gap.process != PROCESS_WIRE)
		return;
	fault_note(&c->fault, FAULT_WIRE_BROKEN);
	if (c->state == STATE_RETRACT ||
	    (c->state == STATE_TRAVEL && walk_needs_wire(c)))
		fault_latch(&c->fault, FAULT_WIRE_BROKEN);
}

static void note_machine(struct cycle *c, const struct io_inputs *in)
{
	struct fault *f = &c->fault;

	if (in->estop)
		fault_note(f, FAULT_ESTOP);
	if (in->lost)
		fault_note(f, FAULT_IO_LOST);
	if (in->door_open)
		fault_note(f, FAULT_DOOR);
	if (in->dielectric_low)
		fault_note(f, FAULT_DIELECTRIC);
	if (in->generator.trouble && c->asking.begun)
		fault_note(f, FAULT_GENERATOR);
	if (in->wire_broken || (in->plc.alive && !in->plc.wire_whole))
		watch_wire(c);
}

static void note_gap(struct cycle *c, const struct io_inputs *in)
{
	if (!c->sensed.valid && gap_is_unreadable(c, in))
		fault_note(&c->fault, FAULT_GAP_LOST);
	if (c->sensed.suspect)
		fault_note(&c->fault, FAULT_GAP_STUCK);
}

void guard_look(struct cycle *c, const struct io_inputs *in)
{
	fault_look_anew(&c->fault);
	note_machine(c, in);
	axes_guard(c, in);
	interlock_note(c, in);
	note_gap(c, in);
	limit_guard(c, in);
	guard_judge(c);
	mcode_hear(c);
	if (state_duty[c->state].power)
		arcing_watch(c);
	c->busy = in->busy;
}

enum cycle_answer guard_forbids(const struct cycle *c)
{
	const uint64_t seen = c->fault.seen[FAULT_ALWAYS] |
			      c->fault.seen[FAULT_IN_MOTION];

	if (seen)
		return ANSWER_SEEN + (uint32_t)__builtin_ctzll(seen);
	return c->plc.present && c->plc.hold ? ANSWER_PLC_HOLDS : ANSWER_DONE;
}

/*
 * A short while positioning is a collision if the gap was open since
 * positioning began. Before that, on the way out of a cut, debris may still
 * bridge the gap. Over ground that was cut it is not a collision either, but a
 * short like any other: look() sees it first.
 */
bool guard_met(const struct cycle *c)
{
	return c->state == STATE_TRAVEL && !c->config.dry_run &&
	       c->free_seen &&
	       (c->sensed.contact || ground_is_open(&c->ground));
}

void guard_contact(struct cycle *c)
{
	if (guard_met(c) && !c->withdraws)
		fault_latch(&c->fault, FAULT_CONTACT);
	if (c->state == STATE_TRAVEL)
		c->free_seen = c->free_seen || c->sensed.is_open;
}
