/* SPDX-License-Identifier: Apache-2.0 */
/* curve_rate.c - direction and bend of a piece of a curve, where it starts and
 * ends */
#include "curve/span.h"
#include "speed/heading.h"
#include "interp/program.h"

#include <math.h>

/* Where C' is zero, look this far inside the piece, as a share of its
 * parameter. */
#define INSIDE	1e-6

/* The span that ends at @u or after it, if @u is not the first knot. */
static uint32_t span_before(const struct interp_nurbs *c, double u)
{
	uint32_t span = interp_nurbs_span(c, u);

	while (span > c->degree &&
	       (c->knots[span] >= u || c->knots[span] == c->knots[span + 1]))
		span--;
	return span;
}

/* One end of a piece of a curve. */
struct end {
	struct interp_nurbs c;
	const uint8_t *axis;
	struct interp_nurbs_point at;
	double speed;			/* length per parameter */
};

/* The two sides of a knot may differ, and a cusp has no direction. */
static bool look_at(const struct interp_program *p,
		    const struct interp_seg *seg, bool at_end, int derivs,
		    struct end *ret)
{
	const struct interp_piece *piece = &p->pieces[seg->arg];
	const struct interp_nurbs_stop *s = p->stops + piece->stops_at;
	struct interp_nurbs *c = &ret->c;
	struct interp_nurbs_eval e;
	double u, inside;

	if (!interp_program_curve(p, piece->curve, c) || piece->nstops < 2 ||
	    piece->stops_at + piece->nstops > p->head->nstops)
		return false;
	u = s[at_end ? piece->nstops - 1 : 0].u;
	inside = (s[piece->nstops - 1].u - s[0].u) *
		 (at_end ? -INSIDE : INSIDE);
	interp_nurbs_open(&e, c);
	nurbs_span_enter(&e, at_end ? span_before(c, u) :
				      interp_nurbs_span(c, u));
	nurbs_span_at(&e, u, derivs, &ret->at);
	ret->speed = sqrt(interp_nurbs_dot(c, ret->at.d[1], ret->at.d[1]));
	if (!(ret->speed * fabs(inside) > INSIDE * INSIDE * seg->length_mm)) {
		nurbs_span_at(&e, u + inside, derivs, &ret->at);
		ret->speed = sqrt(interp_nurbs_dot(c, ret->at.d[1],
						   ret->at.d[1]));
	}
	ret->axis = p->curves[piece->curve].axis;
	return ret->speed > 0;
}

bool interp_program_curve_rate(const struct interp_program *p,
			       const struct interp_seg *seg, bool at_end,
			       double ret[INTERP_NAXES])
{
	struct end end;

	for (uint32_t j = 0; j < INTERP_NAXES; j++)
		ret[j] = 0;
	if (!look_at(p, seg, at_end, 1, &end))
		return false;
	for (uint32_t k = 0; k < end.c.naxes; k++)
		ret[heading_column(p, end.axis[k])] =
			end.at.d[1][k] / end.speed;
	return true;
}

bool interp_program_curve_bend(const struct interp_program *p,
			       const struct interp_seg *seg, bool at_end,
			       double ret[INTERP_NAXES])
{
	struct end end;
	double g2, along;

	for (uint32_t j = 0; j < INTERP_NAXES; j++)
		ret[j] = 0;
	if (!look_at(p, seg, at_end, 2, &end))
		return false;
	g2 = end.speed * end.speed;
	along = interp_nurbs_dot(&end.c, end.at.d[1], end.at.d[2]) / g2;
	for (uint32_t k = 0; k < end.c.naxes; k++)
		ret[heading_column(p, end.axis[k])] =
			(end.at.d[2][k] - along * end.at.d[1][k]) / g2;
	return true;
}
