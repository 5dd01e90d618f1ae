/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_debris.c - where the debris goes, and what it does meanwhile
 *
 * It is made by erosion (sim_erosion.c) and by arcs, settles by itself, is
 * driven out by pressure, and pumped out by the electrode's own strokes.  A
 * stroke moves the liquid to and fro through the gap at the electrode's side;
 * only what comes from beyond that gap is clean:
 *
 *	side  = perimeter * side gap * depth / area	as a length of stroke
 *	clean = gap / (gap + side)
 *	carry = speed / (speed + flush_mm_s)		slow: it falls back
 *	debris halves with flush_mm of stroke * clean * carry
 *
 * What it does: it narrows the gap and shortens the delay (sim_pulses.c),
 * builds bridges, and keeps arcs alive.
 */
#include "sim_process.h"

#include <math.h>

#define LN_2		0.693147180559945309
#define ARC_DEBRIS_S	0.5	/* debris a second, were all pulses arcs */
#define ARC_COOL	3.0	/* times faster with power off, or lifted */
#define BURN_FROM	0.3	/* share of arcs: they stay, and burn */
#define BURN_TO		0.1	/* ... has gone */

double sim_gap_mm(const struct sim *s)
{
	return s->front_mm + s->wear_mm - s->at_mm + s->out.off_path_mm;
}

/* Volume beside the electrode, as a stroke that would fill it. */
double sim_side_mm(const struct sim *s)
{
	const double area = sim_area_mm2(s);
	const double around = s->p.perimeter_mm > 0 ?
			      s->p.perimeter_mm *
			      sqrt(area / s->p.area_mm2) :
			      2 * sqrt(M_PI * area);

	return around * s->p.side_gap_mm * s->depth_mm / area;
}

static double pumped(const struct sim *s, double side_mm)
{
	const double gap = larger(0, sim_gap_mm(s));
	const double speed = s->stroke_mm / s->period_s;
	const double clean = gap > 0 ? gap / (gap + side_mm) : 0;

	return LN_2 * s->stroke_mm / s->p.flush_mm * clean * speed /
	       (speed + s->p.flush_mm_s);
}

void sim_wash(struct sim *s)
{
	const double side = sim_side_mm(s);
	double x = s->period_s / s->p.debris_settle_s;

	if (s->out.pump)
		x += s->period_s * s->p.flush_per_s /
		     (1 + side / s->p.flush_mm);
	if (s->stroke_mm > 0) {
		const double stroke = pumped(s, side);

		x += stroke;
		s->hot /= 1 + stroke;
	}
	s->debris /= 1 + x;
}

/* A bridge is born of debris, and breaks when the gap outgrows it. */
void sim_bridge(struct sim *s, double gap_mm)
{
	const double chance = s->p.bridge_per_s * s->debris * s->debris *
			      s->period_s;

	s->bridge_mm -= s->bridge_mm * s->period_s / s->p.bridge_settle_s;
	if (gap_mm > s->bridge_mm)
		s->bridge_mm = 0;
	if (s->powered_s > 0 && s->bridge_mm == 0 &&
	    rng_uniform(&s->rng) < chance)
		s->bridge_mm = gap_mm - s->p.bridge_mm *
			       log(1 - rng_uniform(&s->rng));
}

static void count_burns(struct sim *s)
{
	const double arc = s->powered_s > 0 ? s->train.arc : 0;

	if (!s->burning && arc > BURN_FROM)
		s->burns++;
	s->burning = arc > (s->burning ? BURN_TO : BURN_FROM);
}

/*
 * Arcs heat the place they burn at, and a hot place draws more of them.  It
 * runs away if arcing_gain (debris + what is left of the channel)^2 > 1.
 */
void sim_heat(struct sim *s)
{
	const double step = s->period_s / s->p.arcing_s;
	const bool lifted = sim_gap_mm(s) > s->p.open_gap_mm;
	double cool = 1;

	if (s->powered_s > 0) {
		const double crowd = s->debris + s->pulse.channel;

		s->hot += step * s->p.arcing_gain * crowd * crowd *
			  s->train.arc * (1 - s->hot);
		s->debris = smaller(1, s->debris + s->train.arc * ARC_DEBRIS_S *
						s->period_s);
	}
	if (s->powered_s == 0 || lifted)
		cool = ARC_COOL;
	s->hot = smaller(1, s->hot / (1 + step * cool));
	count_burns(s);
}
