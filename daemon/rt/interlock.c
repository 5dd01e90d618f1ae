/* SPDX-License-Identifier: Apache-2.0 */
/*
 * interlock.c - a PLC's permit, interlocks and requests
 */
#include "interlock.h"
#include "cycle.h"

#include <stddef.h>

static const struct {
	size_t at;			/* of its bool in struct io_plc */
	enum cycle_fault fault;
} rows[] = {
	{ offsetof(struct io_plc, no_fire), FAULT_FIRE },
	{ offsetof(struct io_plc, door_closed), FAULT_DOOR },
	{ offsetof(struct io_plc, level_ok), FAULT_DIELECTRIC },
	{ offsetof(struct io_plc, temperature_ok), FAULT_TEMPERATURE },
	{ offsetof(struct io_plc, permit), FAULT_PERMIT },
};

#define NROWS	(sizeof(rows) / sizeof(rows[0]))

static bool is_well(const struct io_plc *p, size_t row)
{
	return *(const bool *)((const char *)p + rows[row].at);
}

static void note(struct cycle *c)
{
	const struct io_plc *p = &c->plc;

	if (!p->alive) {
		fault_note(&c->fault, FAULT_PLC_LOST);
		return;
	}
	for (size_t i = 0; i < NROWS; i++) {
		if (!is_well(p, i))
			fault_note(&c->fault, rows[i].fault);
	}
	/* A PLC that watches the level wants it for any motion. */
	if (!p->level_ok)
		fault_note_in(&c->fault, FAULT_DIELECTRIC, FAULT_IN_MOTION);
}

static void command(struct cycle *c, enum cycle_verb verb, double arg)
{
	const struct cycle_command m = { .verb = verb, .arg_mm = arg };

	cycle_command(c, &m);
}

/* If the PLC does not say a temperature, or is gone, the axes keep the last
 * one. */
static void warm(struct cycle *c, double was_c)
{
	const double c_now = c->plc.axes_c;

	if (c_now > 0 && c_now != was_c)
		comp_warm(&c->comp, &c->config.comp, c_now);
}

void interlock_note(struct cycle *c, const struct io_inputs *in)
{
	c->plc = in->plc;
	if (c->plc.present)
		note(c);
}

void interlock_obey(struct cycle *c)
{
	if (!c->plc.present || !c->plc.alive)
		return;
	if (c->plc.reset)
		command(c, CYCLE_RESET, 0);
	if (c->plc.hold && (!c->plc_held || state_duty[c->state].running)) {
		if (c->loaded)
			stand_begin(c, STAND_PLC, 0);
		command(c, CYCLE_HOLD, 0);
	}
	if (c->plc.confirm)
		command(c, CYCLE_CONFIRM, c->stand.of);
	/* Another client may set the override too: the last change counts. */
	if (c->plc.override != c->plc_override)
		command(c, CYCLE_OVERRIDE, c->plc.override);
	c->plc_override = c->plc.override;
	warm(c, c->plc_axes_c);
	c->plc_held = c->plc.hold;
	c->plc_axes_c = c->plc.axes_c;
	/* A start that comes together with the reset was not meant for what is
	 * there now. */
	if (c->plc.start && !c->plc.reset)
		command(c, CYCLE_START, 0);
}
