/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pose.h - a rigid body along a pair of NURBS with one parameter
 *
 * One curve leads the body's origin (X Y Z).  The other leads its rotation: a
 * quaternion w x y z, which is brought to length 1 at every point.  Both are
 * evaluated at the same u, so place and direction always belong together.
 *
 * Units: mm; rotations by unit quaternions, speeds per parameter, spin in
 * radian per parameter, right-handed.
 * Threads: RT-safe; nothing is allocated.
 */
#ifndef INTERP_POSE_H
#define INTERP_POSE_H

#include "interp/nurbs.h"

struct interp_pose_path {
	struct interp_nurbs_eval move;	/* three axes */
	struct interp_nurbs_eval turn;	/* four: w x y z */
};

struct interp_pose {
	double at_mm[3], d_mm[3];	/* origin, and its speed */
	double q[4], spin[3];		/* rotation, and its speed */
};

/**
 * interp_pose_open() - open two valid curves of three and of four axes.  They
 * must stay.
 * Return: 0, or -EINVAL if their axes or the ends of their domains differ.
 */
int interp_pose_open(struct interp_pose_path *p,
		     const struct interp_nurbs *move,
		     const struct interp_nurbs *turn);

/** interp_pose_at() - Return: 0, or -EDOM if the quaternion is 0 there. */
int interp_pose_at(struct interp_pose_path *p, double u,
		   struct interp_pose *ret);

/** interp_pose_apply() - where the body's point @body_mm is, and its speed. */
void interp_pose_apply(const struct interp_pose *p, const double body_mm[3],
		       double ret_mm[3], double ret_d_mm[3]);

#endif /* INTERP_POSE_H */
