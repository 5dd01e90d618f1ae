/* SPDX-License-Identifier: Apache-2.0 */
/*
 * figure.c - figures that are turned, mirrored and scaled: G68, G51.1, G51
 *
 * With p as the program says it, the place in the work system is
 *
 *	turn(scale(mirror(p)))
 *
 * which is the order of Fanuc's controls.  Where the words stand in another
 * order, the same holds.  Turn and mirror go to the builder together with the
 * turn of the work (interp/turn.h), so offsets and tapers of a wire are those
 * of the program, turned and mirrored with it.  A scale is one of units: it
 * counts for lengths in X Y Z U V and for centres, never for a feed or the
 * offset of a wire.
 */
#include "code/reader.h"

#include <math.h>

#define AN_END	"the word that ends it, before: turn, mirror image and scale " \
		"off"

/* -- What it does ---------------------------------------------------------- */

struct interp_turn nc_figure_turn(const struct nc_figure *f)
{
	return interp_turn_image(f->turn_deg, f->mirrored & NC_BIT(NC_X),
				 f->mirrored & NC_BIT(NC_Y), f->exchanged);
}

/* About a fixed place: what it adds to a place, beside its factor. */
static double scale_adds(const struct nc_figure *f, int axis)
{
	return (1 - f->scale) * f->scale_mm[axis];
}

void nc_figure_origin(const struct nc_figure *f, double mm[INTERP_NAXES])
{
	const struct interp_turn turn = interp_turn_of(f->turn_deg, false);
	const struct interp_turn all = nc_figure_turn(f);
	double at[2], about[2];

	for (int i = 0; i < 2; i++) {
		at[i] = f->mirrored & NC_BIT(i) ? 2 * f->mirror_mm[i] : 0;
		at[i] = f->scale * at[i] + scale_adds(f, i) - f->about_mm[i];
	}
	if (interp_turn_is_on(&turn))
		interp_turn_plane(&turn, at, at);
	for (int i = 0; i < 2; i++) {
		about[i] = f->about_mm[i];
		mm[i] += at[i] + about[i];
	}
	mm[INTERP_Z] += scale_adds(f, INTERP_Z);
	if (interp_turn_is_on(&all))
		interp_turn_plane_back(&all, mm, mm);
}

/* -- Lines while it is on -------------------------------------------------- */

/* X Y of a line that names one of them: the other one is where the machine
 * stands, seen by the figure, or what the program said last. */
static int refuse_vague(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const int is = nc_has(r, NC_X) ? NC_X : NC_Y;

	return nc_refuse(r, b->at[is], "both X and Y",
			 "%s alone behind a change of the figure's turn, image "
			 "or scale: controls differ in where %c is then",
			 nc_quote_word(r, b->at[is]).s,
			 nc_words[is == NC_X ? NC_Y : NC_X].letter);
}

static int check_vague(struct nc_reader *r)
{
	const uint32_t xy = NC_BIT(NC_X) | NC_BIT(NC_Y);
	const uint32_t named = r->block.words & xy;

	if (!r->figure.vague || !nc_has_group(r, NC_MOTION) || !named ||
	    nc_has_group(r, NC_MACHINE) || nc_by_distance(r))
		return 0;
	if (named != xy)
		return refuse_vague(r);
	r->figure.vague = false;
	return 0;
}

int nc_check_figure(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const struct nc_code *shot = nc_has_group(r, NC_ONE_SHOT) ?
				     b->code[NC_ONE_SHOT] : NULL;
	enum nc_group group = NC_NGROUPS;

	if (shot && (shot->value == NC_WRITE || shot->value == NC_SET ||
		     shot->value == NC_SET_CANCEL || shot->value == NC_LOCAL))
		group = NC_ONE_SHOT;
	if (nc_has_group(r, NC_PROBE))
		group = NC_PROBE;
	if (nc_has_group(r, NC_CYCLE) && r->figure.scale != 1)
		group = NC_CYCLE;
	if (nc_has_group(r, NC_TOOL_POINT) && b->code[NC_TOOL_POINT]->value)
		group = NC_TOOL_POINT;
	if (group != NC_NGROUPS && nc_figure_is_on(&r->figure))
		return nc_refuse(r, b->code_at[group], AN_END,
				 "%s in a figure that is turned, mirrored or "
				 "scaled",
				 nc_quote_word(r, b->code_at[group]).s);
	return check_vague(r);
}

