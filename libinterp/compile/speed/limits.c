/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.c - speed ceilings of a finished program, and which comes next
 */
#include "interp/limits.h"
#include "speed/heading.h"

#include <math.h>
#include <string.h>

/* Nodes turned by less are on a line: (2*sin(phi/2))^2. */
#define STRAIGHT	1e-12

/* Directions of short lines differ by their rounding; their ceilings must not.*/
#define SAME		4e-6

/* A curve of short lines is seen over so many corners' width, either way. */
#define WINDOW		20
/* Longer lines have no curve that their corners do not have. */
#define LONG		5

#define HOP_MAX		UINT16_MAX

struct pass {
	const struct interp_program *p;
	struct interp_seg *segs;
	double corner_mm;
	uint32_t n;			/* columns */
	struct ways ways;
	uint32_t behind, ahead;		/* nodes one window from here */
	/* Of each column: */
	double v_mm_s[INTERP_NAXES], a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
	double step_mm_s[INTERP_NAXES];	/* at a node */
};

static void begin(struct pass *w, const struct interp_limits *l,
		  const struct interp_program *p, struct interp_seg *segs)
{
	*w = (struct pass) { .p = p, .segs = segs, .corner_mm = l->corner_mm,
			     .n = p->head->naxes };
	heading_ways_init(&w->ways, p);
	for (uint32_t j = 0; j < w->n; j++) {
		const struct interp_axis_limits *m =
			&l->machine->axis[p->head->column[j]];
		const double six = 6 * l->corner_mm;

		w->v_mm_s[j] = m->v_max_mm_s;
		w->a_mm_s2[j] = m->a_max_mm_s2;
		w->j_mm_s3[j] = m->j_max_mm_s3;
		w->step_mm_s[j] = fmin(sqrt(8 * m->a_max_mm_s2 * l->corner_mm),
				       cbrt(m->j_max_mm_s3 * six * six));
	}
}

/* Down to a level; a speed of an axis stays as it is. */
static float level(const struct pass *w, double v_mm_s)
{
	float v = (float)(v_mm_s * (1 + SAME));
	uint32_t bits;

	for (uint32_t j = 0; j < w->n; j++) {
		if (fabs(v_mm_s - w->v_mm_s[j]) <= SAME * v_mm_s)
			return (float)(w->v_mm_s[j] * (1 - 2 * SAME));
	}
	memcpy(&bits, &v, sizeof(bits));
	bits &= ~((UINT32_C(1) << 18) - 1);
	memcpy(&v, &bits, sizeof(v));
	return v * (float)(1 - 2 * SAME);
}

/* The fastest round a bend, where the axes give so much. */
static double round_mm_s(double r_mm, double a_mm_s2, double j_mm_s3)
{
	const double v = sqrt(a_mm_s2 * r_mm), jrr = j_mm_s3 * r_mm * r_mm;

	return v * v * v <= jrr ? v : cbrt(jrr);
}

/* -- Nodes --------------------------------------------------------------- */

static double larger(double a, double b)
{
	return a > b ? a : b;
}

static double smaller(double a, double b)
{
	return a < b ? a : b;
}

/* The columns both lengths are made of: a corner as an arc. */
static double corner(const struct pass *w, const struct heading *a,
		     const struct heading *b)
{
	const uint32_t both = a->along & b->along, any = a->along | b->along;
	double turn = 0, acc = INFINITY, jerk = INFINITY, half, r;

	for (uint32_t j = 0; j < w->n; j++) {
		const double d = both >> j & 1 ? b->rate[j] - a->rate[j] : 0;

		turn += d * d;
	}
	if (!both)
		turn = 2;
	if (turn < STRAIGHT)
		return INFINITY;
	/* No branch in here: corners are as good as random.  x/0 is no limit. */
	for (uint32_t j = 0; j < w->n; j++) {
		const double is = (double)(any >> j & 1);
		const double d = is * fabs(b->rate[j] - a->rate[j]);
		const double m = is * larger(fabs(a->rate[j]),
					     fabs(b->rate[j]));

		acc = smaller(acc, w->a_mm_s2[j] / d);
		jerk = smaller(jerk, w->j_mm_s3[j] / m);
	}
	half = turn < 4 ? sqrt(1 - turn / 4) : 0;
	r = w->corner_mm * half * (1 + half) / (turn / 4);
	return round_mm_s(larger(r, w->corner_mm), acc * sqrt(turn), jerk);
}

