/* SPDX-License-Identifier: Apache-2.0 */
/* curve_rate.c - the direction in which a piece of a curve starts, and ends */
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

bool interp_program_curve_rate(const struct interp_program *p,
			       const struct interp_seg *seg, bool at_end,
			       double ret[INTERP_NAXES])
{
	const struct interp_piece *piece = &p->pieces[seg->arg];
	const struct interp_nurbs_stop *s = p->stops + piece->stops_at;
	struct interp_nurbs_eval e;
	struct interp_nurbs_point at;
	struct interp_nurbs c;
	double u, inside, speed;

	if (!interp_program_curve(p, piece->curve, &c) || piece->nstops < 2 ||
	    piece->stops_at + piece->nstops > p->head->nstops)
		return false;
	u = s[at_end ? piece->nstops - 1 : 0].u;
	inside = (s[piece->nstops - 1].u - s[0].u) *
		 (at_end ? -INSIDE : INSIDE);
	interp_nurbs_open(&e, &c);
	nurbs_span_enter(&e, at_end ? span_before(&c, u) :
				      interp_nurbs_span(&c, u));
	/* The two sides of a knot may differ, and a cusp has no direction. */
	nurbs_span_at(&e, u, 1, &at);
	speed = sqrt(interp_nurbs_dot(&c, at.d[1], at.d[1]));
	if (!(speed * fabs(inside) > INSIDE * INSIDE * seg->length_mm)) {
		nurbs_span_at(&e, u + inside, 1, &at);
		speed = sqrt(interp_nurbs_dot(&c, at.d[1], at.d[1]));
	}
	for (uint32_t j = 0; j < INTERP_NAXES; j++)
		ret[j] = 0;
	for (uint32_t k = 0; speed > 0 && k < c.naxes; k++)
		ret[heading_column(p, p->curves[piece->curve].axis[k])] =
			at.d[1][k] / speed;
	return speed > 0;
}
