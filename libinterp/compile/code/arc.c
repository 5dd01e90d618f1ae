/* SPDX-License-Identifier: Apache-2.0 */
/*
 * arc.c - G2 and G3: finds the centre from I J K or from R
 *
 * A program writes an arc by places that are rounded to their last digit q.  So
 * each of them is up to q / sqrt(2) beside the place that was meant, and only
 * by that may the arc fail to come out: start, end and centre of the radii, or
 * R and half the way from start to end.  What is farther off was not meant so,
 * and is refused.  How fine the machine's pulses are has no part in it.
 */
#include "code/macro.h"
#include "code/number.h"
#include "code/reader.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A shorter length is neither a radius nor a chord. */
#define NOTHING_MM	1e-6

const struct nc_plane nc_planes[3] = {
	{ INTERP_X, INTERP_Y, INTERP_Z, NC_I, NC_J, NC_K,
	  "G17 (XY)", "I and J, or R" },
	{ INTERP_Z, INTERP_X, INTERP_Y, NC_K, NC_I, NC_J,
	  "G18 (ZX)", "I and K, or R" },
	{ INTERP_Y, INTERP_Z, INTERP_X, NC_J, NC_K, NC_I,
	  "G19 (YZ)", "J and K, or R" },
};

/* -- Last digits ---------------------------------------------------------- */

/* X10.5 and X10.500 say the same, so zeros at the end are no digits: one of the
 * two words of a place has others nearly always.  Nobody rounds an arc to less
 * than these. */
#define DECIMALS_MM	2
#define DECIMALS_INCH	3

/* How many decimals the word at @at has.  What macros computed has those that a
 * control keeps; so has a length without a point, where it counts in them. */
int nc_decimals(const struct nc_reader *r, const uint8_t *at)
{
	const int kept = r->unit_mm > 1 ? 4 : 3;
	const uint8_t *p = at + 1;
	int n = 0;

	if (nc_is_computed(r, p))
		return kept;
	while (p < r->stop && *p != '.' &&
	       (nc_classes[*p] == NC_NUMERIC || nc_classes[*p] == NC_BLANK))
		p++;
	if (p == r->stop || *p != '.')
		return r->d->point == NC_POINT_LAST ? kept : 0;
	for (int k = 1; ++p < r->stop && isdigit(*p); k++)
		n = *p == '0' ? n : k;
	return n;
}

/* The last digit of those words of the line that are in @words, in mm. */
static double digit_mm(const struct nc_reader *r, uint32_t words)
{
	int most = r->unit_mm > 1 ? DECIMALS_INCH : DECIMALS_MM;

	for (words &= r->block.words; words; words &= words - 1) {
		const int n = nc_decimals(r, r->block.at[__builtin_ctz(words)]);

		most = n > most ? n : most;
	}
	return r->scale[INTERP_X] /
	       nc_pow10[most < NC_POW10_MAX ? most : NC_POW10_MAX];
}

/* A place that is written to @digit_mm may be so far beside the one meant. */
static double rounded_mm(double digit_mm)
{
	return digit_mm * M_SQRT1_2;
}

/* An end and a centre; where the top of a wire leans, the bottom's too. */
#define RING_PLACES	4

/* Ends of an arc in its plane, and its centre. */
struct ring {
	double from_mm[2], to_mm[2], centre_mm[2];
	uint32_t words[RING_PLACES];	/* that say a place; 0: none */
	const char *name;
};

/* How far the radii may differ. */
static double ring_rounded_mm(const struct nc_reader *r, const struct ring *g)
{
	double mm = 0;

	for (int i = 0; i < RING_PLACES; i++)
		if (g->words[i])
			mm += 2 * rounded_mm(digit_mm(r, g->words[i]));
	return mm;
}

static double length(const double from_mm[2], const double to_mm[2])
{
	const double a = to_mm[0] - from_mm[0], b = to_mm[1] - from_mm[1];

	return sqrt(a * a + b * b);
}

/*
 * Start and end are each at their own place beside the circle.  A centre that
 * is off makes the one radius longer and, on half a turn, the other shorter.
 */
static int check_ring(struct nc_reader *r, const struct ring *g,
		      const double end_mm[INTERP_NAXES])
{
	const double r0 = length(g->from_mm, g->centre_mm);
	const double r1 = length(g->to_mm, g->centre_mm);
	const double off = fabs(r1 - r0);
	char wanted[96];
	double most;

	if (off <= NOTHING_MM)
		return 0;
	most = ring_rounded_mm(r, g);
	if (off <= most + NOTHING_MM)
		return 0;
	snprintf(wanted, sizeof(wanted), "radii that agree within %.3g mm, as "
		 "its last digits can say them", most);
	return nc_placed(r, nc_refuse_at(r, r->line, wanted, "the %s starts "
					 "%.7g mm from its centre and ends "
					 "%.7g mm from it", g->name, r0, r1),
			 end_mm);
}

