/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.c - what each call of a condition will cut, for --check
 *
 * The volume is that of the ground which the electrode meets for the first
 * time: the way times the frontal area, of a wire times its kerf, less what
 * earlier parts of the path have removed (sim_map.h).  The minutes are the
 * volume divided by the condition's own removal rate.  Both are what the table
 * promises, not what a gap will do.
 */
#include "sim.h"
#include "sim_process.h"

#include "interp/at.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* The most steps of a long path: the longer it is, the longer are they. */
#define STEPS_MAX	100000.0

/* One condition, from its call to the next call. */
struct stretch {
	uint16_t cond;
	uint32_t line;
	double from_mm, to_mm;		/* Z, machine */
	double cut_mm;
	double fresh_mm;		/* of it, as if all ground were fresh */
	double dwell_s;
};

struct plan {
	const struct interp_program *p;
	double area_mm2;
	bool wire;
	int z;				/* column of the nodes; -1: none */
	double volume_mm3, minutes, dwell_s;
	struct sim_map *map;
	double step_mm;
	uint32_t turns;			/* columns of A B C, and U V of a
					 * sinker, a bit each */
	FILE *f;
};

static double z_mm(const struct plan *q, uint32_t node)
{
	const struct interp_program_head *h = q->p->head;

	if (q->z < 0)
		return h->start_pulses[INTERP_Z] * h->pulse_mm[INTERP_Z];
	return (double)q->p->nodes[(size_t)node * h->naxes + (size_t)q->z] /
	       INTERP_SUB * h->pulse_mm[INTERP_Z];
}

static void put_or_dash(const struct plan *q, const char *format, double v)
{
	if (isnan(v))
		fprintf(q->f, " %8s", "-");
	else
		fprintf(q->f, format, v);
}

static void put_stretch(struct plan *q, const struct stretch *s)
{
	const struct interp_cond *c = &q->p->conds[s->cond];
	const struct interp_tech *t = &c->tech;
	const double rate = t->v[INTERP_TECH_REMOVAL_MM3_MIN];
	const double volume = s->fresh_mm * q->area_mm2;
	char name[16] = "none";

	if (s->cut_mm <= 0)
		return;
	if (c->letter)
		interp_tech_name(c->letter, c->number, name, sizeof(name));
	fprintf(q->f, "  %-9s %6u %9.3f %9.3f %8.3f", name, s->line,
		s->from_mm, s->to_mm, s->cut_mm);
	put_or_dash(q, " %8.3f", t->v[INTERP_TECH_ALLOWANCE_MM]);
	fprintf(q->f, " %9.2f", volume);
	put_or_dash(q, " %8.2f", volume / rate);
	fprintf(q->f, " %7.1f", s->dwell_s);
	put_or_dash(q, " %8.2f", t->v[INTERP_TECH_ROUGHNESS_UM]);
	fputc('\n', q->f);
	q->dwell_s += s->dwell_s;
	q->volume_mm3 += volume;
	q->minutes += volume / rate;
}

static bool is_cut(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN && !(s->flags & INTERP_SEG_RAPID);
}

/* Has the electrode another outline at the end than at the start? */
static bool turns(const struct plan *q, uint32_t i)
{
	const uint32_t n = q->p->head->naxes;
	const int64_t *from = q->p->nodes + (size_t)i * n, *to = from + n;

	for (uint32_t j = 0; j < n; j++)
		if (q->turns >> j & 1 && from[j] != to[j])
			return true;
	return false;
}

/* The end of the electrode; false: nobody knows where. */
static bool place_mm(const struct plan *q, uint32_t i, double s_mm,
		     double ret[3])
{
	const struct interp_program_head *h = q->p->head;
	struct interp_at_curve last = { 0 };
	struct interp_contour_point at;

	for (int a = 0; a < 3; a++)
		ret[a] = h->start_pulses[a] * h->pulse_mm[a];
	if (!interp_program_at(q->p, i, s_mm, &last, &at))
		return false;
	for (uint32_t j = 0; j < h->naxes; j++)
		if (h->column[j] <= INTERP_Z)
			ret[h->column[j]] = at.mm[j];
	return true;
}

