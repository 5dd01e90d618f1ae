/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_ground.c - how much of the electrode's area meets fresh ground
 *
 * A second turn over the same ground, or a step a little deeper than the turn
 * before, erodes only what the first one has left (sim_map.h).  When A B C
 * turn, or U V of a sinker move, the electrode has another outline, and
 * everything counts as fresh.
 */
#include "sim_process.h"

#include <math.h>
#include <string.h>

#define ELECTRODE_CELLS	64		/* across it; an orbit is a part */
#define WIRE_CELLS	8

void sim_map_of(struct sim_map *m, const struct config_sim *p)
{
	const double kerf_mm = p->wire_mm + 2 * p->best_gap_mm;

	if (p->process == PROCESS_WIRE)
		sim_map_init(m, M_PI / 4 * kerf_mm * kerf_mm, WIRE_CELLS);
	else
		sim_map_init(m, p->area_mm2, ELECTRODE_CELLS);
}

void sim_ground_init(struct sim *s)
{
	sim_map_of(&s->map, &s->p);
	s->fresh = 1;
}

static void lift(struct sim *s)
{
	sim_map_lift(&s->map);
	s->over_mm = s->at_mm;
	s->fresh = 1;
}

void sim_ground_clear(struct sim *s)
{
	sim_map_clear(&s->map);
	lift(s);
}

/* The axes that give the electrode another outline. */
static bool has_turned(struct sim *s)
{
	bool turned = false;

	for (int i = INTERP_A; i < IO_NAXES; i++) {
		const double at = sim_axis(s, i);

		turned = turned || at != s->turned[i];
		s->turned[i] = at;
	}
	return turned && s->p.process == PROCESS_SINK;
}

void sim_ground_follow(struct sim *s)
{
	const double way_mm = s->at_mm - s->over_mm;
	double at_mm[3];

	if (s->out.rapid) {
		lift(s);
		return;
	}
	if (s->out.off_path_mm > 0 ||
	    (s->map.placed && way_mm < sim_map_step_mm(&s->map)))
		return;
	if (has_turned(s)) {
		sim_ground_clear(s);
		return;
	}
	for (int i = 0; i < 3; i++)
		at_mm[i] = sim_axis(s, i) * s->pulse_mm[i];
	s->fresh = sim_map_cut(&s->map, at_mm);
	s->over_mm = s->at_mm;
}
