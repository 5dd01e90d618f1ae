/* SPDX-License-Identifier: Apache-2.0 */
/*
 * inverse.c - the axes that put the tool where it is wanted
 *
 * The direction fixes the rotaries, and with them the tip is linear in the
 * linear joints.  Two rotaries about u1 and u2 turn the tool's axis d0 to d
 * when
 *
 *	R1 R2 d0 = d,	with	z = R2 d0 = R1' d
 *
 * z has the same share along u1 as d and along u2 as d0, and length 1, so
 *
 *	z = a u1 + b u2 + g (u1 x u2)
 *
 * with two values of g: the two ways a machine has to point.
 */
#include "interp/angle.h"
#include "interp/kinematics.h"
#include "kinematics/vector.h"

#include <math.h>
#include <errno.h>
#include <string.h>

/* The tool points at least this well, or the direction cannot be reached. */
#define POINTS		1e-9

/* If a rotary axis is this near to the tool's axis, it has no angle of its
 * own. */
#define SINGULAR	1e-7

/* -- The linear joints ---------------------------------------------------- */

/* In which direction joint @n moves the tip, seen from the work. */
static void column(const struct interp_kinematics *k, uint32_t n,
		   const double q[INTERP_NAXES], double ret[3])
{
	memcpy(ret, k->joint[n].dir, sizeof(k->joint[n].dir));
	for (uint32_t i = n; i-- > 0;) {
		const struct interp_kin_joint *j = &k->joint[i];

		if (interp_axis_is_rotary(j->axis))
			vec_turn(j->dir, q[j->axis] / ANGLE_RADIAN, ret);
	}
}

int interp_kin_place(const struct interp_kinematics *k,
		     const double tip_mm[3], double q[INTERP_NAXES])
{
	double at[INTERP_NAXES], w[3][3], way[3], x[3];
	struct interp_kin_pose zero;
	double volume;

	memcpy(at, q, sizeof(at));
	for (int i = 0; i < 3; i++) {
		at[k->joint[k->linear[i]].axis] = 0;
		column(k, k->linear[i], q, w[i]);
	}
	interp_kin_forward(k, at, &zero);
	for (int i = 0; i < 3; i++)
		way[i] = tip_mm[i] - zero.tip_mm[i];
	vec_cross(w[1], w[2], x);
	volume = vec_dot(w[0], x);
	if (fabs(volume) < 1e-9)
		return -EDOM;
	/* G. Cramer's rule, 1750. */
	for (int i = 0; i < 3; i++) {
		vec_cross(w[(i + 1) % 3], w[(i + 2) % 3], x);
		q[k->joint[k->linear[i]].axis] = vec_dot(way, x) / volume;
	}
	return 0;
}

/* -- The rotaries --------------------------------------------------------- */

/* The angle about @u from @from to @to; false: any angle is right. */
static bool angle(const double u[3], const double from[3], const double to[3],
		  double *ret_deg)
{
	const double f = vec_dot(u, from), t = vec_dot(u, to);
	double a[3], b[3], x[3];

	for (int i = 0; i < 3; i++) {
		a[i] = from[i] - f * u[i];
		b[i] = to[i] - t * u[i];
	}
	if (vec_length(a) < SINGULAR || vec_length(b) < SINGULAR)
		return false;
	vec_cross(a, b, x);
	*ret_deg = atan2(vec_dot(u, x), vec_dot(a, b)) * ANGLE_RADIAN;
	return true;
}

/* @deg, plus the whole turns that bring it nearest to @last. */
static double nearest(double deg, double last)
{
	return deg + 360 * round((last - deg) / 360);
}

struct turns {
	double deg[2];
	bool singular;
};

static int turn_one(const struct interp_kinematics *k, const double d[3],
		    const double last[2], struct turns *ret)
{
	const double *u = k->joint[k->turn[0]].dir;
	double deg = 0;

	if (fabs(vec_dot(u, d) - vec_dot(u, k->tool_dir)) > POINTS)
		return -EDOM;
	if (!angle(u, k->tool_dir, d, &deg))
		return -EDOM;
	ret->deg[0] = nearest(deg, last[0]);
	return 0;
}

/* One of the two solutions: @g is the share of z along u1 x u2. */
static void turn_way(const struct interp_kinematics *k, const double d[3],
		     const double last[2], const double z[3],
		     struct turns *ret)
{
	double deg = 0;