/* The others: their speed steps. */
static double step(const struct pass *w, const struct heading *a,
		   const struct heading *b)
{
	const uint32_t both = a->along & b->along;
	double v = INFINITY;

	for (uint32_t j = 0; j < w->n; j++) {
		const double d = fabs(b->rate[j] - a->rate[j]);

		if (!(both >> j & 1) && d * v > w->step_mm_s[j] && d > 1e-9)
			v = w->step_mm_s[j] / d;
	}
	return v;
}

/* From node @from to @to, in the columns of @along: its length, as it goes. */
static double chord(const struct pass *w, uint32_t from, uint32_t to,
		    uint32_t along, double ret[INTERP_NAXES])
{
	const int64_t *a = w->p->nodes + (uint64_t)from * w->n;
	const int64_t *b = w->p->nodes + (uint64_t)to * w->n;
	double sum = 0, mm;

	for (uint32_t j = 0; j < w->n; j++) {
		ret[j] = along >> j & 1 ?
			 (double)(b[j] - a[j]) * w->ways.sub_mm[j] : 0;
		sum += ret[j] * ret[j];
	}
	mm = sqrt(sum);
	for (uint32_t j = 0; j < w->n && mm > 0; j++)
		ret[j] /= mm;
	return mm;
}

/*
 * Short lines turn by as little as one likes at each node: their curve is that
 * of the chords to both sides.
 */
static double curve(struct pass *w, uint32_t i, uint32_t along)
{
	const struct interp_seg *s = w->segs;
	const double window = WINDOW * w->corner_mm, here = s[i].s_mm;
	double a[INTERP_NAXES], b[INTERP_NAXES], turn = 0, acc = INFINITY;
	double jerk = INFINITY, mm;

	while (here - s[w->behind + 1].s_mm >= window)
		w->behind++;
	if (w->ahead < i)
		w->ahead = i;
	while (w->ahead < w->p->head->nsegs - 1 &&
	       s[w->ahead].s_mm - here < window)
		w->ahead++;
	mm = (chord(w, w->behind, i, along, a) +
	      chord(w, i, w->ahead, along, b)) / 2;
	for (uint32_t j = 0; j < w->n; j++) {
		turn += (b[j] - a[j]) * (b[j] - a[j]);
		if (a[j] == 0 && b[j] == 0)
			continue;
		acc = smaller(acc, w->a_mm_s2[j]);
		jerk = smaller(jerk, w->j_mm_s3[j]);
	}
	return turn < STRAIGHT ? INFINITY :
	       round_mm_s(larger(mm / sqrt(turn), w->corner_mm), acc, jerk);
}

/* In front of segment @i; @last is the one before that moves. */
static float node(struct pass *w, uint32_t last, uint32_t i,
		  const struct heading *a, const struct heading *b)
{
	const double mm = LONG * WINDOW * w->corner_mm;
	double v = smaller(corner(w, a, b), step(w, a, b));

	if (w->segs[last].length_mm < mm || w->segs[i].length_mm < mm)
		v = smaller(v, curve(w, i, a->along & b->along));

	return isinf(v) ? INFINITY : level(w, v);
}

