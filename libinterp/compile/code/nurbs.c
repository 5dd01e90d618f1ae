/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs.c - curves of control points and knots; G6.2 in Fanuc's form
 *
 * A NURBS is put together block by block and built when it is complete: for
 * G5.2 at G5.3; for G6.2 when it has as many knots as its control points and
 * its order need.  Until then no other word may stand on a line.
 */
#include "code/nurbs_words.h"
#include "code/tip_turn.h"
#include "wire/to_build.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROW		(INTERP_NAXES + 1)
#define FANUC_ORDER	4
#define POINTS_MAX	1000000u
#define END_PULSES	2.0

/* -- Points and knots ----------------------------------------------------- */

void nc_curve_free(struct nc_curve *c)
{
	free(c->points);
	free(c->knots);
	free(c->marks);
}

static int refuse_many(struct nc_reader *r)
{
	return nc_refuse_at(r, r->line, "up to 1000000, in several curves",
			    "more than %u control points or knots in a curve",
			    POINTS_MAX);
}

/* Each point has a mark. */
static bool grow_points(struct nc_curve *c)
{
	size_t room = c->points_room;

	return grow_array(&c->points, &room, ROW * sizeof(*c->points)) ||
	       grow_array(&c->marks, &c->points_room, sizeof(*c->marks));
}

int nc_curve_point(struct nc_reader *r, const double at_mm[INTERP_NAXES],
		   double weight)
{
	struct nc_curve *c = &r->curve;
	double *row;

	if (c->npoints == POINTS_MAX)
		return refuse_many(r);
	if (c->npoints == c->points_room && grow_points(c))
		return -ENOMEM;
	row = c->points + (size_t)c->npoints * ROW;
	for (int i = 0; i < INTERP_NAXES; i++)
		row[i] = at_mm[i] * weight;
	row[INTERP_NAXES] = weight;
	c->marks[c->npoints++] = (struct interp_build_mark) { 0, r->line };
	memcpy(c->last_mm, at_mm, sizeof(c->last_mm));
	return 0;
}

int nc_curve_knot(struct nc_reader *r, double u)
{
	struct nc_curve *c = &r->curve;

	if (c->nknots == POINTS_MAX + INTERP_NURBS_ORDER_MAX)
		return refuse_many(r);
	if (c->nknots == c->knots_room &&
	    grow_array(&c->knots, &c->knots_room, sizeof(*c->knots)))
		return -ENOMEM;
	c->knots[c->nknots++] = u;
	return 0;
}

void nc_curve_open(struct nc_reader *r, uint8_t kind, uint32_t order)
{
	struct nc_curve *c = &r->curve;

	c->open = kind;
	c->order = order;
	c->line = r->line;
	c->npoints = c->nknots = 0;
	memcpy(c->last_mm, nc_here(r), sizeof(c->last_mm));
}

void nc_curve_target(const struct nc_reader *r, double ret_mm[INTERP_NAXES])
{
	const struct nc_block *b = &r->block;
	const double *last = r->curve.last_mm;

	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = !nc_has(r, (enum nc_slot)i) ? last[i] :
			    (r->incremental ? last[i] : r->offset_mm[i]) +
			    b->value[i] * r->scale[i];
}

/* Do only rotary axes move?  A curve moves an axis if its control points do. */
static bool is_rotary(const struct nc_curve *c)
{

	for (uint32_t i = 1; i < c->npoints; i++) {
		for (int a = 0; a < INTERP_NAXES; a++) {
			const double *row = c->points + (size_t)i * ROW;

			if (interp_axis_is_rotary((enum interp_axis)a) ||
			    row[a] == c->points[a] * row[INTERP_NAXES] /
				      c->points[INTERP_NAXES])
				continue;
			return false;
		}
	}
	return true;
}

/* Only differences of knots count.  Far from 0, a short span between them would
 * have few digits. */
static void shift_knots(struct nc_curve *c)
{
	const double first = c->knots[0];

	for (uint32_t i = 0; i < c->nknots; i++)
		c->knots[i] -= first;
}

/* The line of a control point is valid where the curve is nearest to the
 * point. */
void nc_curve_set_marks(struct nc_curve *c)
{
	shift_knots(c);
	for (uint32_t i = 0; i < c->npoints; i++) {
		double sum = 0;

		for (uint32_t j = 1; j < c->order; j++)
			sum += c->knots[i + j];
		c->marks[i].u = sum / (c->order - 1);
	}
}

/* A curve with loose ends ends at another place.  What follows would then begin
 * where the machine does not stand. */
