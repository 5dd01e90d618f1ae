/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reader.h - the state of the NC reader, and who does what
 *
 *	scan.c		one line of text into a block of words
 *	modal.c		carry a block out, group by group
 *	mcode.c		M codes of the machine
 *	motion.c	lines, machine zero, dwell, offsets: what axis words do
 *	arc.c		G2 and G3
 *	cycles.c	G130 ... G135, and the way out: G140 ... G143
 *	probing.c	probing: G38.2, G80 ... G82, G160 ... G162
 *	tool_point.c	G43.4, G43.5: places of the tool's tip
 *	tip_curve.c	... its lines, arcs and curves
 *	tip_way.c	... cut into lines of the axes
 *	tip_turn.c	... by its direction: the rotaries are found
 *	tip_body.c	G6.3: a rigid body along two NURBS
 *	nurbs.c		curves of control points and knots, G6.2
 *	spline.c	G5 ... G5.3: curves as LinuxCNC has them
 *	passes.c	contours in passes: G150 ... G152
 *	offset.c	offset and taper: G40 ... G42, G50 ... G52, D and H
 *	tech.c		conditions: called, defined, in a sequence
 *	flow.c		subprograms and the end
 *	macro.h		variables and jumps, in front of the scanner
 *	note.c		say what is ignored, or is read otherwise elsewhere
 *	list.c		all refusals of a text
 *	nc.c		line after line
 *	refuse.c	say what was found and what would be accepted
 *
 * A function that refuses fills the diag and returns -EINVAL (NULL where it
 * returns a place in the text).
 */
#ifndef CODE_READER_H
#define CODE_READER_H

#include "code/words.h"
#include "interp/nc.h"
#include "wire/contour.h"

/* Tool-centre-point programming. */
struct nc_tool_point {
	bool on;
	bool vector;			/* G43.5: I J K are its direction */
	double dir[3];			/* the last one, of length 1 */
	struct interp_kinematics k;	/* with the tool's length */
	double here_mm[INTERP_NAXES];	/* X Y Z of the tip, seen from the work;
					 * the others as the axes stand */
};

/* Notes of one kind each. */
enum nc_told { NC_TOLD_POINT, NC_TOLD_INCHES, NC_TOLD_CONDITION,
	       NC_TOLD_DWELL, NC_TOLD_OFFSET };

/* Why no further line is read. */
enum nc_over { NC_GOING, NC_TAPE_ENDED, NC_FINISHED };

/* The words of one line.  Only what `words` and `groups` name is filled. */
struct nc_block {
	uint32_t words;			/* bit per enum nc_slot */
	uint32_t groups;		/* bit per enum nc_group */
	uint32_t takes;			/* slots its codes use */
	uint32_t drops;			/* ... have no use for, and say so */
	uint32_t cond_number;
	char cond_letter;
	uint32_t angles;		/* A and B of a cycle: they are no axes */
	uint32_t toward;		/* slots without a number: only a sign,
					 * +1 -1 or 0, is their value */
	double value[NC_NSLOTS];
	const struct nc_code *dropper;	/* one that is carried out without some
					 * of its words, or NULL */
	const uint8_t *dropper_at;
	const uint8_t *at[NC_NSLOTS];	/* the letter */
	const struct nc_code *code[NC_NGROUPS];
	const uint8_t *code_at[NC_NGROUPS];
	const struct nc_code *upper;	/* G word behind a :, or NULL */
	struct nc_code mcode[2];	/* of the PLC: before and after */
	bool colon;			/* the top has words of its own */
};

/* A program or subprogram being carried out. */
struct nc_frame {
	uint32_t number;		/* of its O word; 0: none */
	uint32_t left;			/* repeats still to come */
	uint32_t entry_line, return_line;
	const uint8_t *entry, *back;	/* its first line; the caller's next */
};

/* An offset register. */
struct nc_register {
	bool known;
	double mm;
};

#define NC_NREGISTERS	1000

/* Contours in passes: G150 G151 G152. */
#define NC_NPASSES	16
#define NC_NCAVITIES	256

struct nc_pass {
	uint32_t reg;
	double offset_mm;
	struct interp_build_word word;
};

struct nc_cavity {
	double number;			/* of its subprogram */
	uint32_t line;			/* of its G151 */
	double hole_mm[2];
};

/* In which order many contours are cut. */
enum nc_pass_order {
	NC_BY_CONTOUR,			/* one after the other */
	NC_ROUGHS_FIRST,		/* rough cuts, other passes, tabs */
	NC_TABS_LAST,			/* all but the tabs, tabs */
};

