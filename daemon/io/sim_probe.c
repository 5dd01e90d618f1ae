/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_probe.c - what probing meets: a block, with a bore or without, straight
 * or turned about its middle, its face level or not
 *
 * The electrode is a cylinder along Z, its lower end where Z stands.  It is in
 * contact when that end is at the block's upper face or below it and any of
 * its outline is in the material.  Sparks do not change the block: they have
 * a workpiece of their own, the front of sim.c.
 */
#include "sim_process.h"

#include "interp/angle.h"

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

/* The electrode's place, as the block would be met if it lay straight. */
static void straighten(const struct config_sim *p, double at[2])
{
	const double x = (p->block_min_mm[0] + p->block_max_mm[0]) / 2;
	const double y = (p->block_min_mm[1] + p->block_max_mm[1]) / 2;
	const double dx = at[0] - x, dy = at[1] - y;
	const double c = cos(p->block_turn_deg * ANGLE_DEGREE);
	const double s = sin(p->block_turn_deg * ANGLE_DEGREE);

	at[0] = x + c * dx + s * dy;
	at[1] = y - s * dx + c * dy;
}

static double top_mm(const struct config_sim *p, double x)
{
	const double middle = (p->block_min_mm[0] + p->block_max_mm[0]) / 2;

	return p->block_top_mm +
	       (x - middle) * tan(p->block_tilt_deg * ANGLE_DEGREE);
}

bool sim_probe(const struct sim *s)
{
	const struct config_sim *p = &s->p;
	const double z = sim_axis(s, INTERP_Z) * s->pulse_mm[2];
	double at[2] = { sim_axis(s, INTERP_X) * s->pulse_mm[0],
			 sim_axis(s, INTERP_Y) * s->pulse_mm[1] };
	double beside;

	straighten(p, at);
	beside = hypot(outside(at[0], p->block_min_mm[0], p->block_max_mm[0]),
		       outside(at[1], p->block_min_mm[1], p->block_max_mm[1]));
	return p->block && z <= top_mm(p, at[0]) &&
	       beside <= p->feeler_mm / 2 && !in_bore(p, at[0], at[1]);
}
