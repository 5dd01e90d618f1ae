/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.c - speed ceilings of a finished program, and which comes next
 */
#include "speed/pass.h"

#include <math.h>
#include <string.h>

/* Directions of short lines differ by their rounding; their ceilings must not.*/
#define SAME		4e-6

#define HOP_MAX		UINT16_MAX

/* Fewer need no time.  The piece of a curve between two cusps may have some
 * points and next to no length. */
#define MANY_POINTS	64

/* Of an axis: no less than a pulse of it. */
static double tolerance(const struct interp_limits *l, uint8_t axis)
{
	const double deg = 180 / M_PI;
	const double at = interp_axis_is_rotary((enum interp_axis)axis) ?
			  deg / l->rotary_radius_mm : 1;

	return larger(l->machine->axis[axis].pulse_mm, l->tolerance_mm * at);
}

static void add_level(struct levels *l, double at)
{
	for (uint32_t k = 0; k < l->n; k++)
		if (l->at[k] == at)
			return;
	l->at[l->n++] = at;
}

static void begin(struct pass *w, const struct interp_limits *l,
		  const struct interp_program *p, struct interp_seg *segs)
{
	*w = (struct pass) { .p = p, .segs = segs, .corner_mm = l->corner_mm,
			     .points_per_s = l->points_per_s,
			     .n = p->head->naxes, .a_least_mm_s2 = INFINITY,
			     .j_least_mm_s3 = INFINITY,
			     .soft = { INFINITY, 0, INFINITY, 0 } };
	heading_ways_init(&w->ways, p);
	for (int k = 0; k < PASS_WINDOWS; k++)
		w->windows[k].mm = PASS_WINDOW * l->corner_mm * (1 << k);
	for (uint32_t j = 0; j < w->n; j++) {
		const uint8_t axis = p->head->column[j];
		const struct interp_axis_limits *m = &l->machine->axis[axis];
		const double six = 6 * l->corner_mm;

		w->tol[j] = tolerance(l, axis);
		w->near.mm = larger(w->near.mm, PASS_NEAR * w->tol[j]);
		w->v_mm_s[j] = m->v_max_mm_s;
		w->a_mm_s2[j] = m->a_max_mm_s2;
		w->j_mm_s3[j] = m->j_max_mm_s3;
		w->step_mm_s[j] = smaller(sqrt(8 * m->a_max_mm_s2 * l->corner_mm),
				       cbrt(m->j_max_mm_s3 * six * six));
		add_level(&w->v_levels, m->v_max_mm_s);
		add_level(&w->a_levels, m->a_max_mm_s2);
		add_level(&w->j_levels, m->j_max_mm_s3);
		w->a_least_mm_s2 = smaller(w->a_least_mm_s2, m->a_max_mm_s2);
		w->j_least_mm_s3 = smaller(w->j_least_mm_s3, m->j_max_mm_s3);
	}
}

/* Down to a level. */
static float down(double most)
{
	float v = (float)(most * (1 + SAME));
	uint32_t bits;

	memcpy(&bits, &v, sizeof(bits));
	bits &= ~((UINT32_C(1) << 18) - 1);
	memcpy(&v, &bits, sizeof(v));
	return v * (float)(1 - 2 * SAME);
}

/* A speed; that of an axis stays as it is. */
static float level(const struct pass *w, double v_mm_s)
{
	for (uint32_t k = 0; k < w->v_levels.n; k++) {
		const double own = w->v_levels.at[k];

		if (fabs(v_mm_s - own) <= SAME * v_mm_s)
			return (float)(own * (1 - 2 * SAME));
	}
	return down(v_mm_s);
}

/* What an axis can do stays as it is. */
static float soft(double most, const struct levels *own)
{
	for (uint32_t k = 0; k < own->n; k++) {
		if (fabs(most - own->at[k]) <= SAME * most)
			return (float)own->at[k];
	}
	return down(most);
}

/*
 * What bends leave for going along a segment: shares of what the axes that bend
 * can do, and the most along the path.
 */
