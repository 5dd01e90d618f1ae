/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.c - speed ceilings of a finished program
 */
#include "speed/nearby.h"

#include <string.h>

/* Directions of short lines differ by their rounding.  Their ceilings must
 * not. */
#define SAME		4e-6

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
	l->above = larger(l->above, (1 + 2 * SAME) * at);
}

/* However small a corner is, a rounding hides the bend of short lines.  Over a
 * window of so many tolerances it does not. */
static void windows(struct pass *w)
{
	double tol = 0, mm;

	for (uint32_t j = 0; j < w->n; j++)
		if (!w->ways.xyz || w->ways.xyz >> j & 1)
			tol = larger(tol, w->tol[j]);
	mm = larger(PASS_WINDOW * w->corner_mm, PASS_FAR * tol);
	for (int k = 0; k < PASS_WINDOWS; k++)
		w->windows[k].mm = mm * (1 << k);
	w->short_mm = PASS_LONG * mm;
}

/* Of a turn below 1 the radius of a corner is at least 6.46 * corner_mm /
 * turn. */
static void note_turn(struct pass *w, uint32_t j)
{
	const double far = 6.4 * w->corner_mm, step = w->step_mm_s[j];

	w->turn_least[0] = smaller(w->turn_least[0],
				   smaller(w->a_mm_s2[j] * far, step * step));
	w->turn_least[1] = smaller(w->turn_least[1],
				   w->j_mm_s3[j] * far * far);
}

void pass_begin(struct pass *w, const struct interp_limits *l,
		const struct interp_program *p, struct interp_seg *segs)
{
	*w = (struct pass) { .p = p, .segs = segs, .corner_mm = l->corner_mm,
			     .points_per_s = l->points_per_s,
			     .threads = l->threads,
			     .n = p->head->naxes, .at = 1,
			     .turn_least = { INFINITY, INFINITY },
			     .a_linear_mm_s2 = INFINITY,
			     .gate = { .a_mm_s2 = INFINITY,
				       .jerk_mm_s3 = INFINITY },
			     .soft = { INFINITY, 0, INFINITY, 0 } };
	heading_ways_init(&w->ways, p);
	for (uint32_t j = 0; j < w->n; j++) {
		const uint8_t axis = p->head->column[j];
		const struct interp_axis_limits *m = &l->machine->axis[axis];
		const double six = 6 * l->corner_mm;

		w->tol[j] = tolerance(l, axis);
		w->near.mm = larger(w->near.mm, PASS_NEAR * w->tol[j]);
		w->v_mm_s[j] = m->v_max_mm_s;
		w->a_mm_s2[j] = m->a_max_mm_s2;
		w->j_mm_s3[j] = m->j_max_mm_s3;
		w->gate.a_mm_s2 = smaller(w->gate.a_mm_s2, m->a_max_mm_s2);
		w->gate.jerk_mm_s3 = smaller(w->gate.jerk_mm_s3,
					     m->j_max_mm_s3);
		w->step_mm_s[j] = smaller(
			sqrt(8 * m->a_max_mm_s2 * l->corner_mm),
			cbrt(m->j_max_mm_s3 * six * six));
		add_level(&w->v_levels, m->v_max_mm_s);
		add_level(&w->a_levels, m->a_max_mm_s2);
		add_level(&w->j_levels, m->j_max_mm_s3);
		w->curl_mm_s2[j] = cbrt(24 * l->corner_mm * m->j_max_mm_s3 *
					m->j_max_mm_s3);
		note_turn(w, j);
		if (w->ways.xyz >> j & 1)
			w->a_linear_mm_s2 = smaller(w->a_linear_mm_s2,
						    m->a_max_mm_s2);
	}
	interp_machine_travel(l->machine, &w->travel_a_mm_s2,
			      &w->travel_j_mm_s3);
	w->alike = w->a_levels.n == 1 && w->j_levels.n == 1;
	windows(w);
}

/* Levels: so many bits of a float are left out. */
#define COARSE	18		/* 1/64 to 1/32 of a speed */
#define FINE	13		/* 1/2048 to 1/1024 */

static inline float down_to(double most, int out)
{
	float v = (float)(most * (1 + SAME));
	uint32_t bits;

	memcpy(&bits, &v, sizeof(bits));
	bits &= ~((UINT32_C(1) << out) - 1);
	memcpy(&v, &bits, sizeof(v));
	return v * (float)(1 - 2 * SAME);
}