/* How long the cut would be, with the same volume, were all ground fresh. */
static double fresh_mm(struct plan *q, uint32_t i)
{
	const double length = q->p->segs[i].length_mm;
	const double steps = ceil(length / q->step_mm);
	double at[3], sum = 0;

	if (turns(q, i) || !place_mm(q, i, 0, at)) {
		sim_map_clear(q->map);
		return length;
	}
	sim_map_cut(q->map, at);
	for (double k = 1; k <= steps; k++) {
		if (!place_mm(q, i, length * k / steps, at))
			return length;
		sum += length / steps * sim_map_cut(q->map, at);
	}
	return sum;
}

static void walk(struct plan *q)
{
	const struct interp_program *p = q->p;
	struct stretch s = { 0 };

	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		const struct interp_seg *g = &p->segs[i];

		if (g->kind == INTERP_DWELL)
			s.dwell_s += g->arg * 1e-3;
		if (!is_cut(g)) {
			if (g->flags & INTERP_SEG_RAPID)
				sim_map_lift(q->map);
			continue;
		}
		if (g->cond != s.cond || s.cut_mm <= 0) {
			const double dwell_s = s.cut_mm > 0 ? 0 : s.dwell_s;

			put_stretch(q, &s);
			s = (struct stretch) {
				.cond = g->cond, .line = g->line,
				.from_mm = z_mm(q, i), .dwell_s = dwell_s,
			};
		}
		s.cut_mm += g->length_mm;
		s.fresh_mm += fresh_mm(q, i);
		s.to_mm = z_mm(q, i + 1);
	}
	put_stretch(q, &s);
}

static double cut_mm(const struct interp_program *p)
{
	double sum = 0;

	for (uint32_t i = 0; i < p->head->nsegs; i++)
		sum += is_cut(&p->segs[i]) ? p->segs[i].length_mm : 0;
	return sum;
}

static void begin(struct plan *q, const struct machine_config *c)
{
	const struct interp_program_head *h = q->p->head;
	const struct config_sim *p = &c->sim;

	q->wire = p->process == PROCESS_WIRE;
	q->area_mm2 = sim_whole_area_mm2(p);
	for (uint32_t j = 0; j < h->naxes; j++) {
		q->z = h->column[j] == INTERP_Z ? (int)j : q->z;
		if (h->column[j] > INTERP_Z && !q->wire)
			q->turns |= 1u << j;
	}
	sim_map_of(q->map, p);
	q->step_mm = fmax(sim_map_step_mm(q->map), cut_mm(q->p) / STEPS_MAX);
	if (q->wire)
		fprintf(q->f,
			"plan       for a kerf of %g mm in work %g mm high\n",
			p->wire_mm + 2 * p->best_gap_mm, p->height_mm);
	else
		fprintf(q->f, "plan       for a frontal area of %g mm2\n",
			q->area_mm2);
}

int plan_print(const struct sim_job *job, const struct machine_config *c,
	       FILE *f)
{
	struct plan q = { .p = &job->program, .z = -1, .f = f };

	if (q.p->head->nconds < 2)
		return 0;
	q.map = calloc(1, sizeof(*q.map));
	if (!q.map)
		return EX_OSERR;
	begin(&q, c);
	fputs("  condition   line    Z from      Z to      way    leaves"
	      "       mm3      min dwell s    um Ra\n", f);
	walk(&q);
	fprintf(f, "  %-9s %63.2f", "sum", q.volume_mm3);
	put_or_dash(&q, " %8.2f", q.minutes);
	fprintf(f, " %7.1f\n", q.dwell_s);
	free(q.map);
	return 0;
}
