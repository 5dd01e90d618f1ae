/* SPDX-License-Identifier: Apache-2.0 */
/* sections.c - a program's way in sections */
#include "speed/sections.h"

#include "speed/ways.h"
#include "speed/run.h"

#include "interp/at.h"
#include "interp/nurbs_way.h"
#include "interp/smaller.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WITHIN		4	/* corners: over so little, two are one */

/* So far inside a piece of a curve, as a share of it, is its end. */
#define INSIDE		1e-6

struct making {
	struct sections *to;
	const struct interp_limits *l;
	const struct interp_program *p;
	struct ways ways;
	struct interp_axes axes;
	const struct run *run;		/* the one in hand */
	uint32_t seg;			/* its first one */
};

struct interp_axes sections_axes(const struct interp_limits *l,
				 const struct interp_program *p)
{
	struct interp_axes ret = { .n = p->head->naxes };

	for (uint32_t k = 0; k < ret.n; k++) {
		const struct interp_axis_limits *m =
			&l->machine->axis[p->head->column[k]];

		ret.v_mm_s[k] = m->v_max_mm_s;
		ret.a_mm_s2[k] = m->a_max_mm_s2;
		ret.j_mm_s3[k] = m->j_max_mm_s3;
	}
	interp_axes_round(&ret, l->corner_mm);
	return ret;
}

/* -- Ways ------------------------------------------------------------------ */

static void of_line(const struct interp_program *p, uint32_t seg, double *ret)
{
	const uint32_t n = p->head->naxes;
	const int64_t *a = p->nodes + (uint64_t)seg * n, *b = a + n;
	const double by = 1 / p->segs[seg].length_mm / INTERP_SUB;

	for (uint32_t k = 0; k < n; k++, ret += INTERP_AXES_WAY) {
		ret[0] = (double)(b[k] - a[k]) * by *
			 p->head->pulse_mm[p->head->column[k]];
		ret[1] = ret[2] = 0;
	}
}

/* r = radius * (cos, sin) of the angle; both go evenly with the way. */
static void of_arc(const struct interp_program *p, const struct interp_arc *a,
		   double part, double length_mm, double *ret)
{
	const double r = a->r_mm + a->dr_mm * part;
	const double w = a->sweep / length_mm, out = a->dr_mm / length_mm;

	if (!(a->r_mm > 0) || a->sweep == 0)
		return;
	for (int side = 0; side < 2; side++) {
		const double at = a->theta + a->sweep * part -
				  side * M_PI / 2;
		const double c = cos(at), s = sin(at);
		double *way = ret + INTERP_AXES_WAY *
			      ways_column(p, side ? a->axis_b : a->axis_a);

		way[0] = out * c - r * w * s;
		way[1] = -r * w * w * c - 2 * out * w * s;
		way[2] = r * w * w * w * s - 3 * out * w * w * c;
	}
}

static void of_curve(struct sections *w, const struct interp_seg *s,
		     double part, double *ret)
{
	const struct interp_program *p = w->p;
	const struct interp_piece *piece = &p->pieces[s->arg];
	const struct interp_nurbs_stop *stops = p->stops + piece->stops_at;
	struct interp_nurbs_between between;
	struct interp_nurbs_way way_at;
	double s_mm = stops[piece->nstops - 1].s_mm * part;

	if (!w->curve.open || w->curve.curve != piece->curve) {
		struct interp_nurbs c;

		if (!interp_program_curve(p, piece->curve, &c))
			return;
		interp_nurbs_open(&w->curve.eval, &c);
		w->curve.open = true;
		w->curve.curve = piece->curve;
	}
	stops += interp_nurbs_stop_of(stops, piece->nstops, s_mm);
	interp_nurbs_between(stops, &between);
	interp_nurbs_way(&w->curve.eval,
			 interp_nurbs_between_at(&between, s_mm), &way_at);
	for (uint32_t j = 0; !way_at.cusp && j < w->curve.eval.c.naxes; j++) {
		double *way = ret + INTERP_AXES_WAY * ways_column(
			p, p->curves[piece->curve].axis[j]);

		for (int i = 0; i < INTERP_AXES_WAY; i++)
			way[i] = way_at.d[i][j];
	}
}

