/* SPDX-License-Identifier: Apache-2.0 */
/* chain.c - a chain of joints, and where it puts the tool */
#include "interp/angle.h"
#include "interp/kinematics.h"
#include "kinematics/vector.h"

#include <math.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Directions that differ by less than this are equal. */
#define SAME_DIR	1e-9

static const double unit[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

static bool is_turn(const struct interp_kin_joint *j)
{
	return interp_axis_is_rotary(j->axis);
}

void interp_kin_clear(struct interp_kinematics *k)
{
	*k = (struct interp_kinematics) {
		.njoints = 3, .tool_dir = { 0, 0, 1 }, .nlinear = 3,
		.linear = { 0, 1, 2 },
	};
	for (uint32_t i = 0; i < 3; i++) {
		k->joint[i].axis = (enum interp_axis)i;
		memcpy(k->joint[i].dir, unit[i], sizeof(unit[i]));
	}
}

bool interp_kin_turns_work(const struct interp_kinematics *k,
			   enum interp_axis axis)
{
	for (uint32_t i = 0; i < k->njoints; i++) {
		if (k->joint[i].axis == axis)
			return true;
		if (k->joint[i].axis == INTERP_X)
			return false;
	}
	return false;
}

/* -- Is it a machine? ----------------------------------------------------- */

__attribute__((format(printf, 3, 4)))
static int refuse(struct interp_diag *d, const char *wanted,
		  const char *found, ...)
{
	va_list args;

	snprintf(d->wanted, sizeof(d->wanted), "%s", wanted);
	va_start(args, found);
	interp_diag_print(d->found, sizeof(d->found), found, args);
	va_end(args);
	return -EINVAL;
}

static bool make_unit(double v[3])
{
	const double n = vec_length(v);

	if (!(n > 0) || !isfinite(n))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= n;
	return true;
}

static int check_joints(struct interp_kinematics *k, struct interp_diag *diag)
{
	uint32_t seen = 0;

	if (k->njoints > INTERP_NAXES)
		return refuse(diag, "at most 8 axes", "a chain of %u axes",
			      k->njoints);
	for (uint32_t i = 0; i < k->njoints; i++) {
		struct interp_kin_joint *j = &k->joint[i];
		const char letter = INTERP_AXIS_LETTERS[j->axis];

		if (seen & 1u << j->axis)
			return refuse(diag, "each axis once",
				      "axis %c a second time", letter);
		seen |= 1u << j->axis;
		if (!make_unit(j->dir))
			return refuse(diag, "a direction, as in 0 0 1",
				      "axis %c without a direction", letter);
		for (int n = 0; n < 3; n++) {
			if (!isfinite(j->at_mm[n]))
				return refuse(diag, "numbers of mm",
					      "axis %c at no place", letter);
		}
	}
	return 0;
}

static int check_linear(struct interp_kinematics *k, struct interp_diag *diag)
{
	double x[3];

	k->nlinear = 0;
	for (uint32_t i = 0; i < k->njoints; i++) {
		if (is_turn(&k->joint[i]))
			continue;
		if (k->nlinear == 3)
			return refuse(diag, "three linear axes in the chain",
				      "a fourth one, %c",
				      INTERP_AXIS_LETTERS[k->joint[i].axis]);
		k->linear[k->nlinear++] = i;
	}
	if (k->nlinear < 3)
		return refuse(diag, "three linear axes, as in C A X Y Z",
			      "%u linear axes in the chain", k->nlinear);
	vec_cross(k->joint[k->linear[0]].dir, k->joint[k->linear[1]].dir, x);
	if (fabs(vec_dot(x, k->joint[k->linear[2]].dir)) < 1e-6)
		return refuse(diag, "three that do not lie in one plane",
			      "linear axes that lie in one plane");
	return 0;
}

/* A rotary axis along the tool that has no other kind of rotary behind it only
 * rolls the tool. */
static int check_turns(struct interp_kinematics *k, struct interp_diag *diag)
{
	bool rolls = true;

	k->nturn = 0;
	for (uint32_t i = k->njoints; i-- > 0;) {
		const struct interp_kin_joint *j = &k->joint[i];

		if (!is_turn(j))
			continue;
		if (rolls && fabs(vec_dot(j->dir, k->tool_dir)) > 1 - SAME_DIR)
			continue;
		rolls = false;
		if (k->nturn == 2)
			return refuse(diag, "at most two that turn the tool's "
				      "axis", "a third rotary, %c",
				      INTERP_AXIS_LETTERS[j->axis]);
		k->turn[1] = k->turn[0];
		k->turn[0] = i;
		k->nturn++;
	}
	if (k->nturn == 2 &&
	    fabs(vec_dot(k->joint[k->turn[0]].dir,
			 k->joint[k->turn[1]].dir)) > 1 - 1e-6)
		return refuse(diag, "rotaries about two directions",
			      "two rotaries about the same one");
	return 0;
}

int interp_kin_prepare(struct interp_kinematics *k, struct interp_diag *diag)
{
	int err = check_joints(k, diag);

	if (!err && !make_unit(k->tool_dir))
		err = refuse(diag, "a direction, as in 0 0 1",
			    "a tool without a direction");
	if (!err)
		err = check_linear(k, diag);
	if (!err)
		err = check_turns(k, diag);
	return err;
}

/* -- Forward -------------------------------------------------------------- */

static void move(const struct interp_kin_joint *j, double q, double at[3])
{
	double v[3];

	if (!is_turn(j)) {
		for (int i = 0; i < 3; i++)
			at[i] += q * j->dir[i];
		return;
	}
	for (int i = 0; i < 3; i++)
		v[i] = at[i] - j->at_mm[i];
	vec_turn(j->dir, q * ANGLE_DEGREE, v);
	for (int i = 0; i < 3; i++)
		at[i] = j->at_mm[i] + v[i];
}

void interp_kin_forward(const struct interp_kinematics *k,
			const double q[INTERP_NAXES],
			struct interp_kin_pose *ret)
{
	memcpy(ret->tip_mm, k->tip_mm, sizeof(ret->tip_mm));
	memcpy(ret->dir, k->tool_dir, sizeof(ret->dir));
	for (uint32_t i = k->njoints; i-- > 0;) {
		const struct interp_kin_joint *j = &k->joint[i];

		move(j, q[j->axis], ret->tip_mm);
		if (is_turn(j))
			vec_turn(j->dir, q[j->axis] * ANGLE_DEGREE, ret->dir);
	}
}
