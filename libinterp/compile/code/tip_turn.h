/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_turn.h - a way of the tool's tip and direction: the rotary axes are found
 *
 * A direction gives the rotary axes, except for the branch of the solution.
 * They are followed from where they stand, in steps so small that the nearest
 * solution is on the same branch.  Where the tool comes to lie along a rotary
 * axis, that axis may have to turn at once.  Then it turns in place: the tip
 * goes on by less than can be seen.
 */
#ifndef CODE_TIP_TURN_H
#define CODE_TIP_TURN_H

#include "code/reader.h"

/* The pose that is wanted at one place of a way. */
struct nc_pose {
	double mm[INTERP_NAXES];	/* X Y Z of the tip, and the axes that
					 * do not turn the tool */
	double dir[3];			/* from the tip into the holder; 0:
					 * there is no such pose */
	double q[4];			/* for a body: its rotation, a unit
					 * quaternion w x y z */
};

struct nc_pose_way {
	void (*at)(const void *of, double t, struct nc_pose *ret);	/* 0 ...
									 * 1 */
	const void *of;
	bool body;			/* a rotary axis that rolls the tool, if
					 * there is one, follows q */
};

/**
 * nc_pose_way() - move the axes along @w, which begins where they stand, except
 * for rounding; r->word has the rest.  The tip keeps the promises of
 * nc_tip_way(), and so do the rotary axes, compared with the angles of the true
 * direction.
 *
 * Return: 0, or refused with the line of r->word.
 */
int nc_pose_way(struct nc_reader *r, const struct nc_pose_way *w);

/** nc_pose_turned() - the rotation of a body at the axes @axes, w >= 0. */
void nc_pose_turned(const struct interp_kinematics *k,
		    const double axes[INTERP_NAXES], double ret[4]);

/** nc_pose_turn() - turn @v by the unit quaternion @q, in place. */
void nc_pose_turn(const double q[4], double v[3]);

/** nc_pose_roll() - the joint that rolls the tool; -1: none. */
int nc_pose_roll(const struct interp_kinematics *k);

/* tip_body.c: G6.3. */
int nc_body(struct nc_reader *r);

#endif /* CODE_TIP_TURN_H */
