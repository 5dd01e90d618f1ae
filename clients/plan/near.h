/* SPDX-License-Identifier: Apache-2.0 */
/*
 * near.h - how near the electrode is to the part
 *
 * Two trees of boxes are walked at once.  A pose takes places of the
 * electrode's mesh to places of the part's.
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

/* How the electrode moves at one moment: the point p (in the part's frame)
 * at v + w x p, and no point of it bends its way by more than accel. */
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

struct bodies {
	const struct tree *part, *tool;
};

/**
 * near_distance() - the least distance at @pose.
 *
 * @pair holds the triangles of the last answer, which are tried first, and
 * gets the new one: begin with a zeroed one.
 */
double near_distance(const struct bodies *b, const struct pose *pose,
		     struct near_pair *pair);

/** near_below() - is it less than @mm?  Then @pair is such a pair. */
bool near_below(const struct bodies *b, const struct pose *pose, double mm,
		struct near_pair *pair);

/** near_less() - the nearest pair, if it is nearer than @mm; else @pair stays.
 *  Return: whether. */
bool near_less(const struct bodies *b, const struct pose *pose, double mm,
	       struct near_pair *pair);

/* Two nodes of the trees. */
struct near_patch {
	float mm;			/* no less is between them */
	uint32_t part, tool;
};

/* Called with each; false ends the walk. */
typedef bool near_take(void *arg, const struct near_patch *patch);

/** near_patches() - all pairs of nodes that may be nearer than @mm, and neither
 *  of which is much larger than @size_mm if it is not a single triangle. */
void near_patches(const struct bodies *b, const struct pose *pose, double mm,
		  double size_mm, near_take *take, void *arg);

struct near_asked {
	double mm, slack_mm;
};

/**
 * near_between() - the nearest triangles of two nodes, if nearer than @mm.
 *
 * What it finds may be farther than the nearest by @slack_mm: where many pairs
 * are about as near as each other, that saves most of the work.
 * Return: whether; @pair is filled then only.
 */
bool near_between(const struct bodies *b, const struct pose *pose,
		  const struct near_patch *patch,
		  const struct near_asked *asked, struct near_pair *pair);

/** near_pose() - what boxes are placed with; @pose and @rate are lent. */
void near_pose(const struct pose *pose, const struct pose_rate *rate,
	       struct box_pose *ret);

/** near_tri() - a triangle of the electrode in the part's frame. */
void near_tri(const struct bodies *b, const struct pose *pose, uint32_t tool,
	      struct triangle *ret);

#endif /* PLAN_NEAR_H */
