/* SPDX-License-Identifier: Apache-2.0 */
/* to_build.c - a work system, or a figure, that is turned or mirrored, on its
 * way to the builder */
#include "wire/to_build.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define XY	(1u << INTERP_X | 1u << INTERP_Y)

void guides_here(const struct guides *g, double ret_q_mm[INTERP_NAXES])
{
	interp_turn_back(&g->turn, interp_build_here(g->build), ret_q_mm);
}

int guides_line(const struct guides *g, const double end_mm[INTERP_NAXES],
	      const struct interp_build_word *w, struct interp_diag *diag)
{
	double to_mm[INTERP_NAXES];

	if (!interp_turn_is_on(&g->turn))
		return interp_build_line(g->build, end_mm, w, diag);
	interp_turn_to(&g->turn, end_mm, to_mm);
	return interp_build_line(g->build, to_mm, w, diag);
}

static int refuse_plane(const struct interp_turn *t, const char *what,
			struct interp_diag *diag)
{
	return interp_diag_say(diag, "%s beside the plane X Y, where the work "
			       "or the figure is turned by %g degrees%s; one "
			       "in X Y, or places that are not turned",
			       what, t->deg, t->mirrored ?
			       " and mirrored" : "");
}

int guides_arc(const struct guides *g, const double end_mm[INTERP_NAXES],
	     const struct interp_build_arc *arc,
	     const struct interp_build_word *w, struct interp_diag *diag)
{
	struct interp_build_arc turned = *arc;
	double to_mm[INTERP_NAXES], centre[2];

	if (!interp_turn_is_on(&g->turn))
		return interp_build_arc(g->build, end_mm, arc, w, diag);
	if (arc->axis_b != arc->axis_a + 1 ||
	    (arc->axis_a != INTERP_X && arc->axis_a != INTERP_U))
		return refuse_plane(&g->turn, "an arc", diag);
	interp_turn_to(&g->turn, end_mm, to_mm);
	interp_turn_plane(&g->turn, (double[]) { arc->centre_a_mm,
						 arc->centre_b_mm }, centre);
	turned.centre_a_mm = centre[0];
	turned.centre_b_mm = centre[1];
	if (g->turn.mirrored)
		turned.sweep = -arc->sweep;
	return interp_build_arc(g->build, to_mm, &turned, w, diag);
}

int guides_pair(const struct guides *g, const double end_mm[INTERP_NAXES],
	      const struct interp_build_contour contour[2],
	      const struct interp_build_word *w, struct interp_diag *diag)
{
	struct interp_build_contour two[2] = { contour[0], contour[1] };
	double to_mm[INTERP_NAXES];

	if (!interp_turn_is_on(&g->turn))
		return interp_build_pair(g->build, end_mm, contour, w, diag);
	interp_turn_to(&g->turn, end_mm, to_mm);
	for (int i = 0; i < 2; i++) {
		interp_turn_plane(&g->turn, contour[i].centre_mm,
				  two[i].centre_mm);
		if (g->turn.mirrored)
			two[i].sweep = -contour[i].sweep;
	}
	return interp_build_pair(g->build, to_mm, two, w, diag);
}

/* The column of @axis; -1: it has none. */
static int column_of(const struct interp_build_curve *c, int axis)
{
	for (uint32_t i = 0; i < c->nurbs.naxes; i++)
		if (c->axis[i] == axis)
			return (int)i;
	return -1;
}

/* Each point is multiplied by its weight, which a turn about 0 leaves alone. */
static int turn_points(const struct interp_turn *t,
		       const struct interp_build_curve *c, double *points)
{
	const size_t row = c->nurbs.naxes + 1;
	const int pair[2][2] = {
		{ column_of(c, INTERP_X), column_of(c, INTERP_Y) },
		{ column_of(c, INTERP_U), column_of(c, INTERP_V) },
	};

	for (int k = 0; k < 2; k++) {
		const int a = pair[k][0], b = pair[k][1];

		if ((a < 0) != (b < 0))
			return -EINVAL;
		for (uint32_t i = 0; a >= 0 && i < c->nurbs.npoints; i++) {
			double *at = points + i * row, to[2];

			interp_turn_plane(t, (double[]) { at[a], at[b] }, to);
			at[a] = to[0];
			at[b] = to[1];
		}
	}
	return 0;
}

int guides_curve(const struct guides *g, const struct interp_build_curve *c,
	       const struct interp_build_word *w, struct interp_diag *diag)
{
	const size_t bytes = (size_t)c->nurbs.npoints * (c->nurbs.naxes + 1) *
			     sizeof(double);
	struct interp_build_curve turned = *c;
	double *points;
	int err;

	if (!interp_turn_is_on(&g->turn))
		return interp_build_curve(g->build, c, w, diag);
	points = malloc(bytes);
	if (!points)
		return -ENOMEM;
	memcpy(points, c->nurbs.points, bytes);
	turned.nurbs.points = points;
	err = turn_points(&g->turn, c, points) < 0 ?
	      refuse_plane(&g->turn, "a curve", diag) :
	      interp_build_curve(g->build, &turned, w, diag);
	free(points);
	return err;
}

/* Does it move both of X Y, or none? */
static bool goes_together(uint32_t axes)
{
	return (axes & XY) == 0 || (axes & XY) == XY;
}

int guides_escape(const struct guides *g, const struct interp_escape *e)
{
	struct interp_escape turned;

	if (!interp_turn_is_on(&g->turn) || !e)
		return interp_build_escape(g->build, e);
	if (!goes_together(e->home) || !goes_together(e->out))
		return interp_build_escape(g->build, NULL);
	turned = *e;
	if (e->home & XY)
		interp_turn_to(&g->turn, e->home_mm, turned.home_mm);
	if (e->out & XY)
		interp_turn_to(&g->turn, e->out_mm, turned.out_mm);
	return interp_build_escape(g->build, &turned);
}