int nc_curve_check_end(struct nc_reader *r, const double here[INTERP_NAXES])
{
	const double *last = r->curve.last_mm;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const double pulse_mm = r->o->machine->axis[i].pulse_mm;

		if (fabs(here[i] - last[i]) > END_PULSES * pulse_mm)
			return nc_refuse(r, r->line_at, "a last knot that "
				 "stands as often as the order", "a curve that "
				 "ends at %c %.4f, not at its last control "
				 "point: %.4f", INTERP_AXIS_LETTERS[i],
				 here[i], last[i]);
	}
	return 0;
}

/* Each point is a place times its weight. */
static int check_beside(struct nc_reader *r)
{
	const struct nc_curve *c = &r->curve;
	double at[INTERP_NAXES];
	const uint32_t n = nc_is_eccentric(r) ? c->npoints : 0;
	int err = 0;

	for (uint32_t i = 0; i < n && !err; i++) {
		const double *row = c->points + (size_t)i * ROW;

		memcpy(at, nc_here(r), sizeof(at));
		if (fabs(row[INTERP_C] / row[INTERP_NAXES] - at[INTERP_C]) >
		    1e-9)
			at[INTERP_C]++;
		err = nc_check_eccentric(r, at);
	}
	return err;
}

static int check_end(struct nc_reader *r)
{
	double here[INTERP_NAXES];

	guides_here(&r->contour.guides, here);
	return nc_curve_check_end(r, here);
}

int nc_curve_build(struct nc_reader *r)
{
	struct nc_curve *c = &r->curve;
	struct interp_build_curve bc = {
		.nurbs = { .degree = c->order - 1, .naxes = INTERP_NAXES,
			   .npoints = c->npoints, .counted = INTERP_NAXES,
			   .knots = c->knots, .points = c->points },
		.marks = c->marks, .nmarks = c->npoints,
	};
	int err = nc_word(r, is_rotary(c), false);

	c->open = 0;
	if (!err)
		err = check_beside(r);
	if (!err)
		err = nc_room(r);
	if (err)
		return err;
	for (uint8_t i = 0; i < INTERP_NAXES; i++)
		bc.axis[i] = i;
	nc_curve_set_marks(c);
	if (r->tool.on)
		return nc_tip_curve(r, &bc);
	err = contour_nurbs(&r->contour, c->last_mm, &bc, &r->word, r->diag);
	if (err == 1)
		err = 0;
	else if (!err)
		err = check_end(r);
	return nc_placed(r, err, c->last_mm);
}

int nc_curve_refuse_weight(struct nc_reader *r, enum nc_slot slot)
{
	const uint8_t *at = r->block.at[slot];

	return nc_refuse(r, at,
			 "a weight above 0: 0.000000001 or more, within a "
			 "factor of 10000 of the others",
			 "%s, a weight of %g", nc_quote_word(r, at).s,
			 r->block.value[slot]);
}

int nc_curve_check_points(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_curve *c = &r->curve;

	if (c->npoints >= c->order)
		return 0;
	return nc_refuse(r, at, "as many as the order, or more",
			 "%u control points for a curve of order %u",
			 c->npoints, c->order);
}

/* -- G6.2 ----------------------------------------------------------------- */

static int fanuc_open(struct nc_reader *r)
{
	double order = FANUC_ORDER;

	if (nc_has(r, NC_P))
		order = r->block.value[NC_P];
	if (order != floor(order) || order < 2 ||
	    order > INTERP_NURBS_ORDER_MAX)
		return nc_refuse(r, r->block.at[NC_P], "an order of 2 to 10, "
				 "the degree + 1", "a curve of order %g",
				 order);
	nc_curve_open(r, NC_NURBS, (uint32_t)order);
	return 0;
}

int nc_curve_next_knot(struct nc_reader *r, enum nc_slot slot)
{
	const struct nc_curve *c = &r->curve;
	const uint8_t *at = r->block.at[slot];
	const double u = r->block.value[slot];
	uint32_t same = 1;

	if (c->nknots > 0 && u < c->knots[c->nknots - 1])
		return nc_refuse(r, at, "knots that do not fall",
				 "knot %g behind knot %g", u,
				 c->knots[c->nknots - 1]);
	while (same <= c->nknots && c->knots[c->nknots - same] == u)
		same++;
	if (same > c->order)
		return nc_refuse(r, at, "a knot at most as often as the order, "
				 "the next 1e-9 of the whole above it or more",
				 "%s: knot %g a %uth time in a curve of order "
				 "%u", nc_quote_word(r, at).s, u, same,
				 c->order);
	return nc_curve_knot(r, u);
}

int nc_curve_in_turn(struct nc_reader *r, enum nc_slot slot)
{
	if (r->curve.nknots <= r->curve.npoints + 1)
		return 0;
	return nc_refuse(r, r->block.at[slot], "the rest of the knots, "
			 "alone in their blocks",
			 "a control point behind knots of their own");
}

