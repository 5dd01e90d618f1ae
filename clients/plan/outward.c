/* SPDX-License-Identifier: Apache-2.0 */
/*
 * outward.c - which way out of a cavity the air leads an electrode
 */
#include "outward.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#define LED		150		/* points of it that are led */
#define LOOKED_AT	3000		/* that are compared with the box */
#define BESIDE_MM	0.5		/* so far from it: what lies between the
					 * points looked at stays outside */

static const double *point(const struct mesh *m, uint32_t i, uint32_t of)
{
	return m->vert[(uint64_t)i * m->nverts / of];
}

static void place(const struct pose *pose, const double p[3], double ret[3])
{
	rot_apply(&pose->r, p, ret);
	v_add(ret, pose->t, ret);
}

int outward_init(struct outward *o, const struct job *j,
		 const double end[INTERP_NAXES])
{
	struct pose pose;

	*o = (struct outward) { .j = j };
	if (air_cut(&o->air, &j->part))
		return -ENOMEM;
	motion_pose(&j->motion, end, &pose);
	for (uint32_t i = 0; i < j->tool.nverts; i++) {
		double at[3];

		place(&pose, j->tool.vert[i], at);
		air_open(&o->air, at);
	}
	air_fill(&o->air);
	return 0;
}

void outward_free(struct outward *o)
{
	air_free(&o->air);
}

double outward_at(const struct outward *o, const double q[INTERP_NAXES],
		  double ret[INTERP_NAXES])
{
	struct pose pose;
	double left = 0;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	motion_pose(&o->j->motion, q, &pose);
	for (uint32_t i = 0; i < LED; i++) {
		double at[3], to[3], jac[INTERP_NAXES][3];
		double way;

		place(&pose, point(&o->j->tool, i, LED), at);
		way = air_way(&o->air, at, to);
		if (!(way > 0))
			continue;
		left += way / LED;
		motion_jacobian(&o->j->motion, q, at, jac);
		for (int k = 0; k < INTERP_NAXES; k++)
			ret[k] += v_dot(jac[k], to) / LED;
	}
	return left;
}

bool outward_is_out(const struct job *j, const double q[INTERP_NAXES])
{
	const uint32_t n = j->tool.nverts < LOOKED_AT ? j->tool.nverts :
							LOOKED_AT;
	double low[3] = { DBL_MAX, DBL_MAX, DBL_MAX };
	double high[3] = { -DBL_MAX, -DBL_MAX, -DBL_MAX };
	struct pose pose;

	motion_pose(&j->motion, q, &pose);
	for (uint32_t i = 0; i < n; i++) {
		double at[3];

		place(&pose, point(&j->tool, i, n), at);
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], at[k]);
			high[k] = fmax(high[k], at[k]);
		}
	}
	for (int k = 0; k < 3; k++)
		if (low[k] > j->part.max[k] + BESIDE_MM ||
		    high[k] < j->part.min[k] - BESIDE_MM)
			return true;
	return false;
}
