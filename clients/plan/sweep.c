/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sweep.c - pairs of boxes in the order of the time until which they are apart
 *
 * The bounds of box.h and apart.h hold for a time, whatever else happens.  So
 * each pair has its own time at which it is looked at again.  These times are
 * sorted into BINS bins.  All pairs of a bin are looked at where the bin
 * begins, with one pose; that is never too late.  A pair of boxes whose bound
 * holds for a short time only is split.  A pair of leaves is followed by
 * itself through the bin.
 */
#include "sweep.h"

#include "apart.h"
#include "grow.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>

#define BINS		256

/* Boxes that are apart for less than that are split. */
#define SPLIT		(1.0 / 32)

/* Looks at pairs of leaves, after which a block is given up as too near. */
#define LOOKS_MAX	200000000u

#define NONE		UINT32_MAX

struct pair {
	uint32_t part, tool;		/* nodes of the trees */
	uint32_t next;			/* in its bin */
};

struct moment {
	double t;
	struct pose pose;
	struct pose_rate rate;
	struct box_pose at;
	struct sweep_keep keep;
};

struct state {
	struct sweep *s;
	struct pair *pair;
	uint32_t npairs, unused;
	size_t room;
	uint32_t bin[BINS];
	double end;			/* of the bin that is gone through */
	uint32_t looks;
	int err;
};

static void look(struct state *x, double t, struct moment *m)
{
	struct sweep *s = x->s;

	m->t = t;
	block_pose(s->block, t, &m->pose, &m->rate);
	near_pose(&m->pose, &m->rate, &m->at);
	m->at.accel = (float)m->rate.accel * (1 + BOX_MARGIN);
	s->keep(s->arg, &m->pose, &m->keep);
	s->poses++;
}

static void put(struct state *x, uint32_t part, uint32_t tool, double t)
{
	uint32_t *bin = &x->bin[(int)(t * BINS)];
	uint32_t i = x->unused;

	if (i != NONE) {
		x->unused = x->pair[i].next;
	} else if (x->npairs == x->room &&
		   grow_array(&x->pair, &x->room, sizeof(*x->pair))) {
		x->err = -ENOMEM;
		return;
	} else {
		i = x->npairs++;
	}
	x->pair[i] = (struct pair) { part, tool, *bin };
	*bin = i;
}

/* -- One pair ------------------------------------------------------------- */

/* The pair is too near.  Return: true if less is asked now, so it is to be
 * looked at once more. */
static bool refuse(struct state *x, struct moment *m,
		   const struct near_pair *pair)
{
	struct sweep *s = x->s;

	if (s->lower && s->lower(s->arg, m->t, pair)) {
		s->keep(s->arg, &m->pose, &m->keep);
		return true;
	}
	if (m->t < s->t) {
		s->t = m->t;
		s->pair = *pair;
	}
	return false;
}

/* For how long two triangles are as far apart as @far says. 0: they are too
 * near now, and @pair has them. */
static double tri_time(const struct bodies *b, const struct apart *far,
		       const struct triangle *at, struct near_pair *pair)
{
	const struct triangle *part = &b->part->tri[pair->part];

	if (apart_seen(far, part, b->part->plane[pair->part], at))
		return far->time;
	pair->mm = tri_distance(part, at, pair->p, pair->q);
	if (pair->mm < far->least_mm)
		return 0;
	return apart_time(far, at, pair->mm, pair->p, pair->q);
}

static double leaf_time(const struct state *x, const struct moment *m,
			const struct box *part, const struct box *tool,
			struct near_pair *pair)
{
	const struct bodies *b = x->s->bodies;
	struct apart far = { .rate = &m->rate, .keep_mm = m->keep.mm,
			     .rises = m->keep.rises,
			     .least_mm = m->keep.mm + x->s->eps_mm,
			     .time = 1 - m->t };