/* -- Its words ------------------------------------------------------------- */

/* The place of the work system where the machine stands. */
static void here_mm(const struct nc_reader *r, double ret_mm[INTERP_NAXES])
{
	const struct interp_turn work = interp_turn_of(r->turn_deg[r->work],
						       false);
	double origin[INTERP_NAXES];

	interp_turn_to(&r->contour.guides.turn, nc_here(r), ret_mm);
	interp_turn_back(&work, ret_mm, ret_mm);
	nc_work_origin(r, origin);
	interp_turn_back(&work, origin, origin);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] -= origin[i] + r->shift_mm[i];
}

/* The numbers by which the program would name that place. */
static void numbers(const struct nc_reader *r, double ret_mm[2])
{
	for (int i = 0; i < 2; i++)
		ret_mm[i] = (nc_here(r)[i] - r->offset_mm[i]) / r->figure.scale;
}

static int may_change(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_quote word = nc_quote_word(r, at);

	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it", "%s under G43.4",
				 word.s);
	if (r->offset_side || r->taper_side)
		return nc_refuse(r, at, "G40 and G50 before it", "%s under an "
				 "offset or a taper", word.s);
	if (r->loose)
		return nc_refuse(r, at, "a program of its own for the probing",
				 "%s after a probing motion", word.s);
	return 0;
}

/* The figure is @f from here on. */
static int change(struct nc_reader *r, const uint8_t *at,
		  const struct nc_figure *f)
{
	double was[2], is[2];
	const bool on = nc_figure_is_on(f) || nc_figure_is_on(&r->figure);
	int err = on ? may_change(r, at) : 0;

	if (err)
		return err;
	numbers(r, was);
	r->figure = *f;
	nc_set_units(r, r->unit_mm > 1);
	err = nc_set_turn(r);
	numbers(r, is);
	if (fabs(is[0] - was[0]) > NC_SEEN_MM ||
	    fabs(is[1] - was[1]) > NC_SEEN_MM)
		r->figure.vague = true;
	return err;
}

/* Words that name a place under G91 would count from the one before, on some
 * controls. */
static int check_places(struct nc_reader *r, const uint8_t *at, uint32_t may)
{
	const uint32_t named = r->block.words & NC_AXES & ~may;

	if (named)
		return nc_refuse(r, r->block.at[__builtin_ctz(named)],
				 may & NC_BIT(NC_Z) ? "X Y Z" : "X and Y",
				 "%s with %c", nc_quote_word(r, at).s,
				 nc_words[__builtin_ctz(named)].letter);
	if (r->block.words & NC_AXES && r->incremental)
		return nc_refuse(r, at, "G90 before it", "%s under G91",
				 nc_quote_word(r, at).s);
	return 0;
}

#define XY	(NC_BIT(NC_X) | NC_BIT(NC_Y))

/* Two words name its centre, or none: then it is where the machine stands. */
static int centre_of(struct nc_reader *r, enum nc_slot x, enum nc_slot y,
		     struct nc_figure *f)
{
	const struct nc_block *b = &r->block;
	const enum nc_slot slot[2] = { x, y };
	double here[INTERP_NAXES];

	if (nc_has(r, x) != nc_has(r, y))
		return nc_refuse(r, b->at[nc_has(r, x) ? x : y],
				 "both words of the centre, or none: it is "
				 "where the machine stands then",
				 "half a centre of a turn");
	here_mm(r, here);
	for (int i = 0; i < 2; i++)
		f->about_mm[i] = nc_has(r, slot[i]) ?
			f->scale * b->value[slot[i]] * r->unit_mm +
			scale_adds(f, i) : here[i];
	return 0;
}

static int turn(struct nc_reader *r, enum nc_turn what, const uint8_t *at)
{
	const bool by_ij = what == NC_TURN_ABOUT_IJ;
	struct nc_figure f = r->figure;
	int err;

	if (what == NC_TURN_OFF) {
		f.turn_deg = f.about_mm[0] = f.about_mm[1] = 0;
		return change(r, at, &f);
	}
	err = check_places(r, at, XY);
	if (!err && !nc_has(r, NC_R))
		err = nc_refuse(r, at, by_ij ? "RA with the angle, as RA45.0" :
				"R with the angle, as R45.0",
				"%s without an angle", nc_quote_word(r, at).s);
	if (!err && r->incremental)
		err = nc_refuse(r, at, "G90 before it", "%s under G91",
				nc_quote_word(r, at).s);
	if (!err)
		err = by_ij ? centre_of(r, NC_I, NC_J, &f) :
			      centre_of(r, NC_X, NC_Y, &f);
	if (err)
		return err;
	f.turn_deg = remainder(r->block.value[NC_R], 360);
	return change(r, at, &f);
}

