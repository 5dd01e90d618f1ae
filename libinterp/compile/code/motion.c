/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motion.c - what axis words do: lines, machine zero, dwell, offsets
 */
#include "code/reader.h"

#include <stdio.h>
#include <string.h>

#define EACH_AXIS(mask, i) \
	(uint32_t left_ = (mask), i; \
	 left_ && (i = (uint32_t)__builtin_ctz(left_), true); \
	 left_ &= left_ - 1)

/* Where no word leads the top of the wire, it moves with the bottom. */
static void follow(const struct nc_reader *r, uint32_t named,
		   double end_mm[INTERP_NAXES])
{
	const double *here = nc_here(r);

	if (!(named & NC_BIT(NC_U)))
		end_mm[INTERP_U] = here[INTERP_U] + end_mm[INTERP_X] -
				   here[INTERP_X];
	if (!(named & NC_BIT(NC_V)))
		end_mm[INTERP_V] = here[INTERP_V] + end_mm[INTERP_Y] -
				   here[INTERP_Y];
}

/* U V of the line are the distance of the top from X Y, or the change of it. */
static void lean(const struct nc_reader *r, double end_mm[INTERP_NAXES])
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);

	for (int i = INTERP_U; i <= INTERP_V; i++) {
		const int j = i - INTERP_U + INTERP_X;
		const double was = r->incremental ? here[i] - here[j] : 0;

		if (b->words & NC_BIT(i))
			end_mm[i] = end_mm[j] + was + b->value[i] * r->scale[i];
	}
}

/* G53: what is not named stays where it is on the machine. */
static void machine_target(const struct nc_reader *r,
			   double end_mm[INTERP_NAXES])
{
	const struct interp_turn *t = &r->contour.guides.turn;
	const struct nc_block *b = &r->block;
	const bool turns = b->words & (NC_BIT(NC_X) | NC_BIT(NC_Y) |
				       NC_BIT(NC_U) | NC_BIT(NC_V));

	/* There and back is not the same to the last bit. */
	if (turns)
		interp_turn_to(t, end_mm, end_mm);
	for EACH_AXIS(b->words & NC_AXES, i)
		end_mm[i] = b->value[i] * r->scale[i];
	if (turns)
		interp_turn_back(t, end_mm, end_mm);
}

static inline void target(const struct nc_reader *r,
			  double ret_end_mm[INTERP_NAXES])
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	const double *base = r->incremental ? here : r->offset_mm;

	memcpy(ret_end_mm, here, INTERP_NAXES * sizeof(*ret_end_mm));
	if (nc_has_group(r, NC_MACHINE))
		machine_target(r, ret_end_mm);
	else for EACH_AXIS(b->words & NC_AXES, i)
		ret_end_mm[i] = base[i] + b->value[i] * r->scale[i];
	if (!nc_has_guides(r))
		return;
	follow(r, b->words, ret_end_mm);
	if (r->d->lean && !b->colon)
		lean(r, ret_end_mm);
}

void nc_target(const struct nc_reader *r, double ret_end_mm[INTERP_NAXES])
{
	target(r, ret_end_mm);
}

/* Do only rotary axes move on a line to @end_mm? */
static bool is_rotary(const struct nc_reader *r,
		      const double end_mm[INTERP_NAXES])
{
	const double *here = nc_here(r);

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!interp_axis_is_rotary((enum interp_axis)i) &&
		    end_mm[i] != here[i])
			return false;
	}
	return true;
}

static int refuse_feed(struct nc_reader *r)
{
	return nc_refuse(r, r->block.code_at[nc_has_group(r, NC_CYCLE) ?
					     NC_CYCLE :
					     nc_has_group(r, NC_PROBE) ?
					     NC_PROBE :
					     nc_has_group(r, NC_ONE_SHOT) ?
					     NC_ONE_SHOT : NC_MOTION],
			 "an F word, such as F5, in this line or before it",
			 "a motion at a feed, and no feed given yet");
}

static inline int word(struct nc_reader *r, bool turns, bool rapid)
{
	r->word.line = r->line;
	r->word.rapid = rapid;
	if (r->unplaced && nc_place_electrode(r, rapid))
		return -EINVAL;
	if (rapid)
		return 0;
	r->word.feed_mm_s = turns ? r->feed_deg_s : r->feed_mm_s;
	return r->word.feed_mm_s > 0 ? 0 : refuse_feed(r);
}

int nc_word(struct nc_reader *r, bool turns, bool rapid)
{
	return word(r, turns, rapid);
}

int nc_refuse_room(struct nc_reader *r)
{
	char wanted[96];

	snprintf(wanted, sizeof(wanted), "up to %u, with fewer repeats (L)",
		 r->segs_max);
	return nc_refuse_at(r, r->line, wanted,
			    "more than %u segments in all", r->segs_max);
}

/* The word to point to: that of the axis beyond its travel, or the first of the
 * line. */
