/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.c - speed ceilings of a finished program
 *
 * Each place has a ceiling, by what its axes can do and by what of that a move
 * keeps for going along the path.  Who keeps more passes bends slower, and is
 * back at speed earlier.  So the time is found for some shares, and the best of
 * them holds for all between two actions.
 */
#include "speed/pass.h"
#include "speed/heading.h"
#include "speed/sections.h"

#include "interp/bends.h"

#include "grow.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Fewer need no time.  The piece of a curve between two cusps may have some
 * points and next to no length. */
#define MANY_POINTS	64

/* Where stands may be is found with so much of what the axes can do. */
#define BARE		0.5

/* Beside the path, a rounding of it counts so often. */
#define RATE_MOST	20

#define ARC_LOOKS	17
#define CURVE_LOOKS	9

static const struct {
	double a, j;
} shares[] = { {0.1,0.1},{0.2,0.2},{0.35,0.35},{0.5,0.45},{0.7,0.6},{0.9,0.8} };

#define NSHARES	(sizeof(shares) / sizeof(shares[0]))

/* What is looked at of a segment. */
struct looks {
	uint32_t at, n;
	float own_mm_s;			/* its feed_max before */
	float corner_mm_s;
	bool goes_on;			/* its last look is the first of the next
					 * segment */
};

struct making {
	const struct interp_limits *l;
	struct pass pass;
	struct sections sections;
	struct interp_axes axes;
	struct ways ways;
	double tol[INTERP_NAXES];	/* of each column */
	double step_mm_s[INTERP_NAXES];	/* at a node */
	float weakest_mm_s2, weakest_mm_s3;	/* column */
	struct looks *looks;		/* of each segment */
	size_t n, room;
	double *way;			/* of each look */
	float *v2;
};

static uint32_t looks_of(const struct interp_seg *s)
{
	return s->kind == INTERP_LINE ? 1 :
	       s->kind == INTERP_CURVE ? CURVE_LOOKS : ARC_LOOKS;
}

static int look(struct making *m, const struct section *s, double s_mm)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;

	if (m->n == m->room &&
	    grow_array(&m->way, &m->room, each * sizeof(double)) < 0)
		return -ENOMEM;
	sections_way(&m->sections, s, s_mm, m->way + m->n++ * each);
	return 0;
}

static void lessen(struct interp_seg *s, const struct interp_straight *left)
{
	s->a_mm_s2 = pass_least(s->a_mm_s2, (float)left->a_mm_s2);
	s->j_mm_s3 = pass_least(s->j_mm_s3, (float)left->j_mm_s3);
}

/* By how much column @k goes in a mm of line @i, and what a rounding of its ends
 * makes of that. */
struct rate {
	double by, off;
};

static struct rate rate_of(const struct making *m, uint32_t i, uint32_t k)
{
	const uint32_t n = m->axes.n;
	const int64_t *a = m->pass.p->nodes + (uint64_t)i * n + k;
	const double per_mm = 1 / m->pass.segs[i].length_mm;
	const double by = (double)(a[n] - a[0]) * m->ways.sub_mm[k] * per_mm;
	const double size = smaller(larger(fabs(by), 1), RATE_MOST);

	return (struct rate) { by, m->tol[k] * (1 + size) * per_mm };
}

/* How fast the axes of line @i are at most.  INFINITY: it is a rounding. */
static double axes_mm_s(const struct making *m, uint32_t i)
{
	double v = INFINITY;

	for (uint32_t k = 0; k < m->axes.n; k++) {
		const struct rate r = rate_of(m, i, k);
		const double by = fabs(r.by);
		const double sure = by * (1 - r.off / larger(by, 1));

		if (sure * v > m->axes.v_mm_s[k])
			v = m->axes.v_mm_s[k] / sure;
	}
	return v;
}

/* The machine goes along the lines: at the node behind line @i each axis makes a
 * step of its speed, however smooth the shape is. */
static double step_mm_s(const struct making *m, uint32_t i)
{
	double v = INFINITY;

	for (uint32_t k = 0; k < m->axes.n; k++) {
		const struct rate a = rate_of(m, i, k);
		const struct rate b = rate_of(m, i + 1, k);
		const double sure = fabs(b.by - a.by) - a.off - b.off;

		if (sure * v > m->step_mm_s[k])
			v = m->step_mm_s[k] / sure;
	}
	return v;
}

