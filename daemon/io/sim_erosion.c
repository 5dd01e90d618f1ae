/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_erosion.c - what the sparks take away
 *
 *	volume = pulses/s * (sparks + a little of the arcs) * crater,
 *		 less the sparks that struck debris
 *	front  = volume / (frontal area * the part of it that is fresh ground)
 *	wear   = volume / frontal area * wear_ratio
 *
 * The frontal area of a ball or cone grows with the way the front has gone.
 * A wire cuts its kerf over the height of the work, and may break.
 */
#include "sim_process.h"

#include <math.h>

#define ARC_REMOVES	0.2	/* crater of an arc, of a spark's */
#define BLUNT		0.01	/* least area of a tip, of the whole */
#define AFTER		0.01	/* least part of an area that is fresh: what
				 * was eroded before is not quite smooth */
#define SHORT_J		0.5	/* energy of a short, of an arc's */

double sim_whole_area_mm2(const struct config_sim *p)
{
	if (p->process == PROCESS_WIRE)
		return (p->wire_mm + 2 * p->best_gap_mm) * p->height_mm;
	return p->area_mm2;
}

/* Ball: a sphere's segment; cone: a circle that grows with the depth. */
static double tip_part(const struct config_sim *p, double way_mm)
{
	const double t = way_mm / p->tip_mm;

	if (p->process == PROCESS_WIRE ||
	    p->electrode == ELECTRODE_FLAT || t >= 1)
		return 1;
	if (t <= 0)
		return BLUNT;
	return larger(BLUNT, p->electrode == ELECTRODE_BALL ? t * (2 - t) :
							      t * t);
}

double sim_area_mm2(const struct sim *s)
{
	return sim_whole_area_mm2(&s->p) *
	       tip_part(&s->p, s->front_mm - s->begin_mm);
}

/* The cavity is as deep as the electrode has been below its first spark. */
static void deepen(struct sim *s)
{
	const double z_mm = s->out.target[INTERP_Z] * s->z_pulse_mm;

	if (!s->sparked)
		s->surface_z_mm = z_mm;
	s->sparked = true;
	s->depth_mm = larger(s->depth_mm,
			     s->p.depth_mm + s->surface_z_mm - z_mm);
}

void sim_erode(struct sim *s)
{
	const struct pulse_train *t = &s->train;
	const bool sink = s->p.process == PROCESS_SINK;
	const bool negative = io_is_negative(&s->out);
	const double polarity = negative ? s->p.negative_removal : 1;
	const double volume = t->per_s * s->period_s * polarity *
			      s->pulse.crater_mm3 *
			      (1 - s->p.secondary * s->debris) *
			      (t->spark * t->burnt + t->arc * ARC_REMOVES);
	const double d = volume / sim_area_mm2(s);

	if (volume <= 0)
		return;
	deepen(s);
	s->front_mm += d / larger(AFTER, s->fresh);
	s->removed_mm3 += volume;
	if (sink)
		s->wear_mm += d * s->p.wear_ratio *
			      (negative ? s->p.negative_wear : 1);
	s->debris = smaller(1, s->debris + d * s->p.debris_per_mm);
}

/*
 * Arcs and shorts heat the wire at one spot: a chance to break for every
 * joule of them.  A new one is threaded while the power is off.
 */
void sim_wire(struct sim *s)
{
	const struct pulse_train *t = &s->train;
	const double joules = t->per_s * s->period_s * s->pulse.crater_j *
			      (t->arc + SHORT_J * t->shorted);

	if (s->p.process != PROCESS_WIRE)
		return;
	if (s->broken)
		s->broken = s->unpowered_s < s->p.rethread_s;
	else if (s->powered_s > s->p.respond_s &&
		 rng_uniform(&s->rng) < joules * s->p.break_per_j)
		s->broken = true;
}