/* What the axes of its bend can do. */
static void limit_seg(const struct pass *w, struct interp_seg *s,
		      const struct headings *h)
{
	double v = (double)s->feed_max_mm_s;

	if (h->bend_mm > 0) {
		double a = INFINITY, j = INFINITY;

		for (uint32_t k = 0; k < w->n; k++) {
			if (h->first.rate[k] == 0 && h->last.rate[k] == 0)
				continue;
			a = fmin(a, w->a_mm_s2[k]);
			j = fmin(j, w->j_mm_s3[k]);
		}
		v = fmin(v, round_mm_s(h->bend_mm, a, j) / h->share);
	}
	s->feed_max_mm_s = level(w, v);
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

/* An action stands on the node before it. */
static void walk_nodes(struct pass *w)
{
	const uint32_t nsegs = w->p->head->nsegs;
	struct headings h[2];
	uint32_t last = 0;		/* that moves; 0: none yet */
	int now = 0;

	w->segs[0].node_mm_s = INFINITY;
	for (uint32_t i = 1; i < nsegs; i++) {
		w->segs[i].node_mm_s = INFINITY;
		if (w->segs[i].kind >= INTERP_BEGIN)
			continue;
		heading_find(&w->ways, i, &h[now]);
		limit_seg(w, &w->segs[i], &h[now]);
		if (last > 0) {
			const float v = node(w, last, i, &h[!now].last,
					     &h[now].first);

			for (uint32_t k = last; k < i; k++)
				w->segs[k].node_mm_s = v;
		}
		last = i;
		now = !now;
	}
}

/* -- The next slower ------------------------------------------------------- */

/* Actions stop the way, and so may a cut after what is positioned. */
static bool may_stop(const struct pass *w, uint32_t i)
{
	const struct interp_seg *s = &w->segs[i];

	return s->kind >= INTERP_BEGIN ||
	       (!(s->flags & INTERP_SEG_RAPID) &&
		s[-1].kind < INTERP_BEGIN && s[-1].flags & INTERP_SEG_RAPID);
}

/* From the last to the first; what is between was skipped by a faster one. */
static void chain_ahead(const struct pass *w)
{
	for (uint32_t i = w->p->head->nsegs - 1; i-- > 0; ) {
		uint32_t m = i + 1;

		if (w->segs[i].kind < INTERP_BEGIN) {
			const double v = interp_limits_into(w->p, i);

			while (m - i < HOP_MAX && !may_stop(w, m) &&
			       interp_limits_into(w->p, m) >= v)
				m += w->segs[m].slower_ahead;
		}
		w->segs[i].slower_ahead = (uint16_t)(m - i < HOP_MAX ? m - i :
								       HOP_MAX);
	}
	w->segs[w->p->head->nsegs - 1].slower_ahead = 0;
}

static double feed_of(const struct interp_seg *s)
{
	return s->kind >= INTERP_BEGIN || s->flags & INTERP_SEG_RAPID ?
	       INFINITY : (double)s->feed_mm_s;
}

static void chain_feed(const struct pass *w)
{
	const uint32_t end = w->p->head->nsegs - 1;

	w->segs[end].slower_feed = 0;
	for (uint32_t i = end; i-- > 0; ) {
		const double v = feed_of(&w->segs[i]);
		uint32_t m = i + 1;

		while (m - i < HOP_MAX && m < end && feed_of(&w->segs[m]) >= v)
			m = w->segs[m].slower_feed ?
			    m + w->segs[m].slower_feed : end;
		w->segs[i].slower_feed = (uint16_t)(m >= end ? 0 :
						    m - i < HOP_MAX ? m - i :
								      HOP_MAX);
	}
}

static double back_into(const struct pass *w, uint32_t i)
{
	return i == 0 ? 0 : w->segs[i].kind >= INTERP_BEGIN ? INFINITY :
	       interp_limits_back_into(w->p, i);
}

static void chain_behind(const struct pass *w)
{
	w->segs[0].slower_behind = 0;
	for (uint32_t i = 1; i < w->p->head->nsegs; i++) {
		const double v = back_into(w, i);
		uint32_t m = i - 1;

		while (i - m < HOP_MAX && back_into(w, m) >= v)
			m -= w->segs[m].slower_behind;
		w->segs[i].slower_behind = (uint16_t)(i - m < HOP_MAX ? i - m :
							HOP_MAX);
	}
}

void interp_limits_write(const struct interp_limits *l,
			 const struct interp_program *p,
			 struct interp_seg *segs)
{
	struct pass w;

	begin(&w, l, p, segs);
	walk_nodes(&w);
	chain_ahead(&w);
	chain_feed(&w);
	chain_behind(&w);
}
