/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pose.c - a rigid body along a pair of NURBS
 *
 * With q of any length, the rotation is that of q/|q| and turns with
 *
 *	spin = 2 vec(q' q*) / |q|^2
 *
 * where the part of q' along q drops out.
 */
#include "interp/pose.h"

#include <errno.h>
#include <math.h>

int interp_pose_open(struct interp_pose_path *p,
		     const struct interp_nurbs *move,
		     const struct interp_nurbs *turn)
{
	if (move->naxes != 3 || turn->naxes != 4 ||
	    interp_nurbs_first(move) != interp_nurbs_first(turn) ||
	    interp_nurbs_last(move) != interp_nurbs_last(turn))
		return -EINVAL;
	interp_nurbs_open(&p->move, move);
	interp_nurbs_open(&p->turn, turn);
	return 0;
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

int interp_pose_at(struct interp_pose_path *p, double u,
		   struct interp_pose *ret)
{
	struct interp_nurbs_point m, t;
	const double *q = t.d[0], *d = t.d[1];
	double n2 = 0, turned[3];

	interp_nurbs_at(&p->move, u, 1, &m);
	interp_nurbs_at(&p->turn, u, 1, &t);
	for (int i = 0; i < 4; i++)
		n2 += q[i] * q[i];
	if (!(n2 > 0 && isfinite(n2)))
		return -EDOM;
	cross(q + 1, d + 1, turned);
	for (int i = 0; i < 3; i++) {
		ret->at_mm[i] = m.d[0][i];
		ret->d_mm[i] = m.d[1][i];
		ret->spin[i] = 2 * (q[0] * d[i + 1] - d[0] * q[i + 1] +
				    turned[i]) / n2;
	}
	for (int i = 0; i < 4; i++)
		ret->q[i] = q[i] / sqrt(n2);
	return 0;
}

/* v + 2 w (r x v) + 2 r x (r x v) */
static void rotate(const double q[4], const double v[3], double ret[3])
{
	double once[3], twice[3];

	cross(q + 1, v, once);
	cross(q + 1, once, twice);
	for (int i = 0; i < 3; i++)
		ret[i] = v[i] + 2 * (q[0] * once[i] + twice[i]);
}

void interp_pose_apply(const struct interp_pose *p, const double body_mm[3],
		       double ret_mm[3], double ret_d_mm[3])
{
	double arm[3], spun[3];

	rotate(p->q, body_mm, arm);
	cross(p->spin, arm, spun);
	for (int i = 0; i < 3; i++) {
		ret_mm[i] = p->at_mm[i] + arm[i];
		ret_d_mm[i] = p->d_mm[i] + spun[i];
	}
}
