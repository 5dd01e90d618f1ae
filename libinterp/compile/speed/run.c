/* SPDX-License-Identifier: Apache-2.0 */
/* run.c - runs of short lines, cut at their corners */
#include "speed/run.h"

#include "speed/along.h"
#include "speed/ways.h"
#include "interp/smaller.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define CHORD		20		/* tolerances: over it a turn shows */
#define CHORDS		3		/* one WIDER than the other */
#define WIDER		4
#define CORNER		4		/* boxes: turned by more over a chord */
#define BESIDE		3		/* times as much as a chord away */
#define RATE_MM		0.1		/* to both sides */
#define WINDOW		16	/* nodes: where a part is looked for first */
#define WINDOWS		16	/* the next one has so many times as many */

static double at(const struct run *r, size_t i, uint32_t k)
{
	return r->x[i * r->columns + k];
}

static double slope(const struct run *r, size_t a, size_t b, uint32_t k)
{
	return (at(r, b, k) - at(r, a, k)) / (r->s_mm[b] - r->s_mm[a]);
}

static bool is_along(const struct run *r, uint32_t k)
{
	return r->along >> k & 1;
}

/* What a rounding makes of column @k where it goes by @rate in a mm. */
static double box_of(const struct run *r, uint32_t k, double rate)
{
	return r->tolerance[k] *
	       (is_along(r, k) ? 1 : 1 + smaller(fabs(rate), WAYS_RATE_MOST));
}

/* -- Turns ----------------------------------------------------------------- */

/* The nodes @mm before and behind node @i, or the ends. */
struct chords {
	size_t before, behind;
};

static struct chords chords_of(const struct run *r, size_t i, double mm,
			       size_t first, size_t last)
{
	struct chords c = { i, i };

	while (c.before > first && r->s_mm[i] - r->s_mm[c.before] < mm)
		c.before--;
	while (c.behind < last && r->s_mm[c.behind] - r->s_mm[i] < mm)
		c.behind++;
	return c;
}

static double chord_mm(const struct run *r)
{
	double most = 0;

	for (uint32_t k = 0; k < r->columns; k++)
		if (is_along(r, k) || r->along == 0)
			most = larger(most, r->tolerance[k]);
	return CHORD * most;
}

/* How much the path turns at node @i over chords, as a share of what makes a
 * corner. */
static double turn_over(const struct run *r, size_t i, const struct chords *c)
{
	const double least_mm = smaller(r->s_mm[i] - r->s_mm[c->before],
					r->s_mm[c->behind] - r->s_mm[i]);
	double most = 0;

	for (uint32_t k = 0; k < r->columns; k++) {
		const double a = slope(r, c->before, i, k);
		const double b = slope(r, i, c->behind, k);

		most = larger(most, fabs(b - a) * least_mm /
			      (CORNER * box_of(r, k, fabs(a) + fabs(b))));
	}
	return most;
}

/* At each node of a run, over chords of @mm. */
static void turns_of(const struct run *r, double mm, double *turn)
{
	struct chords c = { 0, 0 };

	for (size_t i = 1; i + 1 < r->n; i++) {
		while (r->s_mm[i] - r->s_mm[c.before + 1] >= mm)
			c.before++;
		while (c.behind + 1 < r->n && r->s_mm[c.behind] - r->s_mm[i] <
					      mm)
			c.behind++;
		turn[i] = turn_over(r, i, &c);
	}
}

/* By how much column @k turns at node @i. */
static double turn_of(const struct run *r, size_t i, uint32_t k)
{
	return i == 0 || i + 1 >= r->n ? 0 :
	       slope(r, i, i + 1, k) - slope(r, i - 1, i, k);
}

/* Do the lines beside node @i show by themselves a turn that neither of their
 * other ends goes on with, as a curve does? */
static bool is_sharp(const struct run *r, size_t i)
{
	const double per_mm = 1 / (r->s_mm[i] - r->s_mm[i - 1]) +
			      1 / (r->s_mm[i + 1] - r->s_mm[i]);

	for (uint32_t k = 0; k < r->columns; k++) {
		const double turn = turn_of(r, i, k);
		const double rate = larger(fabs(slope(r, i - 1, i, k)),
					   fabs(slope(r, i, i + 1, k)));
		const double goes_on = larger(
			turn_of(r, i - 1, k) / turn,
			turn_of(r, i + 1, k) / turn);

		if (fabs(turn) > CORNER * box_of(r, k, rate) * per_mm &&
		    BESIDE * goes_on < 1)
			return true;
	}
	return false;
}

