/* SPDX-License-Identifier: Apache-2.0 */
/* at.c - the programmed point at a place: lines, arcs and curves */
#include "interp/at.h"
#include "interp/program.h"

#include <math.h>

static double node_mm(const struct interp_program *p, uint32_t node,
		      uint32_t column)
{
	const struct interp_program_head *h = p->head;

	return (double)p->nodes[(uint64_t)node * h->naxes + column] /
	       INTERP_SUB * h->pulse_mm[h->column[column]];
}

static void along_line(const struct interp_program *p, uint32_t i,
		       const struct interp_seg *s, double part,
		       struct interp_contour_point *ret)
{
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const double from = node_mm(p, i, j);
		const double way = node_mm(p, i + 1, j) - from;

		ret->mm[j] = from + way * part;
		ret->per_u[j] = way / s->length_mm;
	}
}

static void along_arc(const struct interp_program *p,
		      const struct interp_seg *s, struct interp_arc a,
		      double part, struct interp_contour_point *ret)
{
	const double angle = a.theta + a.sweep * part;
	const double r = a.r_mm + a.dr_mm * part;
	const double x = cos(angle), y = sin(angle);

	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint8_t axis = p->head->column[j];

		if (axis == a.axis_a) {
			ret->mm[j] = a.a_mm + r * x;
			ret->per_u[j] = (a.dr_mm * x - r * a.sweep * y) /
					s->length_mm;
		} else if (axis == a.axis_b) {
			ret->mm[j] = a.b_mm + r * y;
			ret->per_u[j] = (a.dr_mm * y + r * a.sweep * x) /
					s->length_mm;
		}
	}
}

static bool piece_ok(const struct interp_program *p,
		     const struct interp_piece *piece)
{
	return piece->nstops >= 2 && piece->stops_at <= p->head->nstops &&
	       piece->nstops <= p->head->nstops - piece->stops_at;
}

/* Open it in the span that was used last. */
static bool open_curve(const struct interp_program *p, uint32_t curve,
		       struct interp_at_curve *k)
{
	struct interp_nurbs c;

	if (k->open && k->curve == curve)
		return true;
	k->open = interp_program_curve(p, curve, &c);
	k->curve = curve;
	if (k->open)
		interp_nurbs_open(&k->eval, &c);
	return k->open;
}

/* At a cusp, keep the direction of the chord. */
static bool along_curve(const struct interp_program *p,
			const struct interp_seg *s, double part,
			struct interp_at_curve *last,
			struct interp_contour_point *ret)
{
	const struct interp_piece piece = p->pieces[s->arg];
	const struct interp_nurbs_stop *stops = p->stops + piece.stops_at;
	struct interp_nurbs_between between;
	struct interp_nurbs_point at;
	double s_mm, speed;

	if (!piece_ok(p, &piece) || !open_curve(p, piece.curve, last))
		return false;
	s_mm = stops[piece.nstops - 1].s_mm * part;
	stops += interp_nurbs_stop_of(stops, piece.nstops, s_mm);
	interp_nurbs_between(stops, &between);
	interp_nurbs_at(&last->eval, interp_nurbs_between_at(&between, s_mm), 1,
			&at);
	speed = sqrt(interp_nurbs_dot(&last->eval.c, at.d[1], at.d[1]));
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		for (uint32_t k = 0; k < last->eval.c.naxes; k++) {
			if (p->curves[piece.curve].axis[k] !=
			    p->head->column[j])
				continue;
			ret->mm[j] = at.d[0][k];
			if (speed > 0)
				ret->per_u[j] = at.d[1][k] / speed;
		}
	}
	return true;
}

static void along_pair(const struct interp_program *p,
		       const struct interp_seg *s, double part,
		       struct interp_contour_point *ret)
{
	const struct interp_couple k = p->couples[s->arg];

	for (int i = 0; i < 2; i++) {
		if (k.side[i].r_mm > 0)
			along_arc(p, s, k.side[i], part, ret);
	}
}

bool interp_program_any_at(const struct interp_program *p, uint32_t i,
			   double s_mm, struct interp_at_curve *last,
			   struct interp_contour_point *ret)
{
	const struct interp_seg s =
		i < p->head->nsegs ? p->segs[i] :
				     (struct interp_seg){ .kind = INTERP_END };
	double part;

	*ret = (struct interp_contour_point) { { 0 }, { 0 } };
	if (s.kind >= INTERP_BEGIN || !interp_program_seg_ok(p, i, &s))
		return false;
	part = fmin(fmax(s_mm / s.length_mm, 0), 1);
	along_line(p, i, &s, part, ret);
	if (s.kind == INTERP_ARC)
		along_arc(p, &s, p->arcs[s.arg], part, ret);
	if (s.kind == INTERP_PAIR)
		along_pair(p, &s, part, ret);
	return s.kind != INTERP_CURVE || along_curve(p, &s, part, last, ret);
}

bool interp_program_at(const struct interp_program *p, uint32_t i, double s_mm,
		       struct interp_at_curve *last,
		       struct interp_contour_point *ret)
{
	*ret = (struct interp_contour_point) { { 0 }, { 0 } };
	return i < p->head->nsegs && p->segs[i].kind != INTERP_PAIR &&
	       interp_program_any_at(p, i, s_mm, last, ret);
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

static void path_at(const void *arg, double u, struct interp_contour_point *ret)
{
	const struct interp_at_path *w = arg;
	const uint32_t i = seg_at(w->program, u);

	interp_program_at(w->program, i, u - w->program->segs[i].s_mm, w->last,
			  ret);
}

bool interp_program_path(const struct interp_at_path *w,
			 struct interp_contour_path *ret)
{
	const struct interp_program *p = w->program;

	for (uint32_t i = 0; i < p->head->nsegs; i++)
		if (p->segs[i].kind == INTERP_PAIR)
			return false;
	*ret = (struct interp_contour_path) {
		w, path_at, 0, p->head->length_mm, (int)p->head->naxes
	};
	return p->head->length_mm > 0;
}