struct nc_passes {
	struct nc_pass pass[NC_NPASSES];
	struct nc_cavity cavity[NC_NCAVITIES];
	uint32_t npasses, ncavities;
	double tab_mm;
	enum nc_pass_order order;	/* of the G152 in hand, as tab_mm */
};

/* A condition that the program defines, as E001= 60 10 25 does. */
struct nc_defined {
	struct nc_defined *next;	/* the one defined before it */
	char letter;
	uint32_t number;
	struct interp_tech tech;
};

#define NC_NDEFINED_MAX	256

/* Where O words stand; line 0: nowhere. */
struct nc_label {
	const uint8_t *at;
	uint32_t line, second;		/* second: where it stands again */
};

/* A curve being put together, block by block. */
struct nc_curve {
	uint8_t open;			/* NC_NURBS, NC_NURBS_BLOCK; 0: none */
	uint32_t order;			/* degree + 1 */
	uint32_t line;			/* where it began */
	uint32_t npoints, points_room;
	uint32_t nknots, knots_room;
	double *points;			/* rows of all axes times the weight,
					 * and the weight */
	double *knots;
	struct interp_build_mark *marks;	/* of each point */
	double last_mm[INTERP_NAXES];	/* the last point */
	bool smooth;			/* a G5 right before this line ... */
	double leave_mm[2];		/* ... and its last handle, mirrored */
};

struct nc_reader {
	const struct nc_dialect *d;
	struct interp_diag first;	/* the refusal that ended the reading */
	bool first_told;
	uint32_t ntold;
	struct nc_macro *macro;		/* NULL: nothing to expand yet */
	bool listing;			/* all refusals are wanted: list.c */
	bool mapped;			/* the line in hand is in its buffer */

	/* The text, and the line in hand. */
	const uint8_t *text, *end;
	const uint8_t *at;		/* the next line */
	const uint8_t *line_at, *stop;	/* this line, its farthest end */
	const uint8_t *word_at;		/* the word read last */
	const uint8_t *value_end;	/* behind the decimal read last */
	uint32_t line;			/* its number, from 1 */
	struct nc_block block;

	/* Modes, until changed. */
	const struct nc_code *motion;	/* NULL: none yet */
	uint8_t plane;			/* 0 ... 2: G17 ... G19 */
	uint8_t work;			/* 0 ... 8: G54 ... G59.3 */
	double work_mm[INTERP_NC_NWORK][INTERP_NAXES];
	bool incremental, arc_incremental;
	uint32_t lengths;		/* slots where a point matters */
	double unit_mm;			/* 1 or 25.4 */
	double scale[INTERP_NAXES];	/* unit_mm, for rotary axes 1 */
	double shift_mm[INTERP_NAXES];	/* by G92 */
	double offset_mm[INTERP_NAXES];	/* work offset and shift together */
	double feed_mm_s, feed_deg_s;	/* 0: none yet */
	struct interp_build_word word;	/* its condition is modal too */
	struct nc_register registers[NC_NREGISTERS];	/* D and H */
	uint32_t selected;		/* the one D or H named last */
	struct nc_defined *defined;	/* the last one; NULL: none */
	uint32_t ndefined;

	/* The wire. */
	struct contour contour;
	int offset_side, taper_side;	/* +1 left, -1 right, 0 off */
	double slope;			/* tangent of the taper */

	struct nc_passes passes;
	enum interp_escape_mode escape;
	struct nc_tool_point tool;

	/* Probing. */
	uint32_t loose;			/* axes that count from a contact */
	uint32_t unnamed;		/* ... and what they read is not said */
	uint32_t once, twice;		/* axes with so many contacts */

	/* Flow. */
	struct nc_frame frame[INTERP_NC_DEPTH_MAX + 1];
	uint32_t depth;			/* frame in use; 0: the main program */
	struct nc_label *labels;	/* by O number; NULL before an M98 */
	bool fresh;			/* no words yet in this program */
	bool tape;			/* the first % is read */
	enum nc_over over;

	struct nc_curve curve;
	uint32_t moved;			/* axes the program has moved */
	uint32_t absent;		/* axes the machine has not */
	uint32_t segs, segs_max;
	uint32_t executed, executed_max;

	/* What has been noted already: codes, then letters by the place of
	 * their reason in d->text; and enum nc_told. */
	uint8_t told[(NC_NCODES + NC_TEXT_MAX) / 8 + 1];
	uint32_t told_once;

	const struct interp_nc_options *o;
	struct interp_build *build;
	struct interp_diag *diag;
};

static inline bool nc_has(const struct nc_reader *r, enum nc_slot slot)
{
	return r->block.words & NC_BIT(slot);
}

static inline bool nc_has_group(const struct nc_reader *r, enum nc_group group)
{
	return r->block.groups & NC_BIT(group);
}

