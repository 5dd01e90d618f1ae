/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near.c - two trees of boxes walked at once
 *
 * A pair of boxes is left out if it cannot better the best so far.  A box of
 * the electrode is brought into the part's frame once and is then compared with
 * as many boxes of the part as needed.
 *
 * The gaps of two boxes along the three axes of one of them bound their
 * distance from below.  The same gap g along n bounds the time: what is in the electrode's box
 * comes toward the part by at most s x + A x^2 / 2 in a time x, where s is the
 * greatest n . (v + w x p) in the box.  Until that is g - keep the pair cannot
 * be nearer than keep.  Each axis gives such a time; the longest holds.
 */
#include "near.h"

#include "tri.h"

#include <float.h>
#include <string.h>

/* Taken off the gap of two triangles, far more than their arithmetic is off. */
#define ROUNDING_MM	1e-9

/* Directions in which a gap of two triangles is looked for. */
#define BESIDE_STEPS	4

struct walk {
	const struct bodies *b;
	const struct pose *pose;
	const struct pose_rate *rate;	/* NULL: distances are asked for */
	double keep, refuse;
	double best;			/* a distance or a time; less wins */
	struct near_pair *pair;
	near_take *take;
	void *arg;
	bool over;
};

static void box_place(const struct walk *w, const struct box *in,
		      struct box *ret)
{
	for (int i = 0; i < 3; i++)
		rot_apply(&w->pose->r, in->axis.m[i], ret->axis.m[i]);
	rot_apply(&w->pose->r, in->centre, ret->centre);
	v_add(ret->centre, w->pose->t, ret->centre);
	memcpy(ret->half, in->half, sizeof(ret->half));
}

/* Until s x + A x^2 / 2 is @gap > 0. */
static double root(double gap, double s, double accel)
{
	double b;

	if (accel <= 0)
		return s > 0 ? gap / s : DBL_MAX;
	b = sqrt(s * s + 2 * accel * gap);
	return s > 0 ? 2 * gap / (s + b) : (b - s) / accel;
}

/* -- Boxes ---------------------------------------------------------------- */

struct gaps {
	double between[3];		/* from the part's centre to the tool's */
	double along[6];		/* gap on each axis: 3 of the part's box,
					 * 3 of the tool's */
	double sign[6];
	double beside[2];		/* all gaps on the part's axes together,
					 * and on the tool's: no less than the
					 * widest of them */
	int widest;
};

/* How far a box reaches along @n from its centre. */
static double box_reach(const struct box *b, const double n[3])
{
	return b->half[0] * fabs(v_dot(b->axis.m[0], n)) +
	       b->half[1] * fabs(v_dot(b->axis.m[1], n)) +
	       b->half[2] * fabs(v_dot(b->axis.m[2], n));
}

/* @enough: a gap like that ends the search; false then, for the others are not
 * filled. */
static bool box_gaps(const struct box *part, const struct box *tool,
		     double enough, struct gaps *g)
{
	double r[3][3];

	v_sub(tool->centre, part->centre, g->between);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			r[i][j] = fabs(v_dot(part->axis.m[i], tool->axis.m[j]));
	g->widest = 0;
	g->beside[0] = g->beside[1] = 0;
	for (int k = 0; k < 6; k++) {
		const int i = k % 3;
		const double *n = k < 3 ? part->axis.m[i] : tool->axis.m[i];
		const double at = v_dot(n, g->between);
		double reach = k < 3 ? part->half[i] : tool->half[i];

		for (int j = 0; j < 3; j++)
			reach += k < 3 ? tool->half[j] * r[i][j] :
					 part->half[j] * r[j][i];
		g->sign[k] = at < 0 ? -1 : 1;
		g->along[k] = fabs(at) - reach;
		if (g->along[k] > g->along[g->widest])
			g->widest = k;
		if (g->along[k] > 0)
			g->beside[k / 3] += g->along[k] * g->along[k];
		if (g->beside[k / 3] >= enough * enough)
			return false;
	}
	g->beside[0] = sqrt(g->beside[0]);
	g->beside[1] = sqrt(g->beside[1]);
	return true;
}