/* Segment @i, by all of its looks.  A line between two nodes of a run may be as
 * fast as the faster of them. */
static void write_seg(struct making *m, uint32_t i,
		      const struct interp_straight *kept)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;
	const struct looks *k = &m->looks[i];
	struct interp_seg *s = &m->pass.segs[i];
	double most = k->n == 2 ? 0 : INFINITY, v = 0;

	s->a_mm_s2 = s->j_mm_s3 = INFINITY;
	for (uint32_t n = 0; n < k->n; n++) {
		const double *way = m->way + (k->at + n) * each;
		struct interp_straight left;

		v = interp_axes_mm_s(&m->axes, way, kept);
		most = k->n == 2 ? larger(most, v) : smaller(most, v);
		left = interp_axes_left(&m->axes, way, v, kept);
		lessen(s, &left);
	}
	/* All of it is within a rounding. */
	s->a_mm_s2 = isinf(s->a_mm_s2) ? m->weakest_mm_s2 : s->a_mm_s2;
	s->j_mm_s3 = isinf(s->j_mm_s3) ? m->weakest_mm_s3 : s->j_mm_s3;
	if (isinf(most))
		most = v = (double)k->own_mm_s;
	s->node_mm_s = k->goes_on ? pass_least((float)v, k->corner_mm_s) :
				    k->corner_mm_s;
	s->feed_max_mm_s = k->own_mm_s;
	if (k->n == 2 && !(s->flags & INTERP_SEG_KNOWN)) {
		s->feed_max_mm_s = (float)smaller(most, axes_mm_s(m, i));
	} else {
		s->feed_max_mm_s = pass_least(k->own_mm_s, (float)most);
	}
	/* A cycle that has no time for its points would break off the move. */
	if (s->ticks >= MANY_POINTS)
		s->feed_max_mm_s = pass_least(
			s->feed_max_mm_s,
			(float)(m->l->points_per_s * s->length_mm /
				(double)s->ticks));
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

static void write_segs(struct making *m, uint32_t from, uint32_t to,
		       const struct interp_straight *kept)
{
	for (uint32_t i = from; i < to; i++)
		if (m->looks[i].n > 0)
			write_seg(m, i, kept);
}

/* What the axes can do along the path, the least of segments @from to @to. */
static struct interp_straight least_of(const struct making *m, uint32_t from,
				       uint32_t to)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;
	struct interp_straight ret = { m->pass.travel_a_mm_s2,
				       m->pass.travel_j_mm_s3 };

	for (uint32_t i = from; i < to; i++)
		for (uint32_t n = 0; n < m->looks[i].n; n++) {
			const struct interp_straight s = interp_axes_straight(
				&m->axes, m->way + (m->looks[i].at + n) * each);

			ret.a_mm_s2 = smaller(ret.a_mm_s2, s.a_mm_s2);
			ret.j_mm_s3 = smaller(ret.j_mm_s3, s.j_mm_s3);
		}
	return ret;
}

static bool bends(const struct making *m, uint32_t from, uint32_t to)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;

	for (uint32_t i = from; i < to; i++) {
		const double *way = m->way + m->looks[i].at * each;

		for (size_t k = 0; k < m->looks[i].n * each;
		     k += INTERP_AXES_WAY)
			if (way[k + 1] != 0 || way[k + 2] != 0)
				return true;
	}
	return false;
}

static void choose(struct making *m, uint32_t from, uint32_t to)
{
	const struct interp_straight all = least_of(m, from, to);
	struct interp_straight kept = all, best = all;
	double least_s = INFINITY;

	if (!bends(m, from, to)) {
		write_segs(m, from, to, &all);
		return;
	}
	for (size_t k = 0; k < NSHARES; k++) {
		double t;

		kept.a_mm_s2 = shares[k].a * all.a_mm_s2;
		kept.j_mm_s3 = shares[k].j * all.j_mm_s3;
		write_segs(m, from, to, &kept);
		t = pass_moves_s(&m->pass, from, to, false, m->v2);
		if (t < least_s)
			best = kept;
		least_s = smaller(least_s, t);
	}
	write_segs(m, from, to, &best);
}

