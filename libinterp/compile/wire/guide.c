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
#include "wire/to_build.h"

#include "interp/angle.h"

#include <complex.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

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
	g->slope_max = tan(w->angle_max_deg * ANGLE_DEGREE);
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
	return interp_diag_say(diag,
			       "the wire leans by %.3f degrees; up to "
			       "%g degrees, wire.angle_max_deg of the "
			       "machine; at a sharp corner both faces lean",
			       atan(slope) / ANGLE_DEGREE,
			       g->wire->angle_max_deg);
}

static int check_tilt(const struct guides *g, const struct curve c[2],
		      struct interp_diag *diag)
{
	const int n = c[0].arc || c[1].arc ? TILT_SAMPLES : 1;

	for (int i = 0; i <= n; i++) {
		const double t = (double)i / n;
		const double slope = curve_distance(curve_at(&c[0], t),
						    curve_at(&c[1], t)) /
				     g->height_mm;

		if (slope > g->slope_max + 1e-9)
			return refuse_tilt(g, slope, diag);
	}
	return 0;
}

/* -- To the builder ------------------------------------------------------- */

struct cut {
	struct guides *g;
	const struct curve *c;		/* the two contours */
	const double *end_mm;
	const struct interp_build_word *w;
	struct interp_diag *diag;
};

/*
 * F is the speed of the faster contour in the work; the builder counts the
 * length on the axes X Y, or on U V if X Y stand.
 */
static double feed_on_axes(const struct cut *k, const double guide_mm[2])
{
	const double axes_mm = guide_mm[0] > 1e-9 ? guide_mm[0] : guide_mm[1];
	const double work_mm = fmax(curve_length(&k->c[0]),
				    curve_length(&k->c[1]));

	return axes_mm > 1e-9 && work_mm > 1e-9 ?
	       k->w->feed_mm_s * axes_mm / work_mm : k->w->feed_mm_s;
}

/* Both guides from where they stand to where the contours' ends lead them. */
static int put(const struct cut *k, const struct interp_build_contour two[2])
{
	struct interp_build_word word = *k->w;
	double here[INTERP_NAXES], end[INTERP_NAXES], guide_mm[2];

	k->g->cuts++;
	guides_here(k->g, here);
	memcpy(end, k->end_mm, sizeof(end));
	for (int i = 0; i < 2; i++) {
		const int x = i ? INTERP_U : INTERP_X, y = x + 1;
		const struct vec at = guide_at(k->g->guide[i], k->c[0].to,
					       k->c[1].to);
		const struct vec from = { here[x], here[y] };
		const struct vec centre = { two[i].centre_mm[0],
					    two[i].centre_mm[1] };
		const struct curve way = two[i].arc ?
			curve_arc(from, at, centre, two[i].sweep) :
			curve_line(from, at);

		end[x] = at.x;
		end[y] = at.y;
		guide_mm[i] = curve_length(&way);
	}
	word.feed_mm_s = feed_on_axes(k, guide_mm);
	return guides_pair(k->g, end, two, &word, k->diag);
}

static int cut_lines(const struct cut *k)
{
	const struct interp_build_contour two[2] = { { .arc = false } };

	return put(k, two);
}

/* A contour that stands, or has shrunk to a point, goes with any arc. */
static bool is_point(const struct curve *c)
{
	return c->arc ? c->r == 0 : curve_distance(c->from, c->to) < 1e-9;
}

static double complex radius_of(const struct curve *c)
{
	return c->arc && c->r > 0 ? c->r * cexp(I * c->theta) : 0;
}

static struct vec centre_of(const struct curve *c)
{
	return c->arc && c->r > 0 ? c->centre : c->from;
}

static bool are_similar(const struct cut *k)
{
	const struct curve *c = k->c;

	if (is_point(&c[0]) || is_point(&c[1]))
		return true;
	return c[0].arc && c[1].arc && fabs(c[0].sweep - c[1].sweep) *
	       fmax(c[0].r, c[1].r) < k->g->pulse_mm / 2;
}