static const uint8_t *blame(const struct nc_reader *r,
			    const double end_mm[INTERP_NAXES])
{
	const struct nc_block *b = &r->block;
	const uint8_t *at = NULL;
	double mm[INTERP_NAXES];

	interp_turn_to(&r->contour.guides.turn, end_mm, mm);
	for EACH_AXIS(b->words & NC_AXES, i) {
		const struct interp_axis_limits *l = &r->o->machine->axis[i];

		if (!(mm[i] >= l->travel_min_mm && mm[i] <= l->travel_max_mm))
			return b->at[i];
	}
	for EACH_AXIS(b->words & NC_MOVES, i) {
		if (!at || b->at[i] < at)
			at = b->at[i];
	}
	if (at)
		return at;
	return b->code_at[nc_has_group(r, NC_PROBE) ? NC_PROBE :
			  nc_has_group(r, NC_ONE_SHOT) ? NC_ONE_SHOT :
							 NC_MOTION];
}

void nc_blame(struct nc_reader *r, const double end_mm[INTERP_NAXES])
{
	if (r->diag->line == r->line)
		r->diag->column = nc_column(r, blame(r, end_mm));
}

int nc_action(struct nc_reader *r, enum interp_kind kind, uint32_t arg,
	      const uint8_t *at)
{
	int err = nc_room(r);

	if (err)
		return err;
	r->word.line = r->line;
	r->word.rapid = false;
	err = contour_action(&r->contour, kind, arg, &r->word, r->diag);
	if (err == -EINVAL && r->diag->line == r->line)
		r->diag->column = nc_column(r, at);
	return err;
}

/* With an electrode whose middle is beside the axis of C: where C turns, X Y go
 * along.  Places of the machine are those of the axes. */
static int line_beside(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		       bool rapid)
{
	const struct interp_turn *t = &r->contour.guides.turn;
	const double from_deg = nc_here(r)[INTERP_C];
	const bool named = nc_has_group(r, NC_MACHINE) ||
			   nc_has_group(r, NC_ONE_SHOT);
	double was[INTERP_NAXES], is[INTERP_NAXES], to_mm[INTERP_NAXES];
	int err = rapid ? 0 : nc_check_eccentric(r, end_mm);

	memcpy(to_mm, end_mm, sizeof(to_mm));
	nc_electrode_at(r, from_deg, was);
	nc_electrode_at(r, end_mm[INTERP_C], is);
	interp_turn_back(t, was, was);
	interp_turn_back(t, is, is);
	for (int i = INTERP_X; i <= INTERP_Y && !named; i++)
		to_mm[i] += is[i] - was[i];
	if (!err)
		err = contour_line(&r->contour, to_mm, &r->word, r->diag);
	err = nc_placed(r, err, to_mm);
	if (from_deg != end_mm[INTERP_C])
		nc_set_offset(r);
	return err;
}

static inline int line_to(struct nc_reader *r,
			  const double end_mm[INTERP_NAXES], bool rapid)
{
	int err = word(r, r->feed_mm_s != r->feed_deg_s &&
			  is_rotary(r, end_mm), rapid);

	r->curve.smooth = false;
	if (!err)
		err = nc_room(r);
	if (err)
		return err;
	if (r->tool.on)
		return nc_tool_line(r, end_mm, rapid);
	if (nc_is_eccentric(r))
		return line_beside(r, end_mm, rapid);
	err = contour_line(&r->contour, end_mm, &r->word, r->diag);
	return nc_placed(r, err, end_mm);
}

int nc_line_to(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       bool rapid)
{
	return line_to(r, end_mm, rapid);
}

/* ,R and ,C; R of a line. */
static int end_corner(struct nc_reader *r, const struct nc_code *motion)
{
	const struct nc_block *b = &r->block;
	const uint32_t xy = NC_BIT(NC_X) | NC_BIT(NC_Y);
	const uint32_t line = motion->value == 1 ? NC_BIT(NC_R) : 0;
	const uint32_t is = b->words & (NC_CORNER | line);
	const int slot = is ? __builtin_ctz(is) : 0;
	struct nc_quote word;

	if (!is)
		return 0;
	word = nc_quote_word(r, b->at[slot]);
	if (is & (is - 1))
		return nc_refuse(r, b->at[slot], "one of ,R ,C",
				 "two words for one corner");
	if (!(b->words & xy))
		return nc_refuse(r, b->at[slot], "X or Y beside it",
				 "%s, a corner, without a motion in X Y",
				 word.s);
	if (r->plane != 0 || r->tool.on || motion->value == 0)
		return nc_refuse(r, b->at[slot], "G17 and G1 G2 or G3, without "
				 "G43.4", "%s, a corner", word.s);
	if (!(b->value[slot] >= 0))
		return nc_refuse(r, b->at[slot], "a size above 0",
				 "%s, a corner below 0", word.s);
	contour_corner(&r->contour, (struct contour_corner) {
		.mm = b->value[slot] * r->scale[INTERP_X],
		.cut = slot == NC_COMMA_C,
	});
	return 0;
}

