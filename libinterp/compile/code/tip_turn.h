/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_turn.h - a way of the tool's tip and direction: the rotaries are found
 *
 * Of a direction the rotaries are known but for the branch: they are followed
 * from where they stand in steps so small that the nearest solution is the same
 * branch.  Where the tool comes to stand along a rotary, that rotary may have to
 * turn at once: it turns in place, while the tip stands.
 */
#ifndef CODE_TIP_TURN_H
#define CODE_TIP_TURN_H

#include "code/reader.h"

/* What is wanted at a place of a way. */
struct nc_pose {
	double mm[INTERP_NAXES];	/* X Y Z of the tip; the axes that do not
					 * turn the tool */
	double dir[3];			/* from the tip into the holder; 0: the
					 * pose is none */
	double q[4];			/* of a body: its rotation, a unit
					 * quaternion w x y z */
};

struct nc_pose_way {
	void (*at)(const void *of, double t, struct nc_pose *ret);	/* 0 ... 1 */
	const void *of;
	bool body;			/* a rotary that rolls the tool, if there
					 * is one, follows q */
};

/**
 * nc_pose_way() - the axes along @w, which begins where they stand but for a
 * rounding; r->word has the rest.  The tip keeps the promises of nc_tip_way(),
 * and so do the rotaries against the angles of the true direction.
 *
 * Return: 0, or refused with the line of r->word.
 */
int nc_pose_way(struct nc_reader *r, const struct nc_pose_way *w);

/** nc_pose_turned() - the rotation of a body at the axes @axes, w >= 0. */
void nc_pose_turned(const struct interp_kinematics *k,
		    const double axes[INTERP_NAXES], double ret[4]);

/** nc_pose_turn() - @v turned by the unit quaternion @q, in place. */
void nc_pose_turn(const double q[4], double v[3]);

/** nc_pose_roll() - the joint that rolls the tool; -1: none. */
int nc_pose_roll(const struct interp_kinematics *k);

/* tip_body.c: G6.3. */
int nc_body(struct nc_reader *r);

#endif /* CODE_TIP_TURN_H */
