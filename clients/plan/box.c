/* SPDX-License-Identifier: Apache-2.0 */
/*
 * box.c - for how long two boxes stay apart
 */
#include "box.h"

#include <float.h>
#include <stdbool.h>

void box_move(const struct box *in, const struct box_pose *pose,
	      struct box_placed *ret)
{
	const double *c = ret->at.centre, *v = pose->v, *w = pose->w;
	const float wf[3] = { (float)w[0], (float)w[1], (float)w[2] };
	double turn[3];

	box_place(in, pose, &ret->at);
	v_cross(w, c, turn);
	ret->off = 0;
	for (int k = 0; k < 3; k++) {
		const int l = (k + 1) % 3, m = (k + 2) % 3;

		ret->spin[k] = wf[l] * ret->at.axis[m] -
			       wf[m] * ret->at.axis[l];
		ret->go[k] = (float)(v[k] + turn[k]);
		ret->off += fabsf(ret->go[k]) + fabsf(wf[k]) * in->half[3];
	}
	ret->off *= BOX_MARGIN;
}

/* The time x at which s x + A x^2 / 2 reaches @gap. */
static float root(float gap, float s, float accel)
{
	float b;

	if (!(gap > 0))
		return 0;
	if (!(accel > 0))
		return s > 0 ? gap / s : FLT_MAX;
	b = sqrtf(s * s + 2 * accel * gap);
	return s > 0 ? 2 * gap / (s + b) : (b - s) / accel;
}

/* How fast the electrode's box comes nearer to the part's at most, along each
 * of three axes; @at tells on which side of the part it is. */
static box_v4 speed(const struct box_placed *tool, const box_v4 axis[3],
		    box_v4 at)
{
	const box_v4 go = box_along(axis, tool->go[0], tool->go[1],
				    tool->go[2]);
	/* The sign of @at, turned: toward the part. */
	const box_v4 toward = (box_v4)((box_i4)go ^
				       (~(box_i4)at & INT32_MIN));

	return toward + tool->off +
	       box_reach(tool->spin, &tool->at.half, axis);
}

/* The time along the direction that joins the gaps on all three axes. */
static float beside(const struct box_placed *tool, const box_v4 axis[3],
		    box_v4 at, box_v4 gaps, const struct box_keep *keep)
{
	const box_v4 g = box_positive(gaps);
	const float gap = sqrtf(box_beside2(gaps));
	box_v4 n[3], s;

	if (!(gap > keep->mm))
		return 0;
	for (int k = 0; k < 3; k++) {
		/* With the sign of @at. */
		const box_v4 to = axis[k] * (box_v4)((box_i4)g |
						     ((box_i4)at & INT32_MIN));
		const float sum = (to[0] + to[1] + to[2]) / gap;

		n[k] = (box_v4){ sum, sum, sum, sum };
	}
	s = speed(tool, n, (box_v4){ 1, 1, 1, 1 });
	return root(gap - keep->mm, s[0] + keep->rises, keep->accel);
}

float box_time(const struct box *part, const struct box_placed *tool,
	       const struct box_keep *keep)
{
	const float enough = keep->enough;
	struct box_gaps g;
	box_v4 rest[2], s[2];
	float most = 0;

	box_gaps(part, &tool->at, &g);
	rest[0] = g.part - keep->mm;
	rest[1] = g.tool - keep->mm;
	s[0] = speed(tool, part->axis, g.part_at) + keep->rises;
	s[1] = speed(tool, tool->at.axis, g.tool_at) + keep->rises;
	for (int of = 0; of < 2; of++) {
		const box_i4 ok = (rest[of] > 0) &
			(s[of] * enough + keep->accel * enough * enough / 2 <=
			 rest[of]);

		if (ok[0] | ok[1] | ok[2])
			return enough;
	}
	for (int of = 0; of < 2; of++)
		for (int i = 0; i < 3; i++)
			if (rest[of][i] > 0)
				most = fmaxf(most, root(rest[of][i], s[of][i],
							keep->accel));
	if (most < enough)
		most = fmaxf(most, beside(tool, part->axis, g.part_at, g.part,
					  keep));
	if (most < enough)
		most = fmaxf(most, beside(tool, tool->at.axis, g.tool_at,
					  g.tool, keep));
	return fminf(most, enough);
}