int nc_run_motion(struct nc_reader *r)
{
	const struct nc_code *motion = r->block.code[NC_MOTION];
	double end_mm[INTERP_NAXES];

	r->motion = motion;
	if (motion->value >= NC_SPLINE)
		return nc_curve(r);
	r->curve.smooth = false;
	if (r->block.words & (NC_CORNER | NC_BIT(NC_R)) &&
	    end_corner(r, motion))
		return -EINVAL;
	if (!(r->block.words & NC_MOVES))
		return 0;
	if (motion->value >= 2)
		return nc_arc(r, motion->value == 2);
	target(r, end_mm);
	if (r->block.colon)
		return nc_line_two(r, end_mm);
	return line_to(r, end_mm, motion->value == 0);
}

static int dwell(struct nc_reader *r)
{
	const enum nc_slot slot = nc_has(r, NC_P) ? NC_P : NC_X;
	double s;

	if (nc_has(r, NC_P) == nc_has(r, NC_X))
		return nc_refuse(r, r->block.code_at[NC_ONE_SHOT],
				 "G4 with P or X in seconds, as in G4 P0.5",
				 nc_has(r, NC_P) ? "G4 with both P and X" :
				 "G4 without a time");
	s = r->block.value[slot];
	if (slot == NC_P && r->d->dwell_ms)
		s /= 1000;
	if (!(s >= 0 && s <= 1000000))
		return nc_refuse(r, r->block.at[slot],
				 "0 to 1000000 seconds", "a dwell of %g s", s);
	return nc_action(r, INTERP_DWELL, (uint32_t)(s * 1000 + 0.5),
			 r->block.code_at[NC_ONE_SHOT]);
}

/* Go through the given place, if there is one, to machine zero of the named
 * axes.  If no axis is named, use all that the program has moved. */
static int home(struct nc_reader *r)
{
	uint32_t axes = r->block.words & NC_AXES;
	double end_mm[INTERP_NAXES];
	int err;

	err = nc_machine_place(r, r->block.code_at[NC_ONE_SHOT]);
	if (err)
		return err;
	nc_target(r, end_mm);
	if (axes) {
		err = nc_line_to(r, end_mm, true);
		if (err)
			return err;
	} else {
		axes = r->moved;
	}
	if (!axes)
		return nc_refuse(r, r->block.code_at[NC_ONE_SHOT],
				 "the axes to send to machine zero, as in "
				 "G91 G28 Z0",
				 "G28 without axis words before any motion");
	interp_turn_to(&r->contour.guides.turn, end_mm, end_mm);
	for EACH_AXIS(axes, i)
		end_mm[i] = 0;
	interp_turn_back(&r->contour.guides.turn, end_mm, end_mm);
	if (nc_has_guides(r))
		follow(r, axes, end_mm);
	return nc_line_to(r, end_mm, true);
}

/* Many programs say U0 V0 here: the wire is upright.  That says nothing new if
 * it leans so. */
static bool leans_so(const struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);

	for (int k = 0; k < 2; k++) {
		const int i = INTERP_U + k;
		const double lean = here[i] - here[INTERP_X + k];

		if (b->words & NC_BIT(NC_U + k) &&
		    fabs(b->value[i] * r->scale[i] - lean) > 1e-6)
			return false;
	}
	return r->d->lean;
}

static int set_here(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	uint32_t axes = b->words & NC_AXES;

	if (r->tool.on)
		return nc_refuse(r, b->code_at[NC_ONE_SHOT], "G49 before it",
				 "G92 under G43.4");
	if (!(b->words & NC_AXES))
		return nc_refuse(r, b->code_at[NC_ONE_SHOT],
				 "the place to call this one, as in G92 X0 Y0; "
				 "G92.1 to cancel", "G92 without axis words");
	if (nc_has_guides(r) && (axes & (NC_BIT(NC_U) | NC_BIT(NC_V)))) {
		if (!leans_so(r))
			return nc_refuse(r, b->code_at[NC_ONE_SHOT],
					 "G92 with X and Y", "G92 with U or V, "
					 "which go with X and Y");
		axes &= ~(NC_BIT(NC_U) | NC_BIT(NC_V));
	}
	for EACH_AXIS(axes, i)
		r->shift_mm[i] = here[i] - b->value[i] * r->scale[i] -
				 r->origin_mm[i];
	nc_set_offset(r);
	r->unnamed &= ~b->words;
	r->unplaced &= ~b->words;
	r->local &= ~b->words;
	return 0;
}

static int set_cancel(struct nc_reader *r)
{
	memset(r->shift_mm, 0, sizeof(r->shift_mm));
	r->local = 0;
	r->unnamed |= r->loose;
	nc_set_offset(r);
	return 0;
}

#define RUN(number, id, run, takes)	[NC_##id] = run,

int nc_run_one_shot(struct nc_reader *r)
{
	static int (*const shots[])(struct nc_reader *) = {
		NC_ONE_SHOTS(RUN)
	};

	return shots[r->block.code[NC_ONE_SHOT]->value](r);
}