/* The time the gap @g on the way @n, from the tool to the part, holds. */
static double box_time(const struct walk *w, const struct box *tool,
		       const double n[3], double gap)
{
	double m[3], s;

	v_cross(n, w->rate->w, m);
	s = v_dot(n, w->rate->v) + v_dot(m, tool->centre) + box_reach(tool, m);
	return root(gap, s, w->rate->accel);
}

static double box_time_along(const struct walk *w, const struct box *part,
			     const struct box *tool, const struct gaps *g,
			     int k)
{
	const double *axis = k < 3 ? part->axis.m[k] : tool->axis.m[k - 3];
	double n[3];

	if (g->along[k] <= w->keep)
		return 0;
	for (int i = 0; i < 3; i++)
		n[i] = -g->sign[k] * axis[i];
	return box_time(w, tool, n, g->along[k] - w->keep);
}

/* Boxes that stand beside each other on two axes or three: the shortest way from
 * the one box (@of: 0 the part's, 1 the tool's) to a box round the other that is
 * turned like it. */
static double box_time_beside(const struct walk *w, const struct box *part,
			      const struct box *tool, const struct gaps *g,
			      int of)
{
	const struct box *axes = of ? tool : part;
	double n[3] = { 0, 0, 0 };

	if (g->beside[of] <= w->keep)
		return 0;
	for (int k = 0; k < 3; k++) {
		const double gap = g->along[3 * of + k];

		if (gap > 0)
			v_madd(n, -g->sign[3 * of + k] * gap / g->beside[of],
			       axes->axis.m[k], n);
	}
	return box_time(w, tool, n, g->beside[of] - w->keep);
}

/* Boxes that face each other by their corners: the way between the centres. */
static double box_time_between(const struct walk *w, const struct box *part,
			       const struct box *tool, const struct gaps *g)
{
	const double d = v_length(g->between);
	double n[3], gap;

	if (!(d > 0))
		return 0;
	for (int i = 0; i < 3; i++)
		n[i] = -g->between[i] / d;
	gap = d - box_reach(part, n) - box_reach(tool, n);
	if (gap <= w->keep)
		return 0;
	return box_time(w, tool, n, gap - w->keep);
}

/* A bound from below of what the two boxes can offer: stops looking for a
 * better one at w->best. */
static double box_bound(const struct walk *w, const struct box *part,
			const struct box *tool)
{
	struct gaps g;
	double most;

	if (!box_gaps(part, tool, w->rate ? DBL_MAX : w->best, &g))
		return w->best;
	if (!w->rate)
		return fmax(g.beside[0], g.beside[1]);
	most = box_time_along(w, part, tool, &g, g.widest);
	for (int k = 0; k < 6 && most < w->best; k++) {
		const double x = k == g.widest ? 0 :
				 box_time_along(w, part, tool, &g, k);

		most = x > most ? x : most;
	}
	for (int of = 0; of < 2 && most < w->best; of++)
		most = fmax(most, box_time_beside(w, part, tool, &g, of));
	if (most < w->best) {
		const double x = box_time_between(w, part, tool, &g);

		most = x > most ? x : most;
	}
	return most;
}

/* -- Triangles ------------------------------------------------------------ */

static void tri_place(const struct walk *w, uint32_t tool, struct triangle *ret)
{
	for (int k = 0; k < 3; k++) {
		rot_apply(&w->pose->r, w->b->tool->tri[tool].at[k], ret->at[k]);
		v_add(ret->at[k], w->pose->t, ret->at[k]);
	}
}

/* The time a pair of triangles holds, by the way between the nearest points. */
static double tri_time(const struct walk *w, const struct triangle *tool,
		       const struct near_pair *x)
{
	double n[3], m[3], s = -DBL_MAX;

	for (int i = 0; i < 3; i++)
		n[i] = (x->p[i] - x->q[i]) / x->mm;
	v_cross(n, w->rate->w, m);
	for (int k = 0; k < 3; k++) {
		const double at = v_dot(m, tool->at[k]);

		s = at > s ? at : s;
	}
	return root(x->mm - w->keep, s + v_dot(n, w->rate->v), w->rate->accel);
}

