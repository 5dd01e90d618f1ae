/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb.c - gives records to the builder
 *
 * A line goes J along the counted axis, and along the other axis by the ratio
 * X:Y.  The end of an arc follows from J, see threeb_arc.c.  Both ends are
 * rounded to whole units.  So a contour that was rounded when the records were
 * written closes again.  Places are sums of whole numbers, which a double holds
 * exactly.
 *
 * 4B: the machine offsets the wire, and every corner has an arc.  Then lines
 * keep their length, and an arc of radius R keeps its angles: the record is
 * carried out with R + offset or R - offset.
 */
#include "code/threeb_reader.h"
#include "interp/nc.h"
#include "wire/contour.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* The axes of the machine; places are in units from where the program
 * starts. */
struct threeb_reader {
	struct threeb_text text;
	const struct interp_threeb_read *o;
	struct contour contour;
	struct interp_build_word word;
	double start_mm[INTERP_NAXES];
	double unit_mm, offset;		/* mm in a unit; units */
	double x, y;			/* units */
	uint32_t records, segs_max;
	double slope;			/* of the taper that is set */
	uint32_t motions, done;		/* in all; 0: not counted, for nothing
					 * is set beside the contour */
};

static int refuse_end(struct threeb_reader *r, const struct threeb_record *c,
		      const char *wanted)
{
	return threeb_refuse(&r->text, c->j_at, wanted, "J %lld, which no end "
			     "point fits", (long long)c->j);
}

static void place_mm(const struct threeb_reader *r, double x, double y,
		     double ret_mm[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] = r->start_mm[i];
	ret_mm[INTERP_X] += x * r->unit_mm;
	ret_mm[INTERP_Y] += y * r->unit_mm;
	ret_mm[INTERP_U] += guides_on(&r->contour.guides) ? x * r->unit_mm : 0;
	ret_mm[INTERP_V] += guides_on(&r->contour.guides) ? y * r->unit_mm : 0;
}

/* What the builder said, with the place of the record; a contour may blame
 * another line. */
static int placed(struct threeb_reader *r, const struct threeb_record *c,
		  int rc)
{
	const uint32_t line = r->text.diag->line;

	if (rc == -EINVAL && (line == 0 || line == r->text.line)) {
		r->text.diag->line = r->text.line;
		r->text.diag->column =
			(uint32_t)(c->at - r->text.line_at) + 1;
	}
	return rc;
}

/* -- Lines ----------------------------------------------------------------- */

/* Only an arc may have the fields of 4B. */
static int no_radius(struct threeb_reader *r, const struct threeb_record *c)
{
	if (c->r == 0 && c->shape == 0)
		return 0;
	return threeb_refuse(&r->text, c->r_at, "B0 or B for R, and no D or "
			     "DD, on a line", "a radius on a line");
}

/* The distances along both axes, without sign. */
static int line_way(struct threeb_reader *r, const struct threeb_record *c,
		    int64_t *ret_counted, int64_t *ret_other)
{
	int64_t counted = c->count_y ? c->y : c->x;
	const int64_t other = c->count_y ? c->x : c->y;

	if (counted == 0 && other == 0)
		counted = 1;		/* blank both: along G's axis */
	if (counted == 0)
		return refuse_end(r, c, c->count_y ?
				  "GX, for the line runs along X" :
				  "GY, for the line runs along Y");
	if (c->j == 0 && (c->x || c->y))
		return refuse_end(r, c, "the length along the axis of G; 0 "
				  "where X and Y are 0");
	*ret_counted = c->j;
	*ret_other = (c->j * other + counted / 2) / counted;
	return 0;
}

static int line(struct threeb_reader *r, const struct threeb_record *c)
{
	const double sx = c->quadrant == 1 || c->quadrant == 4 ? 1 : -1;
	const double sy = c->quadrant <= 2 ? 1 : -1;
	double end_mm[INTERP_NAXES];
	int64_t counted = 0, other = 0;
	int err = no_radius(r, c);

	if (!err)
		err = line_way(r, c, &counted, &other);
	if (err)
		return err;
	r->x += sx * (double)(c->count_y ? other : counted);
	r->y += sy * (double)(c->count_y ? counted : other);
	place_mm(r, r->x, r->y, end_mm);
	err = contour_line(&r->contour, end_mm, &r->word, r->text.diag);
	return placed(r, c, err);
}

/* -- Arcs ------------------------------------------------------------------ */