static int cut_arcs(const struct cut *k)
{
	const struct curve *c = k->c;
	const struct vec centre[2] = { centre_of(&c[0]), centre_of(&c[1]) };
	const double sweep = radius_of(&c[0]) != 0 ? c[0].sweep : c[1].sweep;
	struct interp_build_contour two[2];

	for (int i = 0; i < 2; i++) {
		const struct guide m = k->g->guide[i];
		const double complex r = m.from_bottom * radius_of(&c[0]) +
					 m.from_top * radius_of(&c[1]);
		const struct vec at = guide_at(m, centre[0], centre[1]);

		two[i] = (struct interp_build_contour) {
			.arc = cabs(r) > CURVE_SAME_MM,
			.sweep = sweep,
			.centre_mm = { at.x, at.y },
		};
	}
	return put(k, two);
}

/* The guides stand in the planes: the contours are theirs. */
static bool is_direct(const struct guides *g)
{
	return g->guide[0].from_bottom == 1 && g->guide[0].from_top == 0 &&
	       g->guide[1].from_bottom == 0 && g->guide[1].from_top == 1;
}

static int cut_direct(const struct cut *k)
{
	struct interp_build_contour two[2];

	for (int i = 0; i < 2; i++)
		two[i] = (struct interp_build_contour) {
			.arc = k->c[i].arc && k->c[i].r > CURVE_SAME_MM,
			.sweep = k->c[i].sweep,
			.centre_mm = { k->c[i].centre.x, k->c[i].centre.y },
		};
	return put(k, two);
}

/* Chords for a sagitta of a quarter pulse at the worse guide: an arc of n
 * chords has r*(sweep/n)^2/8. */
static double chords(const struct cut *k)
{
	double sagitta = 0;

	for (int i = 0; i < 2; i++) {
		const struct guide m = k->g->guide[i];
		double s = 0;

		for (int j = 0; j < 2; j++) {
			const struct curve *c = &k->c[j];

			if (c->arc)
				s += fabs(j ? m.from_top : m.from_bottom) *
				     c->r * c->sweep * c->sweep;
		}
		sagitta = fmax(sagitta, s / 8);
	}
	return fmax(ceil(sqrt(sagitta / (k->g->pulse_mm / 4))), 1);
}

static int cut_chords(const struct cut *k)
{
	const double n = chords(k);
	struct curve part[2];
	struct cut chord = *k;

	if (!(n <= CHORDS_MAX)) {
		return interp_diag_say(k->diag, "two contours that need %.0f "
				       "chords; smaller arcs", n);
	}
	chord.c = part;
	for (double i = 1; i <= n; i++) {
		int err;

		for (int j = 0; j < 2; j++)
			part[j] = curve_line(curve_at(&k->c[j], (i - 1) / n),
					     curve_at(&k->c[j], i / n));
		err = cut_lines(&chord);
		if (err < 0)
			return err;
	}
	return 0;
}

/* Guides off: the bottom contour is what X Y do. */
static int cut_bottom(const struct cut *k)
{
	const struct curve *c = &k->c[0];
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = c->centre.x, .centre_b_mm = c->centre.y,
		.sweep = c->sweep,
	};
	double end[INTERP_NAXES];

	k->g->cuts++;
	memcpy(end, k->end_mm, sizeof(end));
	end[INTERP_X] = c->to.x;
	end[INTERP_Y] = c->to.y;
	return c->arc ? guides_arc(k->g, end, &arc, k->w, k->diag) :
			guides_line(k->g, end, k->w, k->diag);
}

int guides_cut(struct guides *g, const struct curve c[2],
	       const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	const struct cut k = { g, c, end_mm, w, diag };
	int err;

	if (!guides_on(g))
		return cut_bottom(&k);
	err = check_tilt(g, c, diag);
	if (err < 0)
		return err;
	if (!(c[0].arc && c[0].r > 0) && !(c[1].arc && c[1].r > 0))
		return cut_lines(&k);
	if (are_similar(&k))
		return cut_arcs(&k);
	return is_direct(g) ? cut_direct(&k) : cut_chords(&k);
}
