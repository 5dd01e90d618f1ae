/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.c - the contour error of a dry run: of the simulated axes as the
 * cycle led them, or, without these, of models that follow the job afterwards
 */
#include "sim.h"

#include "interp/at.h"
#include "path/place.h"

#include <math.h>
#include <stdlib.h>

#define LOOK_MM	0.02

struct watch {
	struct interp_at_path way;
	struct interp_at_curve last;
	struct interp_contour_path path;
	struct interp_contour foot;
	double place_mm, sum_mm, max_mm;
	uint64_t n;
};

/* Standing still is no error, and would only make the mean smaller. */
static void look(struct sim_run *r)
{
	struct watch *w = r->on_cycle_arg;
	const struct cycle *c = &r->v.cycle;
	const struct interp_program_head *h = r->job.program.head;
	const double at_mm = place_mm(c);
	struct interp_contour_error e;
	double mm[INTERP_NAXES];

	if (at_mm == w->place_mm)
		return;
	for (uint32_t j = 0; j < h->naxes; j++) {
		const uint8_t i = h->column[j];

		mm[j] = (comp_place(&c->comp.axis[i], r->v.in.actual[i]) -
			 c->probe.shift[i]) * h->pulse_mm[i];
	}
	interp_contour_step(&w->foot, mm, at_mm, &e);
	w->place_mm = at_mm;
	w->max_mm = fmax(w->max_mm, e.mm);
	w->sum_mm += e.mm;
	w->n++;
}

bool edmsim_contour_look(struct sim_run *r)
{
	struct watch *w;

	if (!r->config->sim.loops || config_machine_is(r->config, MACHINE_NONE))
		return false;
	w = calloc(1, sizeof(*w));
	if (!w)
		return false;
	w->way = (struct interp_at_path) { &r->job.program, &w->last };
	if (!interp_program_path(&w->way, &w->path)) {
		free(w);
		return false;
	}
	interp_contour_begin(&w->foot, &w->path, 0, LOOK_MM);
	r->on_cycle = look;
	r->on_cycle_arg = w;
	return true;
}

void edmsim_contour_looked(struct sim_run *r)
{
	struct watch *w = r->on_cycle_arg;

	r->result.contour_known = w->n > 0;
	r->result.contour_mm_max = w->max_mm;
	r->result.contour_mm_mean = w->sum_mm / fmax((double)w->n, 1);
	free(w);
	r->on_cycle_arg = NULL;
	r->on_cycle = NULL;
}