/* Down to a level. */
static float down(double most)
{
	return down_to(most, COARSE);
}

/* What an axis can do, if @most is that but for a rounding; else 0.  On most
 * lines no axis moves alone, so that it is more than any can do. */
static inline double own_level(const struct levels *own, double most)
{
	if (most > own->above && most < INFINITY)
		return 0;
	for (uint32_t k = 0; k < own->n; k++)
		if (fabs(most - own->at[k]) <= SAME * most)
			return own->at[k];
	return 0;
}

/* A speed; that of an axis stays as it is. */
static float level(const struct pass *w, double v_mm_s)
{
	const double own = own_level(&w->v_levels, v_mm_s);

	return own > 0 ? (float)(own * (1 - 2 * SAME)) : down(v_mm_s);
}

/* So many limits that are near to each other are a plateau. */
#define PLATEAU		8
#define PLATEAU_HIGH	(1 + 1.0 / 32)

/*
 * An axis that turns evenly beside the path makes a plateau, which is walked
 * for long.  So it is worth a fine level: the lowest of its limits.  Where one
 * is lower still, its coarse level stands once.  So a way that becomes slower
 * and slower has no more levels than it would have without plateaus, and seen
 * from its other end twice as many.  Single limits far from it, as those of
 * lines that a rounding made longer, do not end it.  But a move is no faster
 * than the low ones: where these are a third and more, they are the plateau.
 * On a way that becomes faster and faster, a coarse level above it is taken.
 */
static float plateau_level(struct pass *w, double v_mm_s)
{
	struct plateau *p = &w->plateau;
	const double low = (double)p->low_mm_s;
	const float most = level(w, v_mm_s);

	if (v_mm_s >= low && v_mm_s < PLATEAU_HIGH * low) {
		p->far = 0;
		p->below -= p->below > 0;
		if (++p->near <= PLATEAU)
			return pass_least(most, p->low_mm_s);
		return most > p->low_mm_s ? most : p->low_mm_s;
	}
	if (v_mm_s < low && PLATEAU_HIGH * v_mm_s >= low) {
		p->far = p->below = 0;
	} else {
		if (v_mm_s < low)
			p->below += 2;
		else
			p->below -= p->below > 0;
		if (++p->far <= PLATEAU && p->below <= 2 * PLATEAU)
			return most;
		p->near = p->far = p->below = 0;
	}
	p->low_mm_s = down_to(v_mm_s, FINE);
	return most;
}

/* What an axis can do stays as it is.  Levels are made of the rest when all is
 * known (levels.c). */