static int fanuc_point(struct nc_reader *r)
{
	const double weight = nc_has(r, NC_R) ? r->block.value[NC_R] : 1;
	double at_mm[INTERP_NAXES];
	const int err = nc_curve_in_turn(r, NC_K);

	if (err)
		return err;
	if (!(weight >= NC_WEIGHT_MIN))
		return nc_curve_refuse_weight(r, NC_R);
	nc_curve_target(r, at_mm);
	return nc_curve_point(r, at_mm, weight);
}

static int fanuc(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	struct nc_curve *c = &r->curve;
	const bool first = !c->open;
	int err = 0;

	if (!(b->words & (NC_AXES | NC_BIT(NC_K))) && !nc_has(r, NC_R) &&
	    !nc_has(r, NC_P))
		return 0;
	if (!nc_has(r, NC_K))
		return nc_refuse(r, b->code_at[NC_MOTION],
				 "K and a knot in each block of G6.2",
				 "a block of G6.2 without a knot");
	if (first)
		err = fanuc_open(r);
	else if (nc_has(r, NC_P))
		err = nc_refuse(r, b->at[NC_P], "P in the first block of G6.2",
			       "a second order of one curve");
	if (!err)
		err = nc_curve_next_knot(r, NC_K);
	if (!err && (first || b->words & (NC_AXES | NC_BIT(NC_R))))
		err = fanuc_point(r);
	if (err || c->nknots != c->npoints + c->order)
		return err;
	err = nc_curve_check_points(r, b->at[NC_K]);
	return err ? err : nc_curve_build(r);
}

int nc_curve_refuse_plane(struct nc_reader *r)
{
	return nc_refuse(r, r->block.code_at[NC_MOTION], "G17 before it",
			 "%s outside the plane XY", nc_quote_word(r,
			 r->block.code_at[NC_MOTION]).s);
}

/* -- Lines ---------------------------------------------------------------- */

int nc_curve_goes_on(struct nc_reader *r)
{
	const uint32_t may = NC_BIT(NC_MOTION) | NC_BIT(NC_FEED);
	const struct nc_block *b = &r->block;
	const struct nc_curve *c = &r->curve;
	const int motion = nc_has_group(r, NC_MOTION) ?
			   b->code[NC_MOTION]->value : -1;
	/* Groups whose words have a value have no code. */
	const uint32_t words = NC_BIT(NC_LABEL) | NC_BIT(NC_REGISTER);
	const bool same = motion == c->open || motion < 0 ||
			  (motion == NC_NURBS_END &&
			   c->open == NC_NURBS_BLOCK);
	const uint8_t *at = nc_has(r, NC_D) ? b->at[NC_D] :
			    nc_has(r, NC_H) ? b->at[NC_H] :
			    nc_has(r, NC_O) ? b->at[NC_O] : r->line_at;

	if ((b->groups & ~may) == 0 && same)
		return 0;
	for (int g = 0; g < NC_NGROUPS; g++) {
		if (b->groups & ~((same ? may : NC_BIT(NC_FEED)) | words) &
		    NC_BIT(g))
			at = b->code_at[g];
	}
	if (c->open == NC_NURBS || c->open == NC_BODY)
		return nc_refuse(r, at, c->open == NC_BODY ? "the rest of its "
				 "knots, P alone in a block" :
				 "the rest of its knots, K alone in a block",
				 "%s in a curve of %u knots for %u control "
				 "points of order %u: it takes %u",
				 nc_quote_word(r, at).s, c->nknots, c->npoints,
				 c->order, c->npoints + c->order);
	return nc_refuse(r, at, "G5.3 before it",
			 "another word inside a curve begun in line %u",
			 c->line);
}

int nc_curve(struct nc_reader *r)
{
	static int (*const curves[])(struct nc_reader *) = {
		[NC_SPLINE]		= nc_curve_spline,
		[NC_PARABOLA]		= nc_curve_parabola,
		[NC_NURBS_BLOCK]	= nc_curve_block,
		[NC_NURBS_END]		= nc_curve_end,
		[NC_NURBS]		= fanuc,
		[NC_BODY]		= nc_body,
	};
	const int motion = r->block.code[NC_MOTION]->value;

	if (motion <= NC_PARABOLA && !(r->block.words & NC_MOVES))
		return 0;
	if (motion <= NC_PARABOLA && r->plane != 0)
		return nc_curve_refuse_plane(r);
	if (motion != NC_SPLINE)
		r->curve.smooth = false;
	return curves[motion](r);
}
