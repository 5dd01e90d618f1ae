/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.c - speed ceilings of a finished program
 *
 * Each place has a ceiling, by what its axes can do and by what of that a move
 * keeps for going along the path.  Who keeps more passes bends slower, and is
 * back at speed earlier.  A move has the least acceleration and jerk of its
 * way.  So its time is found for some shares of what its axes can do at their
 * worst place, and the best of them holds for all of it.
 */
#include "speed/looks.h"
#include "speed/pass.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Of what looks at a curve allow, between them. */
#define LOOKED		0.98f

/* Where stands may pay is found with so much of what the axes can do. */
#define PLAIN		0.5

/* From what is best for a way of many bends to that for one with few. */
static const struct interp_straight shares[] = {
	{ 0.1, 0.1 }, { 0.2, 0.2 }, { 0.35, 0.35 }, { 0.5, 0.45 },
	{ 0.7, 0.6 }, { 0.9, 0.8 },
};

#define NSHARES		((int)(sizeof(shares) / sizeof(shares[0])))

struct limits {
	struct pass pass;
	struct look_all looks;
	double points_per_s;
	float *v2;
};

/* -- Segments -------------------------------------------------------------- */

/* At a look. */
struct seen {
	double v_mm_s;
	struct interp_straight left;
};

static struct seen see(const struct limits *w, size_t look,
		       const struct interp_straight *kept)
{
	const struct interp_axes *x = &w->looks.axes;
	double way[INTERP_NAXES * INTERP_AXES_WAY];
	struct seen ret;

	looks_way(&w->looks, look, way);
	ret.v_mm_s = interp_axes_mm_s(x, way, kept, &ret.left);
	return ret;
}

static void set_speed(const struct limits *w, uint32_t i, double v_mm_s)
{
	struct interp_seg *s = &w->pass.segs[i];

	s->feed_max_mm_s = (float)smaller((double)w->looks.of[i].own_mm_s,
					  v_mm_s);
	/* A cycle that has no time for its points would break off the move. */
	if (s->ticks > 0)
		s->feed_max_mm_s = pass_least(
			s->feed_max_mm_s,
			(float)(w->points_per_s * s->length_mm /
				(double)s->ticks));
	if (s->flags & INTERP_SEG_RAPID)
		s->feed_mm_s = s->feed_max_mm_s;
}

/* Segment @i.  A line of a run may be as fast as at the faster of its ends.
 * @last: the look at the end of the segment before; then that at its own. */
static void write_seg(const struct limits *w, uint32_t i,
		      const struct interp_straight *kept, struct seen *last)
{
	const struct looks *of = &w->looks.of[i];
	struct interp_seg *s = &w->pass.segs[i];
	double v = of->is_run ? 0 : INFINITY;
	float a = INFINITY, j = INFINITY;

	for (uint32_t n = 0; n < of->n; n++) {
		if (n > 0 || !of[-1].goes_on || last->v_mm_s < 0)
			*last = see(w, of->at + n, kept);
		v = of->is_run ? larger(v, last->v_mm_s) :
				 smaller(v, last->v_mm_s);
		a = pass_least(a, (float)last->left.a_mm_s2);
		j = pass_least(j, (float)last->left.j_mm_s3);
	}
	if (s->kind == INTERP_CURVE) {
		a *= LOOKED;
		j *= LOOKED;
	}
	s->a_mm_s2 = pass_least(a, of->a_mm_s2);
	s->j_mm_s3 = pass_least(j, of->j_mm_s3);
	s->node_mm_s = of->node_mm_s;
	if (of->goes_on)
		s->node_mm_s = pass_least(s->node_mm_s, (float)last->v_mm_s);
	set_speed(w, i, v);
}

static bool bends(const struct looks *of)
{
	return of->n > 1;
}

static void write_segs(const struct limits *w, uint32_t from, uint32_t to,
		       const struct interp_straight *kept)
{
	struct seen last = { -1, { 0, 0 } };

	for (uint32_t i = from; i < to; i++)
		if (bends(&w->looks.of[i]))
			write_seg(w, i, kept, &last);
}

/* As far as they do not depend on a share. */
static void write_plain(const struct limits *w)
{
	struct interp_seg *s = w->pass.segs;

	for (uint32_t i = 0; i <= w->pass.end; i++) {
		const struct looks *of = &w->looks.of[i];

		s[i].a_mm_s2 = of->a_mm_s2;
		s[i].j_mm_s3 = of->j_mm_s3;
		s[i].node_mm_s = of->node_mm_s;
		s[i].flags &= (uint8_t)~INTERP_SEG_STAND;
		if (of->n > 0)
			set_speed(w, i, INFINITY);
	}
}

