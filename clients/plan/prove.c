/* SPDX-License-Identifier: Apache-2.0 */
/*
 * prove.c - proves the clearance along a block, and finds the largest one
 */
#include "prove.h"

#include "proved.h"
#include "sweep.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* prove_least(): shares of what it is to be within.  It proves so much under
 * the least distance that was seen; a pair nearer than that by half is new. */
#define LEAST_KEEP	0.8
#define LEAST_EPS	0.4
#define DESCEND		0.05		/* of the search for the least */

/* prove_least() asks for no more than that: no gap is wider, and single
 * precision could not tell its share of PROVE_FINE_MM from nothing. */
#define LEAST_MOST_MM	100.0

/* A pose costs far less than a proof does before it comes to a contact. */
#define REFUTE_POSES	8

/* -- What is to be kept --------------------------------------------------- */

void clearance_init(struct clearance *c, double mm)
{
	*c = (struct clearance) { .mm = mm, .end_mm = mm };
}

static void place(const struct pose *pose, const double p[3], double ret[3])
{
	rot_apply(&pose->r, p, ret);
	v_add(ret, pose->t, ret);
}

void clearance_end(struct clearance *c, const struct mesh *tool,
		   const struct pose *end, double zone_mm, double end_mm)
{
	c->zone_mm = zone_mm;
	c->end_mm = end_mm;
	for (int i = 0; i < 8; i++) {
		for (int k = 0; k < 3; k++)
			c->corner[i][k] = i >> k & 1 ? tool->max[k] :
						       tool->min[k];
		place(end, c->corner[i], c->end[i]);
	}
}

/* How far the corners of a box round the electrode are from their end places.
 * No point of the electrode is farther from its own. */
static double from_end(const struct clearance *c, const struct pose *pose)
{
	double most = 0;

	for (int i = 0; i < 8; i++) {
		double at[3];

		place(pose, c->corner[i], at);
		most = fmax(most, v_distance(at, c->end[i]));
	}
	return most;
}

double clearance_at(const struct clearance *c, const struct pose *pose)
{
	double far;

	if (!(c->zone_mm > 0))
		return c->mm;
	far = from_end(c, pose);
	if (far >= c->zone_mm)
		return c->mm;
	return c->end_mm + (c->mm - c->end_mm) * far / c->zone_mm;
}

/* -- Proofs --------------------------------------------------------------- */

struct asked {
	const struct clearance *clear;
	const struct block *block;
};

/* What is to be kept rises with the distance of from_end(), and that by no more
 * than the corners move. */
static void keep_from(void *arg, const struct pose *pose,
		      struct sweep_keep *ret)
{
	const struct asked *a = arg;
	const struct clearance *c = a->clear;
	const double way = a->block->corner_way_mm;

	ret->most_mm = c->zone_mm > 0 ? fmax(c->mm, c->end_mm) : c->mm;
	ret->mm = ret->most_mm;
	ret->rises = 0;
	if (!(c->zone_mm > 0) || c->end_mm >= c->mm)
		return;
	ret->mm = clearance_at(c, pose);
	ret->rises = (c->mm - c->end_mm) / c->zone_mm * way;
}

bool prove_block(const struct bodies *bodies, const struct block *b,
		 const struct clearance *c, struct proof *p)
{
	struct asked asked = { c, b };
	struct sweep s = { .bodies = bodies, .block = b, .keep = keep_from,
			   .eps_mm = PROVE_EPS_MM, .arg = &asked };
	int kept;

	/* In an end zone more than c->mm says is asked, and less. */
	if (!(c->zone_mm > 0) && proved_keeps(bodies->proved, b, c->mm))
		return true;
	kept = sweep_block(&s);
	p->queries += s.poses;
	p->given_up = kept < 0;
	if (kept > 0 && !(c->zone_mm > 0))
		proved_put(bodies->proved, b, c->mm);
	if (kept == 0) {
		p->t = s.t;
		p->pair = s.pair;
		p->least_mm = s.pair.mm;
	}
	return kept > 0;
}

/* 1/2, 1/4, 3/4, 1/8 ... for 1, 2, 3, 4 ...: the middle first, where a block is
 * farthest from the path. */
static double halved(unsigned int i)
{
	double ret = 0;

	for (double bit = 0.5; i; i >>= 1, bit /= 2)
		ret += i & 1 ? bit : 0;
	return ret;
}

bool prove_refuted(const struct bodies *bodies, const struct block *b,
		   const struct clearance *c, struct proof *p)
{
	for (unsigned int i = 1; i < REFUTE_POSES; i++) {
		const double t = halved(i);
		struct pose pose;

		block_pose(b, t, &pose, NULL);
		p->queries++;
		if (!near_below(bodies, &pose, clearance_at(c, &pose),
				&p->pair))
			continue;
		p->t = t;
		p->least_mm = p->pair.mm;
		return true;
	}
	return false;
}

/* -- The most that can be proved ------------------------------------------ */

struct least {
	const struct bodies *bodies;
	const struct block *b;
	struct near_pair pair;
	struct proof *p;
	double within_mm;
	double keep_mm;
};

/* Is it nearer at @t than all that was seen? */
static bool see(struct least *l, double t)
{
	struct pose pose;

	block_pose(l->b, t, &pose, NULL);
	l->p->queries++;
	if (!near_less(l->bodies, &pose, l->p->least_mm, &l->pair))
		return false;
	l->p->least_mm = l->pair.mm;
	l->p->t = t;
	l->p->pair = l->pair;
	return true;
}

/* Find the least distance near @t.  Otherwise the proof would find every step
 * on the way down to it.  No step is so short that it could not matter. */
static void descend(struct least *l, double t)
{
	const double enough_mm = DESCEND * l->within_mm;
	double h = 1.0 / 32;

	while (h * l->b->way_mm > enough_mm && l->p->least_mm > 0) {
		const double at = t;

		for (int side = -1; side <= 1; side += 2) {
			const double to = fmin(fmax(at + side * h, 0), 1);

			if (to != at && see(l, to))
				t = to;
		}
		if (t == at)
			h /= 2;
	}
	l->keep_mm = fmin(l->p->least_mm, LEAST_MOST_MM) -
		     LEAST_KEEP * l->within_mm;
}

static void keep_least(void *arg, const struct pose *pose,
		       struct sweep_keep *ret)
{
	const struct least *l = arg;

	(void)pose;
	*ret = (struct sweep_keep) { l->keep_mm, l->keep_mm, 0 };
}

static bool lower(void *arg, double t, const struct near_pair *pair)
{
	struct least *l = arg;

	if (pair->mm >= l->keep_mm + LEAST_EPS * l->within_mm)
		return true;	/* lowered since that moment was taken */
	l->pair = *pair;
	see(l, t);
	descend(l, t);
	return l->keep_mm > 0;
}

double prove_least(const struct bodies *bodies, const struct block *b,
		   double within_mm, struct proof *p)
{
	struct least l = { .bodies = bodies, .b = b, .pair = p->pair, .p = p,
			   .within_mm = within_mm };
	struct sweep s = { .bodies = bodies, .block = b, .keep = keep_least,
			   .lower = lower, .eps_mm = LEAST_EPS * within_mm,
			   .arg = &l };
	int kept;

	p->least_mm = DBL_MAX;
	for (int i = 0; i <= 8; i++)
		see(&l, i / 8.0);
	descend(&l, p->t);
	kept = l.keep_mm > 0 ? sweep_block(&s) : 0;
	p->queries += s.poses;
	if (kept <= 0)
		return -1;
	proved_put(bodies->proved, b, l.keep_mm);
	return l.keep_mm;
}