int nc_run_turn(struct nc_reader *r)
{
	return turn(r, r->block.code[NC_TURN]->value,
		    r->block.code_at[NC_TURN]);
}

static int mirror_places(struct nc_reader *r, const uint8_t *at,
			 struct nc_figure *f)
{
	const uint32_t named = r->block.words & XY;
	int err = check_places(r, at, XY);

	if (!err && !named)
		err = nc_refuse(r, at, "X or Y with the place of the mirror, "
				"as in X0.0", "%s without an axis",
				nc_quote_word(r, at).s);
	for (int i = 0; i < 2; i++)
		if (named & NC_BIT(i))
			f->mirror_mm[i] = r->block.value[i] * r->unit_mm;
	f->mirrored |= named;
	return err;
}

/* Which comes first would matter, and controls differ. */
static int check_images(struct nc_reader *r, const uint8_t *at,
			const struct nc_figure *f)
{
	if (f->exchanged && f->mirrored)
		return nc_refuse(r, at, "one of the two", "%s beside a mirror "
				 "image and an exchange of X and Y: which is "
				 "first is not known", nc_quote_word(r, at).s);
	return 0;
}

int nc_run_mirror(struct nc_reader *r)
{
	const enum nc_mirror what = r->block.code[NC_MIRROR]->value;
	const uint8_t *at = r->block.code_at[NC_MIRROR];
	struct nc_figure f = r->figure;
	int err = 0;

	if (what == NC_MIRROR_PLACES)
		err = mirror_places(r, at, &f);
	else if (what == NC_MIRROR_END)
		f.mirrored &= r->block.words & NC_AXES ? ~r->block.words : 0;
	else if (what == NC_MIRROR_OFF)
		f.mirrored = 0, f.exchanged = false;
	else if (what == NC_MIRROR_EXCHANGE)
		f.exchanged = true;
	else
		f.mirrored |= what == NC_MIRROR_X ? NC_BIT(NC_X) : NC_BIT(NC_Y);
	if (!err)
		err = check_images(r, at, &f);
	for (int i = 0; i < 2; i++)
		if (!(f.mirrored & NC_BIT(i)))
			f.mirror_mm[i] = 0;
	return err ? err : change(r, at, &f);
}

/* 2 without a decimal point is two thousandths in Fanuc, as lengths are. */
static int factor_of(struct nc_reader *r, double *ret)
{
	const uint8_t *at = r->block.code_at[NC_SCALE];
	double by;

	if (!nc_has(r, NC_P))
		return nc_refuse(r, at, "P with the factor in thousandths, as "
				 "in P1005 for 1.005", "%s without P",
				 nc_quote_word(r, at).s);
	at = r->block.at[NC_P];
	by = r->block.value[NC_P] / 1000;
	if (nc_decimals(r, at) > 0)
		return nc_refuse(r, at, "thousandths, as P1005 for 1.005",
				 "%s, a factor with a decimal point",
				 nc_quote_word(r, at).s);
	if (!(by >= NC_SCALE_LEAST && by <= NC_SCALE_MOST))
		return nc_refuse(r, at, "P1 to P1000000", "a factor of %g", by);
	*ret = by;
	return 0;
}

int nc_run_scale(struct nc_reader *r)
{
	const uint8_t *at = r->block.code_at[NC_SCALE];
	struct nc_figure f = r->figure;
	double here[INTERP_NAXES], by = 1;
	int err = 0;

	if (r->block.code[NC_SCALE]->value) {
		err = check_places(r, at, XY | NC_BIT(NC_Z));
		if (!err)
			err = factor_of(r, &by);
		if (!err && f.scale != 1)
			err = nc_refuse(r, at, "the scale off before it",
					"a scale under a scale");
	}
	if (err)
		return err;
	here_mm(r, here);
	for (int i = 0; i < 3; i++)
		f.scale_mm[i] = by == 1 ? 0 : nc_has(r, (enum nc_slot)i) ?
				r->block.value[i] * r->unit_mm : here[i];
	f.scale = by;
	return change(r, at, &f);
}
