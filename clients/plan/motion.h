/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motion.h - how the electrode moves in a block of the machine's own axes
 *
 * In a block every axis moves linearly with the same time, from 0 to 1.  The
 * points of the electrode do not move on straight lines if a rotary axis turns.
 *
 * The electrode's mesh is given in the machine's frame with all axes at 0.  The
 * part's mesh is given in the frame of the work, which is then the same frame.
 *
 * Units: mm; q is mm or, of a rotary, degrees.  Any thread.
 */
#ifndef PLAN_MOTION_H
#define PLAN_MOTION_H

#include "near.h"

#include "interp/kinematics.h"

struct machine_motion {
	const struct interp_kinematics *kin;	/* lent */
	double ball_mm[3], ball_r_mm;	/* a ball that contains the electrode,
					 * with all axes at 0 */
	double corner_mm;		/* how far a corner of the electrode's
					 * bounds is from the ball's middle */
};

/* One block, with bounds of the ways of its points. */
struct block {
	const struct machine_motion *m;	/* lent */
	double from[INTERP_NAXES], to[INTERP_NAXES];
	double reach_mm[INTERP_NAXES];	/* by joint of the chain: how far a unit
					 * (mm, radian) of it moves any point */
	double way_mm;			/* no point goes farther in the block */
	double corner_way_mm;		/* no corner of the bounding box of the
					 * electrode goes farther */
	double accel_mm;		/* bounds every second derivative */
};

/** motion_init() - for the electrode @tool. */
void motion_init(struct machine_motion *m, const struct interp_kinematics *kin,
		 const struct mesh *tool);

/** block_init() - @from and @to are copied. */
void block_init(struct block *b, const struct machine_motion *m,
		const double from[INTERP_NAXES], const double to[INTERP_NAXES]);

/** block_at() - the axes at time @t. */
void block_at(const struct block *b, double t, double q[INTERP_NAXES]);

/** block_pose() - the pose at @t; @rate may be NULL. */
void block_pose(const struct block *b, double t, struct pose *pose,
		struct pose_rate *rate);

/** motion_pose() - the pose at axes @q. */
void motion_pose(const struct machine_motion *m, const double q[INTERP_NAXES],
		 struct pose *pose);

/**
 * motion_jacobian() - how the point @p (part's frame) of the electrode moves
 * with each axis at @q: @ret[axis] per mm or degree; 0 for axes outside the
 * chain.
 */
void motion_jacobian(const struct machine_motion *m,
		     const double q[INTERP_NAXES], const double p[3],
		     double ret[INTERP_NAXES][3]);

/**
 * motion_strays_mm() - the most that any point is off, anywhere on @b, if every
 * axis is off by at most @off.
 */
double motion_strays_mm(const struct block *b, const double off[INTERP_NAXES]);

/** motion_moves() - a bit for each axis that the chain has. */
uint32_t motion_moves(const struct machine_motion *m);

#endif /* PLAN_MOTION_H */
