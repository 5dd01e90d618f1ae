/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour_curve.c - a curve under an offset or a taper, as arcs and lines
 *
 * The parallel of a NURBS is none.  So it is cut where its knots are, and
 * further, until arcs through three of its points are a quarter pulse from it.
 */
#include "wire/contour.h"

#include "interp/nurbs.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define DEPTH_MAX	20
#define STRAIGHT_MM	1e-6		/* bent less than this is a line */
#define LOOKS		8		/* in each piece */

struct cutter {
	struct contour *k;
	struct interp_nurbs_eval eval;
	const struct interp_build_curve *curve;
	const struct interp_build_word *w;
	struct interp_diag *diag;
	double end_mm[INTERP_NAXES];
};

static struct vec at(struct cutter *k, double u)
{
	struct interp_nurbs_point p;
	struct vec v = { k->end_mm[INTERP_X], k->end_mm[INTERP_Y] };

	interp_nurbs_at(&k->eval, u, 0, &p);
	for (uint32_t j = 0; j < k->curve->nurbs.naxes; j++) {
		if (k->curve->axis[j] == INTERP_X)
			v.x = p.d[0][j];
		if (k->curve->axis[j] == INTERP_Y)
			v.y = p.d[0][j];
	}
	return v;
}

/* The arc from @a over @m to @b; a line where they are on one. */
static struct curve through(struct vec a, struct vec m, struct vec b)
{
	const double mx = m.x - a.x, my = m.y - a.y;
	const double bx = b.x - a.x, by = b.y - a.y;
	const double cross = mx * by - my * bx;
	const double m2 = mx * mx + my * my, b2 = bx * bx + by * by;
	struct vec centre;

	if (fabs(cross) < STRAIGHT_MM * sqrt(b2) || b2 == 0)
		return curve_line(a, b);
	centre.x = a.x + (by * m2 - my * b2) / (2 * cross);
	centre.y = a.y + (mx * b2 - bx * m2) / (2 * cross);
	return curve_round(a, b, centre, cross < 0);
}

static bool is_near(struct cutter *k, const struct curve *c, double u0,
		    double u1)
{
	if (c->arc && fabs(c->sweep) > 1.6)
		return false;
	for (int i = 1; i < LOOKS; i++) {
		const double u = u0 + (u1 - u0) * i / LOOKS;

		if (curve_from(c, at(k, u)) > k->k->guides.pulse_mm / 4)
			return false;
	}
	return true;
}

/* The wire keeps its lean: the top goes along. */
static int lay(struct cutter *k, const struct curve *c)
{
	const double *here = k->k->here_mm;
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = c->centre.x, .centre_b_mm = c->centre.y,
		.sweep = c->sweep,
	};
	double end[INTERP_NAXES];

	memcpy(end, here, sizeof(end));
	end[INTERP_X] = c->to.x;
	end[INTERP_Y] = c->to.y;
	if (guides_on(&k->k->guides)) {
		end[INTERP_U] += c->to.x - here[INTERP_X];
		end[INTERP_V] += c->to.y - here[INTERP_Y];
	}
	return c->arc ? contour_arc(k->k, end, &arc, k->w, k->diag) :
			contour_line(k->k, end, k->w, k->diag);
}

static int cut(struct cutter *k, double u0, double u1, int depth)
{
	const double mid = (u0 + u1) / 2;
	const struct curve c = through(at(k, u0), at(k, mid), at(k, u1));
	int err;

	if (depth == DEPTH_MAX || is_near(k, &c, u0, u1))
		return curve_length(&c) > 0 ? lay(k, &c) : 0;
	err = cut(k, u0, mid, depth + 1);
	return err ? err : cut(k, mid, u1, depth + 1);
}

static int check(struct cutter *k, const double end_mm[INTERP_NAXES])
{
	const struct interp_nurbs *n = &k->curve->nurbs;
	const struct vec to = at(k, interp_nurbs_last(n));
	const double slack = 2 * k->k->guides.pulse_mm;

	k->diag->line = k->w->line;
	/* Over which of its arcs would depend on the length of a pulse. */
	if (contour_leads(k->k))
		return interp_diag_say(k->diag, "a curve over which the offset "
				       "or the taper is reached or left; G1, G2 "
				       "or G3 as the lead");
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (i > INTERP_Y && fabs(end_mm[i] - k->k->here_mm[i]) > 1e-9)
			return interp_diag_say(k->diag, "a curve with another "
					       "axis under an offset, a taper, "
					       "guides or corner control; X and "
					       "Y alone");
	}
	if (fabs(to.x - end_mm[INTERP_X]) > slack ||
	    fabs(to.y - end_mm[INTERP_Y]) > slack)
		return interp_diag_say(k->diag, "a curve that does not end at "
				       "its last control point; a last knot as "
				       "often as the order");
	k->diag->line = 0;
	return 0;
}

int contour_cut_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		      const struct interp_build_curve *c,
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	struct cutter cutter = { .k = k, .curve = c, .w = w, .diag = diag };
	const struct interp_nurbs *n = &c->nurbs;
	uint32_t bad;
	const enum interp_nurbs_flaw flaw = interp_nurbs_check(n, &bad);
	int err;

	if (flaw != INTERP_NURBS_SOUND) {
		diag->line = w->line;
		return interp_diag_say(diag, "%s; %s",
				       interp_nurbs_flaw_text(flaw),
				       interp_nurbs_flaw_wanted(flaw));
	}
	memcpy(cutter.end_mm, end_mm, sizeof(cutter.end_mm));
	interp_nurbs_open(&cutter.eval, n);
	err = check(&cutter, end_mm);
	for (uint32_t i = n->degree; !err && i < n->npoints; i++) {
		if (n->knots[i] < n->knots[i + 1])
			err = cut(&cutter, n->knots[i], n->knots[i + 1], 0);
	}
	return err;
}
