/* SPDX-License-Identifier: Apache-2.0 */
/* sections.c - a program's way from stand to stand, in sections */
#include "speed/sections.h"

#include "speed/heading.h"
#include "speed/run.h"

#include "interp/at.h"
#include "interp/nurbs_feed.h"
#include "interp/smaller.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHORT_CORNERS	100	/* lines shorter than so many corners stand for
				 * a curve */

/* What a section goes along.  Of a run: part. */
struct along {
	const struct interp_program *p;
	uint32_t seg;
	struct run_part part;
	struct interp_at_curve curve;
};

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
			      heading_column(p, side ? a->axis_b : a->axis_a);

		way[0] = out * c - r * w * s;
		way[1] = -r * w * w * c - 2 * out * w * s;
		way[2] = r * w * w * w * s - 3 * out * w * w * c;
	}
}

static void of_curve(struct along *k, const struct interp_seg *s, double part,
		     double *ret)
{
	const struct interp_program *p = k->p;
	const struct interp_piece *piece = &p->pieces[s->arg];
	const struct interp_nurbs_stop *stops = p->stops + piece->stops_at;
	struct interp_nurbs_between between;
	struct interp_nurbs_way w;
	double s_mm = stops[piece->nstops - 1].s_mm * part;

	if (!k->curve.open) {
		struct interp_nurbs c;

		if (!interp_program_curve(p, piece->curve, &c))
			return;
		interp_nurbs_open(&k->curve.eval, &c);
		k->curve.open = true;
	}
	stops += interp_nurbs_stop_of(stops, piece->nstops, s_mm);
	interp_nurbs_between(stops, &between);
	interp_nurbs_way(&k->curve.eval, interp_nurbs_between_at(&between,
								 s_mm), &w);
	for (uint32_t j = 0; !w.cusp && j < k->curve.eval.c.naxes; j++) {
		double *way = ret + INTERP_AXES_WAY * heading_column(
			p, p->curves[piece->curve].axis[j]);

		for (int i = 0; i < INTERP_AXES_WAY; i++)
			way[i] = w.d[i][j];
	}
}

static void seg_way(const void *of, double s_mm, double *ret)
{
	struct along *k = (struct along *)(uintptr_t)of;
	const struct interp_program *p = k->p;
	const struct interp_seg *s = &p->segs[k->seg];
	const double part = larger(smaller((s_mm - s->s_mm) / s->length_mm, 1),
				   0);

	of_line(p, k->seg, ret);
	if (s->kind == INTERP_ARC)
		of_arc(p, &p->arcs[s->arg], part, s->length_mm, ret);
	for (int side = 0; s->kind == INTERP_PAIR && side < 2; side++)
		of_arc(p, &p->couples[s->arg].side[side], part, s->length_mm,
		       ret);
	if (s->kind == INTERP_CURVE)
		of_curve(k, s, part, ret);
}

static void part_way(const void *of, double s_mm, double *ret)
{
	const struct along *k = of;

	run_part_way(&k->part, s_mm, ret);
}

/* -- Sections -------------------------------------------------------------- */

static double feed_mm_s(const struct interp_seg *s)
{
	return s->flags & INTERP_SEG_RAPID ? INFINITY : (double)s->feed_mm_s;
}

static int add(struct making *m, uint32_t seg, double from_mm, double to_mm,
	       struct along **ret)
{
	struct sections *to = m->to;
	size_t corners = to->room;

	*ret = calloc(1, sizeof(**ret));
	if (!*ret)
		return -ENOMEM;
	if (to->n == to->room &&
	    (grow_array(&to->corner_mm_s, &corners, sizeof(double)) < 0 ||
	     grow_array(&to->at, &to->room, sizeof(*to->at)) < 0)) {
		free(*ret);
		return -ENOMEM;
	}
	**ret = (struct along) { .p = m->p, .seg = seg };
	to->at[to->n++] = (struct profile_section) {
		from_mm, to_mm, feed_mm_s(&m->p->segs[seg]), seg_way, *ret
	};
	return 0;
}

