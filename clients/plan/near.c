/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near.c - two trees of boxes walked at once
 *
 * A pair of boxes is left out if it cannot hold a nearer pair of triangles than
 * the best so far.  A box of the electrode is brought into the part's frame
 * once, and is then compared with several boxes of the part.
 */
#include "near.h"

#include "apart.h"

#include <float.h>
#include <stddef.h>

struct walk {
	const struct bodies *b;
	const struct pose *pose;
	struct box_pose at;
	double best;			/* less wins */
	double refuse;			/* what is no more than that ends it */
	struct near_pair *pair;
	near_take *take;
	void *arg;
	bool over;
};

void near_pose(const struct pose *pose, const struct pose_rate *rate,
	       struct box_pose *ret)
{
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			ret->r[i][k] = (float)pose->r.m[i][k];
	ret->rot = &pose->r;
	ret->t = pose->t;
	ret->v = rate ? rate->v : NULL;
	ret->w = rate ? rate->w : NULL;
}

void near_tri(const struct bodies *b, const struct pose *pose, uint32_t tool,
	      struct triangle *ret)
{
	for (int k = 0; k < 3; k++) {
		rot_apply(&pose->r, b->tool->tri[tool].at[k], ret->at[k]);
		v_add(ret->at[k], pose->t, ret->at[k]);
	}
}

/* -- Triangles ------------------------------------------------------------ */

static void offer(struct walk *w, uint32_t part, uint32_t tool,
		  const struct triangle *at)
{
	const struct tree *t = w->b->part;
	const struct apart far = { .least_mm = w->best };
	struct near_pair x = { .part = part, .tool = tool };

	if (apart_seen(&far, &t->tri[part], t->plane[part], at))
		return;
	x.mm = tri_distance(&t->tri[part], at, x.p, x.q);
	if (x.mm >= w->best)
		return;
	if (w->take) {
		w->over = !w->take(w->arg, &x);
		return;
	}
	w->best = x.mm;
	*w->pair = x;
	w->over = x.mm <= w->refuse;
}

static void leaves(struct walk *w, const struct box *part,
		   const struct box *tool)
{
	for (uint32_t j = tool->first; j < tool->first + tool->n; j++) {
		struct triangle at;

		near_tri(w->b, w->pose, j, &at);
		for (uint32_t i = part->first; i < part->first + part->n; i++) {
			offer(w, i, j, &at);
			if (w->over)
				return;
		}
	}
}

/* -- The walk ------------------------------------------------------------- */

static void visit(struct walk *w, const struct box *part,
		  const struct box *placed);

/* The child that promises less first: it may end the other's visit. */
static void visit_part(struct walk *w, const struct box *part,
		       const struct box *placed)
{
	const struct box *child = &w->b->part->node[part->first];
	const double bound[2] = { (double)box_distance(&child[0], placed),
				  (double)box_distance(&child[1], placed) };
	const int first = bound[1] < bound[0];

	for (int k = 0; k < 2; k++) {
		const int at = k ? !first : first;

		if (!w->over && bound[at] < w->best)
			visit(w, &child[at], placed);
	}
}

static void visit_tool(struct walk *w, const struct box *part,
		       const struct box *tool)
{
	const struct box *child = &w->b->tool->node[tool->first];
	struct box placed[2];
	double bound[2];
	int first;

	for (int k = 0; k < 2; k++) {
		box_place(&child[k], &w->at, &placed[k]);
		bound[k] = (double)box_distance(part, &placed[k]);
	}
	first = bound[1] < bound[0];
	for (int k = 0; k < 2; k++) {
		const int at = k ? !first : first;

		if (!w->over && bound[at] < w->best)
			visit(w, part, &placed[at]);
	}
}

static void visit(struct walk *w, const struct box *part,
		  const struct box *placed)
{
	if (part->n && placed->n)
		leaves(w, part, placed);
	else if (placed->n || (!part->n && part->half[3] > placed->half[3]))
		visit_part(w, part, placed);
	else
		visit_tool(w, part, placed);
}

/* What was nearest last time is near again. */
static void try_last(struct walk *w)
{
	struct triangle at;

	if (w->pair->part >= w->b->part->ntris ||
	    w->pair->tool >= w->b->tool->ntris)
		return;
	near_tri(w->b, w->pose, w->pair->tool, &at);
	offer(w, w->pair->part, w->pair->tool, &at);
}

static void walk_all(struct walk *w)
{
	const struct box *part = w->b->part->node;
	struct box placed;

	near_pose(w->pose, NULL, &w->at);
	if (w->pair)
		try_last(w);
	if (w->over)
		return;
	box_place(w->b->tool->node, &w->at, &placed);
	if ((double)box_distance(part, &placed) < w->best)
		visit(w, part, &placed);
}

double near_distance(const struct bodies *b, const struct pose *pose,
		     struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = DBL_MAX,
			  .pair = pair };

	walk_all(&w);
	return pair->mm;
}

bool near_below(const struct bodies *b, const struct pose *pose, double mm,
		struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = mm, .pair = pair,
			  .refuse = DBL_MAX };

	walk_all(&w);
	return w.over;
}

void near_within(const struct bodies *b, const struct pose *pose, double mm,
		 near_take *take, void *arg)
{
	struct walk w = { .b = b, .pose = pose, .best = mm, .take = take,
			  .arg = arg };

	walk_all(&w);
}