/* -- The centre ----------------------------------------------------------- */

/* What says a centre in this dialect. */
static const char *centre_words(const struct nc_reader *r,
				const struct nc_plane *p)
{
	return r->d->classes['R'] == NC_WORD + NC_R ? p->centre : "I and J";
}

static int by_centre(struct nc_reader *r, const struct nc_plane *p,
		     const double end_mm[INTERP_NAXES],
		     struct interp_build_arc *arc)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	const uint8_t *at = b->code_at[NC_MOTION];
	const bool has_a = nc_has(r, p->ca), has_b = nc_has(r, p->cb);
	const double ca = has_a ? b->value[p->ca] * r->scale[p->a] : 0;
	const double cb = has_b ? b->value[p->cb] * r->scale[p->b] : 0;

	if (nc_has(r, p->other))
		return nc_refuse(r, b->at[p->other], centre_words(r, p),
				 "%s for an arc in the plane %s",
				 nc_quote_word(r, b->at[p->other]).s, p->name);
	if (!has_a && !has_b)
		return nc_refuse(r, at, centre_words(r, p),
				 "an arc without a centre");
	if (r->d->arc_places && r->incremental)
		return nc_refuse(r, at, "arcs under G90: I J are places there; "
				 "under G91 controls of this family differ",
				 "an arc under G91");
	if (!r->arc_incremental && !(has_a && has_b))
		return nc_refuse(r, at, "both words of the centre; G91.1 makes "
				 "them distances, where one may be missing",
				 "half a centre under G90.1");
	arc->centre_a_mm = ca + (r->arc_incremental ? here[p->a] :
				 r->offset_mm[p->a]);
	arc->centre_b_mm = cb + (r->arc_incremental ? here[p->b] :
				 r->offset_mm[p->b]);
	if (hypot(arc->centre_a_mm - here[p->a],
		  arc->centre_b_mm - here[p->b]) < NOTHING_MM)
		return nc_refuse(r, b->at[has_a ? p->ca : p->cb],
				 "a centre away from the start",
				 "an arc of radius 0: its centre is its start");
	return check_ring(r, &(struct ring) {
		.name = "arc",
		.from_mm = { here[p->a], here[p->b] },
		.to_mm = { end_mm[p->a], end_mm[p->b] },
		.centre_mm = { arc->centre_a_mm, arc->centre_b_mm },
		.words = { NC_BIT(p->a) | NC_BIT(p->b),
			   NC_BIT(p->ca) | NC_BIT(p->cb) },
	}, end_mm);
}

static int refuse_radius(struct nc_reader *r, double radius, double half)
{
	char wanted[96];

	snprintf(wanted, sizeof(wanted),
		 "R of at least %.6g mm, half the way from start to end", half);
	return nc_refuse(r, r->block.at[NC_R], wanted,
			 "a radius of %.6g mm, too small to reach the end",
			 radius);
}

/*
 * The centre lies on the perpendicular bisector of the chord.  For a
 * counter-clockwise arc of less than half a turn it is on the left side.  A
 * clockwise arc changes the side, and so does an arc longer than half a turn.
 */
static int by_radius(struct nc_reader *r, const struct nc_plane *p,
		     const double end_mm[INTERP_NAXES], bool clockwise,
		     struct interp_build_arc *arc)
{
	const double *here = nc_here(r);
	const double value = r->block.value[NC_R] * r->scale[p->a];
	const double radius = fabs(value);
	const double da = end_mm[p->a] - here[p->a];
	const double db = end_mm[p->b] - here[p->b];
	const double chord = hypot(da, db), half = chord / 2;
	double off = 0;

	if (radius < NOTHING_MM)
		return nc_refuse(r, r->block.at[NC_R], "R above 0 for the "
				 "shorter arc, below 0 for the longer",
				 "an arc of radius 0");
	if (chord < NOTHING_MM)
		return nc_refuse(r, r->block.at[NC_R], "an end away from the "
				 "start; I J K for a full circle",
				 "R on an arc that ends at its start");
	if (half - radius > NOTHING_MM +
	    rounded_mm(digit_mm(r, NC_BIT(p->a) | NC_BIT(p->b))) +
	    digit_mm(r, NC_BIT(NC_R)) / 2)
		return refuse_radius(r, radius, half);
	if (radius > half)
		off = sqrt((radius - half) * (radius + half)) / chord;
	if (clockwise != (value < 0))
		off = -off;
	arc->centre_a_mm = here[p->a] + da / 2 - off * db;
	arc->centre_b_mm = here[p->b] + db / 2 + off * da;
	return 0;
}

