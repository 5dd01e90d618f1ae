/* SPDX-License-Identifier: Apache-2.0 */
/* flush.c - when to jump: by time, by depth, or because arcs ask for it */
#include "gap/flush.h"
#include "cycle.h"

#include <math.h>

#define TRIAL_JUMPS	4		/* jumps that judge a period */
#define STEP		1.15		/* factor on the period, up or down */
#define OFTENER		0.7		/* two steps halve the period */
#define HIGHER		1.25
#define LOWER		0.95

bool flush_jumps(const struct cycle *c)
{
	return c->gap.process == PROCESS_SINK && c->jump.height_mm > 0;
}

static bool is_adapted(const struct cycle *c)
{
	const struct flush *f = &c->flush;

	return c->jump.adaptive && f->every_cycles &&
	       f->from_cycles == c->jump.every.cycles &&
	       f->from_mm == c->jump.height_mm;
}

static uint64_t every_cycles(const struct cycle *c)
{
	return is_adapted(c) ? c->flush.every_cycles : c->jump.every.cycles;
}

bool flush_due(const struct cycle *c)
{
	if (!flush_jumps(c))
		return false;
	if (arcing_jump_due(c) || c->flush.eroded >= every_cycles(c))
		return true;
	return c->jump.every_mm > 0 && c->flush.depth_mm >= c->jump.every_mm;
}

static double within(double x, double min, double max)
{
	return fmin(fmax(x, min), max);
}

static void scale(struct cycle *c, double period, double height)
{
	const struct cycle_jump_config *j = &c->jump;
	struct flush *f = &c->flush;

	f->every_cycles = (uint64_t)within(
		floor((double)f->every_cycles * period + 0.5),
		(double)j->every_min.cycles, (double)j->every_max.cycles);
	f->height_mm = within(f->height_mm * height, j->height_min_mm,
			      j->height_max_mm);
}

static void begin_anew(struct cycle *c)
{
	struct flush *f = &c->flush;

	f->from_cycles = f->every_cycles = c->jump.every.cycles;
	f->from_mm = f->height_mm = c->jump.height_mm;
	f->trial = (struct flush_trial) { .seldomer = true };
}

/* Make a few jumps with one period. Then change the period, or go back if the
 * last change made it slower. */
static void climb(struct cycle *c)
{
	struct flush *f = &c->flush;
	struct flush_trial *t = &f->trial;
	double rate;

	t->depth_mm += f->depth_mm;
	t->cycles += f->cycles;
	if (++t->jumps < TRIAL_JUMPS)
		return;
	rate = t->depth_mm / t->cycles;
	if (rate < t->before)
		t->seldomer = !t->seldomer;
	*t = (struct flush_trial) { .before = rate, .seldomer = t->seldomer };
	scale(c, t->seldomer ? STEP : 1 / STEP,
	      f->height_mm > f->from_mm ? LOWER : 1);
}

static void adapt(struct cycle *c)
{
	struct flush *f = &c->flush;

	if (!is_adapted(c)) {
		begin_anew(c);
	} else if (f->bad > c->jump.bad_share * f->cycles) {
		scale(c, OFTENER, HIGHER);
		f->trial = (struct flush_trial) { .seldomer = true };
	} else {
		climb(c);
	}
}

double flush_begin(struct cycle *c)
{
	struct flush *f = &c->flush;
	double height = c->jump.height_mm;

	if (c->jump.adaptive) {
		adapt(c);
		height = f->height_mm;
	}
	f->eroded = 0;
	f->cycles = f->bad = f->depth_mm = 0;
	return height;
}

/* The time that jumps take counts as well. */
void flush_watch(struct cycle *c)
{
	struct flush *f = &c->flush;
	const double deeper = c->far_mm - f->far_mm;

	f->far_mm = c->far_mm;
	if (c->state == STATE_ERODE) {
		f->eroded++;
		f->depth_mm += deeper;
	} else if (!state_duty[c->state].running) {
		return;
	}
	f->cycles++;
	f->bad += c->state == STATE_RETRACT || c->sensed.contact ? 1 :
							 c->sensed.arc;
}
