/* SPDX-License-Identifier: Apache-2.0 */
/*
 * probing.c - probing motions: G38.2, G80 ... G82, G160 ... G162
 *
 * Each word is made of three parts: a probing motion along one axis, the way to
 * the middle between the last two contacts (a "half"), and rapid motions.
 *
 * Only the machine learns where a probing motion ends.  So the program must say
 * by G92 what the axis reads afterwards, and it can no longer use machine
 * coordinates for this axis.
 */
#include "code/reader.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define OFF_MM		0.1		/* a wall, without Q */

/* -- Lines after a probing motion ------------------------------------------ */

static int refuse_unnamed(struct nc_reader *r, uint32_t axes)
{
	const int axis = __builtin_ctz(axes);
	char wanted[96];

	snprintf(wanted, sizeof(wanted), "G92 %c... before it, or G91",
		 INTERP_AXIS_LETTERS[axis]);
	return nc_refuse(r, r->block.at[axis], wanted,
			 "%s after a probing motion along %c, whose place has "
			 "no number yet", nc_quote_word(r, r->block.at[axis]).s,
			 INTERP_AXIS_LETTERS[axis]);
}

static int refuse_machine(struct nc_reader *r, enum nc_group group)
{
	const uint8_t *at = r->block.code_at[group];

	return nc_refuse(r, at, "places that count from the contact",
			 "%s after a probing motion: where the program is in "
			 "machine coordinates is not known",
			 nc_quote_word(r, at).s);
}

/* A G4, whose X is a time, or a G92, which gives the place its number. */
static bool is_no_place(const struct nc_reader *r)
{
	const struct nc_code *c = r->block.code[NC_ONE_SHOT];

	return nc_has_group(r, NC_ONE_SHOT) &&
	       (c->value == NC_DWELL || c->value == NC_SET);
}

int nc_check_probed(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint32_t named = b->words & NC_AXES & ~b->toward;

	if (b->toward && !nc_has_group(r, NC_PROBE)) {
		const uint8_t *at = b->at[__builtin_ctz(b->toward)];

		return nc_refuse(r, at, "a sign, digits and one decimal point; "
				 "without them with G80 G81 G82 G162",
				 "%s is not a word with a number",
				 nc_quote_run(r, at).s);
	}
	if (nc_has_group(r, NC_MACHINE) && named & r->loose)
		return refuse_machine(r, NC_MACHINE);
	if (nc_has_group(r, NC_ONE_SHOT) && r->loose &&
	    b->code[NC_ONE_SHOT]->value == NC_HOME &&
	    (!named || named & r->loose))
		return refuse_machine(r, NC_ONE_SHOT);
	if (nc_has_group(r, NC_TOOL_POINT) && r->loose &&
	    b->code[NC_TOOL_POINT]->value)
		return refuse_machine(r, NC_TOOL_POINT);
	if (is_no_place(r) || nc_by_distance(r) || !(named & r->unnamed))
		return 0;
	return refuse_unnamed(r, named & r->unnamed);
}

/* -- What they are made of ------------------------------------------------- */

static double length_of(const struct nc_reader *r, enum nc_slot slot,
			double without_mm)
{
	return nc_has(r, slot) ? r->block.value[slot] * r->unit_mm :
				 without_mm;
}

static double off_mm(const struct nc_reader *r)
{
	return length_of(r, NC_Q, OFF_MM);
}

/* The length of the axis's whole travel. */
static double span_mm(const struct nc_reader *r, int axis)
{
	const struct interp_axis_limits *l = &r->o->machine->axis[axis];

	return l->travel_max_mm - l->travel_min_mm;
}

/* G38.2 moves at the programmed feed; the others are rapid. */
static int go(struct nc_reader *r, int axis, double by_mm)
{
	double end_mm[INTERP_NAXES];

	memcpy(end_mm, nc_here(r), sizeof(end_mm));
	end_mm[axis] += by_mm;
	r->moved |= NC_BIT(axis);
	return nc_line_to(r, end_mm,
			  r->block.code[NC_PROBE]->value != NC_PROBE_FEED);
}

static int go_sensed(struct nc_reader *r, int axis, double by_mm, uint8_t ends)
{
	int err;

	/* Room for this line, and for the stop that is put in front of it. */
	err = nc_room(r);
	r->word.ends = ends;
	if (!err)
		err = go(r, axis, by_mm);
	r->word.ends = 0;
	r->loose |= NC_BIT(axis);
	r->unnamed |= NC_BIT(axis);
	return err;
}

static int probe(struct nc_reader *r, int axis, double by_mm)
{
	r->twice |= r->once & NC_BIT(axis);
	r->once |= NC_BIT(axis);
	return go_sensed(r, axis, by_mm, INTERP_SEG_PROBE);
}

/* Only the machine knows in which direction the middle lies.  So both
 * directions are written, and the machine walks one of the two. */
static int half(struct nc_reader *r, int axis)
{
	const int err = go_sensed(r, axis, span_mm(r, axis), INTERP_SEG_HALF);

	return err ? err : go_sensed(r, axis, -span_mm(r, axis),
				   INTERP_SEG_HALF);
}