/* As if nothing bent. */
static void bare(struct making *m)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;
	struct interp_straight kept;
	const double by = BARE;

	for (uint32_t i = 1; i < m->pass.end; i++) {
		struct interp_seg *k = &m->pass.segs[i];

		if (k->kind >= INTERP_BEGIN)
			continue;
		kept = least_of(m, i, i + 1);
		kept.a_mm_s2 *= by;
		kept.j_mm_s3 *= by;
		write_seg(m, i, &kept);
		k->a_mm_s2 = k->j_mm_s3 = INFINITY;
		for (uint32_t n = 0; n < m->looks[i].n; n++) {
			const struct interp_straight s = interp_axes_straight(
				&m->axes, m->way + (m->looks[i].at + n) * each);

			lessen(k, &s);
		}
		k->a_mm_s2 *= (float)by;
		k->j_mm_s3 *= (float)by;
	}
}

/* Between two actions, and between stands. */
static void choose_all(struct making *m)
{
	const struct interp_seg *s = m->pass.segs;

	for (uint32_t i = 1, to; i < m->pass.end; i = to) {
		to = i + 1;
		if (s[i].kind >= INTERP_BEGIN)
			continue;
		while (s[to].kind < INTERP_BEGIN &&
		       !(s[to - 1].flags & INTERP_SEG_STAND))
			to++;
		choose(m, i, to);
	}
}

static int look_at(struct making *m, const struct section *s)
{
	const struct interp_seg *segs = m->pass.segs;
	int err = 0;

	for (uint32_t i = s->from; err == 0 && i < s->to; i++) {
		const struct interp_seg *k = &segs[i];
		struct looks *looks = &m->looks[i];

		looks->at = (uint32_t)m->n;
		looks->goes_on = i + 1 < s->to;
		looks->corner_mm_s = looks->goes_on ? (float)step_mm_s(m, i) :
						      INFINITY;
		looks->n = s->part ? 2 : looks_of(k);
		if (looks->n == 1 || s->part) {
			err = look(m, s, k->s_mm);
			continue;
		}
		for (uint32_t n = 0; err == 0 && n < looks->n; n++)
			err = look(m, s, k->s_mm + k->length_mm * n /
						   (looks->n - 1));
	}
	if (err == 0 && s->part)
		err = look(m, s, segs[s->to - 1].s_mm +
				 segs[s->to - 1].length_mm);
	return err;
}

static int prepare(struct making *m)
{
	struct interp_seg *segs = m->pass.segs;
	const struct section *s = m->sections.at;
	int err = 0;

	for (uint32_t i = 0; i <= m->pass.end; i++) {
		m->looks[i] = (struct looks) {
			.own_mm_s = segs[i].feed_max_mm_s };
		segs[i].node_mm_s = segs[i].a_mm_s2 = segs[i].j_mm_s3 =
			INFINITY;
		segs[i].flags &= (uint8_t)~INTERP_SEG_STAND;
	}
	for (size_t k = 0; err == 0 && k < m->sections.n; k++)
		err = look_at(m, &s[k]);
	for (size_t k = 0; err == 0 && k + 1 < m->sections.n; k++) {
		m->looks[s[k].to - 1].corner_mm_s = (float)s[k].corner_mm_s;
		for (uint32_t i = s[k].to; i < s[k + 1].from; i++)
			segs[i].node_mm_s = (float)s[k].corner_mm_s;
	}
	return err;
}

static void note_soft(struct pass *w)
{
	w->soft = (struct pass_soft) { INFINITY, 0, INFINITY, 0 };
	for (uint32_t i = 1; i < w->end; i++) {
		const double a = (double)w->segs[i].a_mm_s2;
		const double j = (double)w->segs[i].j_mm_s3;

		if (w->segs[i].kind >= INTERP_BEGIN)
			continue;
		w->soft.a_least = smaller(w->soft.a_least, a);
		w->soft.a_most = larger(w->soft.a_most, a);
		w->soft.j_least = smaller(w->soft.j_least, j);
		w->soft.j_most = larger(w->soft.j_most, j);
	}
}

static void note_parts(struct making *m)
{
	const struct section *s = m->sections.at;

	for (size_t i = 0; i + 1 < m->sections.n; i++) {
		if (s[i].along == s[i + 1].along || s[i].to != s[i + 1].from)
			continue;
		pass_set_stand(&m->pass, s[i].to - 1, true);
		m->pass.parts = true;
	}
}