/* a toward b is counter-clockwise; ca, cb are the centre words, other takes
 * no part; `normal` is square to both. */
struct nc_plane {
	enum interp_axis a, b, normal;
	enum nc_slot ca, cb, other;
	const char *name, *centre;
};

extern const struct nc_plane nc_planes[3];

/** nc_scan_line() - the line at r->at into r->block; r->at is the next. */
int nc_scan_line(struct nc_reader *r);

/** nc_check_line() - do the words of r->block go together? */
int nc_check_line(struct nc_reader *r);

/** nc_list_refusals() - what r->diag has, and all others, to o->refused. */
void nc_list_refusals(struct nc_reader *r);

/** nc_tell() - what r->diag has, to o->refused. */
void nc_tell(struct nc_reader *r);

/** nc_run_line() - carry r->block out. */
int nc_run_line(struct nc_reader *r);

/** nc_set_units(), nc_set_offset() - after a change of units; of offsets. */
void nc_set_units(struct nc_reader *r, bool inches);
void nc_set_offset(struct nc_reader *r);

/* Functions of groups, called by nc_run_line(). */
int nc_run_motion(struct nc_reader *r);
int nc_run_one_shot(struct nc_reader *r);
int nc_run_stop(struct nc_reader *r);
int nc_run_label(struct nc_reader *r);

/* cycles.c */
int nc_run_cycle(struct nc_reader *r);
int nc_run_escape(struct nc_reader *r);

/** nc_take_cycle() - A and B of a cycle are no axes. */
void nc_take_cycle(struct nc_reader *r);

/** nc_set_lift() - after a change of plane or of the way out. */
void nc_set_lift(struct nc_reader *r);
int nc_run_tool_point(struct nc_reader *r);

/* Under G43.4: as contour_line(), contour_arc() and contour_nurbs(), for the
 * tip; r->word is filled.  A curve ends at r->curve.last_mm. */
int nc_tip_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		bool rapid);
int nc_tip_arc(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       const struct interp_build_arc *arc);
int nc_tip_curve(struct nc_reader *r, const struct interp_build_curve *c);

/** nc_tool_vector() - of a line under G43.5: may it have I J K, and no angles
 *  of the rotaries that turn the tool? */
int nc_tool_vector(struct nc_reader *r);

/** nc_tool_looks() - the tool's direction is that of the axes. */
void nc_tool_looks(struct nc_reader *r);

/** nc_tool_line() - a line under G43.4 or G43.5. */
int nc_tool_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		 bool rapid);

/* probing.c */
int nc_run_probe(struct nc_reader *r);

/** nc_check_probed() - does the line name places that nobody knows? */
int nc_check_probed(struct nc_reader *r);

/* The same for wires. */
int nc_run_register(struct nc_reader *r);
int nc_run_offset(struct nc_reader *r);
int nc_run_taper(struct nc_reader *r);
int nc_run_taper_corner(struct nc_reader *r);

/** nc_take_angle() - the A of a G51 or G52 is no axis. */
int nc_take_angle(struct nc_reader *r);

/** nc_here() - where the program has come to, in the frame it is written in. */
static inline const double *nc_here(const struct nc_reader *r)
{
	return r->tool.on ? r->tool.here_mm : r->contour.here_mm;
}

/** nc_has_guides() - are U V the contour on the second plane? */
static inline bool nc_has_guides(const struct nc_reader *r)
{
	return guides_on(&r->contour.guides);
}

/** nc_call_condition() - from here on; the word is at @at. */
int nc_call_condition(struct nc_reader *r, char letter, uint32_t number,
		      const uint8_t *at);

/** nc_define_condition() - by the numbers at @p; the word is at @at.
 *  Return: behind them, or NULL. */
const uint8_t *nc_define_condition(struct nc_reader *r, const uint8_t *at,
				   const uint8_t *p, uint32_t number);

/** nc_forget_conditions() - those the program has defined. */
void nc_forget_conditions(struct nc_reader *r);

/* passes.c: G150, G151, G152. */
int nc_pass(struct nc_reader *r);
int nc_cavity(struct nc_reader *r);
int nc_cut(struct nc_reader *r);

/** nc_call() - go on in subprogram @number; the word is at @at. */
int nc_call(struct nc_reader *r, double number, const uint8_t *at);

/** nc_read_line() - the next line, carried out. */
int nc_read_line(struct nc_reader *r);

/** nc_sink() - G120: a straight motion by a sequence of conditions. */
int nc_sink(struct nc_reader *r);

/** nc_line_to() - a straight motion to @end_mm. */
int nc_line_to(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       bool rapid);

