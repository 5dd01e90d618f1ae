/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.c - what each call of a condition will cut, for --check
 *
 * The volume is the way times the frontal area.  The minutes are the volume
 * divided by the condition's own removal rate.  Both are what the table
 * promises, not what a gap will do.
 */
#include "sim.h"

#include <math.h>

/* One condition, from its call to the next call. */
struct stretch {
	uint16_t cond;
	uint32_t line;
	double from_mm, to_mm;		/* Z, machine */
	double cut_mm;
};

struct plan {
	const struct interp_program *p;
	double area_mm2;
	int z;				/* column of the nodes; -1: none */
	double volume_mm3, minutes;
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
	const double volume = s->cut_mm * q->area_mm2;
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
	put_or_dash(q, " %8.2f", t->v[INTERP_TECH_ROUGHNESS_UM]);
	fputc('\n', q->f);
	q->volume_mm3 += volume;
	q->minutes += volume / rate;
}

static bool is_cut(const struct interp_seg *s)
{
	return s->kind < INTERP_BEGIN && !(s->flags & INTERP_SEG_RAPID);
}

static void walk(struct plan *q)
{
	const struct interp_program *p = q->p;
	struct stretch s = { 0 };

	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		const struct interp_seg *g = &p->segs[i];

		if (!is_cut(g))
			continue;
		if (g->cond != s.cond || s.cut_mm <= 0) {
			put_stretch(q, &s);
			s = (struct stretch) {
				.cond = g->cond, .line = g->line,
				.from_mm = z_mm(q, i),
			};
		}
		s.cut_mm += g->length_mm;
		s.to_mm = z_mm(q, i + 1);
	}
	put_stretch(q, &s);
}

void plan_print(const struct sim_job *job, const struct machine_config *c,
		FILE *f)
{
	struct plan q = {
		.p = &job->program, .area_mm2 = c->sim.area_mm2, .z = -1,
		.f = f,
	};
	const struct interp_program_head *h = q.p->head;

	if (h->nconds < 2)
		return;
	for (uint32_t j = 0; j < h->naxes; j++)
		q.z = h->column[j] == INTERP_Z ? (int)j : q.z;
	fprintf(f, "plan       for a frontal area of %g mm2\n"
		"  condition   line    Z from      Z to      way    leaves"
		"       mm3      min    um Ra\n", q.area_mm2);
	walk(&q);
	fprintf(f, "  %-9s %63.2f", "sum", q.volume_mm3);
	put_or_dash(&q, " %8.2f", q.minutes);
	fputc('\n', f);
}
