/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kinematics.h - from axes to the tool's tip and direction, and back
 *
 * A machine is one chain of joints from the work to the tool.  It does not
 * matter which joints are in the table and which in the head: only their order
 * counts.  Each joint moves the tool relative to the work, with the signs of
 * ISO 841.  So a table that goes left when X counts up is a joint that moves
 * the tool right.
 *
 *	C A X Y Z	trunnion table: C on A, under a head on X Y Z
 *	X Y Z C A	both rotaries in the head
 *	C X Y Z B	one in the table, one in the head
 *
 * A joint is a homogeneous transform: a linear joint is a translation along its
 * direction, a rotary joint a rotation about a line.  When all axes are at 0,
 * the frame of the work is the frame of the machine.  The lines of the rotary
 * joints and the tool are given for that place, so their offsets are simply the
 * points at_mm and tip_mm.
 *
 * Units: mm and degrees on axes; directions are unit vectors.
 * Sources: offset constants and transforms as in equations (5) to (8) of the
 * paper on sparse NC code (2017), for any order of joints by the product of
 * exponentials (R. W. Brockett, 1984); the inverse by the subproblems of
 * B. Paden (1986).
 * Threads: no call allocates, blocks or touches a global; all but
 * interp_kin_parse() are RT-safe.
 */
#ifndef INTERP_KINEMATICS_H
#define INTERP_KINEMATICS_H

#include "interp/axis.h"
#include "interp/diag.h"

struct interp_kin_joint {
	enum interp_axis axis;		/* A B C are rotary */
	double dir[3];			/* of motion; of a rotary, its axis */
	double at_mm[3];		/* rotary: a point on the axis */
};

struct interp_kinematics {
	uint32_t njoints;
	struct interp_kin_joint joint[INTERP_NAXES];	/* from work to tool */
	double tip_mm[3];		/* of the tool, all axes at 0 */
	double tool_dir[3];		/* from the tip into the holder */
	/* Found by interp_kin_prepare(): */
	uint32_t nlinear, linear[3];	/* indices of joints */
	uint32_t nturn, turn[2];	/* rotaries that turn the tool's axis */
};

/* Where a tool is and which way it points, seen from the work. */
struct interp_kin_pose {
	double tip_mm[3];
	double dir[3];			/* from the tip into the holder */
};

/** interp_kin_clear() - X Y Z alone, the tool along +Z with its tip at 0. */
void interp_kin_clear(struct interp_kinematics *k);

/**
 * interp_kin_parse() - a chain as a machine file has it.
 *
 *	chain = C(0 0 -120) A(0 15 -80) X Y Z
 *	chain = X Y Z C B(0 0 0 / 0 0.70710678 0.70710678)
 *
 * The order is from the work to the tool.  The brackets hold a point on the
 * axis of a rotary joint and, after a slash, its direction if that is not X, Y
 * or Z.  The tool in @k is not changed, so call interp_kin_clear() first.
 *
 * Return: 0, or -EINVAL with @diag's found and wanted filled.
 */
int interp_kin_parse(struct interp_kinematics *k, const char *chain,
		     struct interp_diag *diag);

/**
 * interp_kin_prepare() - check a chain that was filled by the caller, and index
 * it.
 *
 * Each axis may stand in it once.  It needs three linear joints that span
 * space, and at most two rotary joints that turn the tool's axis.
 * Return: as interp_kin_parse().
 */
int interp_kin_prepare(struct interp_kinematics *k, struct interp_diag *diag);

/** interp_kin_turns_work() - does @axis turn the work, not the tool?  One that
 *  is not in the chain does not. */
bool interp_kin_turns_work(const struct interp_kinematics *k,
			   enum interp_axis axis);

/** interp_kin_forward() - the pose at axes @q (mm, degrees). */
void interp_kin_forward(const struct interp_kinematics *k,
			const double q[INTERP_NAXES],
			struct interp_kin_pose *ret);

/**
 * interp_kin_place() - set the linear axes of @q so that the tip is at @tip_mm.
 *
 * The rotary axes of @q stay.  Programs of the tool's tip need this.
 * Return: 0, or -EDOM if the linear joints do not span space there.
 */
int interp_kin_place(const struct interp_kinematics *k,
		     const double tip_mm[3], double q[INTERP_NAXES]);

/**
 * interp_kin_inverse() - the axes of a pose, the solution nearest to @q.
 *
 * @q: the last places of the axes; it gets the new ones.  Axes outside the
 * chain stay.  Of two solutions the one with the smaller turns is taken.
 * Angles go on beyond +-180 degrees.
 * Return: 0; -EDOM if the tool cannot point that way; -ESRCH if the pose is
 * singular: a rotary axis could have any angle there, and keeps the one it has.
 */
int interp_kin_inverse(const struct interp_kinematics *k,
		       const struct interp_kin_pose *pose,
		       double q[INTERP_NAXES]);

/**
 * interp_kin_margin() - how far from singular: 1 best, 0 singular.
 *
 * It is the smallest turn of the tool for a turn of the rotary axes.  Near 0
 * they must turn very fast for a small turn of the tool.  With fewer than two
 * rotary axes it is 1.
 */
double interp_kin_margin(const struct interp_kinematics *k,
			 const double q[INTERP_NAXES]);

#endif /* INTERP_KINEMATICS_H */
