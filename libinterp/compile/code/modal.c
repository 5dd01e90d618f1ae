/* SPDX-License-Identifier: Apache-2.0 */
/* modal.c - carries out a block, group by group */
#include "code/reader.h"

#include <string.h>

void nc_set_units(struct nc_reader *r, bool inches)
{
	r->unit_mm = inches ? 25.4 : 1;
	for (int i = 0; i < INTERP_NAXES; i++)
		r->scale[i] = interp_axis_is_rotary((enum interp_axis)i) ?
			      1 : r->unit_mm * r->figure.scale;
}

uint32_t nc_origin(const struct nc_reader *r, uint32_t pass, double wire_mm)
{
	struct interp_origin o = {
		.work = r->work, .turn_deg = r->contour.guides.turn.deg,
		.mirrored = r->contour.guides.turn.mirrored,
		.pass = pass, .npasses = pass ? r->passes.npasses : 0,
		.wire_mm = wire_mm,
	};

	memcpy(o.mm, r->offset_mm, sizeof(o.mm));
	return interp_build_origin(r->build, &o);
}

void nc_work_origin(const struct nc_reader *r, double ret_mm[INTERP_NAXES])
{
	nc_electrode_at(r, r->contour.here_mm[INTERP_C], ret_mm);
	/* Under G43.4 it is part of the tool. */
	if (r->tool.on)
		ret_mm[INTERP_Z] = 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] += r->work_mm[r->work][i];
}

void nc_set_offset(struct nc_reader *r)
{
	double *mm = r->origin_mm, by[INTERP_NAXES];

	nc_work_origin(r, mm);
	interp_turn_back(&r->contour.guides.turn, mm, mm);
	memcpy(by, r->shift_mm, sizeof(by));
	nc_figure_origin(&r->figure, by);
	for (int i = 0; i < INTERP_NAXES; i++)
		r->offset_mm[i] = mm[i] + by[i];
	/* The second plane is measured from the same origin. */
	if (nc_has_guides(r)) {
		r->offset_mm[INTERP_U] = r->offset_mm[INTERP_X];
		r->offset_mm[INTERP_V] = r->offset_mm[INTERP_Y];
	}
	r->word.origin = nc_origin(r, 0, r->contour.offset_mm);
}

int nc_set_turn(struct nc_reader *r)
{
	const struct interp_turn figure = nc_figure_turn(&r->figure);
	const double deg = figure.deg == 0 ? r->turn_deg[r->work] :
			   remainder(r->turn_deg[r->work] + figure.deg, 360);
	const uint8_t *at = r->line_at;
	int err;

	if (deg == r->contour.guides.turn.deg &&
	    figure.mirrored == r->contour.guides.turn.mirrored) {
		nc_set_offset(r);
		return 0;
	}
	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it", "work that is turned "
				 "by %g degrees, under G43.4", deg);
	if (r->offset_side || r->taper_side)
		return nc_refuse(r, at, "G40 and G50 before it", "work that is "
				 "turned by %g degrees, under an offset or a "
				 "taper", deg);
	if (r->loose & (NC_BIT(NC_X) | NC_BIT(NC_Y)))
		return nc_refuse(r, at, "a program of its own for the probing",
				 "work that is turned by %g degrees, after a "
				 "probing motion along X or Y", deg);
	/* The direction in which a G5 left was that of the other system. */
	r->curve.smooth = false;
	err = contour_turn(&r->contour, deg, figure.mirrored, r->diag);
	nc_set_offset(r);
	return err;
}

static int run_units(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const bool was = r->unit_mm > 1, inches = b->code[NC_UNITS]->value;

	if (b->unit_at && inches != was)
		return nc_refuse(r, b->unit_at, "the units on a line before it",
				 "%s on a line that changes the units",
				 nc_quote_word(r, b->unit_at).s);
	nc_set_units(r, inches);
	return 0;
}

static int run_plane(struct nc_reader *r)
{
	r->plane = r->block.code[NC_PLANE]->value;
	nc_set_lift(r);
	return 0;
}

static int run_distance(struct nc_reader *r)
{
	r->incremental = r->block.code[NC_DISTANCE]->value;
	return 0;
}

