/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_probe.c - what probing meets: a block, with a bore or without
 *
 * The electrode is a cylinder along Z, its lower end where Z stands.  It is in
 * contact when that end is at the block's upper face or below it and any of
 * its outline is in the material.  Sparks do not change the block: they have
 * a workpiece of their own, the front of sim.c.
 */
#include "sim_process.h"

#include <math.h>

/* How far outside an interval. */
static double outside(double at, double min, double max)
{
	return fmax(0, fmax(min - at, at - max));
}

static bool in_bore(const struct config_sim *p, double x, double y)
{
	return hypot(x - p->bore_at_mm[0], y - p->bore_at_mm[1]) +
	       p->feeler_mm / 2 < p->bore_mm / 2;
}

bool sim_probe(const struct sim *s)
{
	const struct config_sim *p = &s->p;
	const double x = sim_axis(s, INTERP_X) * s->pulse_mm[0];
	const double y = sim_axis(s, INTERP_Y) * s->pulse_mm[1];
	const double z = sim_axis(s, INTERP_Z) * s->pulse_mm[2];
	const double beside = hypot(
		outside(x, p->block_min_mm[0], p->block_max_mm[0]),
		outside(y, p->block_min_mm[1], p->block_max_mm[1]));

	return p->block && z <= p->block_top_mm &&
	       beside <= p->feeler_mm / 2 && !in_bore(p, x, y);
}