/* How much each node turns over the chords in hand, and over narrower ones. */
struct turns {
	double mm;			/* of a chord */
	double *over, *narrow;
	uint8_t *corner;		/* which nodes are */
};

/*
 * Does node @i turn most of those around it, and others a chord away hardly?
 * There is no corner within the chord that shows over a narrower one.  A corner
 * turns as much there, but for what a rounding makes; a bend does not.
 */
static bool stands_out(const struct run *r, size_t i, const struct turns *t)
{
	const double turn = t->over[i];
	struct chords c;

	if (turn <= 1 || turn > WIDER * (t->narrow[i] + 1))
		return false;
	c = chords_of(r, i, t->mm, 0, r->n - 1);
	if (BESIDE * larger(t->over[c.before], t->over[c.behind]) >= turn ||
	    memchr(t->corner + c.before, 1, c.behind - c.before + 1))
		return false;
	for (size_t k = c.before; k <= c.behind; k++)
		if (t->over[k] > turn || (k < i && t->over[k] == turn))
			return false;
	return true;
}

/* Those that lines show by themselves, and then those that show over wider and
 * wider chords: softer ones. */
static void mark_corners(const struct run *r, struct turns *t)
{
	for (size_t i = 1; i + 1 < r->n; i++) {
		t->corner[i] = is_sharp(r, i);
		t->over[i] = INFINITY;
	}
	t->mm = 0.95 * chord_mm(r);
	for (int n = 0; n < CHORDS; n++, t->mm *= WIDER) {
		double *const was = t->narrow;

		t->narrow = t->over;
		t->over = was;
		turns_of(r, t->mm, t->over);
		for (size_t i = 1; i + 1 < r->n; i++)
			t->corner[i] |= stands_out(r, i, t);
	}
}

/* -- Points ---------------------------------------------------------------- */

/* The nodes of a part, and what a rounding makes of each. */
struct points {
	struct shape_points of;
	double *box, *weight;
};

static void points_free(struct points *p)
{
	free(p->box);
	free(p->weight);
}

/* The boxes of a rounding, by the rates around each point. */
static void fill(struct points *p, const struct run *r)
{
	const struct shape_points *of = &p->of;
	size_t a = 0, b = 0;

	for (size_t i = 0; i < of->n; i++) {
		while (of->s_mm[i] - of->s_mm[a + 1] > RATE_MM)
			a++;
		while (b + 1 < of->n && of->s_mm[b] - of->s_mm[i] < RATE_MM)
			b++;
		p->weight[i] = (of->s_mm[i + 1 < of->n ? i + 1 : i] -
				of->s_mm[i > 0 ? i - 1 : i]) / 2;
		for (uint32_t k = 0; k < r->columns; k++) {
			const double rate = (of->x[b * r->columns + k] -
					     of->x[a * r->columns + k]) /
					    (of->s_mm[b] - of->s_mm[a]);

			p->box[i * r->columns + k] = box_of(r, k, rate);
		}
	}
}

static int points_make(struct points *p, const struct run *r, size_t first,
		       size_t last)
{
	const size_t n = last - first + 1;

	p->box = malloc(n * r->columns * sizeof(double));
	p->weight = malloc(n * sizeof(double));
	p->of = (struct shape_points) {
		.n = n, .columns = r->columns, .s_mm = r->s_mm + first,
		.x = r->x + first * r->columns, .box = p->box,
		.weight = p->weight,
	};
	if (p->box && p->weight) {
		fill(p, r);
		return 0;
	}
	points_free(p);
	return -ENOMEM;
}

/* -- Parts ----------------------------------------------------------------- */

/* Is column @k straight, within its boxes?  @ret: by so much in a mm. */
static bool is_straight(const struct shape_points *p, uint32_t k, double *ret)
{
	const double *at = p->x + k, *box = p->box + k;
	const size_t n = p->n, by = p->columns;
	double w = 0, s = 0, x = 0, ss = 0, sx = 0;

	for (size_t i = 0; i < n; i++) {
		w += p->weight[i];
		s += p->weight[i] * p->s_mm[i];
		x += p->weight[i] * at[i * by];
	}
	for (size_t i = 0; i < n; i++) {
		const double ds = p->s_mm[i] - s / w;

		ss += p->weight[i] * ds * ds;
		sx += p->weight[i] * ds * (at[i * by] - x / w);
	}
	*ret = sx / ss;
	for (size_t i = 0; i < n; i++)
		if (!(fabs(at[i * by] - x / w - *ret * (p->s_mm[i] - s / w)) <=
		      box[i * by]))
			return false;
	return true;
}

