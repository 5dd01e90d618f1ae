/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near.h - how near the electrode is to the part
 *
 * It walks through two trees of boxes at once.  A pose takes a place in the
 * frame of the electrode's mesh to a place in the part's frame.
 *
 * Units: mm.
 * Threads: any, each with its own struct near_pair.
 */
#ifndef PLAN_NEAR_H
#define PLAN_NEAR_H

#include "tree.h"

#include <stdbool.h>

struct pose {
	struct rot r;			/* part = r electrode + t */
	double t[3];
};

/* How the electrode moves at one moment: the point p (in the part's frame) has
 * the velocity v + w x p, and no point has more acceleration than accel. */
struct pose_rate {
	double v[3], w[3];		/* per unit of time */
	double accel;			/* for the whole of the block */
};

/* Two triangles and their nearest points, in the part's frame. */
struct near_pair {
	double mm;			/* 0: they meet */
	uint32_t part, tool;		/* triangles: numbers of the trees */
	double p[3], q[3];		/* on the part, on the electrode */
};

struct proved;

struct bodies {
	const struct tree *part, *tool;
	struct proved *proved;		/* blocks of them; NULL: not kept */
};

/**
 * near_distance() - the least distance at @pose.
 *
 * @pair has the triangles of the last answer, which are tried first, and gets
 * those of the new answer.  It is zeros at first.
 */
double near_distance(const struct bodies *b, const struct pose *pose,
		     struct near_pair *pair);

/** near_below() - is the distance less than @mm?  Then @pair is a pair that is
 *  so near. */
bool near_below(const struct bodies *b, const struct pose *pose, double mm,
		struct near_pair *pair);

#define NEAR_SLACK_MM		0.0005

/** near_less() - find a pair that is nearer than @mm, and farther than the
 *  nearest one by NEAR_SLACK_MM at most; otherwise @pair stays as it is.  One
 *  that is nearer than @mm by less may be missed.  Where walls face each other
 *  many pairs are equally near but for rounding, and near_distance() looks at
 *  all of them.  Return: was one found? */
bool near_less(const struct bodies *b, const struct pose *pose, double mm,
	       struct near_pair *pair);

#define NEAR_CELL_MM		5.0

/* Two nodes of the trees. */
struct near_patch {
	float mm;			/* a lower bound of their distance */
	uint32_t part, tool;
};

/* Called for each patch; false ends the walk. */
typedef bool near_take(void *arg, const struct near_patch *patch);

/** near_patches() - find all pairs of nodes that may be nearer than @mm.  A
 *  node is not much larger than NEAR_CELL_MM, or is a single triangle. */
void near_patches(const struct bodies *b, const struct pose *pose, double mm,
		  near_take *take, void *arg);

struct near_asked {
	double mm, slack_mm;
};

/**
 * near_between() - find the nearest triangles of two nodes, if they are nearer
 * than @mm.
 *
 * The pair that it finds may be farther apart than the nearest one by
 * @slack_mm. This saves most of the work where many pairs are about equally
 * near. Return: was one found?  Only then @pair is filled.
 */
bool near_between(const struct bodies *b, const struct pose *pose,
		  const struct near_patch *patch,
		  const struct near_asked *asked, struct near_pair *pair);

/** near_pose() - prepare a pose for box_place() and box_move(); @pose and @rate
 *  are lent. */
void near_pose(const struct pose *pose, const struct pose_rate *rate,
	       struct box_pose *ret);

/** near_tri() - get a triangle of the electrode in the part's frame. */
void near_tri(const struct bodies *b, const struct pose *pose, uint32_t tool,
	      struct triangle *ret);

#endif /* PLAN_NEAR_H */