	*ret = (struct turns) { .deg = { last[0], last[1] } };
	if (angle(k->joint[k->turn[1]].dir, k->tool_dir, z, &deg))
		ret->deg[1] = nearest(deg, last[1]);
	else
		ret->singular = true;
	if (angle(k->joint[k->turn[0]].dir, z, d, &deg))
		ret->deg[0] = nearest(deg, last[0]);
	else
		ret->singular = true;
}

static int turn_two(const struct interp_kinematics *k, const double d[3],
		    const double last[2], struct turns *ret)
{
	const double *u1 = k->joint[k->turn[0]].dir;
	const double *u2 = k->joint[k->turn[1]].dir;
	const double c = vec_dot(u1, u2), along1 = vec_dot(u1, d);
	const double along2 = vec_dot(u2, k->tool_dir);
	const double a = (along1 - c * along2) / (1 - c * c);
	const double b = (along2 - c * along1) / (1 - c * c);
	const double g2 = (1 - a * a - b * b - 2 * a * b * c) / (1 - c * c);
	const double g = sqrt(fmax(g2, 0));
	double x[3], z[3], best = INFINITY;

	if (g2 < -POINTS)
		return -EDOM;
	vec_cross(u1, u2, x);
	for (int sign = -1; sign <= 1; sign += 2) {
		struct turns t;
		double far;

		for (int i = 0; i < 3; i++)
			z[i] = a * u1[i] + b * u2[i] + sign * g * x[i];
		turn_way(k, d, last, z, &t);
		far = fabs(t.deg[0] - last[0]) + fabs(t.deg[1] - last[1]);
		if (far < best) {
			best = far;
			*ret = t;
		}
	}
	return 0;
}

static int turns_of(const struct interp_kinematics *k, const double d[3],
		    const double last[2], struct turns *ret)
{
	double x[3];

	*ret = (struct turns) { .singular = false };
	if (k->nturn == 2)
		return turn_two(k, d, last, ret);
	if (k->nturn == 1)
		return turn_one(k, d, last, ret);
	vec_cross(d, k->tool_dir, x);
	return vec_length(x) < POINTS && vec_dot(d, k->tool_dir) > 0 ? 0 :
								   -EDOM;
}

int interp_kin_inverse(const struct interp_kinematics *k,
		       const struct interp_kin_pose *pose,
		       double q[INTERP_NAXES])
{
	const double n = vec_length(pose->dir);
	double at[INTERP_NAXES], d[3], last[2] = { 0, 0 };
	struct turns t;
	int err;

	if (!(n > 0) || !isfinite(n))
		return -EDOM;
	for (int i = 0; i < 3; i++)
		d[i] = pose->dir[i] / n;
	for (uint32_t i = 0; i < k->nturn; i++)
		last[i] = q[k->joint[k->turn[i]].axis];
	err = turns_of(k, d, last, &t);
	if (err)
		return err;
	memcpy(at, q, sizeof(at));
	for (uint32_t i = 0; i < k->nturn; i++)
		at[k->joint[k->turn[i]].axis] = t.deg[i];
	err = interp_kin_place(k, pose->tip_mm, at);
	if (err)
		return err;
	memcpy(q, at, sizeof(at));
	return t.singular ? -ESRCH : 0;
}

double interp_kin_margin(const struct interp_kinematics *k,
			 const double q[INTERP_NAXES])
{
	double d[3], u2[3], v1[3], v2[3], sum, det;
	const double *u1 = k->joint[k->turn[0]].dir;
	struct interp_kin_pose pose;

	if (k->nturn < 2)
		return 1;
	interp_kin_forward(k, q, &pose);
	memcpy(d, pose.dir, sizeof(d));
	memcpy(u2, k->joint[k->turn[1]].dir, sizeof(u2));
	vec_turn(u1, q[k->joint[k->turn[0]].axis] / ANGLE_RADIAN, u2);
	vec_cross(u1, d, v1);
	vec_cross(u2, d, v2);
	/* The smaller singular value of the 3 x 2 matrix (v1 v2). */
	sum = vec_dot(v1, v1) + vec_dot(v2, v2);
	det = vec_dot(v1, v1) * vec_dot(v2, v2) -
	      vec_dot(v1, v2) * vec_dot(v1, v2);
	return sqrt(fmax(0, (sum - sqrt(fmax(0, sum * sum - 4 * det))) / 2));
}
