/* SPDX-License-Identifier: Apache-2.0 */
/* looks.c - what the axes do along each segment of a program */
#include "speed/looks.h"

#include "speed/sections.h"
#include "speed/ways.h"

#include "interp/smaller.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define ARC_RAD		(M_PI / 8)	/* between two looks at an arc */
#define CURVE_LOOKS	17
#define NEAR		1.05		/* the speeds at two neighbours of these
					 * differ by no more */
#define HALVINGS	6

struct making {
	struct look_all *to;
	struct sections sections;
	struct ways ways;
};

/* -- Lines ----------------------------------------------------------------- */

/* By how much column @k goes in a mm of line @i, and what a rounding of its
 * ends makes of that. */
struct rate {
	double by, off;
};

static struct rate rate_of(const struct making *m, uint32_t i, uint32_t k)
{
	return (struct rate) { ways_rate(&m->ways, i, k),
			       ways_rate_off(&m->ways, i, k) };
}

/* By how much it goes for sure. */
static double sure_of(struct rate r)
{
	const double by = fabs(r.by);

	return by * (1 - r.off / larger(by, 1));
}

/* The machine goes along the lines: at the node behind line @i each axis makes
 * a step of its speed, however smooth the shape is. */
static double step_mm_s(const struct making *m, uint32_t i)
{
	double v = INFINITY;

	for (uint32_t k = 0; k < m->to->axes.n; k++) {
		const struct rate a = rate_of(m, i, k);
		const struct rate b = rate_of(m, i + 1, k);
		const double sure = fabs(b.by - a.by) - a.off - b.off;

		if (sure * v > m->to->axes.step_mm_s[k])
			v = m->to->axes.step_mm_s[k] / sure;
	}
	return v;
}

/* -- Looks ----------------------------------------------------------------- */

static float least(float a, double b)
{
	return (double)a < b ? a : (float)b;
}

static int look(struct making *m, const struct section *s, double s_mm,
		struct looks *of)
{
	struct look_all *to = m->to;
	const size_t each = to->axes.n * INTERP_AXES_WAY;
	double way[INTERP_NAXES * INTERP_AXES_WAY];
	struct interp_straight straight;
	float *at;

	if (to->n == to->room &&
	    grow_array(&to->way, &to->room, each * sizeof(float)) < 0)
		return -ENOMEM;
	sections_way(&m->sections, s, s_mm, way);
	straight = interp_axes_straight(&to->axes, way);
	of->a_mm_s2 = least(of->a_mm_s2, straight.a_mm_s2);
	of->j_mm_s3 = least(of->j_mm_s3, straight.j_mm_s3);
	at = to->way + to->n++ * each;
	for (size_t i = 0; i < each; i++)
		at[i] = (float)way[i];
	return 0;
}

static uint32_t looks_of(const struct interp_program *p,
			 const struct interp_seg *s)
{
	double sweep = 0;

	if (s->kind == INTERP_LINE)
		return 1;
	if (s->kind == INTERP_CURVE)
		return CURVE_LOOKS;
	if (s->kind == INTERP_ARC)
		sweep = fabs(p->arcs[s->arg].sweep);
	for (int i = 0; s->kind == INTERP_PAIR && i < 2; i++)
		sweep = larger(sweep, fabs(p->couples[s->arg].side[i].sweep));
	return 2 + (uint32_t)(sweep / ARC_RAD);
}

/* A look at a segment, and how fast the axes could pass it on a curve. */
struct spot {
	double s_mm, v_mm_s;
};

static int look_at_spot(struct making *m, const struct section *s,
			struct spot *at)
{
	static const struct interp_straight none = { 0, 0 };
	struct looks *of = &m->to->of[s->from];
	double way[INTERP_NAXES * INTERP_AXES_WAY];
	struct interp_straight left;
	int err = look(m, s, at->s_mm, of);

	of->n++;
	if (err < 0 || m->to->p->segs[s->from].kind != INTERP_CURVE)
		return err;
	looks_way(m->to, m->to->n - 1, way);
	at->v_mm_s = interp_axes_mm_s(&m->to->axes, way, &none, &left);
	return 0;
}

/* A bend may be so narrow that two looks only show where it begins. */
static int look_between(struct making *m, const struct section *s,
			const struct spot *a, const struct spot *b,
			int halvings)
{
	struct spot middle = { (a->s_mm + b->s_mm) / 2, 0 };
	int err;

	if (halvings == 0 || larger(a->v_mm_s, b->v_mm_s) <=
			     NEAR * smaller(a->v_mm_s, b->v_mm_s))
		return 0;
	err = look_at_spot(m, s, &middle);
	if (err == 0)
		err = look_between(m, s, a, &middle, halvings - 1);
	return err < 0 ? err : look_between(m, s, &middle, b, halvings - 1);
}

static int look_at_seg(struct making *m, const struct section *s)
{
	const struct interp_seg *seg = &m->to->p->segs[s->from];
	const uint32_t looks = looks_of(m->to->p, seg);
	struct spot last = { 0, 0 };
	int err = 0;

	for (uint32_t n = 0; err == 0 && n < looks; n++) {
		struct spot at = { looks == 1 ? seg->s_mm : seg->s_mm +
				   seg->length_mm * n / (looks - 1), 0 };

		err = look_at_spot(m, s, &at);
		if (err == 0 && n > 0 && seg->kind == INTERP_CURVE)
			err = look_between(m, s, &last, &at, HALVINGS);
		last = at;
	}
	return err;
}