/* -- One axis -------------------------------------------------------------- */

static const uint8_t *word_at(const struct nc_reader *r)
{
	return r->block.code_at[NC_PROBE];
}

/* The one axis of the line; -1 if there is none, or more than one. */
static int axis_of(struct nc_reader *r, const char *wanted)
{
	const uint32_t axes = r->block.words & NC_AXES;

	if (axes && !(axes & (axes - 1)))
		return __builtin_ctz(axes);
	nc_refuse(r, word_at(r), wanted, "%s %s",
		  nc_quote_word(r, word_at(r)).s,
		  axes ? "along several axes" : "without an axis");
	return -1;
}

/* G80 X- goes to the end of the travel; G80 X-5 and G38.2 X-5 to that place. */
static int probe_one(struct nc_reader *r)
{
	static const char wanted[] = "one of X Y Z with a way to go, as in "
				     "G80 X- or G80 X-5";
	const bool feed = r->block.code[NC_PROBE]->value == NC_PROBE_FEED;
	const int axis = axis_of(r, wanted);
	double end_mm[INTERP_NAXES], by_mm;

	if (axis < 0)
		return -EINVAL;
	if (r->block.toward && (feed || r->block.value[axis] == 0))
		return nc_refuse(r, r->block.at[axis], feed ? "a place to go "
				 "to, as in G38.2 X-5" : wanted,
				 "%s without a %s", nc_quote_run(r,
				 r->block.at[axis]).s, feed ? "place" : "sign");
	nc_target(r, end_mm);
	by_mm = r->block.toward ? r->block.value[axis] * span_mm(r, axis) :
				  end_mm[axis] - nc_here(r)[axis];
	if (fabs(by_mm) < r->o->machine->axis[axis].pulse_mm)
		return nc_refuse(r, r->block.at[axis], wanted,
				 "a probing motion without a way to go");
	return probe(r, axis, by_mm);
}

static int limit(struct nc_reader *r)
{
	static const char wanted[] = "one of X Y Z with a sign, as in G81 X-";
	const int axis = axis_of(r, wanted);

	if (axis < 0)
		return -EINVAL;
	if (!r->block.toward || r->block.value[axis] == 0)
		return nc_refuse(r, r->block.at[axis], wanted,
				 "%s is not a sign alone",
				 nc_quote_run(r, r->block.at[axis]).s);
	return go_sensed(r, axis, r->block.value[axis] * span_mm(r, axis),
			 INTERP_SEG_LIMIT);
}

static int half_one(struct nc_reader *r)
{
	static const char wanted[] = "one of X Y Z alone, as in G82 X";
	const int axis = axis_of(r, wanted);

	if (axis < 0)
		return -EINVAL;
	if (!r->block.toward || r->block.value[axis] != 0)
		return nc_refuse(r, r->block.at[axis], wanted,
				 "%s is not an axis alone",
				 nc_quote_run(r, r->block.at[axis]).s);
	if (!(r->twice & NC_BIT(axis)))
		return nc_refuse(r, word_at(r), "two probing motions along "
				 "that axis before it",
				 "a half with %s probing motion along %c",
				 r->once & NC_BIT(axis) ? "one" : "no",
				 INTERP_AXIS_LETTERS[axis]);
	return half(r, axis);
}

/* -- Several --------------------------------------------------------------- */

static int check_off(struct nc_reader *r)
{
	if (off_mm(r) >= r->o->machine->axis[0].pulse_mm)
		return 0;
	return nc_refuse(r, r->block.at[NC_Q], "the way off a wall, a pulse "
			 "or more", "%s is no way off a wall",
			 nc_quote_word(r, r->block.at[NC_Q]).s);
}

static int check_positive(struct nc_reader *r, enum nc_slot slot,
			  const char *wanted)
{
	const uint8_t *at = r->block.at[slot];

	if (!nc_has(r, slot) || r->block.value[slot] > 0)
		return 0;
	return nc_refuse(r, at, wanted, "%s is not above 0",
			 nc_quote_word(r, at).s);
}

static uint32_t passes(const struct nc_reader *r)
{
	return nc_has(r, NC_L) ? (uint32_t)r->block.value[NC_L] : 1;
}

static int probe_and_back(struct nc_reader *r, int axis, double by_mm)
{
	const int err = probe(r, axis, by_mm);

	return err ? err : go(r, axis, by_mm > 0 ? -off_mm(r) : off_mm(r));
}

/* Find both walls along one axis, and go to the middle between them. */
static int across_hole(struct nc_reader *r, int axis)
{
	const double most = length_of(r, NC_R, span_mm(r, axis));
	int err = probe_and_back(r, axis, -most);

	if (!err)
		err = probe(r, axis, most);
	return err ? err : half(r, axis);
}

static int hole(struct nc_reader *r)
{
	int err = check_positive(r, NC_R, "the farthest from wall to wall, "
				"above 0");

	if (!err)
		err = check_off(r);
	for (uint32_t n = passes(r); n > 0 && !err; n--) {
		err = across_hole(r, INTERP_X);
		if (!err)
			err = across_hole(r, INTERP_Y);
	}
	return err;
}