static int run_arc_distance(struct nc_reader *r)
{
	r->arc_incremental = r->block.code[NC_ARC_DISTANCE]->value;
	return 0;
}

static int run_work(struct nc_reader *r)
{
	r->work = r->block.code[NC_WORK]->value;
	return nc_set_turn(r);
}

static int run_feed(struct nc_reader *r)
{
	r->feed_deg_s = r->block.value[NC_F] / 60;
	r->feed_mm_s = r->block.value[NC_F] * r->unit_mm / 60;
	return 0;
}

static int run_condition(struct nc_reader *r)
{
	return nc_call_condition(r, r->block.cond_letter,
				 r->block.cond_number,
				 r->block.code_at[NC_CONDITION]);
}

/* Feed per minute is the only feed mode. */
static int run_nothing(struct nc_reader *r)
{
	(void)r;
	return 0;
}

static int run_mcode(struct nc_reader *r)
{
	return nc_run_mcode(r, NC_MCODE);
}

static int run_mcode_after(struct nc_reader *r)
{
	return nc_run_mcode(r, NC_MCODE_AFTER);
}

/* M3 too, but an electrode that nothing makes negative is positive. */
static int check_polarity(struct nc_reader *r)
{
	struct interp_tech t;

	if (r->block.code[NC_POWER]->value != INTERP_AUX_POWER_NEGATIVE)
		return 0;
	interp_tech_clear(&t);
	t.v[INTERP_TECH_POLARITY] = -1;
	return nc_refuse_undelivered(r, &t, "a negative electrode",
				     r->block.code_at[NC_POWER]);
}

static int run_power(struct nc_reader *r)
{
	if (check_polarity(r))
		return -EINVAL;
	return nc_action(r, INTERP_AUX, r->block.code[NC_POWER]->value,
			 r->block.code_at[NC_POWER]);
}

static int run_pump(struct nc_reader *r)
{
	const struct interp_delivery *d = r->o->delivery;

	if (d && d->no_pump &&
	    r->block.code[NC_PUMP]->value == INTERP_AUX_PUMP_ON)
		return nc_refuse(r, r->block.code_at[NC_PUMP], d->no_pump,
				 "the pump, which nothing switches on");
	return nc_action(r, INTERP_AUX, r->block.code[NC_PUMP]->value,
			 r->block.code_at[NC_PUMP]);
}

static int run_wire_stop(struct nc_reader *r)
{
	return nc_action(r, INTERP_STOP, 0, r->block.code_at[NC_WIRE_STOP]);
}

int nc_machine_place(struct nc_reader *r, const uint8_t *at)
{
	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it", "%s under G43.4",
				 nc_quote_word(r, at).s);
	if (r->offset_side || r->taper_side)
		return nc_refuse(r, at, "G40 and G50 before it",
				 "%s under an offset or a taper",
				 nc_quote_word(r, at).s);
	return 0;
}

/* nc_target() obeys G53.  This function checks who may use it. */
static int run_machine(struct nc_reader *r)
{
	const struct nc_code *motion = nc_has_group(r, NC_MOTION) ?
				       r->block.code[NC_MOTION] : NULL;
	const int err = nc_machine_place(r, r->block.code_at[NC_MACHINE]);

	if (err)
		return err;
	if (motion && motion->value <= 1 && (r->block.words & NC_AXES))
		return 0;
	return nc_refuse(r, r->block.code_at[NC_MACHINE],
			 "G53 with axis words, under G0 or G1",
			 motion && motion->value > 1 ? "G53 with an arc" :
			 "G53 without a motion");
}