static int centre(struct nc_reader *r, const struct nc_plane *p,
		  const double end_mm[INTERP_NAXES], bool clockwise,
		  struct interp_build_arc *arc)
{
	if (!nc_has(r, NC_R))
		return by_centre(r, p, end_mm, arc);
	if (r->block.words & NC_CENTRE)
		return nc_refuse(r, r->block.at[NC_R], p->centre,
				 "R beside a centre");
	return by_radius(r, p, end_mm, clockwise, arc);
}

/* What the centre of the top's arc is counted from: as U V are, from that of
 * the bottom's arc; behind a colon as I J are. */
static double top_centre_from(const struct nc_reader *r, int i,
			      const struct interp_build_contour *bottom)
{
	const int axis = i ? INTERP_V : INTERP_U;

	if (r->d->lean && !r->block.colon)
		return bottom->centre_mm[i];
	return r->arc_incremental ? nc_here(r)[axis] : r->offset_mm[axis];
}

static int check_top(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		     const struct interp_build_contour *c, bool leans)
{
	const double *here = nc_here(r);

	return check_ring(r, &(struct ring) {
		.name = "arc of the top",
		.from_mm = { here[INTERP_U], here[INTERP_V] },
		.to_mm = { end_mm[INTERP_U], end_mm[INTERP_V] },
		.centre_mm = { c->centre_mm[0], c->centre_mm[1] },
		.words = {
			NC_BIT(NC_U) | NC_BIT(NC_V),
			NC_BIT(NC_UI) | NC_BIT(NC_UJ),
			leans ? NC_BIT(NC_X) | NC_BIT(NC_Y) : 0,
			leans ? NC_BIT(NC_I) | NC_BIT(NC_J) | NC_BIT(NC_R) : 0,
		},
	}, end_mm);
}

/* The arc of the top.  Its direction is the G word behind the colon, or else
 * that of the bottom.  If the line only has U or V, the top goes straight. */
static int top(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       int motion, const struct interp_build_contour *bottom,
	       struct interp_build_contour *c)
{
	const struct nc_block *b = &r->block;
	const bool leans = r->d->lean && !b->colon;
	const double *here = nc_here(r);

	*c = (struct interp_build_contour) { .arc = false };
	if (b->upper)
		motion = b->upper->value;
	if (!(b->colon || nc_has(r, NC_UI) || nc_has(r, NC_UJ)) || motion < 2) {
		if (leans)
			return nc_refuse_at(r, r->line, "K and L, the centre "
					    "of the top's arc",
					    "an arc with U or V and no centre "
					    "of its top");
		if (b->words & (NC_BIT(NC_UI) | NC_BIT(NC_UJ)))
			return nc_refuse_at(r, r->line, "G2 or G3 before it",
					    "a centre of a straight top");
		return 0;
	}
	c->arc = true;
	for (int i = 0; i < 2; i++) {
		const enum nc_slot slot = i ? NC_UJ : NC_UI;

		if (!nc_has(r, slot) && !r->arc_incremental && !leans)
			return nc_refuse_at(r, r->line, "both I and J",
					    "half a centre under G90.1");
		c->centre_mm[i] = top_centre_from(r, i, bottom) +
				  (nc_has(r, slot) ? b->value[slot] *
				   r->scale[INTERP_U + i] : 0);
	}
	if (hypot(c->centre_mm[0] - here[INTERP_U],
		  c->centre_mm[1] - here[INTERP_V]) < NOTHING_MM)
		return nc_refuse_at(r, r->line, "I or J away from 0",
				    "a top arc of radius 0");
	c->sweep = interp_build_sweep(&here[INTERP_U], &end_mm[INTERP_U],
				      c->centre_mm, motion == 2);
	return check_top(r, end_mm, c, leans);
}

static int go_two(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		  int motion, const struct interp_build_contour *bottom)
{
	struct interp_build_contour two[2] = { *bottom };
	const int err = top(r, end_mm, motion, bottom, &two[1]);

	return err ? err : contour_two(&r->contour, end_mm, two, &r->word,
				     r->diag);
}

