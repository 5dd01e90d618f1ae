/* SPDX-License-Identifier: Apache-2.0 */
/* way.c - where the programmed path is, and where it goes, by its length */
#include "way.h"

#include "interp/nurbs_length.h"

#include <math.h>

static double node_mm(const struct interp_program *p, uint32_t node,
		      uint32_t column)
{
	const struct interp_program_head *h = p->head;

	return (double)p->nodes[(uint64_t)node * h->naxes + column] /
	       INTERP_SUB * h->pulse_mm[h->column[column]];
}

/* The last segment with a length that begins at @u or before it. */
static uint32_t seg_at(const struct interp_program *p, double u)
{
	uint32_t low = 0, high = p->head->nsegs;

	while (high - low > 1) {
		const uint32_t mid = low + (high - low) / 2;

		if (p->segs[mid].s_mm <= u)
			low = mid;
		else
			high = mid;
	}
	while (low > 0 && !(p->segs[low].length_mm > 0))
		low--;
	while (low + 1 < p->head->nsegs && !(p->segs[low].length_mm > 0))
		low++;
	return low;
}

static void along_arc(const struct interp_arc *a, double part, double length_mm,
		      double mm[2], double per_u[2])
{
	const double angle = a->theta + a->sweep * part;
	const double r = a->r_mm + a->dr_mm * part;

	mm[0] = a->a_mm + r * cos(angle);
	mm[1] = a->b_mm + r * sin(angle);
	per_u[0] = (a->dr_mm * cos(angle) - r * a->sweep * sin(angle)) /
		   length_mm;
	per_u[1] = (a->dr_mm * sin(angle) + r * a->sweep * cos(angle)) /
		   length_mm;
}

static uint32_t column_of(const struct interp_program *p, int axis)
{
	uint32_t j = 0;

	while (j + 1 < p->head->naxes && p->head->column[j] != axis)
		j++;
	return j;
}

/* The curve of @s, with the span last looked at. */
static struct interp_nurbs_eval *opened(const struct way *w,
					const struct interp_seg *s)
{
	const struct interp_piece *piece = &w->program->pieces[s->arg];
	struct way_curve *k = w->last;
	struct interp_nurbs c;

	if (k->open && k->curve == piece->curve)
		return &k->eval;
	k->open = interp_program_curve(w->program, piece->curve, &c);
	if (!k->open)
		return NULL;
	k->curve = piece->curve;
	interp_nurbs_open(&k->eval, &c);
	return &k->eval;
}

static void along_curve(const struct way *w, const struct interp_seg *s,
			double part, struct interp_contour_point *ret)
{
	const struct interp_program *p = w->program;
	const struct interp_piece *piece = &p->pieces[s->arg];
	const struct interp_nurbs_stop *stops = p->stops + piece->stops_at;
	const double s_mm = stops[piece->nstops - 1].s_mm * part;
	struct interp_nurbs_eval *e = opened(w, s);
	struct interp_nurbs_between between;
	struct interp_nurbs_point at;
	double speed;

	if (!e)
		return;
	stops += interp_nurbs_stop_of(stops, piece->nstops, s_mm);
	interp_nurbs_between(stops, &between);
	interp_nurbs_at(e, interp_nurbs_between_at(&between, s_mm), 1, &at);
	speed = sqrt(interp_nurbs_dot(&e->c, at.d[1], at.d[1]));
	for (uint32_t k = 0; k < e->c.naxes; k++) {
		const uint32_t j = column_of(p,
				p->curves[piece->curve].axis[k]);

		ret->mm[j] = at.d[0][k];
		/* A cusp has no direction: there the chord's is kept. */
		if (speed > 0)
			ret->per_u[j] = at.d[1][k] / speed;
	}
}

void way_at(const void *arg, double u, struct interp_contour_point *ret)
{
	const struct way *w = arg;
	const struct interp_program *p = w->program;
	const uint32_t i = seg_at(p, u);
	const struct interp_seg *s = &p->segs[i];
	const double part = fmin(fmax((u - s->s_mm) / s->length_mm, 0), 1);

	*ret = (struct interp_contour_point) { 0 };
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const double from = node_mm(p, i, j);
		const double way = node_mm(p, i + 1, j) - from;

		ret->mm[j] = from + way * part;
		ret->per_u[j] = way / s->length_mm;
	}
	if (s->kind == INTERP_ARC) {
		const struct interp_arc *a = &p->arcs[s->arg];
		double mm[2], per_u[2];

		along_arc(a, part, s->length_mm, mm, per_u);
		for (uint32_t j = 0; j < p->head->naxes; j++) {
			const int axis = p->head->column[j];

			if (axis != a->axis_a && axis != a->axis_b)
				continue;
			ret->mm[j] = mm[axis == a->axis_b];
			ret->per_u[j] = per_u[axis == a->axis_b];
		}
	}
	if (s->kind == INTERP_CURVE)
		along_curve(w, s, part, ret);
}