static int (*const run[NC_NGROUPS])(struct nc_reader *) = {
	[NC_LABEL]		= nc_run_label,
	[NC_UNITS]		= run_units,
	[NC_PLANE]		= run_plane,
	[NC_DISTANCE]		= run_distance,
	[NC_ARC_DISTANCE]	= run_arc_distance,
	[NC_WORK]		= run_work,
	[NC_ELECTRODE]		= nc_run_electrode,
	[NC_ELECTRODE_CHANGE]	= nc_run_electrode_change,
	[NC_FEED_MODE]		= run_nothing,
	[NC_FEED]		= run_feed,
	[NC_CONDITION]		= run_condition,
	[NC_REGISTER]		= nc_run_register,
	[NC_OFFSET]		= nc_run_offset,
	[NC_TAPER]		= nc_run_taper,
	[NC_TAPER_CORNER]	= nc_run_taper_corner,
	[NC_MIRROR]		= nc_run_mirror,
	[NC_SCALE]		= nc_run_scale,
	[NC_TURN]		= nc_run_turn,
	[NC_MCODE]		= run_mcode,
	[NC_POWER]		= run_power,
	[NC_PUMP]		= run_pump,
	[NC_ESCAPE]		= nc_run_escape,
	[NC_TOOL_POINT]		= nc_run_tool_point,
	[NC_MACHINE]		= run_machine,
	[NC_CYCLE]		= nc_run_cycle,
	[NC_PROBE]		= nc_run_probe,
	[NC_ONE_SHOT]		= nc_run_one_shot,
	[NC_MOTION]		= nc_run_motion,
	[NC_MCODE_AFTER]	= run_mcode_after,
	[NC_WIRE_STOP]		= run_wire_stop,
	[NC_STOP]		= nc_run_stop,
};

int nc_run_groups(struct nc_reader *r, uint32_t groups)
{
	for (; groups; groups &= groups - 1) {
		const int err = run[__builtin_ctz(groups)](r);

		if (err)
			return err;
	}
	return 0;
}

/* Letters that mean something with a word elsewhere, and nothing here. */
static const struct stray {
	uint8_t slot, group, least, most;	/* value of the word's code */
	const char *what, *wanted;
} strays[] = {
	{ NC_P, NC_MOTION, 2, 3, "turns of an arc, in LinuxCNC",
	  "an arc without P, once for each turn, or dialect linuxcnc" },
	{ NC_UJ, NC_STOP, NC_CALL, NC_CALL,
	  "in this dialect the centre of the top's arc, not how often",
	  "M98 P21000 for two times O1000, or G65 P1000 L2" },
};

/* Words that have no use on this line are a mistake, so the line is refused. */
static int refuse_leftover(struct nc_reader *r, uint32_t left)
{
	const int slot = __builtin_ctz(left);
	const uint8_t *at = r->block.at[slot];

	for (size_t i = 0; i < sizeof(strays) / sizeof(strays[0]); i++) {
		const struct stray *s = &strays[i];
		const struct nc_code *code = nc_has_group(r, s->group) ?
					     r->block.code[s->group] : NULL;

		if (s->slot == slot && code && code->value >= s->least &&
		    code->value <= s->most)
			return nc_refuse(r, at, s->wanted, "%s: %s",
					 nc_quote_word(r, at).s, s->what);
	}
	return nc_refuse(r, at, nc_words[slot].goes_with,
			 "%s has no use on this line", nc_quote_word(r, at).s);
}

static int refuse_absent(struct nc_reader *r, uint32_t absent)
{
	const int slot = __builtin_ctz(absent);
	char axes[2 * INTERP_NAXES + 32] = "one of";
	size_t n = 6;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(r->absent & NC_BIT(i))) {
			axes[n++] = ' ';
			axes[n++] = INTERP_AXIS_LETTERS[i];
		}
	}
	return nc_refuse(r, r->block.at[slot], axes,
			 "axis %c, which this machine has not",
			 nc_words[slot].letter);
}

/* A line with places but without a motion word uses the motion mode in force.
 * Places beside an ignored word may belong to that word. */
static int add_motion(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	const int slot = __builtin_ctz(b->words);

	if (b->alone_at)
		return nc_refuse(r, b->at[slot], "places on a line of "
				 "their own",
				 "%s beside %s, which is ignored",
				 nc_quote_word(r, b->at[slot]).s,
				 nc_quote_word(r, b->alone_at).s);
	if (!r->motion)
		return nc_refuse(r, b->at[slot], "G0 G1 G2 or G3 in this line "
				 "or before it",
				 "%s with no motion mode in force",
				 nc_quote_word(r, b->at[slot]).s);
	b->groups |= NC_BIT(NC_MOTION);
	b->code[NC_MOTION] = r->motion;
	b->code_at[NC_MOTION] = b->at[slot];
	b->takes |= r->motion->takes;
	return 0;
}