static bool is_line(const struct shape_points *p, struct run_part *ret)
{
	for (uint32_t k = 0; k < p->columns; k++)
		if (!is_straight(p, k, &ret->straight[k]))
			return false;
	return true;
}

/* Of a part that has no shape: the node near to @node that turns most. */
static size_t cut_at(const struct run *r, size_t node,
		     const struct run_part *part)
{
	const size_t first = part->first + 1, last = part->last - 1;
	const double mm = chord_mm(r);
	const struct chords near = chords_of(r, node < first ? first :
						node > last ? last : node,
					     2.5 * mm, first, last);
	size_t ret = near.before;
	double most = 0;

	for (size_t k = near.before; k <= near.behind; k++) {
		const struct chords c = chords_of(r, k, 0.95 * mm,
						  part->first, part->last);
		const double turn = turn_over(r, k, &c);

		if (turn > most)
			ret = k;
		most = larger(most, turn);
	}
	return ret;
}

/* Return: 0; @ret_cut: where to cut it, or its last node. */
static int fit(const struct run *r, struct run_part *part, size_t *ret_cut)
{
	struct points p;
	size_t corner;
	int err;

	*ret_cut = part->last;
	part->shape = (struct shape) { .columns = r->columns };
	if (points_make(&p, r, part->first, part->last) < 0)
		return -ENOMEM;
	if (is_line(&p.of, part)) {
		points_free(&p);
		return 0;
	}
	err = shape_fit(&p.of, &part->shape, &corner);
	if (err == 0 && corner < p.of.n) {
		*ret_cut = cut_at(r, part->first + corner, part);
		shape_free(&part->shape);
	}
	points_free(&p);
	return err;
}

/* Ends of parts that are still to be found, the next one last. */
struct ends {
	size_t *at, n, room;
};

static int push(struct ends *e, size_t node)
{
	if (e->n == e->room &&
	    grow_array(&e->at, &e->room, sizeof(*e->at)) < 0)
		return -ENOMEM;
	e->at[e->n++] = node;
	return 0;
}

static int find_corners(const struct run *r, struct ends *e)
{
	struct turns t = {
		.over = calloc(r->n, sizeof(double)),
		.narrow = calloc(r->n, sizeof(double)),
		.corner = calloc(r->n, 1),
	};
	int err = t.over && t.narrow && t.corner ? push(e, r->n - 1) : -ENOMEM;

	if (err == 0)
		mark_corners(r, &t);
	for (size_t i = r->n - 1; err == 0 && i-- > 1;)
		if (t.corner[i])
			err = push(e, i);
	free(t.over);
	free(t.narrow);
	free(t.corner);
	return err;
}

/* A part is looked for in a window, which grows as long as there is no corner
 * in it: so what a node costs does not depend on how far the run goes on. */
int sections_parts(const struct run *r,
	      int (*found)(void *to, struct run_part *p), void *to)
{
	struct ends ends = { NULL, 0, 0 };
	struct run_part part = { .first = 0 };
	int err = find_corners(r, &ends);
	size_t window = WINDOW;

	while (err == 0 && ends.n > 0) {
		const size_t end = ends.at[ends.n - 1];
		size_t cut;

		part.last = end - part.first > 2 * window ?
				    part.first + window : end;
		err = fit(r, &part, &cut);
		if (err == 0 && cut < part.last) {
			err = push(&ends, cut);
		} else if (err == 0 && part.last < end) {
			window *= WINDOWS;
			shape_free(&part.shape);
		} else {
			if (err == 0)
				err = found(to, &part);
			shape_free(&part.shape);
			part.first = part.last;
			window = WINDOW;
			ends.n--;
		}
	}
	free(ends.at);
	return err;
}

void sections_part_way(const struct run_part *p, double s_mm, double *ret)
{
	if (p->shape.n > 0) {
		shape_way(&p->shape, s_mm, ret);
		return;
	}
	for (uint32_t k = 0; k < p->shape.columns; k++) {
		double *way = ret + k * INTERP_AXES_WAY;

		way[0] = p->straight[k];
		way[1] = way[2] = 0;
	}
}