/* -- Bends ----------------------------------------------------------------- */

static float most(float a, double b)
{
	return (float)larger((double)a, b);
}

static void add_bend(struct interp_bends *b, const struct interp_axes *x,
		     uint32_t k, const double *way)
{
	const double by = fabs(way[0]);
	const double a = x->a_mm_s2[k], j = x->j_mm_s3[k];

	if (by > 0) {
		b->a_mm_s2 = pass_least(b->a_mm_s2, (float)(a / by));
		b->j_mm_s3 = pass_least(b->j_mm_s3, (float)(j / by));
	}
	if (way[1] == 0 && way[2] == 0)
		return;
	b->by_v2 = most(b->by_v2, fabs(way[1]) / a);
	b->by_va = most(b->by_va, 3 * fabs(way[1]) / j);
	b->by_v3 = most(b->by_v3, fabs(way[2]) / j);
	if (by > 0) {
		b->bent_a_mm_s2 = pass_least(b->bent_a_mm_s2, (float)(a / by));
		b->bent_j_mm_s3 = pass_least(b->bent_j_mm_s3, (float)(j / by));
	}
}

/* Of the segments of one of @bends, from @from on. */
static void add_bends(const struct making *m, uint32_t from,
		      struct interp_bends *bends)
{
	const size_t each = m->axes.n * INTERP_AXES_WAY;

	*bends = INTERP_BENDS_NONE;
	for (uint32_t i = from; i < from + INTERP_BENDS_SEGS &&
				i <= m->pass.end; i++) {
		const struct looks *k = &m->looks[i];
		const double *way = m->way + k->at * each;

		for (uint32_t n = 0; n < k->n * m->axes.n; n++,
		     way += INTERP_AXES_WAY)
			add_bend(bends, &m->axes, n % m->axes.n, way);
	}
}

static void write_bends(const struct making *m, struct interp_bends *bends)
{
	const uint64_t n = m->pass.p->head->nbends;
	bool any = false;

	for (uint64_t k = 0; k < n; k++) {
		add_bends(m, (uint32_t)(k * INTERP_BENDS_SEGS), &bends[k]);
		any = any || bends[k].by_va > 0 || bends[k].by_v3 > 0;
	}
	if (!any && n > 0)
		memset(bends, 0, n * sizeof(*bends));
}

static int write(struct making *m, struct interp_bends *bends)
{
	const int err = prepare(m);

	if (err < 0)
		return err;
	bare(m);
	note_soft(&m->pass);
	note_parts(m);
	pass_stretches(&m->pass);
	choose_all(m);
	pass_levels(&m->pass);
	pass_hops(&m->pass);
	write_bends(m, bends);
	return 0;
}

int interp_limits_write(const struct interp_limits *l,
			const struct interp_program *p, struct interp_seg *segs,
			struct interp_bends *bends)
{
	const size_t n = p->head->nsegs;
	struct making m = {
		.l = l, .axes = sections_axes(l, p),
		.pass = { .p = p, .segs = segs, .end = (uint32_t)n - 1,
			  .short_mm = 100 * l->corner_mm, .threads = 1 },
		.looks = calloc(n, sizeof(*m.looks)),
		.v2 = malloc(n * sizeof(float)),
	};
	int err = m.looks && m.v2 ? sections_make(&m.sections, l, p) : -ENOMEM;

	heading_ways_init(&m.ways, p);
	m.weakest_mm_s2 = m.weakest_mm_s3 = INFINITY;
	for (uint32_t k = 0; k < m.axes.n; k++) {
		m.tol[k] = sections_tolerance(l, p, k);
		m.step_mm_s[k] = interp_axes_step_mm_s(&m.axes, k,
						       l->corner_mm);
		m.weakest_mm_s2 = pass_least(m.weakest_mm_s2,
					     (float)m.axes.a_mm_s2[k]);
		m.weakest_mm_s3 = pass_least(m.weakest_mm_s3,
					     (float)m.axes.j_mm_s3[k]);
	}
	interp_machine_travel(l->machine, &m.pass.travel_a_mm_s2,
			      &m.pass.travel_j_mm_s3);
	if (err == 0)
		err = write(&m, bends);
	sections_free(&m.sections);
	free(m.looks);
	free(m.v2);
	free(m.way);
	return err;
}