struct along {
	double a, j;
	double a_mm_s2, j_mm_s3;
};

static void note_soft(struct pass_soft *k, double a, double j)
{
	k->a_least = smaller(a, k->a_least);
	k->a_most = larger(a, k->a_most);
	k->j_least = smaller(j, k->j_least);
	k->j_most = larger(j, k->j_most);
}

/* Along the path, what its axes leave. */
static void soften_seg(struct pass *w, struct interp_seg *s,
		       const struct along *left, const struct rates *r)
{
	double a = left->a_mm_s2, j = left->j_mm_s3;

	for (uint32_t k = 0; k < w->n; k++) {
		const bool bends = r->bends >> k & 1;

		if (!(r->by[k] > 0))
			continue;
		a = smaller(a, (bends ? left->a : 1) * w->a_mm_s2[k] / r->by[k]);
		j = smaller(j, (bends ? left->j : 1) * w->j_mm_s3[k] / r->by[k]);
	}
	s->a_mm_s2 = soft(a, &w->a_levels);
	s->j_mm_s3 = soft(j, &w->j_levels);
	if (!isinf(s->a_mm_s2) && !isinf(s->j_mm_s3))
		note_soft(&w->soft, (double)s->a_mm_s2, (double)s->j_mm_s3);
}

/*
 * The ceiling of an arc, @v_mm_s at most, by the axes of its bend; and what it
 * leaves at that speed.  Along and across are square to each other.
 */
static double round_bend(const struct pass *w, const struct headings *h,
			 double v_mm_s, struct along *ret)
{
	const double r = h->bend_mm;
	double a = INFINITY, j = INFINITY, top = 0, v, across, both, speed_up;

	for (uint32_t k = 0; k < w->n; k++) {
		if (h->first.rate[k] == 0 && h->last.rate[k] == 0)
			continue;
		a = smaller(a, w->a_mm_s2[k]);
		j = smaller(j, w->j_mm_s3[k]);
		top = fmax(top, w->v_mm_s[k]);
	}
	v = smaller(v_mm_s * h->share, pass_round_mm_s(r, INTERP_BEND_ACROSS * a,
						    INTERP_ARC_JERK_ROUND * j));
	v = smaller(v, INTERP_ARC_JERK_BOTH * j * r /
		    (3 * interp_bend_least(top, a, j)));
	across = v * v / (r * a);
	speed_up = smaller(sqrt(1 - across * across) * a,
			INTERP_ARC_JERK_BOTH * j * r / (3 * v));
	both = 3 * v * speed_up / (r * j);
	*ret = (struct along) {
		speed_up / a, sqrt(1 - both * both) - v * v * v / (r * r * j),
		INFINITY, INFINITY
	};
	return v / h->share;
}

