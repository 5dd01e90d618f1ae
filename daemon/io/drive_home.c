/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_home.c - a drive that homes by itself, in mode 6
 *
 * There it does not follow targets, and counts anew from its zero.  Some drives
 * do so only when they leave the mode, and some refuse to change it under
 * torque.  So the mode is changed without torque where the axis stays by
 * itself, and its count is believed only in mode 8 again.
 *
 * Bits 12 and 13 may still tell of an earlier homing.  One counts once it was 0
 * since this one began; and bit 12 if homing moves nothing and the count is
 * about 0, bit 13 if nothing else comes.  Not all drives set bit 10 with bit
 * 12, so an axis stands when its count stands still.
 */
#include "drive.h"

#include <stdlib.h>

#define MODE_HOMING	6
#define ATTAINED	0x1000u		/* bits of the statusword in mode 6 */
#define FAILED		0x2000u
#define START		0x10u		/* bits of the controlword */
#define HALT		0x100u
#define EDGE_MS		20		/* bit 4 is 0 for so long before it is
					 * 1: drives look at it seldom */
#define STILL_MS	100		/* the axis stands: it has gone no */
#define STILL_PULSES	2		/* more than this for so long */

enum drive_home_step {
	STEP_NONE,
	STEP_LET_GO,			/* no torque, ... */
	STEP_MODE,			/* ... mode 6, ... */
	STEP_READY,			/* ... torque, and bit 4 is 0 */
	STEP_RUN,			/* bit 4 is 1 */
	STEP_HALT,			/* it is not asked any more */
	STEP_LET_GO_AGAIN,
	STEP_MODE_AGAIN,
	STEP_FOLLOW,			/* mode 8, and it follows */
	NSTEPS
};

bool drive_is_homing(const struct drive *d)
{
	return d->home_step != STEP_NONE;
}

void drive_home_drop(struct drive *d)
{
	if (d->home_step != STEP_NONE)
		d->homed_now = DRIVE_UNFOUND;
	d->home_step = STEP_NONE;
}

static void go_to(struct drive *d, enum drive_home_step step)
{
	d->home_step = step;
	d->home_for = 0;
}

void drive_home_ask(struct drive *d, bool asked)
{
	if (asked && !d->home_asked && d->c.homes && d->joined &&
	    d->shows_mode)
		go_to(d, STEP_LET_GO);
	else if (asked && !d->home_asked)
		d->homed_now = DRIVE_UNFOUND;
	if (!asked && !drive_is_homing(d))
		d->homed_now = DRIVE_NOT_HOMED;
	d->home_asked = asked;
}

/* -- One function for each step: where the next period is ------------------ */

static enum drive_home_step let_go(struct drive *d)
{
	const enum drive_home_step step = (enum drive_home_step)d->home_step;

	if (!d->c.held && d->state != DRIVE_READY)
		return step;
	d->mode_wanted = step == STEP_LET_GO ? MODE_HOMING : drive_mode(&d->c);
	d->remode = true;
	return step + 1;
}

static enum drive_home_step change_mode(struct drive *d)
{
	return (enum drive_home_step)d->home_step + !d->remode;
}

static enum drive_home_step get_ready(struct drive *d)
{
	const bool ready = d->state == DRIVE_ENABLED &&
			   d->mode == MODE_HOMING;

	d->ready_for = ready ? d->ready_for + 1 : 0;
	d->home_fresh = ~d->status & (ATTAINED | FAILED);
	return d->ready_for <= drive_cycles(d, EDGE_MS) ? STEP_READY :
							  STEP_RUN;
}

int32_t drive_dither(const struct drive *d)
{
	return STILL_PULSES * abs(d->c.increments / d->c.pulses) + 1;
}

static void watch_still(struct drive *d)
{
	const int64_t off = (int64_t)d->actual - d->still_at;

	d->still_for++;
	if (llabs(off) <= drive_dither(d))
		return;
	d->still_at = d->actual;
	d->still_for = 0;
}