static int go_round(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		    const struct interp_build_arc *arc)
{
	const struct interp_build_contour bottom = {
		.arc = true, .sweep = arc->sweep,
		.centre_mm = { arc->centre_a_mm, arc->centre_b_mm },
	};

	if (nc_has_guides(r) && arc->axis_a == INTERP_X &&
	    (r->block.colon || (r->block.words & (NC_BIT(NC_U) | NC_BIT(NC_V) |
				NC_BIT(NC_UI) | NC_BIT(NC_UJ)))))
		return go_two(r, end_mm, arc->sweep < 0 ? 2 : 3, &bottom);
	return contour_arc(&r->contour, end_mm, arc, &r->word, r->diag);
}

int nc_line_two(struct nc_reader *r, const double end_mm[INTERP_NAXES])
{
	const struct interp_build_contour bottom = { .arc = false };
	int err = nc_word(r, false, r->block.code[NC_MOTION]->value == 0);

	if (!err)
		err = nc_room(r);
	if (err)
		return err;
	return nc_placed(r, go_two(r, end_mm, 1, &bottom), end_mm);
}

static double sweep_of(const struct nc_reader *r, const struct nc_plane *p,
		       const double end_mm[INTERP_NAXES],
		       const struct interp_build_arc *arc, bool clockwise)
{
	const double from_mm[2] = { nc_here(r)[p->a], nc_here(r)[p->b] };
	const double to_mm[2] = { end_mm[p->a], end_mm[p->b] };
	const double centre_mm[2] = { arc->centre_a_mm, arc->centre_b_mm };

	return interp_build_sweep(from_mm, to_mm, centre_mm, clockwise);
}

/* -- Turns ----------------------------------------------------------------- */

#define TURNS_MOST	1000

/* P of an arc: how often it goes round, with the last part of a turn. */
static int turns_of(struct nc_reader *r, int *ret)
{
	const double p = nc_has(r, NC_P) ? r->block.value[NC_P] : 1;

	*ret = (int)p;
	if (p == floor(p) && p >= 1 && p <= TURNS_MOST)
		return 0;
	return nc_refuse(r, r->block.at[NC_P], "P1 to P1000", "an arc of %g "
			 "turns", p);
}

/* One arc, or a whole turn of one. */
static int go_once(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		   const struct interp_build_arc *arc)
{
	int err = nc_room(r);

	if (err)
		return err;
	if (r->tool.on)
		return nc_tip_arc(r, end_mm, arc);
	err = go_round(r, end_mm, arc);
	return nc_placed(r, err, end_mm);
}

/* The other axes go on evenly. */
static int go_turns(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		    struct interp_build_arc arc, int turns)
{
	const double whole = arc.sweep < 0 ? -2 * M_PI : 2 * M_PI;
	const double all = arc.sweep + (turns - 1) * whole, last = arc.sweep;
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];
	int err = 0;

	memcpy(from_mm, nc_here(r), sizeof(from_mm));
	arc.sweep = whole;
	for (int k = 1; !err && k < turns; k++) {
		for (int i = 0; i < INTERP_NAXES; i++)
			to_mm[i] = from_mm[i] + k * whole / all *
				   (end_mm[i] - from_mm[i]);
		to_mm[arc.axis_a] = from_mm[arc.axis_a];
		to_mm[arc.axis_b] = from_mm[arc.axis_b];
		err = go_once(r, to_mm, &arc);
	}
	arc.sweep = last;
	return err ? err : go_once(r, end_mm, &arc);
}

int nc_arc(struct nc_reader *r, bool clockwise)
{
	const struct nc_plane *p = &nc_planes[r->plane];
	struct interp_build_arc arc = {
		.axis_a = p->a, .axis_b = p->b,
	};
	double end_mm[INTERP_NAXES];
	int err, turns;

	if (r->absent & (NC_BIT(p->a) | NC_BIT(p->b)))
		return nc_refuse(r, r->block.code_at[NC_MOTION],
				 "a plane of axes the machine has",
				 "an arc in the plane %s", p->name);
	nc_target(r, end_mm);
	err = nc_check_eccentric(r, end_mm);
	if (!err)
		err = centre(r, p, end_mm, clockwise, &arc);
	arc.sweep = sweep_of(r, p, end_mm, &arc, clockwise);
	if (!err)
		err = turns_of(r, &turns);
	if (!err)
		err = nc_word(r, false, false);
	if (err)
		return err;
	r->moved |= NC_BIT(p->a) | NC_BIT(p->b);
	return turns == 1 ? go_once(r, end_mm, &arc) :
			    go_turns(r, end_mm, arc, turns);
}