/* Is a gap along @n, a unit vector from the tool to the part, enough to leave the
 * pair out? */
static bool is_enough(const struct walk *w, const struct triangle *tool,
		      const double n[3], double gap)
{
	double m[3], s = -DBL_MAX;

	if (!w->rate)
		return gap >= w->best;
	if (gap <= w->refuse)
		return false;
	v_cross(n, w->rate->w, m);
	for (int k = 0; k < 3; k++)
		s = fmax(s, v_dot(m, tool->at[k]));
	return root(gap - w->keep, s + v_dot(n, w->rate->v),
		    w->rate->accel) >= w->best;
}

/* Over the plane of the part's triangle: along a wall that faces another it
 * mostly is. */
static bool is_over(const struct walk *w, uint32_t part,
		    const struct triangle *tool)
{
	const double *plane = w->b->part->plane[part];
	double h[3], n[3], side, gap;

	for (int k = 0; k < 3; k++)
		h[k] = v_dot(plane, tool->at[k]) - plane[3];
	side = h[0] > 0 ? 1 : -1;
	gap = fmin(side * h[0], fmin(side * h[1], side * h[2])) - ROUNDING_MM;
	if (gap <= 0)
		return false;
	for (int k = 0; k < 3; k++)
		n[k] = -side * plane[k];
	return is_enough(w, tool, n, gap);
}

static void middle(const struct triangle *t, double ret[3])
{
	for (int i = 0; i < 3; i++)
		ret[i] = (t->at[0][i] + t->at[1][i] + t->at[2][i]) / 3;
}

/* The way between the corners that are nearest along @v, as from @a to @b. */
static void nearest_along(const struct triangle *a, const struct triangle *b,
			  const double v[3], double ret[3])
{
	int i = 0, j = 0;

	for (int k = 1; k < 3; k++) {
		if (v_dot(a->at[k], v) > v_dot(a->at[i], v))
			i = k;
		if (v_dot(b->at[k], v) < v_dot(b->at[j], v))
			j = k;
	}
	v_sub(b->at[j], a->at[i], ret);
}

/*
 * A triangle that stands beside the other, not over it.  Any way v from one to
 * the other is a direction to measure the gap along; it is turned toward the
 * shortest by Frank and Wolfe's steps, and each costs a tenth of the distance.
 */
static bool is_beside(const struct walk *w, uint32_t part,
		      const struct triangle *tool)
{
	const struct triangle *at = &w->b->part->tri[part];
	double a[3], v[3];

	middle(at, a);
	middle(tool, v);
	v_sub(v, a, v);
	for (int i = 0; i < BESIDE_STEPS; i++) {
		const double d = v_length(v);
		double to[3], n[3], share;

		if (!(d > 0) || (!w->rate && d < w->best))
			return false;
		nearest_along(at, tool, v, to);
		for (int k = 0; k < 3; k++)
			n[k] = -v[k] / d;
		if (is_enough(w, tool, n, -v_dot(n, to) - ROUNDING_MM))
			return true;
		v_sub(to, v, to);
		share = -v_dot(v, to) / v_dot(to, to);
		if (!(share > 0))
			return false;
		v_madd(v, fmin(share, 1), to, v);
	}
	return false;
}

static void tri_offer(struct walk *w, uint32_t part, uint32_t tool,
		      const struct triangle *at)
{
	struct near_pair x = { .part = part, .tool = tool };
	double key;

	if (is_over(w, part, at) || is_beside(w, part, at))
		return;
	x.mm = tri_distance(&w->b->part->tri[part], at, x.p, x.q);
	if (w->take) {
		if (x.mm < w->best)
			w->over = !w->take(w->arg, &x);
		return;
	}
	if (w->rate && x.mm < w->refuse) {
		*w->pair = x;
		w->best = 0;
		w->over = true;
		return;
	}
	key = w->rate ? tri_time(w, at, &x) : x.mm;
	if (key >= w->best)
		return;
	w->best = key;
	*w->pair = x;
	w->over = !w->rate && x.mm <= w->refuse;
}