static int add_part(void *to, struct run_part *part)
{
	struct making *m = to;
	const struct run *r = m->run;
	struct along *k;
	const int err = add(m, m->seg, r->s_mm[part->first],
			    r->s_mm[part->last], &k);

	if (err < 0)
		return err;
	k->part = *part;
	part->shape = (struct shape) { 0 };
	m->to->at[m->to->n - 1].way = part_way;
	return 0;
}

static bool is_short(const struct making *m, uint32_t i)
{
	const struct interp_seg *s = &m->p->segs[i];

	return s->kind == INTERP_LINE &&
	       s->length_mm < SHORT_CORNERS * m->l->corner_mm;
}

static uint32_t along_of(const struct making *m, uint32_t seg)
{
	struct headings h;

	heading_of(&m->ways, seg, &h);
	return h.first.along;
}

/* Behind the run that begins with segment @i: at the same F, its length in the
 * same columns. */
static uint32_t run_end(const struct making *m, uint32_t i, uint32_t to)
{
	struct heading_run run = heading_run(&m->ways, i);
	const double feed = feed_mm_s(&m->p->segs[i]);
	uint32_t end = i;

	while (end < to && is_short(m, end) &&
	       !(feed_mm_s(&m->p->segs[end]) < feed) &&
	       !(feed_mm_s(&m->p->segs[end]) > feed))
		end++;
	heading_run_on(&m->ways, &run, end);
	return run.at < end ? run.at : end;
}

static int add_run(struct making *m, uint32_t from, uint32_t to)
{
	const uint32_t n = m->p->head->naxes;
	const size_t nodes = to - from + 1;
	double *s = malloc(nodes * sizeof(*s));
	double *x = malloc(nodes * n * sizeof(*x));
	struct run r = { .n = nodes, .columns = n,
			 .along = along_of(m, from), .s_mm = s, .x = x,
			 .corner_mm = m->l->corner_mm };
	int err = s && x ? 0 : -ENOMEM;

	for (uint32_t k = 0; k < n; k++)
		r.tolerance[k] = larger(
			m->p->head->pulse_mm[m->p->head->column[k]],
			m->l->tolerance_mm *
			(interp_axis_is_rotary(m->p->head->column[k]) ?
			 180 / M_PI / m->l->rotary_radius_mm : 1));
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
		err = run_parts(&r, add_part, m);
	free(s);
	free(x);
	return err;
}

/* How fast the end of each section may be passed. */
static void find_corners(struct making *m)
{
	struct sections *s = m->to;
	double before[INTERP_NAXES * INTERP_AXES_WAY];
	double behind[INTERP_NAXES * INTERP_AXES_WAY];

	for (size_t i = 0; i + 1 < s->n; i++) {
		const struct along *a = s->at[i].of, *b = s->at[i + 1].of;

		s->at[i].way(a, s->at[i].to_mm, before);
		s->at[i + 1].way(b, s->at[i + 1].from_mm, behind);
		s->corner_mm_s[i] = interp_axes_corner_mm_s(
			&m->axes, before, behind,
			along_of(m, a->seg) & along_of(m, b->seg),
			m->l->corner_mm);
	}
}

int sections_make(struct sections *ret, const struct interp_limits *l,
		  const struct interp_program *p, uint32_t from, uint32_t to)
{
	struct making m = { .to = ret, .l = l, .p = p,
			    .axes = sections_axes(l, p) };
	int err = 0;

	*ret = (struct sections) { 0 };
	heading_ways_init(&m.ways, p);
	for (uint32_t i = from, end; err == 0 && i < to; i = end) {
		const struct interp_seg *s = &p->segs[i];
		struct along *k;

		end = i + 1;
		if (!(s->length_mm > 0))
			continue;
		if (is_short(&m, i)) {
			end = run_end(&m, i, to);
			err = add_run(&m, i, end);
		} else {
			err = add(&m, i, s->s_mm, s->s_mm + s->length_mm, &k);
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
		struct along *k = (struct along *)(uintptr_t)s->at[i].of;

		shape_free(&k->part.shape);
		free(k);
	}
	free(s->at);
	free(s->corner_mm_s);
	*s = (struct sections) { 0 };
}