/* What the axes of its bend can do. */
static void limit_seg(struct pass *w, uint32_t i, const struct headings *h)
{
	struct interp_seg *s = &w->segs[i];
	struct along left = { 1, 1, INFINITY, INFINITY };
	double v = (double)s->feed_max_mm_s;
	struct rates rates;

	pass_rates(w, i, h, &rates);
	if (s->kind == INTERP_LINE && pass_is_short(w, i))
		v = larger(v, pass_rate_mm_s(w, &rates));
	if (s->kind == INTERP_CURVE) {
		/* What its axes leave is known already. */
		left.a_mm_s2 = w->p->pieces[s->arg].a_mm_s2;
		left.j_mm_s3 = w->p->pieces[s->arg].j_mm_s3;
		memset(rates.by, 0, sizeof(rates.by));
	} else if (h->bend_mm > 0) {
		v = round_bend(w, h, v, &left);
	}
	soften_seg(w, s, &left, &rates);
	/* A cycle that has no time for its points would break off the move. */
	if (s->ticks >= MANY_POINTS)
		v = smaller(v, w->points_per_s * s->length_mm /
				   (double)s->ticks);
	s->feed_max_mm_s = level(w, v);
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

/* Those from the end of segment @first to the start of segment @i. */
static void limit_nodes(struct pass *w, uint32_t first, uint32_t i, double v)
{
	const float most = isinf(v) ? INFINITY : level(w, v);

	for (uint32_t k = first; k < i; k++)
		w->segs[k].node_mm_s = fminf(w->segs[k].node_mm_s, most);
}

/* An action stands on the node before it. */
static void walk_nodes(struct pass *w)
{
	const uint32_t nsegs = w->p->head->nsegs;
	struct headings h[2];
	uint32_t last = 0;		/* that moves; 0: none yet */
	int now = 0;

	w->segs[0].node_mm_s = INFINITY;
	w->segs[0].a_mm_s2 = w->segs[0].j_mm_s3 = INFINITY;
	for (uint32_t i = 1; i < nsegs; i++) {
		w->segs[i].node_mm_s = INFINITY;
		w->segs[i].a_mm_s2 = w->segs[i].j_mm_s3 = INFINITY;
		w->segs[i].flags &= (uint8_t)~INTERP_SEG_STAND;
		if (w->segs[i].kind >= INTERP_BEGIN)
			continue;
		heading_find(&w->ways, i, &h[now]);
		limit_seg(w, i, &h[now]);
		if (last > 0) {
			double v = pass_node_mm_s(w, last, i, &h[!now].last,
						  &h[now].first);

			limit_nodes(w, last, i, v);
			if (pass_is_tiny(w, last) && !pass_is_tiny(w, i)) {
				v = pass_over_mm_s(w, &last, i, &h[now].first);
				limit_nodes(w, last, i, v);
			}
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
	double next = 0, v;

	w->segs[end].slower_feed = 0;
	for (uint32_t i = end; i-- > 0; next = v) {
		uint32_t m = i + 1;

		v = feed_of(&w->segs[i]);
		while (m - i < HOP_MAX && m < end &&
		       (m == i + 1 ? next : feed_of(&w->segs[m])) >= v)
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
	double last = 0, v;

	w->segs[0].slower_behind = 0;
	for (uint32_t i = 1; i < w->p->head->nsegs; i++, last = v) {
		uint32_t m = i - 1;

		v = back_into(w, i);
		while (i - m < HOP_MAX &&
		       (m == i - 1 ? last : back_into(w, m)) >= v)
			m -= w->segs[m].slower_behind;
		w->segs[i].slower_behind = (uint16_t)(i - m < HOP_MAX ? i - m :
							HOP_MAX);
	}
}

/* -- The next softer ------------------------------------------------------- */

static bool is_softer(const struct interp_seg *s, const struct interp_seg *than)
{
	return s->a_mm_s2 < than->a_mm_s2 || s->j_mm_s3 < than->j_mm_s3;
}

static bool stands(const struct interp_seg *s)
{
	return s->flags & INTERP_SEG_STAND;
}

static void chain_softer(const struct pass *w)
{
	struct interp_seg *s = w->segs;
	const uint32_t end = w->p->head->nsegs - 1;

	s[end].softer_ahead = 0;
	for (uint32_t i = end; i-- > 0; ) {
		uint32_t m = i + 1;

		while (m < end && m - i < HOP_MAX && s[i].kind < INTERP_BEGIN &&
		       s[m].kind < INTERP_BEGIN && !stands(&s[m - 1]) &&
		       !is_softer(&s[m], &s[i]))
			m += s[m].softer_ahead;
		s[i].softer_ahead = (uint16_t)(m - i < HOP_MAX ? m - i :
							   HOP_MAX);
	}
	s[0].softer_behind = 0;
	for (uint32_t i = 1; i <= end; i++) {
		uint32_t m = i - 1;

		while (m > 0 && i - m < HOP_MAX && !stands(&s[m]) &&
		       !is_softer(&s[m], &s[i]))
			m = s[m].softer_behind ? m - s[m].softer_behind : 0;
		s[i].softer_behind = (uint16_t)(m == 0 ? 0 :
						i - m < HOP_MAX ? i - m :
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
	pass_stretches(&w);
	chain_softer(&w);
}