	for (uint32_t j = tool->first; j < tool->first + tool->n; j++) {
		struct triangle at;

		near_tri(b, &m->pose, j, &at);
		for (uint32_t i = part->first; i < part->first + part->n &&
					       far.time > 0; i++) {
			pair->part = i;
			pair->tool = j;
			far.time = fmin(far.time, tri_time(b, &far, &at, pair));
		}
	}
	return far.time;
}

/* For how long two boxes keep what is asked: the most on the block, or else
 * what is asked here, as it rises. */
static double pair_time(const struct moment *m, const struct box *part,
			const struct box_placed *tool)
{
	const struct sweep_keep *k = &m->keep;
	const float left = (float)(1 - m->t) * (1 + 0x1p-20f);
	struct box_keep keep = { .mm = (float)k->most_mm,
				 .accel = m->at.accel, .enough = left };
	const float time = box_time(part, tool, &keep);

	if (k->mm >= k->most_mm || (double)time >= SPLIT)
		return (double)time;
	keep.mm = (float)k->mm;
	keep.rises = (float)k->rises;
	return (double)fmaxf(time, box_time(part, tool, &keep));
}

/* The same of two leaves; 0: too near. */
static double leaves_time(struct state *x, struct moment *m,
			  const struct box *part, const struct box *tool)
{
	struct near_pair pair = { 0 };
	double time;

	do {
		time = leaf_time(x, m, part, tool, &pair);
		if (x->looks++ > LOOKS_MAX)
			x->err = -ELOOP;
	} while (!(time > 0) && refuse(x, m, &pair) && x->err == 0);
	return time;
}

static void settle(struct state *x, struct moment *m, uint32_t part,
		   uint32_t tool);

static void split(struct state *x, struct moment *m, uint32_t part,
		  uint32_t tool)
{
	const struct box *p = &x->s->bodies->part->node[part];
	const struct box *q = &x->s->bodies->tool->node[tool];

	if (q->n || (!p->n && p->half[3] > q->half[3])) {
		settle(x, m, p->first, tool);
		settle(x, m, p->first + 1, tool);
	} else {
		settle(x, m, part, q->first);
		settle(x, m, part, q->first + 1);
	}
}

/* Follow a pair from @m on, until it is put into a later bin, or split, or
 * apart until the end. */
static void settle(struct state *x, struct moment *m, uint32_t part,
		   uint32_t tool)
{
	const struct box *p = &x->s->bodies->part->node[part];
	const struct box *q = &x->s->bodies->tool->node[tool];
	const bool leaves = p->n && q->n;
	struct moment own;

	while (m->t < x->s->t && x->err == 0) {
		struct box_placed placed;
		double time;

		box_move(q, &m->at, &placed);
		time = pair_time(m, p, &placed);
		if (leaves && time < SPLIT)
			time = fmax(time, leaves_time(x, m, p, q));
		if (m->t + time >= 1 || !(time > 0 || !leaves))
			return;
		if (!leaves && time < SPLIT) {
			split(x, m, part, tool);
			return;
		}
		if (m->t + time >= x->end) {
			put(x, part, tool, m->t + time);
			return;
		}
		look(x, m->t + time, &own);
		m = &own;
	}
}

/* -- All pairs ------------------------------------------------------------ */

static void go_through(struct state *x, int i)
{
	struct moment m;

	look(x, (double)i / BINS, &m);
	x->end = (double)(i + 1) / BINS;
	while (x->bin[i] != NONE && x->err == 0) {
		const uint32_t at = x->bin[i];
		const struct pair pair = x->pair[at];

		x->bin[i] = pair.next;
		x->pair[at].next = x->unused;
		x->unused = at;
		settle(x, &m, pair.part, pair.tool);
	}
}

int sweep_block(struct sweep *s)
{
	struct state x = { .s = s, .unused = NONE };

	s->t = DBL_MAX;
	for (int i = 0; i < BINS; i++)
		x.bin[i] = NONE;
	put(&x, 0, 0, 0);
	for (int i = 0; i < BINS && s->t == DBL_MAX && x.err == 0; i++)
		if (x.bin[i] != NONE)
			go_through(&x, i);
	free(x.pair);
	return x.err ? x.err : s->t == DBL_MAX;
}
