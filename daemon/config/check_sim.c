/* SPDX-License-Identifier: Apache-2.0 */
/* check_sim.c - values that the simulated process cannot have */
#include "keys.h"

#include <errno.h>
#include <math.h>


struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

static uint32_t line_of(const struct check *q, enum config_section_id s,
			const char *key)
{
	return q->lines->at[config_key_find(s, key)][0];
}

/* The message points to the last of the keys. */
static void blame(struct check *q, uint32_t a, uint32_t b, uint32_t c)
{
	q->diag->line = a > b ? a : b;
	q->diag->line = q->diag->line > c ? q->diag->line : c;
	q->diag->column = 0;
}

/* For its area, a circle has the smallest perimeter. */
static int perimeter(struct check *q)
{
	const double round_mm = 2 * sqrt(M_PI * q->c->sim.area_mm2);

	/* The perimeter of a circle may be given with two decimals. */
	if (q->c->sim.perimeter_mm == 0 ||
	    q->c->sim.perimeter_mm > 0.99 * round_mm)
		return 0;

	blame(q, line_of(q, SECTION_SIM, "perimeter_mm"),
	      line_of(q, SECTION_SIM, "area_mm2"), 0);
	return interp_diag_say(q->diag, "sim.perimeter_mm %g mm is too short "
			       "for area_mm2 %g mm2; 0 for a round electrode, "
			       "or more than its %.4g mm",
			       q->c->sim.perimeter_mm, q->c->sim.area_mm2,
			       round_mm);
}

/* Otherwise hardly any discharge would ignite even at the best gap. */
static int ignition_wait(struct check *q)
{
	const double least = (q->c->sim.on_us + q->c->sim.off_us) / 4;

	if (!q->c->sim.iso || q->c->sim.wait_us >= least)
		return 0;

	blame(q, line_of(q, SECTION_SIM, "wait_us"),
	      line_of(q, SECTION_SIM, "on_us"),
	      line_of(q, SECTION_SIM, "off_us"));
	return interp_diag_say(q->diag, "sim.wait_us %g us is short for on_us "
			       "%g us and off_us %g us; a quarter of on and "
			       "off time, %.4g us, or more; or iso = no",
			       q->c->sim.wait_us, q->c->sim.on_us,
			       q->c->sim.off_us, least);
}

/* An open gap must look wider than the gap that the servo holds. */
static int open_mean(struct check *q)
{
	const struct config_sim *s = &q->c->sim;
	const double wait_us = s->iso ? s->wait_us : s->on_us;
	const double mean_v = s->open_v * wait_us / (wait_us + s->off_us);

	if (!config_machine_is(q->c, MACHINE_MODEL) ||
	    mean_v > q->c->gap.servo_v)
		return 0;

	blame(q, line_of(q, SECTION_GAP, "servo_v"),
	      line_of(q, SECTION_SIM, "open_v"),
	      line_of(q, SECTION_SIM, "off_us"));
	return interp_diag_say(q->diag, "gap.servo_v %g V is not below the "
			       "simulated gap's %.4g V when it is open; a "
			       "lower servo_v, or a shorter [sim] off_us %g us",
			       q->c->gap.servo_v, mean_v, s->off_us);
}

/* One pair of sides, by their keys. */
static int block_side(struct check *q, int i, const char *min, const char *max)
{
	const double low = q->c->sim.block_min_mm[i];
	const double high = q->c->sim.block_max_mm[i];

	if (low < high)
		return 0;

	blame(q, line_of(q, SECTION_SIM, min), line_of(q, SECTION_SIM, max), 0);
	return interp_diag_say(q->diag, "sim.%s %g mm is not below %s %g mm; "
			       "a block with an inside", min, low, max, high);
}

static int block(struct check *q)
{
	return block_side(q, 0, "block_x_min_mm", "block_x_max_mm") ||
	       block_side(q, 1, "block_y_min_mm", "block_y_max_mm") ?
	       -EINVAL : 0;
}

int config_check_sim(const struct machine_config *c,
		     const struct config_lines *lines,
		     struct interp_diag *diag)
{
	struct check q = { c, lines, diag };

	return perimeter(&q) || ignition_wait(&q) || open_mean(&q) ||
	       block(&q) ? -EINVAL : 0;
}
