/* SPDX-License-Identifier: Apache-2.0 */
/*
 * guide.c - from contours on the two planes to motions of the two guides
 *
 * Each guide is at from_bottom * P + from_top * Q.  Of two lines that makes a
 * line.  Of two arcs of one sense and sweep it makes an arc: with complex
 * places P = c0 + R0*e^(i*t) and Q = c1 + R1*e^(i*t) a guide has the centre
 * and the radius of the same sum, whatever the phases of R0 and R1.  Any
 * other two make a curve that is neither; if the guides stand in the planes
 * it need not be known, else it is cut into chords within a quarter pulse.
 */
#include "wire/guide.h"

#include <complex.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEGREE		(3.14159265358979323846 / 180)

#define CHORDS_MAX	20000.0
#define TILT_SAMPLES	16		/* along an arc */

static double share_at(const struct interp_wire *w, double z_mm)
{
	return (z_mm - w->z_program_mm) / (w->z_second_mm - w->z_program_mm);
}

void guides_init(struct guides *g, const struct interp_wire *w,
		 const struct interp_machine *m, struct interp_build *b)
{
	*g = (struct guides) { .wire = w, .build = b,
			       .pulse_mm = m->axis[INTERP_X].pulse_mm };
	if (!guides_on(g))
		return;
	const double lower = share_at(w, w->z_lower_mm);
	const double upper = share_at(w, w->z_upper_mm);

	g->height_mm = w->z_second_mm - w->z_program_mm;
	g->slope_max = tan(w->angle_max_deg * DEGREE);
	g->guide[0] = (struct guide) { 1 - lower, lower };
	g->guide[1] = (struct guide) { 1 - upper, upper };
	if (w->guides == INTERP_GUIDES_RELATIVE)
		g->guide[1] = (struct guide) { lower - upper, upper - lower };
}

void guides_planes(const struct guides *g, const double at_mm[INTERP_NAXES],
		   struct vec ret[2])
{
	const struct guide a = g->guide[0], b = g->guide[1];
	const struct vec xy = { at_mm[INTERP_X], at_mm[INTERP_Y] };
	const struct vec uv = { at_mm[INTERP_U], at_mm[INTERP_V] };
	const double det = a.from_bottom * b.from_top -
			   a.from_top * b.from_bottom;

	ret[0] = ret[1] = xy;
	if (!guides_on(g))
		return;
	for (int i = 0; i < 2; i++) {
		const double kx = (i ? -b.from_bottom : b.from_top) / det;
		const double ku = (i ? a.from_bottom : -a.from_top) / det;

		ret[i] = (struct vec) { kx * xy.x + ku * uv.x,
					kx * xy.y + ku * uv.y };
	}
}

static struct vec guide_at(struct guide k, struct vec p, struct vec q)
{
	return (struct vec) { k.from_bottom * p.x + k.from_top * q.x,
			      k.from_bottom * p.y + k.from_top * q.y };
}

/* -- The wire's angle ------------------------------------------------------ */

static int refuse_tilt(const struct guides *g, double slope,
		       struct interp_diag *diag)
{
	snprintf(diag->found, sizeof(diag->found),
		 "the wire leans by %.3f degrees", atan(slope) / DEGREE);
	snprintf(diag->wanted, sizeof(diag->wanted),
		 "up to %g degrees, wire.angle_max_deg of the machine; at a "
		 "sharp corner both faces lean", g->wire->angle_max_deg);
	return -EINVAL;
}

static int check_tilt(const struct guides *g, const struct curve c[2],
		      struct interp_diag *diag)
{
	const int n = c[0].arc || c[1].arc ? TILT_SAMPLES : 1;

	for (int i = 0; i <= n; i++) {
		const double t = (double)i / n;
		const double slope = vec_distance(curve_at(&c[0], t),
						  curve_at(&c[1], t)) /
				     g->height_mm;

		if (slope > g->slope_max + 1e-9)
			return refuse_tilt(g, slope, diag);
	}
	return 0;
}

/* -- To the builder ---------------------------------------------------------- */

/* Both guides from where they stand to where P and Q lead them. */
static int put(struct guides *g, const struct vec to[2],
	       const struct interp_build_contour k[2],
	       const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	double end[INTERP_NAXES];

	g->cuts++;
	memcpy(end, end_mm, sizeof(end));
	for (int i = 0; i < 2; i++) {
		const struct vec at = guide_at(g->guide[i], to[0], to[1]);

		end[i ? INTERP_U : INTERP_X] = at.x;
		end[i ? INTERP_V : INTERP_Y] = at.y;
	}
	return interp_build_pair(g->build, end, k, w, diag);
}

static int cut_lines(struct guides *g, const struct curve c[2],
		     const double end_mm[INTERP_NAXES],
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	const struct interp_build_contour k[2] = { { .arc = false } };
	const struct vec to[2] = { c[0].to, c[1].to };

	return put(g, to, k, end_mm, w, diag);
}

/* A contour that stands, or has shrunk to a point, goes with any arc. */
static bool is_point(const struct curve *c)
{
	return c->arc ? c->r == 0 : vec_distance(c->from, c->to) < 1e-9;
}

