/* SPDX-License-Identifier: Apache-2.0 */
/* corner.c - how fast a node may be passed at which a path turns */
#include "speed/along.h"
#include "interp/smaller.h"

#include <math.h>

void interp_axes_round(struct interp_axes *x, double corner_mm)
{
	const double c = corner_mm;

	x->corner_mm = c;
	for (uint32_t k = 0; k < x->n; k++) {
		const double a = x->a_mm_s2[k], j = x->j_mm_s3[k];

		x->step_mm_s[k] = smaller(sqrt(8 * a * c),
					  cbrt(36 * j * c * c));
		x->step_mm_s2[k] = cbrt(24 * c * j * j);
	}
}

/* Of two columns together: what they go by in a mm, and the turn between. */
struct bow {
	double before, behind, both, turn;	/* squares, and a product */
};

/* An arc past the node, whose middle is @corner_mm from it. */
static double radius_mm(const struct bow *b, double corner_mm)
{
	const double size = sqrt(b->before * b->behind);
	const double c = size > 0 ? larger(smaller(b->both / size, 1), -1) : -1;
	const double half = sqrt((1 + c) / 2);

	return half < 1 ? larger(corner_mm * half / (1 - half), corner_mm) :
			  INFINITY;
}

double interp_axes_corner_mm_s(const struct interp_axes *x,
			       const double *before, const double *behind,
			       uint32_t along)
{
	struct interp_straight across = { INFINITY, INFINITY };
	double v = INFINITY, r, turn[2];
	struct bow bow = { 0, 0, 0, 0 };

	for (uint32_t k = 0; k < x->n; k++) {
		const double *a = before + k * INTERP_AXES_WAY;
		const double *b = behind + k * INTERP_AXES_WAY;

		for (int i = 0; i < 2; i++)
			turn[i] = b[i] - a[i];
		if (fabs(turn[0]) * v > x->step_mm_s[k])
			v = x->step_mm_s[k] / fabs(turn[0]);
		if (fabs(turn[1]) * v * v > x->step_mm_s2[k])
			v = sqrt(x->step_mm_s2[k] / fabs(turn[1]));
		if (!(along >> k & 1))
			continue;
		bow.before += a[0] * a[0];
		bow.behind += b[0] * b[0];
		bow.both += a[0] * b[0];
		bow.turn += turn[0] * turn[0];
		across.a_mm_s2 = smaller(across.a_mm_s2,
					 x->a_mm_s2[k] / fabs(turn[0]));
		across.j_mm_s3 = smaller(across.j_mm_s3,
					 x->j_mm_s3[k] / fabs(turn[0]));
	}
	r = radius_mm(&bow, x->corner_mm);
	if (!(bow.turn > 0) || isinf(r))
		return v;
	return smaller(v, smaller(sqrt(across.a_mm_s2 * sqrt(bow.turn) * r),
				  cbrt(across.j_mm_s3 * sqrt(bow.turn) * r *
				       r)));
}