/* -- Shares ---------------------------------------------------------------- */

/* A long move is judged by parts of it, evenly along it. */
#define PARTS		4
#define PART		4096		/* segments */

/* Of a move. */
struct choice {
	uint32_t from, to;
	struct interp_straight can;	/* at its worst place */
};

static struct interp_straight kept_of(const struct choice *k, int share)
{
	return (struct interp_straight) {
		shares[share].a_mm_s2 * k->can.a_mm_s2,
		shares[share].j_mm_s3 * k->can.j_mm_s3
	};
}

static double part_s(const struct limits *w, uint32_t from, uint32_t to,
		     const struct interp_straight *kept)
{
	write_segs(w, from, to, kept);
	return pass_moves_s(&w->pass, from, to, w->v2, true);
}

static double time_s(const struct limits *w, const struct choice *k, int share)
{
	const struct interp_straight kept = kept_of(k, share);
	const uint32_t n = k->to - k->from;
	double sum = 0;

	if (n <= PARTS * PART)
		return part_s(w, k->from, k->to, &kept);
	for (uint32_t i = 0; i < PARTS; i++) {
		const uint32_t at = k->from +
			(uint32_t)((uint64_t)i * (n - PART) / (PARTS - 1));

		sum += part_s(w, at, at + PART, &kept);
	}
	return sum;
}

/* From the middle on, as long as it gets better. */
static void choose(const struct limits *w, const struct choice *k)
{
	int best = NSHARES / 2;
	double least_s = time_s(w, k, best);
	struct interp_straight kept;

	for (int way = -1; way <= 1; way += 2) {
		const int was = best;

		for (int i = best + way; i >= 0 && i < NSHARES; i += way) {
			const double s = time_s(w, k, i);

			if (s >= least_s)
				break;
			best = i;
			least_s = s;
		}
		if (best != was)
			break;
	}
	kept = kept_of(k, best);
	write_segs(w, k->from, k->to, &kept);
}

/* From stand to stand. */
static void choose_all(const struct limits *w)
{
	const struct interp_seg *s = w->pass.segs;

	for (uint32_t i = 1; i < w->pass.end;) {
		struct choice k = { i, i, { w->pass.travel_a_mm_s2,
					    w->pass.travel_j_mm_s3 } };
		bool any = false;

		do {
			const struct looks *of = &w->looks.of[i];

			k.can.a_mm_s2 = smaller(k.can.a_mm_s2,
						(double)of->a_mm_s2);
			k.can.j_mm_s3 = smaller(k.can.j_mm_s3,
						(double)of->j_mm_s3);
			any = any || bends(of);
			k.to = ++i;
		} while (s[i].kind < INTERP_BEGIN &&
			 !(s[i - 1].flags & INTERP_SEG_STAND));
		if (any)
			choose(w, &k);
	}
}

/* -- Stands ---------------------------------------------------------------- */

/* Ceilings by what is kept of each segment alone. */
static void write_ceilings(const struct limits *w)
{
	for (uint32_t i = 1; i < w->pass.end; i++) {
		const struct looks *of = &w->looks.of[i];
		const struct interp_straight kept = {
			PLAIN * (double)of->a_mm_s2,
			PLAIN * (double)of->j_mm_s3
		};

		if (bends(of))
			write_segs(w, i, i + 1, &kept);
	}
}

static int find_stands(struct limits *w)
{
	const uint32_t sides = pass_sides(&w->pass);

	if (sides == 1)
		return 0;
	write_ceilings(w);
	return pass_join(&w->pass, sides, w->v2);
}

static int write_all(struct limits *w)
{
	int err;

	write_plain(w);
	err = find_stands(w);
	if (err < 0)
		return err;
	choose_all(w);
	pass_levels(&w->pass);
	pass_hops(&w->pass);
	return 0;
}

int interp_limits_write(const struct interp_limits *l,
			const struct interp_program *p, struct interp_seg *segs)
{
	struct limits w = {
		.pass = { .p = p, .segs = segs, .end = p->head->nsegs - 1 },
		.points_per_s = l->points_per_s,
		.v2 = malloc(p->head->nsegs * sizeof(float)),
	};
	int err = w.v2 ? looks_make(&w.looks, l, p) : -ENOMEM;

	interp_machine_travel(l->machine, &w.pass.travel_a_mm_s2,
			      &w.pass.travel_j_mm_s3);
	if (err == 0)
		err = write_all(&w);
	looks_free(&w.looks);
	free(w.v2);
	return err;
}