/* By what factor the arc that is carried out is larger than its record. */
static int scale_of(struct threeb_reader *r, const struct threeb_record *c,
		    double radius, double *ret)
{
	const bool grows = (c->shape == 1) != c->minus;

	*ret = 1;
	if (!r->text.o->fourb)
		return 0;
	if (fabs((double)c->r - radius) > 1)
		return threeb_refuse(&r->text, c->r_at, "R within a unit of "
				     "the length of (X, Y)", "R %lld, where X "
				     "and Y are %.1f from the centre",
				     (long long)c->r, radius);
	if (c->shape == 0)
		return threeb_refuse(&r->text, c->r_at, "D for convex, DD for "
				     "concave, behind R", "an arc that is "
				     "neither convex nor concave");
	*ret = (radius + (grows ? r->offset : -r->offset)) / radius;
	if (*ret * radius < 0.5)
		return threeb_refuse(&r->text, c->r_at, "a radius above the "
				     "offset", "an offset of %g units inside "
				     "a radius of %lld", r->offset,
				     (long long)c->r);
	return 0;
}

static int build_arc(struct threeb_reader *r, const struct threeb_record *c,
		     const struct threeb_arc *a, const struct threeb_end *e,
		     double scale)
{
	const double cx = r->x - scale * (double)a->x;
	const double cy = r->y - scale * (double)a->y;
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = r->start_mm[INTERP_X] + cx * r->unit_mm,
		.centre_b_mm = r->start_mm[INTERP_Y] + cy * r->unit_mm,
		.sweep = interp_build_sweep((double[]) { (double)a->x,
							 (double)a->y },
					    (double[]) { (double)e->x,
							 (double)e->y },
					    (double[]) { 0, 0 }, a->clockwise),
	};
	double end_mm[INTERP_NAXES];
	int rc;

	if (!e->full) {
		r->x = cx + scale * (double)e->x;
		r->y = cy + scale * (double)e->y;
	}
	place_mm(r, r->x, r->y, end_mm);
	rc = contour_arc(&r->contour, end_mm, &arc, &r->word, r->text.diag);
	return placed(r, c, rc);
}

static int arc(struct threeb_reader *r, const struct threeb_record *c)
{
	const bool left = c->quadrant == 2 || c->quadrant == 3;
	const struct threeb_arc a = {
		.x = left ? -c->x : c->x,
		.y = c->quadrant <= 2 ? c->y : -c->y,
		.clockwise = c->kind == THREEB_CW, .count_y = c->count_y,
	};
	struct threeb_end e;
	double scale;
	int err;

	if (a.x == 0 && a.y == 0)
		return threeb_refuse(&r->text, c->at, "X and Y from the centre "
				     "to the start", "an arc of radius 0");
	if (c->j == 0)
		return refuse_end(r, c, "more than 0; four times the radius "
				  "for a full circle");
	if (threeb_arc_end(&a, c->j, &e))
		return refuse_end(r, c, "at most four times the radius, "
				  "which is a full circle");
	err = scale_of(r, c, hypot((double)a.x, (double)a.y), &scale);
	/* An end that is rounded to the start would be taken for a full
	 * turn. */
	if (err || (!e.full && e.x == a.x && e.y == a.y))
		return err;
	return build_arc(r, c, &a, &e, scale);
}

/* -- What is set at the machine -------------------------------------------- */

static bool is_beside(const struct interp_setting *set)
{
	return set->wire_mm != 0 || set->taper_deg != 0;
}

/* The first motion leads to the contour, and the last one away from it. */
static void set_side(struct threeb_reader *r)
{
	const struct interp_setting *set = &r->text.o->set;
	const bool on = ++r->done < r->motions;

	contour_side(&r->contour, on ? set->wire_mm : 0, on ? r->slope : 0);
}

static int refuse_setting(struct interp_diag *diag, const char *wanted,
			  const char *found)
{
	diag->line = diag->column = 0;
	return interp_diag_say(diag, "%s; %s", found, wanted);
}

static int check_setting(struct threeb_reader *r)
{
	const struct interp_setting *set = &r->text.o->set;
	struct interp_diag *diag = r->text.diag;

	if (set->wire_mm != 0 && r->text.o->fourb)
		return refuse_setting(diag, "fourb_offset_um for it", "an "
				      "offset beside the contour of 4B, which "
				      "has its own");
	return contour_set_taper(&r->contour, set->taper_deg, &r->slope, diag);
}

/* A line of length 0 leads nowhere. */
static bool is_motion(int what, const struct threeb_record *c)
{
	return (what == THREEB_LINE && c->j > 0) || what == THREEB_CCW ||
	       what == THREEB_CW;
}