static void seg_way(struct sections *w, uint32_t seg, double s_mm, double *ret)
{
	const struct interp_program *p = w->p;
	const struct interp_seg *s = &p->segs[seg];
	const double part = larger(smaller((s_mm - s->s_mm) / s->length_mm, 1),
				   0);

	of_line(p, seg, ret);
	if (s->kind == INTERP_ARC)
		of_arc(p, &p->arcs[s->arg], part, s->length_mm, ret);
	for (int side = 0; s->kind == INTERP_PAIR && side < 2; side++)
		of_arc(p, &p->couples[s->arg].side[side], part, s->length_mm,
		       ret);
	if (s->kind == INTERP_CURVE)
		of_curve(w, s, part, ret);
}

void sections_way(struct sections *w, const struct section *s, double s_mm,
		  double *ret)
{
	if (s->part)
		sections_part_way(s->part, s_mm, ret);
	else
		seg_way(w, s->from, s_mm, ret);
	for (uint32_t k = 0; w->p->segs[s->from].kind == INTERP_CURVE &&
			     k < w->p->head->naxes; k++)
		if (s->along >> k & 1)
			interp_axes_overlook(ret + k * INTERP_AXES_WAY,
					     w->pulse_mm);
}

/* -- Sections -------------------------------------------------------------- */

static int add(struct making *m, uint32_t from, uint32_t to,
	       struct run_part *part)
{
	struct sections *k = m->to;

	if (k->n == k->room &&
	    grow_array(&k->at, &k->room, sizeof(*k->at)) < 0)
		return -ENOMEM;
	k->at[k->n++] = (struct section) { .from = from, .to = to,
					   .part = part,
					   .along = ways_along(&m->ways, from),
					   .corner_mm_s = INFINITY };
	return 0;
}

static int add_part(void *to, struct run_part *part)
{
	struct making *m = to;
	struct run_part *own = malloc(sizeof(*own));

	if (!own || add(m, m->seg + (uint32_t)part->first,
			m->seg + (uint32_t)part->last, own) < 0) {
		free(own);
		return -ENOMEM;
	}
	*own = *part;
	part->shape = (struct shape) { 0 };
	return 0;
}

static bool is_short(const struct making *m, uint32_t i)
{
	const struct interp_seg *s = &m->p->segs[i];

	return s->kind == INTERP_LINE &&
	       s->length_mm < SECTIONS_SHORT * m->l->corner_mm;
}

/* Behind the run that begins with segment @i: its length is in the same
 * columns. */
static uint32_t run_end(const struct making *m, uint32_t i, uint32_t to)
{
	const uint32_t along = ways_along(&m->ways, i);
	uint32_t end = i + 1;

	while (end < to && is_short(m, end) &&
	       ways_along(&m->ways, end) == along)
		end++;
	return end;
}

static int add_run(struct making *m, uint32_t from, uint32_t to)
{
	const uint32_t n = m->p->head->naxes;
	const size_t nodes = to - from + 1;
	double *s = malloc(nodes * sizeof(*s));
	double *x = malloc(nodes * n * sizeof(*x));
	struct run r = { .n = nodes, .columns = n,
			 .along = ways_along(&m->ways, from), .s_mm = s,
			 .x = x };
	int err = s && x ? 0 : -ENOMEM;

	for (uint32_t k = 0; k < n; k++)
		r.tolerance[k] = m->ways.tol[k];
	for (size_t i = 0; err == 0 && i < nodes; i++) {
		const struct interp_seg *seg = &m->p->segs[from + i];

		s[i] = i + 1 < nodes ? seg->s_mm :
				       seg[-1].s_mm + seg[-1].length_mm;
		for (uint32_t k = 0; k < n; k++)
			x[i * n + k] = (double)m->p->nodes[(from + i) * n + k] *
				       m->ways.sub_mm[k];
	}
	m->run = &r;
	m->seg = from;
	if (err == 0)
		err = sections_parts(&r, add_part, m);
	free(s);
	free(x);
	return err;
}