/* Go down beside the block, find its wall, go off it and up again. */
static int against_pillar(struct nc_reader *r, int axis, double by_mm)
{
	const double down = length_of(r, NC_K, 0);
	int err = go(r, INTERP_Z, -down);

	if (!err)
		err = probe_and_back(r, axis, by_mm);
	return err ? err : go(r, INTERP_Z, down);
}

static int over_pillar(struct nc_reader *r, int axis, double beside_mm)
{
	int err = go(r, axis, -beside_mm);

	if (!err)
		err = against_pillar(r, axis, beside_mm);
	if (!err)
		err = go(r, axis, 2 * beside_mm + off_mm(r));
	if (!err)
		err = against_pillar(r, axis, -2 * beside_mm);
	return err ? err : half(r, axis);
}

static int check_pillar(struct nc_reader *r)
{
	int err = check_off(r);

	if (!err && !(nc_has(r, NC_K) && (nc_has(r, NC_I) || nc_has(r, NC_J))))
		err = nc_refuse(r, word_at(r), "I, J or both: how far to the "
			       "side; and K: how far down",
			       "G161 without %s", nc_has(r, NC_K) ? "I and J" :
			       "K");
	if (!err)
		err = check_positive(r, NC_I, "so far that it is beside the "
				    "work, above 0");
	if (!err)
		err = check_positive(r, NC_J, "so far that it is beside the "
				    "work, above 0");
	return err ? err : check_positive(r, NC_K, "so far that it is below "
					"the edge, above 0");
}

static int pillar(struct nc_reader *r)
{
	int err = check_pillar(r);

	for (uint32_t n = passes(r); n > 0 && !err; n--) {
		if (nc_has(r, NC_I))
			err = over_pillar(r, INTERP_X, length_of(r, NC_I, 0));
		if (!err && nc_has(r, NC_J))
			err = over_pillar(r, INTERP_Y, length_of(r, NC_J, 0));
	}
	return err;
}

/* Find one wall of the corner: go in front of it first, and back at the end. */
static int wall(struct nc_reader *r, int axis, int beside, double by_mm)
{
	const double most = length_of(r, NC_R, span_mm(r, axis));
	int err = go(r, beside, by_mm);

	if (!err)
		err = probe_and_back(r, axis, r->block.value[axis] * most);
	return err ? err : go(r, beside, -by_mm);
}

/* At an outer corner, I and J lead from the start to places in front of its
 * walls. */
static int corner(struct nc_reader *r)
{
	const uint32_t xy = NC_BIT(NC_X) | NC_BIT(NC_Y);
	const double *way = r->block.value;
	int err = check_off(r);

	if (err)
		return err;
	if ((r->block.toward & xy) != xy || way[NC_X] == 0 || way[NC_Y] == 0)
		return nc_refuse(r, word_at(r), "the way to both walls, as in "
				 "G162 X+ Y-", "G162 without the ways of X and "
				 "Y");
	err = check_positive(r, NC_R, "the farthest to a wall, above 0");
	if (!err)
		err = wall(r, INTERP_X, INTERP_Y,
			  way[NC_Y] * length_of(r, NC_J, 0));
	return err ? err : wall(r, INTERP_Y, INTERP_X,
			      way[NC_X] * length_of(r, NC_I, 0));
}

static int refuse_mode(struct nc_reader *r)
{
	const uint8_t *at = word_at(r);

	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it", "%s under G43.4",
				 nc_quote_word(r, at).s);
	if (nc_has_guides(r))
		return nc_refuse(r, at, "wire.guides = off",
				 "%s on a machine with wire guides",
				 nc_quote_word(r, at).s);
	return nc_refuse(r, at, "G40 and G50 before it",
			 "%s under an offset or a taper",
			 nc_quote_word(r, at).s);
}

int nc_run_probe(struct nc_reader *r)
{
	static int (*const probes[NC_NPROBES])(struct nc_reader *) = {
		[NC_PROBE_FEED]		= probe_one,
		[NC_PROBE_ONE]		= probe_one,
		[NC_PROBE_LIMIT]	= limit,
		[NC_PROBE_HALF]		= half_one,
		[NC_PROBE_HOLE]		= hole,
		[NC_PROBE_PILLAR]	= pillar,
		[NC_PROBE_CORNER]	= corner,
	};
	int err;

	if (r->tool.on || nc_has_guides(r) || r->offset_side || r->taper_side)
		return refuse_mode(r);
	if (interp_turn_is_on(&r->contour.guides.turn))
		return nc_refuse(r, word_at(r), "a work system that is not "
				 "turned before it, as G55", "%s where the work "
				 "is turned by %g degrees: it feels along one "
				 "axis", nc_quote_word(r, word_at(r)).s,
				 r->contour.guides.turn.deg);
	if (r->o->delivery && r->o->delivery->no_sense)
		return nc_refuse(r, r->block.code_at[NC_PROBE],
				 r->o->delivery->no_sense, "a motion that "
				 "feels for the work, and no voltage to feel "
				 "it by");
	err = contour_flush(&r->contour, r->diag);
	return err ? err : probes[r->block.code[NC_PROBE]->value](r);
}
