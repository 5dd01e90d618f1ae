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
	double slack;			/* a pair that is nearer by less is
					 * not looked for */
	struct near_pair *pair;
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
	const struct apart far = { .least_mm = w->best - w->slack };
	struct near_pair x = { .part = part, .tool = tool };

	if (apart_seen(&far, &t->tri[part], t->plane[part], at))
		return;
	x.mm = tri_distance(&t->tri[part], at, x.p, x.q);
	if (x.mm >= w->best)
		return;
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

		if (!w->over && bound[at] < w->best - w->slack)
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

		if (!w->over && bound[at] < w->best - w->slack)
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

bool near_less(const struct bodies *b, const struct pose *pose, double mm,
	       struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = mm, .pair = pair,
			  .slack = NEAR_SLACK_MM };

	walk_all(&w);
	return w.best < mm;
}

bool near_between(const struct bodies *b, const struct pose *pose,
		  const struct near_patch *patch,
		  const struct near_asked *asked, struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = asked->mm,
			  .slack = asked->slack_mm, .pair = pair };
	struct box placed;

	near_pose(pose, NULL, &w.at);
	box_place(&b->tool->node[patch->tool], &w.at, &placed);
	visit(&w, &b->part->node[patch->part], &placed);
	return w.best < asked->mm;
}

/* -- Patches -------------------------------------------------------------- */

struct patches {
	const struct bodies *b;
	struct box_pose at;
	double mm;
	near_take *take;
	void *arg;
};

static bool is_small(const struct box *x)
{
	return x->n || x->half[3] <= (float)NEAR_CELL_MM;
}

/* Return: false to end the walk. */
static bool patches(const struct patches *p, uint32_t part, uint32_t tool,
		    const struct box *placed)
{
	const struct box *x = &p->b->part->node[part];
	const float mm = box_distance(x, placed);
	const bool small_part = is_small(x), small = is_small(placed);

	if ((double)mm >= p->mm)
		return true;
	if (small_part && small) {
		const struct near_patch ret = { mm, part, tool };

		return p->take(p->arg, &ret);
	}
	if (small || (!small_part && x->half[3] > placed->half[3]))
		return patches(p, x->first, tool, placed) &&
		       patches(p, x->first + 1, tool, placed);
	for (uint32_t i = placed->first; i < placed->first + 2; i++) {
		struct box child;

		box_place(&p->b->tool->node[i], &p->at, &child);
		if (!patches(p, part, i, &child))
			return false;
	}
	return true;
}

void near_patches(const struct bodies *b, const struct pose *pose, double mm,
		  near_take *take, void *arg)
{
	struct patches p = { .b = b, .mm = mm, .take = take, .arg = arg };
	struct box placed;

	near_pose(pose, NULL, &p.at);
	box_place(b->tool->node, &p.at, &placed);
	patches(&p, 0, 0, &placed);
}