/* Cycles and probing motions must be alone. */
static int check_alone(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint32_t mine = NC_BIT(NC_CYCLE) | NC_BIT(NC_PROBE);
	const uint32_t others = NC_BIT(NC_MOTION) | NC_BIT(NC_MACHINE) |
				NC_BIT(NC_ONE_SHOT);
	const uint8_t *at = b->code_at[nc_has_group(r, NC_CYCLE) ? NC_CYCLE :
								   NC_PROBE];

	if (!(b->groups & others) && (b->groups & mine) != mine)
		return 0;
	return nc_refuse(r, at, "a cycle on a line of its own",
			 "%s on a line with another G word",
			 nc_quote_word(r, at).s);
}

/* Does the line go on with a body?  While refusals are listed, no curve is
 * put together, and nobody knows where one ends. */
static bool in_body(const struct nc_reader *r)
{
	return r->listing ? nc_has_no_code(r) && r->motion &&
			    r->motion->value == NC_BODY :
			    r->curve.open == NC_BODY;
}

/* The word of the line by which a figure is turned, mirrored or scaled, and to
 * which its other words belong; NC_NGROUPS: there is none. */
static enum nc_group figure_word(const struct nc_reader *r)
{
	const struct nc_block *b = &r->block;

	for (enum nc_group g = NC_MIRROR; g <= NC_TURN; g++)
		if (nc_has_group(r, g) && b->words & b->code[g]->takes)
			return g;
	return NC_NGROUPS;
}

static int check_figure_alone(struct nc_reader *r, enum nc_group figure)
{
	const struct nc_block *b = &r->block;
	const uint32_t moves = NC_BIT(NC_MOTION) | NC_BIT(NC_MACHINE);

	if (!(b->groups & moves))
		return 0;
	return nc_refuse(r, b->code_at[figure], "a line of its own",
			 "%s with its words on a line with a motion word",
			 nc_quote_word(r, b->code_at[figure]).s);
}

static int complete(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	/* For a body, P is a knot and Q belongs to the rotation. */
	const uint32_t moves = in_body(r) ?
			       NC_MOVES | NC_BIT(NC_P) | NC_BIT(NC_Q) :
			       NC_MOVES;

	if (nc_has_group(r, NC_CYCLE) || nc_has_group(r, NC_PROBE))
		return check_alone(r);
	if (nc_has_group(r, NC_ONE_SHOT)) {
		if (b->groups & (NC_BIT(NC_MOTION) | NC_BIT(NC_MACHINE)))
			return nc_refuse(
				r, b->code_at[NC_ONE_SHOT],
				"G4 G10 G28 G52 G92 G92.1 and G120 on lines of "
				"their own, without G0 G1 G2 G3 G53",
				"%s on a line with a motion word",
				nc_quote_word(r, b->code_at[NC_ONE_SHOT]).s);
		return 0;
	}
	if (figure_word(r) != NC_NGROUPS)
		return check_figure_alone(r, figure_word(r));
	if (b->words & moves && !nc_has_group(r, NC_MOTION))
		return add_motion(r);
	return 0;
}

int nc_check_line(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	int err = nc_take_angle(r);

	nc_take_cycle(r);
	if (!err)
		err = complete(r);
	if (err)
		return err;
	if (r->curve.open && (b->words | b->groups)) {
		err = nc_curve_goes_on(r);
		if (err)
			return err;
	}
	err = nc_tool_vector(r);
	if (err)
		return err;
	if (b->words & ~b->takes)
		return refuse_leftover(r, b->words & ~b->takes);
	if (b->words & r->absent)
		return refuse_absent(r, b->words & r->absent);
	return 0;
}

int nc_run_line(struct nc_reader *r)
{
	const uint32_t first = NC_BIT(NC_LABEL);
	struct nc_block *b = &r->block;
	int err = nc_check_line(r);

	if (err)
		return err;
	if (b->toward | r->loose) {
		err = nc_check_probed(r);
		if (err)
			return err;
	}
	if (r->figure.vague || nc_figure_is_on(&r->figure)) {
		err = nc_check_figure(r);
		if (err)
			return err;
	}

	if (b->groups & first) {
		err = nc_run_groups(r, b->groups & first);
		if (err)
			return err;
	}
	if (b->words | b->groups)
		r->fresh = false;
	return nc_run_groups(r, b->groups & ~first);
}