/* Which motion is the last one is known when all are read. */
static int count_motions(struct threeb_reader *r, const struct interp_text *t)
{
	struct threeb_text text = r->text;
	struct threeb_record c;
	int what, err = threeb_open(&text, t->bytes ? t->at : "", t->bytes);

	while (!err && (what = threeb_next(&text, &c)) != THREEB_OVER) {
		if (what < 0)
			return what;
		r->motions += is_motion(what, &c);
	}
	if (!err && r->motions < 3)
		return refuse_setting(r->text.diag, "a motion to the contour, "
				      "one along it and one away from it",
				      "an offset or a taper, and fewer than "
				      "three motions");
	return err;
}

static int place_figure(struct threeb_reader *r)
{
	const struct interp_setting *set = &r->text.o->set;
	const struct interp_turn turn =
		interp_turn_image(set->turn_deg, set->mirror == INTERP_MIRROR_X,
				  set->mirror == INTERP_MIRROR_Y,
				  set->mirror == INTERP_MIRROR_EXCHANGE);

	if (set->scale > 0)
		r->unit_mm *= set->scale;
	return contour_turn(&r->contour, turn.deg, turn.mirrored,
			    r->text.diag);
}

/* -- The program ----------------------------------------------------------- */

static int run(struct threeb_reader *r, int what,
	       const struct threeb_record *c)
{
	r->word.line = r->text.line;
	r->records += what != THREEB_END;
	if (r->records > r->segs_max)
		return threeb_refuse(&r->text, c->at, "fewer records",
				     "more than %u records", r->segs_max);
	if (is_motion(what, c))
		set_side(r);
	switch (what) {
	case THREEB_LINE:
		return line(r, c);
	case THREEB_PAUSE:
		return contour_action(&r->contour, INTERP_STOP, 0, &r->word,
				      r->text.diag);
	case THREEB_END:
		return contour_action(&r->contour, INTERP_END, 0, &r->word,
				      r->text.diag);
	default:
		return arc(r, c);
	}
}

static int read_records(struct threeb_reader *r)
{
	struct threeb_record c;
	int rc, what;
	bool ended = false;

	while ((what = threeb_next(&r->text, &c)) != THREEB_OVER) {
		if (what < 0)
			return what;
		if (what == THREEB_END && ended)
			continue;
		ended = what == THREEB_END;
		rc = run(r, what, &c);
		if (rc)
			return rc;
	}
	return 0;
}

static double feed_of(const struct interp_threeb_read *o)
{
	const struct interp_axis_limits *l = o->machine->axis;

	return o->feed_mm_s > 0 ? o->feed_mm_s :
	       fmin(l[INTERP_X].v_max_mm_s, l[INTERP_Y].v_max_mm_s);
}

static void set_up(struct threeb_reader *r)
{
	const struct interp_threeb_options *o = r->o->options;
	const double unit_um = o->unit_um > 0 ? o->unit_um : 1;

	r->unit_mm = unit_um / 1000;
	r->offset = o->offset_um / unit_um;
	r->word.feed_mm_s = feed_of(r->o);
	r->segs_max = r->o->segs_max ? r->o->segs_max : INTERP_NC_SEGS_MAX;
}

static int compile(struct threeb_reader *r, const struct interp_text *text)
{
	int err = check_setting(r);

	if (!err)
		err = place_figure(r);
	for (int i = 0; i < INTERP_NAXES; i++)
		r->start_mm[i] = r->contour.here_mm[i];
	if (!err && is_beside(&r->text.o->set))
		err = count_motions(r, text);
	if (!err)
		err = threeb_open(&r->text, text->bytes ? text->at : "",
				  text->bytes);
	return err ? err : read_records(r);
}

int interp_threeb_compile(const struct interp_text *text,
			  const struct interp_threeb_read *o,
			  struct interp_build *b,
			  struct interp_threeb_result *ret,
			  struct interp_diag *diag)
{
	static const struct interp_wire none = { .corner_angle_deg = 180 };
	struct threeb_reader r = {
		.text = { .o = o->options, .diag = diag }, .o = o,
	};
	int err;

	set_up(&r);
	contour_init(&r.contour, o->wire ? o->wire : &none, o->machine, b);
	err = compile(&r, text);
	if (!err)
		err = contour_flush(&r.contour, diag);
	contour_free(&r.contour);
	if (!err && r.records == 0) {
		err = threeb_refuse(&r.text, r.text.line_at, "at least one "
				   "record", "empty program");
		diag->line = diag->column = 0;
	}
	if (err)
		return err;
	ret->lines = r.text.line - (r.text.line_at == r.text.end);
	ret->records = r.records;
	return 0;
}