static void leaves(struct walk *w, const struct tree_node *part,
		   const struct tree_node *tool)
{
	for (uint32_t j = tool->first; j < tool->first + tool->n; j++) {
		struct triangle at;

		tri_place(w, j, &at);
		for (uint32_t i = part->first; i < part->first + part->n; i++) {
			tri_offer(w, i, j, &at);
			if (w->over)
				return;
		}
	}
}

/* -- The walk ------------------------------------------------------------- */

static double size2(const struct box *b)
{
	return v_dot(b->half, b->half);
}

static void visit(struct walk *w, const struct tree_node *part,
		  const struct tree_node *tool, const struct box *placed);

/* The child that promises less first: it may end the other's visit. */
static void visit_part(struct walk *w, const struct tree_node *part,
		       const struct tree_node *tool, const struct box *placed)
{
	const struct tree_node *child = &w->b->part->node[part->first];
	const double bound[2] = { box_bound(w, &child[0].box, placed),
				  box_bound(w, &child[1].box, placed) };
	const int first = bound[1] < bound[0];

	for (int k = 0; k < 2; k++) {
		const int at = k ? !first : first;

		if (!w->over && bound[at] < w->best)
			visit(w, &child[at], tool, placed);
	}
}

static void visit_tool(struct walk *w, const struct tree_node *part,
		       const struct tree_node *tool)
{
	const struct tree_node *child = &w->b->tool->node[tool->first];
	struct box placed[2];
	double bound[2];
	int first;

	for (int k = 0; k < 2; k++) {
		box_place(w, &child[k].box, &placed[k]);
		bound[k] = box_bound(w, &part->box, &placed[k]);
	}
	first = bound[1] < bound[0];
	for (int k = 0; k < 2; k++) {
		const int at = k ? !first : first;

		if (!w->over && bound[at] < w->best)
			visit(w, part, &child[at], &placed[at]);
	}
}

static void visit(struct walk *w, const struct tree_node *part,
		  const struct tree_node *tool, const struct box *placed)
{
	if (part->n && tool->n)
		leaves(w, part, tool);
	else if (tool->n || (!part->n && size2(&part->box) > size2(placed)))
		visit_part(w, part, tool, placed);
	else
		visit_tool(w, part, tool);
}

static void walk_all(struct walk *w)
{
	const struct tree_node *part = w->b->part->node;
	const struct tree_node *tool = w->b->tool->node;
	struct box placed;

	box_place(w, &tool->box, &placed);
	if (box_bound(w, &part->box, &placed) < w->best)
		visit(w, part, tool, &placed);
}

/* What was nearest last time is near again. */
static void try_last(struct walk *w)
{
	struct triangle at;

	if (w->pair->part >= w->b->part->ntris ||
	    w->pair->tool >= w->b->tool->ntris)
		return;
	tri_place(w, w->pair->tool, &at);
	tri_offer(w, w->pair->part, w->pair->tool, &at);
}

double near_distance(const struct bodies *b, const struct pose *pose,
		     struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = DBL_MAX,
			  .pair = pair };

	try_last(&w);
	if (!w.over)
		walk_all(&w);
	return pair->mm;
}

bool near_below(const struct bodies *b, const struct pose *pose, double mm,
		struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .best = mm, .pair = pair,
			  .refuse = DBL_MAX };

	try_last(&w);
	if (!w.over)
		walk_all(&w);
	return w.over;
}

double near_step(const struct bodies *b, const struct pose *pose,
		 const struct pose_rate *rate, const struct near_step *s,
		 struct near_pair *pair)
{
	struct walk w = { .b = b, .pose = pose, .rate = rate,
			  .keep = s->keep_mm, .refuse = s->refuse_mm,
			  .best = s->until, .pair = pair };

	try_last(&w);
	if (!w.over)
		walk_all(&w);
	return w.best;
}

void near_within(const struct bodies *b, const struct pose *pose, double mm,
		 near_take *take, void *arg)
{
	struct walk w = { .b = b, .pose = pose, .best = mm, .take = take,
			  .arg = arg };

	walk_all(&w);
}
