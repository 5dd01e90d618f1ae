/* SPDX-License-Identifier: Apache-2.0 */
/*
 * kinematics.h - from axes to the tool's tip and direction, and back
 *
 * A machine is one chain of joints from the work to the tool, whatever of it
 * is table and whatever head: only the order counts.  Every joint moves the
 * tool relative to the work, positive as ISO 841 has it, so a table that goes
 * left when X counts up is a joint that moves the tool right.
 *
 *	C A X Y Z	trunnion table: C on A, under a head on X Y Z
 *	X Y Z C A	both rotaries in the head
 *	C X Y Z B	one in the table, one in the head
 *
 * A joint is a homogeneous transform: a linear one a translation along its
 * direction, a rotary one a rotation about a line.  At all axes 0 the work
 * frame and the machine frame are one; a rotary's line and the tool are given
 * there, so their offset constants are the points at_mm and tip_mm.
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
 * From work to tool; in brackets a point on a rotary's axis and, behind a
 * slash, its direction if it is not that of X, Y or Z.  The tool stays as
 * it is in @k: interp_kin_clear() first.
 *
 * Return: 0, or -EINVAL with @diag's found and wanted filled.
 */
int interp_kin_parse(struct interp_kinematics *k, const char *chain,
		     struct interp_diag *diag);

/**
 * interp_kin_prepare() - check a chain filled by hand and index it.
 *
 * Wanted: each axis once, three linear joints that span space, at most two
 * rotaries that turn the tool's axis.  Return: as interp_kin_parse().
 */
int interp_kin_prepare(struct interp_kinematics *k, struct interp_diag *diag);

/** interp_kin_forward() - the pose at axes @q (mm, degrees). */
void interp_kin_forward(const struct interp_kinematics *k,
			const double q[INTERP_NAXES],
			struct interp_kin_pose *ret);

/**
 * interp_kin_place() - set the linear axes of @q so that the tip is at @tip_mm.
 *
 * The rotaries of @q stay: what tool-centre-point programming needs.
 * Return: 0, or -EDOM if the linear joints do not span space there.
 */
int interp_kin_place(const struct interp_kinematics *k,
		     const double tip_mm[3], double q[INTERP_NAXES]);

/**
 * interp_kin_inverse() - the axes of a pose, the solution nearest to @q.
 *
 * @q holds the last axes, and gets the new ones; axes beyond the chain stay.
 * Of two solutions the one is taken whose rotaries turn least; angles go on
 * across +-180.
 * Return: 0; -EDOM if the tool cannot point that way; -ESRCH if the pose is
 * singular: a rotary could have any angle, and keeps its own.
 */
int interp_kin_inverse(const struct interp_kinematics *k,
		       const struct interp_kin_pose *pose,
		       double q[INTERP_NAXES]);

/**
 * interp_kin_margin() - how far from singular: 1 best, 0 singular.
 *
 * The smallest turn of the tool, per turn of the rotaries together: near 0
 * they race for a small turn of the tool.  1 with fewer than two of them.
 */
double interp_kin_margin(const struct interp_kinematics *k,
			 const double q[INTERP_NAXES]);

#endif /* INTERP_KINEMATICS_H */