static float soft(double most, const struct levels *own)
{
	const double is = own_level(own, most);

	return (float)(is > 0 ? is : most);
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

/* A segment has that along the path. */
static inline void set_soft(struct pass *w, struct interp_seg *s, double a,
			    double j)
{
	s->a_mm_s2 = soft(a, &w->a_levels);
	s->j_mm_s3 = soft(j, &w->j_levels);
	if (s->a_mm_s2 < INFINITY && s->j_mm_s3 < INFINITY)
		note_soft(&w->soft, (double)s->a_mm_s2, (double)s->j_mm_s3);
}

/* Along the path, what its axes leave. */
COLUMNS_INLINE void soften_seg(struct pass *w, struct interp_seg *s,
			    const struct along *left, const struct rates *r,
			    uint32_t n)
{
	double a = left->a_mm_s2, j = left->j_mm_s3;

	for (uint32_t k = 0; k < n; k++) {
		const bool bends = r->bends >> k & 1;

		if (!(r->by[k] > 0))
			continue;
		a = smaller(a,
			    (bends ? left->a : 1) * w->a_mm_s2[k] / r->by[k]);
		j = smaller(j,
			    (bends ? left->j : 1) * w->j_mm_s3[k] / r->by[k]);
	}
	set_soft(w, s, a, j);
}

/* The same of a line.  Of axes that are alike the one that moves most leaves
 * least. */
COLUMNS_INLINE void soften_line(struct pass *w, struct interp_seg *s,
				const struct rates *r, uint32_t n)
{
	const struct along left = { 1, 1, INFINITY, INFINITY };
	double most = 0;

	if (!w->alike) {
		soften_seg(w, s, &left, r, n);
		return;
	}
	for (uint32_t k = 0; k < n; k++)
		most = larger(r->by[k], most);
	set_soft(w, s, w->gate.a_mm_s2 / most, w->gate.jerk_mm_s3 / most);
}

/*
 * The ceiling of an arc, @v_mm_s at most, by the axes that go round it; and
 * what it leaves at that speed, as a share of what those can do.  Along and
 * across are square to each other.  An axis that goes evenly beside them has
 * all of its own for going along.
 */
static double round_bend(const struct pass *w, const struct headings *h,
			 uint32_t bends, double v_mm_s, struct along *ret)
{
	const struct weakest own = pass_weakest(w, bends);
	const double r = h->bend_mm, a = own.a_mm_s2, j = own.j_mm_s3;
	double v, across, both, speed_up;

	v = smaller(v_mm_s * h->share,
		    pass_round_mm_s(r, INTERP_BEND_ACROSS * a,
				    INTERP_ARC_JERK_ROUND * j));
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

/* A line that a rounding made longer on an axis seems to need more of it than
 * the lines near to it.  A known way has no such roundings. */
static inline double ceiling(const struct interp_seg *s, const struct rates *r)
{
	const double own = (double)s->feed_max_mm_s;

	return s->flags & INTERP_SEG_KNOWN ? own : larger(own, r->v_mm_s);
}

/* What the axes of its bend can do.  Return: the speed. */
static double limit_bend(struct pass *w, uint32_t i, const struct headings *h)
{
	struct interp_seg *s = &w->segs[i];
	struct along left = { 1, 1, INFINITY, INFINITY };
	struct rates rates;
	double v;

	pass_rates(w, i, h, &rates);
	w->top_mm_s[1] = rates.top_mm_s;
	v = ceiling(s, &rates);
	if (s->kind == INTERP_CURVE) {
		/* What its axes leave is known already. */
		left.a_mm_s2 = w->p->pieces[s->arg].a_mm_s2;
		left.j_mm_s3 = w->p->pieces[s->arg].j_mm_s3;
		memset(rates.by, 0, sizeof(rates.by));
	} else if (h->bend_mm > 0) {
		v = round_bend(w, h, rates.bends, v, &left);
	}
	BY_COLUMNS(w->n, soften_seg, w, s, &left, &rates);
	return v;
}

/* The same of a short line whose length is in the usual columns. */
COLUMNS_INLINE double limit_line(struct pass *w, uint32_t i,
				 const struct heading *h, uint32_t n)
{
	struct rates rates = { .bends = 0 };

	near_rates(w, i, h, &rates, near_usual(n), n);
	soften_line(w, &w->segs[i], &rates, n);
	w->top_mm_s[1] = rates.top_mm_s;
	return ceiling(&w->segs[i], &rates);
}

/* The same of a line that is not short. */
COLUMNS_INLINE double limit_long(struct pass *w, uint32_t i,
				 const struct headings *h, uint32_t n)
{
	struct interp_seg *s = &w->segs[i];
	struct rates rates;

	near_other_rates(h, &rates, n);
	soften_line(w, s, &rates, n);
	return (double)s->feed_max_mm_s;
}

COLUMNS_INLINE void limit_seg(struct pass *w, uint32_t i,
			      const struct headings *h, uint32_t n)
{
	struct interp_seg *s = &w->segs[i];
	const bool line = s->kind == INTERP_LINE;
	const bool near = line && pass_is_short(w, i);
	double v;

	w->top_mm_s[0] = w->top_mm_s[1];
	w->top_mm_s[1] = INFINITY;
	if (near && h->first.along == near_usual(n))
		v = limit_line(w, i, &h->first, n);
	else if (line && !near)
		v = limit_long(w, i, h, n);
	else
		v = limit_bend(w, i, h);

	/* A cycle that has no time for its points would break off the move. */
	if (s->ticks >= MANY_POINTS)
		v = smaller(v, w->points_per_s * s->length_mm /
				   (double)s->ticks);
	s->feed_max_mm_s = near_all(n) == w->ways.xyz ? level(w, v) :
							plateau_level(w, v);
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

void pass_soften_segs(struct pass *w, uint32_t from, uint32_t to,
		      const struct leave *left)
{
	const float a = soft(left->a_mm_s2, &w->a_levels);
	const float j = soft(left->j_mm_s3, &w->j_levels);

	for (uint32_t i = from; i <= to; i++) {
		struct interp_seg *s = &w->segs[i];

		if (s->kind >= INTERP_BEGIN)
			continue;
		s->a_mm_s2 = pass_least(s->a_mm_s2, a);
		s->j_mm_s3 = pass_least(s->j_mm_s3, j);
	}
	w->soft.a_least = smaller(w->soft.a_least, left->a_mm_s2);
	w->soft.j_least = smaller(w->soft.j_least, left->j_mm_s3);
}

/* Those from the end of segment @first to the start of segment @i. */
static void limit_nodes(struct pass *w, uint32_t first, uint32_t i, double v)
{
	const float most = (float)v;

	struct interp_seg *s = &w->segs[i];

	/* Mostly one. */
	do {
		s--;
		s->node_mm_s = pass_least(s->node_mm_s, most);
	} while (s > w->segs + first);
}

/* An action stops there anyway. */
static void note_parts(struct pass *w, uint32_t last, uint32_t i)
{
	if (last + 1 != i)
		return;
	w->segs[last].flags |= INTERP_SEG_STAND;
	w->parts = true;
}

/* Node @i is known, and so is what is near to one before it. */
static void look_for_dip(struct pass *w, uint32_t i, double top_mm_s)
{
	const uint32_t k = i - DIP_NODES;
	struct interp_seg *s;
	double v;

	w->dip.firm_mm_s = pass_least(w->dip.firm_mm_s, (float)top_mm_s);
	pass_note_dip(w, i);
	if (i <= DIP_NODES)
		return;
	s = &w->segs[k - 1];
	/* One that its segments do not reach slows nothing down. */
	if (s->node_mm_s >= pass_least(s->feed_max_mm_s, s[1].feed_max_mm_s))
		return;
	v = pass_dip_mm_s(w, k);
	if (v > (double)s->node_mm_s)
		s->node_mm_s = (float)v;
}

/* The node in front of segment @i; @last is the segment before it that
 * moves. */
COLUMNS_INLINE void limit_node(struct pass *w, uint32_t last, uint32_t i,
			       const struct heading *a, const struct heading *b,
			       uint32_t n)
{
	const double top = smaller(w->top_mm_s[0], w->top_mm_s[1]);
	struct joint k = { .a = a, .b = b, .last = last, .i = i };
	double v = smaller(near_node_mm_s(w, &k, n), top);

	if (!(k.least_mm > 0))
		v = smaller(v, pass_curl(w, last, i, a, b));
	limit_nodes(w, last, i, v);
	/* Mostly nothing is beside the path. */
	if ((a->along & b->along) != near_all(n)) {
		if (a->along != b->along)
			note_parts(w, last, i);
		if (w->bends)
			pass_note_bends(w, last, i);
		if (last + 1 == i)
			look_for_dip(w, i, top);
	}
	if (pass_is_tiny(w, last) && !pass_is_tiny(w, i)) {
		const double over = pass_over_mm_s(w, &last, i, b);

		limit_nodes(w, last, i, over);
		pass_dip_firm(w, last, i, over);
	}
}

/* -- From segment to segment ----------------------------------------------- */

/* No node beside it is between short lines. */
static inline bool is_among_long(const struct pass *w, uint32_t i)
{
	const double mm = larger(w->short_mm, w->near.mm);

	return w->segs[i - 1].length_mm >= mm && w->segs[i].length_mm >= mm;
}

static inline void beside_slow(struct pass *w, uint32_t known)
{
	if (is_among_long(w, w->slow))
		w->slow = 0;
	else
		pass_beside_corner(w, known);
}

/* What was seen near the slowest node of late may be a corner, of which no node
 * from that in front of segment @i on sees anything. */
static inline void leave_slow(struct pass *w, uint32_t i)
{
	if (w->slow > 0 && w->gate.v_mm_s < INFINITY &&
	    pass_from_to(w, w->slow, i) >= pass_sees_mm(w))
		pass_change_anew(w, i);
}

/* The node in front of segment @i is known. */
static inline void note_slow(struct pass *w, uint32_t i)
{
	const struct interp_seg *s = &w->segs[i];

	if (w->slow > 0 && pass_from_to(w, w->slow, i) >= pass_sees_mm(w))
		beside_slow(w, i);
	if (s[-1].node_mm_s < s->feed_max_mm_s &&
	    (w->slow == 0 || s[-1].node_mm_s < w->segs[w->slow - 1].node_mm_s))
		w->slow = i;
}

/* The run that began last ends there; UINT32_MAX: behind what is known. */
static void look_for_run_end(struct pass *w, uint32_t known)
{
	if (heading_run_on(&w->ways, &w->ahead, known))
		w->run_end = w->ahead.at;
	else
		w->run_end = known == w->end ? known : UINT32_MAX;
}

static void next_run(struct pass *w, uint32_t i, uint32_t known)
{
	pass_beside_corner(w, i);
	pass_change_anew(w, i);
	w->run = i;
	w->ahead = heading_run(&w->ways, i);
	look_for_run_end(w, known);
}

/* An action stands on the node before it. */
COLUMNS_INLINE void walk_nodes(struct pass *w, uint32_t known, uint32_t to,
			       uint32_t n)
{
	struct headings *was = &w->headings[0], *is = &w->headings[1], *swap;
	uint32_t last = w->last;

	for (uint32_t i = w->at; i < to; i++) {
		struct interp_seg *s = &w->segs[i];

		s->node_mm_s = INFINITY;
		s->flags &= (uint8_t)~INTERP_SEG_STAND;
		if (s->kind >= INTERP_BEGIN) {
			s->a_mm_s2 = s->j_mm_s3 = INFINITY;
			continue;
		}
		if (i >= w->run_end)
			next_run(w, i, known);
		heading_find(&w->ways, i, is, n);
		limit_seg(w, i, is, n);
		w->a_own_mm_s2[0] = w->a_own_mm_s2[1];
		w->a_own_mm_s2[1] = (double)w->segs[i].a_mm_s2;
		if (last > 0) {
			leave_slow(w, i);
			limit_node(w, last, i, &was->last, &is->first, n);
			note_slow(w, i);
		}
		last = i;
		swap = was;
		was = is;
		is = swap;
	}
	if (was != &w->headings[0])
		w->headings[0] = *was;
	w->last = last;
	w->at = to;
}

void pass_walk(struct pass *w, uint32_t known, uint32_t to)
{
	w->known = known;
	if (w->run_end == UINT32_MAX)
		look_for_run_end(w, known);
	BY_COLUMNS(w->n, walk_nodes, w, known, to);
}

/* The last node before node @i that is at least @mm from it; 0 if none is. */
static uint32_t far_before(const struct pass *w, uint32_t i, double mm)
{
	const double s_mm = w->segs[i].s_mm;
	uint32_t near = i, far = 0;

	while (far + 1 < near) {
		const uint32_t k = far + (near - far) / 2;

		if (s_mm - w->segs[k].s_mm >= mm)
			far = k;
		else
			near = k;
	}
	return far;
}

/* The widest window is looked at twice, one behind the other (beside.c). */
uint32_t pass_seen(const struct pass *w, uint32_t known)
{
	const double mm = larger(w->windows[PASS_WINDOWS - 1].mm, w->near.mm);

	return known < 2 ? 0 :
	       far_before(w, far_before(w, known - 1, mm), mm);
}

void pass_move(struct pass *w, const struct interp_program *p,
	       struct interp_seg *segs)
{
	w->p = w->ways.p = p;
	w->segs = segs;
}

void pass_finish(struct pass *w, struct interp_bends *bends)
{
	w->end = w->p->head->nsegs - 1;
	w->segs[0].node_mm_s = INFINITY;
	w->segs[0].a_mm_s2 = w->segs[0].j_mm_s3 = INFINITY;
	pass_walk(w, w->end, w->end + 1);
	pass_beside_corner(w, w->end);
	pass_dip_bends(w);
	pass_way_known(w);
	pass_bends(w, bends);
	pass_soften(w);
	pass_levels(w);
	pass_stretches(w);
	pass_hops(w);
}

void interp_limits_write(const struct interp_limits *l,
			 const struct interp_program *p,
			 struct interp_seg *segs, struct interp_bends *bends)
{
	struct pass w;

	pass_begin(&w, l, p, segs);
	pass_finish(&w, bends);
}