/* Of a line of a run: by the mean of what its shape goes by, and by what it
 * goes by itself for sure. */
static void bound(struct making *m, uint32_t i)
{
	const struct interp_axes *x = &m->to->axes;
	struct looks *k = &m->to->of[i];
	const size_t each = x->n * INTERP_AXES_WAY;
	const float *a = m->to->way + k->at * each, *b = a + each;
	double v = INFINITY;

	for (uint32_t j = 0; j < x->n; j++) {
		const double sure = sure_of(rate_of(m, i, j));
		const double by = fabs((double)(a[j * INTERP_AXES_WAY] +
						b[j * INTERP_AXES_WAY])) / 2;

		if (larger(sure, by) * v > x->v_mm_s[j])
			v = x->v_mm_s[j] / larger(sure, by);
		if (sure * (double)k->a_mm_s2 > x->a_mm_s2[j])
			k->a_mm_s2 = (float)(x->a_mm_s2[j] / sure);
		if (sure * (double)k->j_mm_s3 > x->j_mm_s3[j])
			k->j_mm_s3 = (float)(x->j_mm_s3[j] / sure);
	}
	if (v < INFINITY)
		k->own_mm_s = (float)v;
}

/* The look between two lines belongs to both. */
static int look_at_run(struct making *m, const struct section *s)
{
	const struct interp_seg *segs = m->to->p->segs;
	int err = 0;

	for (uint32_t i = s->from; err == 0 && i < s->to; i++) {
		struct looks *k = &m->to->of[i];

		k->at = (uint32_t)m->to->n;
		k->n = 2;
		k->is_run = true;
		k->goes_on = i + 1 < s->to;
		if (k->goes_on)
			k->node_mm_s = (float)step_mm_s(m, i);
		err = look(m, s, segs[i].s_mm, k);
		if (i > s->from) {
			k[-1].a_mm_s2 = least(k[-1].a_mm_s2,
					      (double)k->a_mm_s2);
			k[-1].j_mm_s3 = least(k[-1].j_mm_s3,
					      (double)k->j_mm_s3);
		}
	}
	if (err == 0)
		err = look(m, s, segs[s->to - 1].s_mm +
				 segs[s->to - 1].length_mm,
			   &m->to->of[s->to - 1]);
	for (uint32_t i = s->from; err == 0 && i < s->to; i++)
		bound(m, i);
	return err;
}

/* Over actions, too. */
static void note_corner(struct making *m, const struct section *s)
{
	const struct section *next = s + 1;

	for (uint32_t i = s->to - 1; i < next->from; i++)
		m->to->of[i].node_mm_s = (float)s->corner_mm_s;
}

/* A line that goes back and forth within a rounding asks for nothing. */
static void ask_something(struct look_all *k, struct looks *of)
{
	for (uint32_t j = 0; j < k->axes.n; j++) {
		if (isinf(of->a_mm_s2))
			of->a_mm_s2 = least(of->a_mm_s2, k->axes.a_mm_s2[j]);
		if (isinf(of->j_mm_s3))
			of->j_mm_s3 = least(of->j_mm_s3, k->axes.j_mm_s3[j]);
	}
}

static int look_at_all(struct making *m)
{
	const struct section *s = m->sections.at;
	int err = 0;

	for (size_t k = 0; err == 0 && k < m->sections.n; k++) {
		m->to->of[s[k].from].at = (uint32_t)m->to->n;
		err = s[k].part ? look_at_run(m, &s[k]) :
				  look_at_seg(m, &s[k]);
		for (uint32_t i = s[k].from; i < s[k].to; i++)
			ask_something(m->to, &m->to->of[i]);
		if (k + 1 < m->sections.n)
			note_corner(m, &s[k]);
	}
	return err;
}

int looks_make(struct look_all *ret, const struct interp_limits *l,
	       const struct interp_program *p)
{
	struct making m = { .to = ret };
	int err;

	*ret = (struct look_all) {
		.p = p, .axes = sections_axes(l, p),
		.of = calloc(p->head->nsegs, sizeof(*ret->of)),
	};
	if (!ret->of)
		return -ENOMEM;
	ways_init(&m.ways, l, p);
	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		ret->of[i].own_mm_s = p->segs[i].feed_max_mm_s;
		ret->of[i].node_mm_s = INFINITY;
		ret->of[i].a_mm_s2 = ret->of[i].j_mm_s3 = INFINITY;
	}
	err = sections_make(&m.sections, l, p);
	if (err == 0)
		err = look_at_all(&m);
	sections_free(&m.sections);
	return err;
}

void looks_free(struct look_all *k)
{
	free(k->of);
	free(k->way);
}

void looks_way(const struct look_all *k, size_t i,
	       double ret[INTERP_NAXES * INTERP_AXES_WAY])
{
	const size_t each = k->axes.n * INTERP_AXES_WAY;

	for (size_t j = 0; j < each; j++)
		ret[j] = (double)k->way[i * each + j];
}
