/* SPDX-License-Identifier: Apache-2.0 */
/*
 * box.h - oriented boxes, and what the gap between two of them promises
 *
 * A walk through two trees does little but compare boxes.  So boxes are in
 * single precision, and four numbers are computed at a time.  Each bound is
 * made smaller by more than its rounding error (BOX_MARGIN), so that it stays a
 * bound.  Centres are in double precision, because what counts is the small
 * difference of two of them.
 *
 * Units: mm; time is the block's parameter.  Any thread.
 */
#ifndef PLAN_BOX_H
#define PLAN_BOX_H

#include "vec.h"

#include <stdint.h>

typedef float box_v4 __attribute__((vector_size(16)));
typedef int32_t box_i4 __attribute__((vector_size(16)));

/* A share of the sizes that go into a bound.  Rounding makes each term of a
 * bound wrong by a few times 2^-24 of them; this is 32 times 2^-24. */
#define BOX_MARGIN	2e-6f

struct box {
	box_v4 axis[3];			/* [k][i]: component k of axis i, a unit
					 * vector; [k][3] is 0 */
	box_v4 half;			/* by axis; [3]: their sum */
	double centre[3];
	uint32_t first;			/* child, or triangle of a leaf */
	uint32_t n;			/* triangles of a leaf; 0: not a leaf */
};

/* Where the electrode is at a moment, and how it moves. */
struct box_pose {
	float r[3][3];
	const struct rot *rot;		/* lent */
	const double *t;		/* lent */
	const double *v, *w;		/* lent; NULL: only distances are asked
					 * for */
	float accel;
};

/* A box of the electrode in the part's frame. */
struct box_placed {
	struct box at;
	box_v4 spin[3];			/* w x axis i, laid out as the axes */
	float go[3];			/* the motion of its centre */
	float off;			/* what the speed may be off by */
};

/* The gaps on the axes of both boxes, each a bound of the distance. */
struct box_gaps {
	box_v4 part, tool;		/* [3] is less than 0 */
	box_v4 part_at, tool_at;	/* of the way between the centres */
};

static inline box_v4 box_abs(box_v4 x)
{
	return (box_v4)((box_i4)x & INT32_MAX);
}

static inline box_v4 box_positive(box_v4 x)
{
	return (box_v4)((box_i4)x & (x > 0));
}

/* The dot products of each axis with x y z. */
static inline box_v4 box_along(const box_v4 axis[3], float x, float y, float z)
{
	return x * axis[0] + y * axis[1] + z * axis[2];
}

/* How far a box reaches to both sides of its centre along three directions at
 * once; @dir is laid out as the axes are. */
static inline box_v4 box_reach(const box_v4 axis[3], const box_v4 *half,
			       const box_v4 dir[3])
{
	box_v4 sum = { 0 };

	for (int j = 0; j < 3; j++)
		sum += (*half)[j] * box_abs(box_along(dir, axis[0][j],
						      axis[1][j], axis[2][j]));
	return sum;
}

static inline void box_gaps(const struct box *part, const struct box *tool,
			    struct box_gaps *g)
{
	const float x = (float)(tool->centre[0] - part->centre[0]);
	const float y = (float)(tool->centre[1] - part->centre[1]);
	const float z = (float)(tool->centre[2] - part->centre[2]);
	const float margin = BOX_MARGIN * (fabsf(x) + fabsf(y) + fabsf(z) +
					   part->half[3] + tool->half[3]);

	g->part_at = box_along(part->axis, x, y, z);
	g->tool_at = box_along(tool->axis, x, y, z);
	g->part = box_abs(g->part_at) - margin - part->half -
		  box_reach(tool->axis, &tool->half, part->axis);
	g->tool = box_abs(g->tool_at) - margin - tool->half -
		  box_reach(part->axis, &part->half, tool->axis);
}

/* The square of the distance that the gaps on three axes make together.  Boxes
 * with gaps on two or three axes are farther apart than on any one of them. */
static inline float box_beside2(box_v4 gaps)
{
	const box_v4 g = box_positive(gaps), sq = g * g;

	return sq[0] + sq[1] + sq[2];
}

/** box_distance() - a lower bound of their distance; 0 if they may meet. */
static inline float box_distance(const struct box *part, const struct box *tool)
{
	struct box_gaps g;
	float a, b;

	box_gaps(part, tool, &g);
	a = box_beside2(g.part);
	b = box_beside2(g.tool);
	return sqrtf(a > b ? a : b);
}

/** box_place() - bring a box of the electrode into the part's frame. */
static inline void box_place(const struct box *in, const struct box_pose *pose,
			     struct box *ret)
{
	for (int k = 0; k < 3; k++)
		ret->axis[k] = box_along(in->axis, pose->r[k][0],
					 pose->r[k][1], pose->r[k][2]);
	ret->half = in->half;
	rot_apply(pose->rot, in->centre, ret->centre);
	v_add(ret->centre, pose->t, ret->centre);
	ret->first = in->first;
	ret->n = in->n;
}

/** box_move() - as box_place(), and find how the box moves there. */
void box_move(const struct box *in, const struct box_pose *pose,
	      struct box_placed *ret);

struct box_keep {
	float mm;			/* the distance to be kept now */
	float rises;			/* how much it grows in a unit of
					 * time */
	float accel;			/* as in struct pose_rate */
	float enough;			/* no longer time is needed */
};

/**
 * box_time() - for how long no point of @tool comes nearer to @part than @keep.
 *
 * In a time x, nothing in the electrode's box moves along n by more than s x +
 * A x^2 / 2, where s is the greatest n . (v + w x p) in the box.  As long as
 * this is less than the gap along n minus @keep, the pair is not nearer than
 * @keep.  Each axis gives such a time, and the longest of them holds.
 * Return: that time, but no more than keep->enough; 0: not at all.
 */
float box_time(const struct box *part, const struct box_placed *tool,
	       const struct box_keep *keep);

#endif /* PLAN_BOX_H */