/** nc_define_register() - D or H @n is @value; the word is at @at. */
int nc_define_register(struct nc_reader *r, const uint8_t *at, uint32_t n,
		       double value);

/** nc_refuse_wire() - the word at @at wants guides the machine has not. */
int nc_refuse_wire(struct nc_reader *r, const uint8_t *at);

/** nc_arc() - G2 or G3. */
int nc_arc(struct nc_reader *r, bool clockwise);

/** nc_curve() - G5 ... G5.3 and G6.2. */
int nc_curve(struct nc_reader *r);

/** nc_curve_goes_on() - may the line stand inside the curve that is open? */
int nc_curve_goes_on(struct nc_reader *r);

/** nc_curve_free() */
void nc_curve_free(struct nc_curve *c);

/** nc_line_two() - G1 with a : for the top. */
int nc_line_two(struct nc_reader *r, const double end_mm[INTERP_NAXES]);

/** nc_target() - where the axis words of the line lead, machine mm. */
void nc_target(const struct nc_reader *r, double ret_end_mm[INTERP_NAXES]);

/** nc_word() - r->word made ready for a move to @end_mm. */
int nc_word(struct nc_reader *r, const double end_mm[INTERP_NAXES], bool rapid);

/** nc_room() - count a segment, or refuse one too many. */
int nc_room(struct nc_reader *r);

/** nc_placed() - what the builder said to a move, with its place. */
int nc_placed(struct nc_reader *r, int rc, const double end_mm[INTERP_NAXES]);

/**
 * nc_mcode() - the machine's own M@n; NULL if it has none such.
 *
 * One of the reader's own numbers is never the machine's.
 */
const struct nc_code *nc_mcode(struct nc_reader *r, uint64_t n);

/** nc_run_mcode() - that of the line. */
int nc_run_mcode(struct nc_reader *r, enum nc_group group);

/** nc_action() - an action of the line at hand. */
int nc_action(struct nc_reader *r, enum interp_kind kind, uint32_t arg,
	      const uint8_t *at);

/** nc_end_of_text() - the text is over: may it be? */
int nc_end_of_text(struct nc_reader *r);

/** nc_label_at() - does the line @p to @end begin a program? Its number, or 0. */
uint32_t nc_label_at(const struct nc_reader *r, const uint8_t *p,
		     const uint8_t *end);

/** nc_column() - of the byte @at of the line in hand, in the text. */
uint32_t nc_column(const struct nc_reader *r, const uint8_t *at);

/** nc_line_end() - the line break at or after @p, or @end. */
const uint8_t *nc_line_end(const uint8_t *p, const uint8_t *end);

/** nc_line_next() - behind the line break at @p. */
static inline const uint8_t *nc_line_next(const uint8_t *p, const uint8_t *end)
{
	if (p < end && *p == '\r' && p + 1 < end && p[1] == '\n')
		return p + 2;
	return p < end ? p + 1 : end;
}

/* note.c.  Nothing is noted twice.  All but nc_note_code() speak only to who
 * wants to know before a run: notes->plan. */

/** nc_note_code() - the word at @at has a reason to be mentioned. */
void nc_note_code(struct nc_reader *r, const uint8_t *at,
		  const struct nc_code *code);

/** nc_note_point() - the length at @at has no decimal point. */
void nc_note_point(struct nc_reader *r, const uint8_t *at);

/** nc_note_line() - what the line in hand means, and would not elsewhere. */
void nc_note_line(struct nc_reader *r);

/** nc_write_offset() - G10 L2 and L20: a work offset of this program. */
int nc_write_offset(struct nc_reader *r);

/** nc_refuse() - fill the diag for the byte at @at. Return: -EINVAL. */
int nc_refuse(struct nc_reader *r, const uint8_t *at, const char *wanted,
	      const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/** nc_refuse_at() - the same for any place; @line 0 is the whole text. */
int nc_refuse_at(struct nc_reader *r, uint32_t line, const char *wanted,
		 const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/* Some of the text, fit to be quoted. */
struct nc_quote {
	char s[24];
};

/** nc_quote_word() - a letter and what can belong to its number. */
struct nc_quote nc_quote_word(const struct nc_reader *r, const uint8_t *at);

/** nc_quote_run() - everything up to a blank. */
struct nc_quote nc_quote_run(const struct nc_reader *r, const uint8_t *at);

/** nc_letters_known() - the letters that a word may begin with, into @buf;
 *  returns it. */
const char *nc_letters_known(const struct nc_dialect *d, char *buf,
			     size_t size);

/** nc_codes_known() - the numbers that @letter may have, in words into @buf;
 *  returns it. */
const char *nc_codes_known(const struct nc_letter *l, char letter, char *buf,
			   size_t size);

#endif /* CODE_READER_H */