static double complex radius_of(const struct curve *c)
{
	return c->arc && c->r > 0 ? c->r * cexp(I * c->theta) : 0;
}

static struct vec centre_of(const struct curve *c)
{
	return c->arc && c->r > 0 ? c->centre : c->from;
}

static bool are_similar(const struct guides *g, const struct curve c[2])
{
	if (is_point(&c[0]) || is_point(&c[1]))
		return true;
	return c[0].arc && c[1].arc && fabs(c[0].sweep - c[1].sweep) *
	       fmax(c[0].r, c[1].r) < g->pulse_mm / 2;
}

static int cut_arcs(struct guides *g, const struct curve c[2],
		    const double end_mm[INTERP_NAXES],
		    const struct interp_build_word *w,
		    struct interp_diag *diag)
{
	const struct vec centre[2] = { centre_of(&c[0]), centre_of(&c[1]) };
	const struct vec to[2] = { c[0].to, c[1].to };
	const double sweep = radius_of(&c[0]) != 0 ? c[0].sweep : c[1].sweep;
	struct interp_build_contour k[2];

	for (int i = 0; i < 2; i++) {
		const struct guide m = g->guide[i];
		const double complex r = m.from_bottom * radius_of(&c[0]) +
					 m.from_top * radius_of(&c[1]);
		const struct vec at = guide_at(m, centre[0], centre[1]);

		/* Of a pulse or less the builder makes no circle. */
		k[i] = (struct interp_build_contour) {
			.arc = cabs(r) > 2 * g->pulse_mm,
			.clockwise = sweep < 0,
			.centre_mm = { at.x, at.y },
		};
	}
	return put(g, to, k, end_mm, w, diag);
}

/* The guides stand in the planes: the contours are theirs. */
static bool is_direct(const struct guides *g)
{
	return g->guide[0].from_bottom == 1 && g->guide[0].from_top == 0 &&
	       g->guide[1].from_bottom == 0 && g->guide[1].from_top == 1;
}

static int cut_direct(struct guides *g, const struct curve c[2],
		      const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const struct vec to[2] = { c[0].to, c[1].to };
	struct interp_build_contour k[2];

	for (int i = 0; i < 2; i++)
		k[i] = (struct interp_build_contour) {
			.arc = c[i].arc, .clockwise = c[i].sweep < 0,
			.centre_mm = { c[i].centre.x, c[i].centre.y },
		};
	return put(g, to, k, end_mm, w, diag);
}

/* Chords for a sagitta of a quarter pulse at the worse guide: an arc of n
 * chords has r*(sweep/n)^2/8. */
static double chords(const struct guides *g, const struct curve c[2])
{
	double sagitta = 0;

	for (int i = 0; i < 2; i++) {
		double s = 0;

		for (int j = 0; j < 2; j++) {
			const double k = j ? g->guide[i].from_top :
					     g->guide[i].from_bottom;

			if (c[j].arc)
				s += fabs(k) * c[j].r * c[j].sweep * c[j].sweep;
		}
		sagitta = fmax(sagitta, s / 8);
	}
	return ceil(sqrt(sagitta / (g->pulse_mm / 4)));
}

static int cut_chords(struct guides *g, const struct curve c[2],
		      const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const double n = fmax(chords(g, c), 1);

	if (!(n <= CHORDS_MAX)) {
		snprintf(diag->found, sizeof(diag->found),
			 "two contours that need %.0f chords", n);
		snprintf(diag->wanted, sizeof(diag->wanted), "smaller arcs");
		return -EINVAL;
	}
	for (double i = 1; i <= n; i++) {
		const struct curve part[2] = {
			curve_line(curve_at(&c[0], (i - 1) / n),
				   curve_at(&c[0], i / n)),
			curve_line(curve_at(&c[1], (i - 1) / n),
				   curve_at(&c[1], i / n)),
		};
		const int r = cut_lines(g, part, end_mm, w, diag);

		if (r < 0)
			return r;
	}
	return 0;
}

/* Guides off: the bottom contour is what X Y do. */
static int cut_bottom(struct guides *g, const struct curve *c,
		      const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = c->centre.x, .centre_b_mm = c->centre.y,
		.clockwise = c->sweep < 0,
	};
	double end[INTERP_NAXES];

	g->cuts++;
	memcpy(end, end_mm, sizeof(end));
	end[INTERP_X] = c->to.x;
	end[INTERP_Y] = c->to.y;
	return c->arc && c->r > 0 ?
	       interp_build_arc(g->build, end, &arc, w, diag) :
	       interp_build_line(g->build, end, w, diag);
}

int guides_cut(struct guides *g, const struct curve c[2],
	       const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	int r;

	if (!guides_on(g))
		return cut_bottom(g, c, end_mm, w, diag);
	r = check_tilt(g, c, diag);
	if (r < 0)
		return r;
	if (!(c[0].arc && c[0].r > 0) && !(c[1].arc && c[1].r > 0))
		return cut_lines(g, c, end_mm, w, diag);
	if (are_similar(g, c))
		return cut_arcs(g, c, end_mm, w, diag);
	return is_direct(g) ? cut_direct(g, c, end_mm, w, diag) :
			      cut_chords(g, c, end_mm, w, diag);
}
