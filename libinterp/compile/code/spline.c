/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spline.c - curves in LinuxCNC's form: G5 G5.1 and G5.2 G5.3
 *
 * G5 and G5.1 are Bezier curves that are complete on their line.
 */
#include "code/nurbs_words.h"

#include <string.h>

#define LINUXCNC_ORDER	3

/* -- G5.2 and G5.3 -------------------------------------------------------- */

static int linuxcnc_weight(struct nc_reader *r, double *ret)
{
	*ret = nc_has(r, NC_P) ? r->block.value[NC_P] : 1;
	return *ret >= NC_WEIGHT_MIN ? 0 : nc_curve_refuse_weight(r, NC_P);
}

/* The point where the curve begins is its first control point.  Its weight is
 * that of a block without X and Y. */
int nc_curve_block(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const bool named = b->words & (NC_BIT(NC_X) | NC_BIT(NC_Y));
	struct nc_curve *c = &r->curve;
	double weight, at_mm[INTERP_NAXES];
	int err = linuxcnc_weight(r, &weight);

	if (err)
		return err;
	if (r->plane != 0)
		return nc_curve_refuse_plane(r);
	if (!c->open) {
		nc_curve_open(r, NC_NURBS_BLOCK, LINUXCNC_ORDER);
		err = nc_curve_point(r, nc_here(r), named ? 1 : weight);
	} else if (!named && nc_has(r, NC_P)) {
		return nc_refuse(r, b->at[NC_P], "X and Y with it, but in the "
				 "first block", "a weight without a point");
	}
	if (nc_has(r, NC_L)) {
		if (!(b->value[NC_L] >= 2 &&
		      b->value[NC_L] <= INTERP_NURBS_ORDER_MAX))
			return nc_refuse(r, b->at[NC_L], "an order of 2 to 10, "
					 "the degree + 1", "a curve of order "
					 "%g", b->value[NC_L]);
		c->order = (uint32_t)b->value[NC_L];
	}
	if (err || !named)
		return err;
	nc_curve_target(r, at_mm);
	return nc_curve_point(r, at_mm, weight);
}

int nc_curve_end(struct nc_reader *r)
{
	struct nc_curve *c = &r->curve;
	int err = 0;

	if (c->open != NC_NURBS_BLOCK)
		return nc_refuse(r, r->block.code_at[NC_MOTION],
				 "G5.2 and control points before it",
				 "G5.3 without G5.2");
	err = nc_curve_check_points(r, r->block.code_at[NC_MOTION]);
	/* Even knots; those at the ends are there as many times as the order
	 * says. */
	for (uint32_t i = 0; !err && i < c->npoints + c->order; i++)
		err = nc_curve_knot(r, i < c->order ? 0 : i < c->npoints ?
				 i - c->order + 1 : c->npoints - c->order + 1);
	return err ? err : nc_curve_build(r);
}

/* -- G5 and G5.1 ---------------------------------------------------------- */

/* The control points @p are rows of X and Y, after the place where it stands.
 * The last one is the end of the curve. */
static int bezier(struct nc_reader *r, const double *p, uint32_t n)
{
	double at_mm[INTERP_NAXES];
	int err;

	nc_curve_open(r, NC_NURBS, n + 1);
	memcpy(at_mm, nc_here(r), sizeof(at_mm));
	err = nc_curve_point(r, at_mm, 1);
	for (uint32_t i = 0; !err && i < n; i++) {
		at_mm[INTERP_X] = p[2 * i];
		at_mm[INTERP_Y] = p[2 * i + 1];
		err = nc_curve_point(r, at_mm, 1);
	}
	for (uint32_t i = 0; !err && i < 2 * (n + 1); i++)
		err = nc_curve_knot(r, i <= n ? 0 : 1);
	r->curve.open = 0;
	return err ? err : nc_curve_build(r);
}

/* I and J of the line; without them the direction of the last G5 is kept. */
static int handle(struct nc_reader *r, double ret_mm[2])
{
	const struct nc_block *b = &r->block;

	if (nc_has(r, NC_I) && nc_has(r, NC_J)) {
		ret_mm[0] = b->value[NC_I] * r->scale[INTERP_X];
		ret_mm[1] = b->value[NC_J] * r->scale[INTERP_X];
		return 0;
	}
	if (nc_has(r, NC_I) || nc_has(r, NC_J) || !r->curve.smooth)
		return nc_refuse(r, b->code_at[NC_MOTION],
				 "I and J, or none of them right behind "
				 "another G5", "G5 with%s",
				 nc_has(r, NC_I) ? " I and no J" :
				 nc_has(r, NC_J) ? " J and no I" :
				 "out I and J");
	memcpy(ret_mm, r->curve.leave_mm, sizeof(r->curve.leave_mm));
	return 0;
}

int nc_curve_spline(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	double end_mm[INTERP_NAXES], p[6] = { 0 };
	int err;

	if (!nc_has(r, NC_P) || !nc_has(r, NC_Q))
		return nc_refuse(r, b->code_at[NC_MOTION],
				 "P and Q, from the end to the second control "
				 "point", "G5 without P and Q");
	err = handle(r, p);
	if (err)
		return err;
	nc_target(r, end_mm);
	for (int i = 0; i < 2; i++) {
		const double back_mm = b->value[i ? NC_Q : NC_P] *
				       r->scale[INTERP_X];

		p[i] += here[i];
		p[2 + i] = end_mm[i] + back_mm;
		p[4 + i] = end_mm[i];
		r->curve.leave_mm[i] = -back_mm;
	}
	err = bezier(r, p, 3);
	r->curve.smooth = !err;
	return err;
}

int nc_curve_parabola(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	double end_mm[INTERP_NAXES], p[4];

	if (!nc_has(r, NC_I) && !nc_has(r, NC_J))
		return nc_refuse(r, b->code_at[NC_MOTION],
				 "I or J, from the start to the control point",
				 "G5.1 without I and J");
	nc_target(r, end_mm);
	for (int i = 0; i < 2; i++) {
		const enum nc_slot slot = i ? NC_J : NC_I;

		p[i] = here[i] +
		       (nc_has(r, slot) ?
			b->value[slot] * r->scale[INTERP_X] : 0);
		p[2 + i] = end_mm[i];
	}
	return bezier(r, p, 2);
}