static bool is_found(const struct drive *d)
{
	return d->status & ATTAINED &&
	       d->still_for > drive_cycles(d, STILL_MS) &&
	       (d->home_fresh & ATTAINED ||
		(d->c.homes_here && abs(d->actual) <= drive_dither(d)));
}

static bool has_failed(const struct drive *d)
{
	return (d->status & FAILED && (d->home_fresh & FAILED ||
				       d->home_for > d->c.enable_cycles)) ||
	       d->mode != MODE_HOMING || d->home_for > d->c.home_cycles;
}

static enum drive_home_step run(struct drive *d)
{
	/* What it shows at once may be older than bit 4. */
	const bool new = d->home_for > drive_cycles(d, STILL_MS);

	d->home_fresh |= ~d->status & (ATTAINED | FAILED);
	if (has_failed(d))
		return STEP_HALT;
	if (!new || !is_found(d))
		return STEP_RUN;
	d->homed_now = DRIVE_HOMED;
	return STEP_LET_GO_AGAIN;
}

static enum drive_home_step halt(struct drive *d)
{
	d->homed_now = DRIVE_UNFOUND;
	return d->still_for > drive_cycles(d, STILL_MS) ? STEP_LET_GO_AGAIN :
							  STEP_HALT;
}

/* It stands where it was sent before it homed: only the number is another. */
static enum drive_home_step follow(struct drive *d)
{
	if (!drive_follows(d))
		return STEP_FOLLOW;
	drive_set_zero(d, d->told_pulses);
	d->target = d->actual;
	for (int i = 0; i < DRIVE_SENT; i++)
		d->sent[i] = d->target;
	d->enabled_for = 0;
	d->lag = 0;
	d->led = true;
	return STEP_NONE;
}

typedef enum drive_home_step step_fn(struct drive *d);

static step_fn *const steps[NSTEPS] = {
	[STEP_LET_GO]		= let_go,
	[STEP_MODE]		= change_mode,
	[STEP_READY]		= get_ready,
	[STEP_RUN]		= run,
	[STEP_HALT]		= halt,
	[STEP_LET_GO_AGAIN]	= let_go,
	[STEP_MODE_AGAIN]	= change_mode,
	[STEP_FOLLOW]		= follow,
};

static bool wants_torque(const struct drive *d)
{
	return d->c.held || d->home_step == STEP_READY ||
	       d->home_step == STEP_RUN || d->home_step == STEP_HALT ||
	       d->home_step == STEP_FOLLOW;
}

uint16_t drive_home_control(const struct drive *d)
{
	const uint16_t word = drive_control(wants_torque(d) ? DRIVE_GO_ON :
					    DRIVE_GO_OFF, d->state);

	return d->state != DRIVE_ENABLED ? word :
	       d->home_step == STEP_RUN ? word | START :
	       d->home_step == STEP_HALT ? word | HALT : word;
}

/* Its state and time, in each step. */
static enum drive_trouble trouble_of(const struct drive *d)
{
	const bool runs = d->home_step == STEP_RUN ||
			  d->home_step == STEP_HALT;

	if (runs && d->state != DRIVE_ENABLED)
		return DRIVE_FELL_OFF;
	if (d->home_step != STEP_RUN && d->home_for > d->c.enable_cycles)
		return d->state == DRIVE_ENABLED ? DRIVE_OTHER_MODE :
						   DRIVE_POWERLESS;
	return DRIVE_WELL;
}

bool drive_home_step(struct drive *d)
{
	const uint32_t was = d->home_step;

	watch_still(d);
	if (was == STEP_NONE)
		return false;
	if (d->trouble == DRIVE_WELL)
		d->trouble = trouble_of(d);
	if (d->trouble != DRIVE_WELL || d->goal != DRIVE_GO_ON) {
		drive_home_drop(d);
		return false;
	}
	d->home_for++;
	if (!d->home_asked && was < STEP_HALT)
		go_to(d, STEP_HALT);
	else
		d->home_step = steps[was](d);
	if (d->home_step != was)
		d->home_for = 0;
	return true;
}