/* The machine goes along the lines: at the end of a run it comes by line @i.  A
 * rounding alone may have the shape off it. */
static void keep_to_line(const struct ways *w, uint32_t i, double *way)
{
	for (uint32_t k = 0; k < w->p->head->naxes; k++) {
		const double by = ways_rate(w, i, k);
		const double off = ways_rate_off(w, i, k);

		way[k * INTERP_AXES_WAY] = larger(smaller(
			way[k * INTERP_AXES_WAY], by + off), by - off);
	}
}

/* At an end of a section.  The two sides of a knot of a curve may differ. */
static void way_at_end(struct making *m, const struct section *s, bool last,
		       double *ret)
{
	const uint32_t i = last ? s->to - 1 : s->from;
	const struct interp_seg *k = &m->p->segs[i];
	const double in = k->kind == INTERP_CURVE ? INSIDE : 0;

	sections_way(m->to, s, k->s_mm + k->length_mm * (last ? 1 - in : in),
		     ret);
	if (s->part)
		keep_to_line(&m->ways, i, ret);
}

static double section_mm(const struct sections *w, const struct section *s)
{
	const struct interp_seg *a = &w->p->segs[s->from];
	const struct interp_seg *b = &w->p->segs[s->to - 1];

	return b->s_mm + b->length_mm - a->s_mm;
}

/* How fast the end of each section may be passed.  Where sections are so short
 * that they are within a corner, what they turn by together is one. */
static void find_corners(struct making *m)
{
	struct sections *w = m->to;
	double before[INTERP_NAXES * INTERP_AXES_WAY];
	double behind[INTERP_NAXES * INTERP_AXES_WAY];

	for (size_t i = 0; i + 1 < w->n; i++) {
		struct section *a = &w->at[i], *b = a + 1;
		double mm = 0;

		way_at_end(m, a, true, before);
		do {
			double v;

			way_at_end(m, b, false, behind);
			v = interp_axes_corner_mm_s(&m->axes, before, behind,
						    a->along & b->along);
			for (struct section *k = a; k < b; k++)
				k->corner_mm_s = smaller(k->corner_mm_s, v);
			mm += section_mm(w, b);
			b++;
		} while (mm < WITHIN * m->l->corner_mm && b < w->at + w->n);
	}
}

int sections_make(struct sections *ret, const struct interp_limits *l,
		  const struct interp_program *p)
{
	struct making m = { .to = ret, .l = l, .p = p,
			    .axes = sections_axes(l, p) };
	int err = 0;

	*ret = (struct sections) { .p = p, .pulse_mm = INFINITY };
	for (uint32_t k = 0; k < p->head->naxes; k++)
		ret->pulse_mm = smaller(ret->pulse_mm,
					p->head->pulse_mm[p->head->column[k]]);
	ways_init(&m.ways, l, p);
	for (uint32_t i = 1, end; err == 0 && i + 1 < p->head->nsegs; i = end) {
		end = i + 1;
		if (p->segs[i].kind >= INTERP_BEGIN)
			continue;
		if (is_short(&m, i)) {
			end = run_end(&m, i, p->head->nsegs - 1);
			err = add_run(&m, i, end);
		} else {
			err = add(&m, i, end, NULL);
		}
	}
	if (err < 0)
		sections_free(ret);
	else
		find_corners(&m);
	return err;
}

void sections_free(struct sections *s)
{
	for (size_t i = 0; i < s->n; i++) {
		if (s->at[i].part)
			shape_free(&s->at[i].part->shape);
		free(s->at[i].part);
	}
	free(s->at);
	*s = (struct sections) { 0 };
}
