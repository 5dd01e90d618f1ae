/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reader.h - the state of the NC reader, and who does what
 *
 *	scan.c		one line of text into a block of words
 *	scan_again.c	the same for a line like the one before
 *	modal.c		carry a block out, group by group
 *	mcode.c		M codes of the machine
 *	electrode.c	T words: which electrode cuts
 *	figure.c	figures that are turned, mirrored, scaled: G68 G51.1
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

#include <errno.h>

/* Tool-centre-point programming. */
struct nc_tool_point {
	bool on;
	bool vector;			/* G43.5: I J K are its direction */
	bool longer;			/* by this register: */
	uint32_t length;
	double dir[3];			/* the last one, of length 1 */
	struct interp_kinematics k;	/* with the tool's length */
	double here_mm[INTERP_NAXES];	/* X Y Z of the tip, seen from the work;
					 * the others as the axes stand */
};

/* Kinds of notes; each is made once. */
enum nc_told { NC_TOLD_POINT, NC_TOLD_INCHES, NC_TOLD_CONDITION,
	       NC_TOLD_DWELL, NC_TOLD_OFFSET, NC_TOLD_ELECTRODE,
	       NC_TOLD_CHANGE, NC_TOLD_SKIPPED, NC_TOLD_VACANT,
	       NC_TOLD_PRINT, NC_TOLD_COLUMNS };

/* The words of one line.  Only members that `words` and `groups` name are
 * filled. */
struct nc_block {
	uint32_t words;			/* bit per enum nc_slot */
	uint32_t groups;		/* bit per enum nc_group */
	uint32_t takes;			/* slots that its codes use */
	uint32_t drops;			/* ... that they ignore, with a note */
	uint32_t cond_number;
	char cond_letter;
	uint64_t electrode;		/* number of its T word */
	uint32_t angles;		/* A and B of a cycle: here they are not
					 * axes */
	uint32_t toward;		/* slots without a number: their value
					 * is only a direction, +1 -1 or 0 */
	double value[NC_NSLOTS];
	const struct nc_code *dropper;	/* a word that is carried out without
					 * some of its letters, or NULL */
	const uint8_t *dropper_at;
	const uint8_t *alone_at;	/* an ignored word beside which nothing
					 * may move, or NULL */
	const uint8_t *unit_at;		/* the first word whose value needed the
					 * units when it was scanned, or NULL */
	const uint8_t *at[NC_NSLOTS];	/* position of the letter */
	const struct nc_code *code[NC_NGROUPS];
	const uint8_t *code_at[NC_NGROUPS];
	const struct nc_code *upper;	/* the G word behind a colon, or NULL */
	struct nc_code mcode[2];	/* for the PLC: before and after */
	bool colon;			/* the top has its own words */
};

/* A line up to its numbers: scan_again.c. */
#define NC_PATTERN_WORDS	8

struct nc_pattern_word {
	uint64_t text, mask;		/* what is in front of its number, with
					 * its letter; and which bytes of it */
	uint8_t bytes;			/* that are in front of it */
	uint8_t slot;
};

struct nc_pattern {
	uint32_t n;			/* 0: the next line is not compared */
	uint32_t words;			/* those of the last line, if it can be
					 * a pattern */
	struct nc_pattern_word word[NC_PATTERN_WORDS];
	uint8_t behind, back;		/* the motion is so far in front of the
					 * letter of that slot */
};

/* A line of the text.  A line that macros have expanded is read in a buffer
 * that the next line uses again: nothing that is kept points into a line. */
struct nc_place {
	size_t offset;			/* of its first byte in the text */
	uint32_t line;			/* from 1; 0: there is none */
};

/* A program or subprogram that is being carried out. */
struct nc_frame {
	uint32_t number;		/* number of its O word; 0: none */
	uint32_t left;			/* how often it is still to be
					 * repeated */
	char name[40];			/* as a message calls it */
	struct nc_place entry, back;	/* its first line; the caller's next
					 * line */
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
	double number;			/* number of its subprogram */
	uint32_t line;			/* line of its G151 */
	double hole_mm[2];
};

/* The order in which several contours are cut. */
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
	enum nc_pass_order order;	/* of the present G152, as tab_mm is */
};

/* A condition that the program defines, for example by E001= 60 10 25. */
struct nc_defined {
	struct nc_defined *next;	/* the condition that was defined before
					 * it */
	char letter;
	uint32_t number;
	bool empty;			/* nobody says what its columns mean,
					 * and it is not in the table */
	struct interp_tech tech;
};

#define NC_NDEFINED_MAX	256

/* A line that begins a program, by an O word or a <NAME>. */
struct nc_label {
	struct nc_place place;
	uint32_t second;		/* the line where its number is again */
	uint32_t name;			/* how far in its line its < is */
};

/* A curve that is put together, block by block. */
struct nc_curve {
	uint8_t open;			/* NC_NURBS, NC_NURBS_BLOCK; 0: none */
	uint32_t order;			/* degree + 1 */
	uint32_t line;			/* where it began */
	uint32_t npoints, nknots;
	size_t points_room, knots_room;
	double *points;			/* rows of all axes times the weight,
					 * and then the weight */
	double *knots;
	struct interp_build_mark *marks;	/* a mark for each point */
	double last_mm[INTERP_NAXES];	/* the last point */
	bool smooth;			/* there was a G5 right before this line
					 * ... */
	double leave_mm[2];		/* ... and its last handle, mirrored */
};

/* A figure that is turned, mirrored and scaled. */
struct nc_figure {
	double turn_deg, about_mm[2];	/* a place of the work system */
	uint32_t mirrored;		/* bits of X and Y */
	double mirror_mm[2];		/* where the mirror stands, as the
					 * program says it */
	bool exchanged;			/* X and Y */
	double scale, scale_mm[3];	/* 1: none; as the program says it */
	bool vague;			/* since it changed, no line has named
					 * both X and Y */
};

/* Of P in G51. */
#define NC_SCALE_LEAST	0.001
#define NC_SCALE_MOST	1000

/* Two places that a program can tell apart. */
#define NC_SEEN_MM	1e-6

struct nc_reader {
	const struct nc_dialect *d;
	struct interp_diag first;	/* the refusal that ended the reading */
	bool first_told;
	uint32_t ntold;
	struct nc_macro *macro;		/* NULL: nothing was expanded yet */
	bool listing;			/* all refusals are wanted: list.c */
	bool lost;			/* the motion in force was refused */
	bool mapped;			/* the present line is in its buffer */

	/* The text, and the present line. */
	const uint8_t *text, *text_end;
	const uint8_t *end;		/* nothing behind it is read: the % that
					 * ends the text */
	const uint8_t *at;		/* the next line */
	const uint8_t *line_at, *stop;	/* begin of this line, and its farthest
					 * end */
	const uint8_t *word_at;		/* the word that was read last */
	const uint8_t *value_end;	/* behind the decimal that was read
					 * last */
	uint32_t line;			/* number of this line, from 1 */
	struct nc_block block;
	struct nc_pattern pattern;

	/* Modes, until changed. */
	const struct nc_code *motion;	/* NULL: none yet */
	uint8_t plane;			/* 0 ... 2: G17 ... G19 */
	uint8_t work;			/* 0 ... 8: G54 ... G59.3 */
	double work_mm[INTERP_NC_NWORK][INTERP_NAXES];
	double turn_deg[INTERP_NC_NWORK];
	bool incremental, arc_incremental;
	uint32_t lengths;		/* slots where a decimal point
					 * matters */
	double unit_mm;			/* 1 or 25.4 */
	double scale[INTERP_NAXES];	/* unit_mm by the scale of the figure; 1
					 * for rotary axes */
	struct nc_figure figure;
	double shift_mm[INTERP_NAXES];	/* by G92 or G52 */
	uint32_t local;			/* axes that G52 has shifted */
	double offset_mm[INTERP_NAXES];	/* work offset, electrode and shift
					 * together, turned back as nc_here()
					 * is: interp/turn.h */
	double origin_mm[INTERP_NAXES];	/* ... without the shift */
	double feed_mm_s, feed_deg_s;	/* 0: there is none yet */
	struct interp_build_word word;	/* its condition is modal, too */
	struct nc_register registers[NC_NREGISTERS];	/* D and H */
	uint32_t selected;		/* the register that D or H named
					 * last */
	bool h_alone;			/* H did, on a line without G43.4 */
	struct nc_defined *defined;	/* the last one; NULL: none */
	uint32_t ndefined;

	/* The wire. */
	struct contour contour;
	int offset_side, taper_side;	/* +1 left, -1 right, 0 off */
	double slope;			/* tangent of the taper */
	double set_slope;		/* + left, of one that is set for the
					 * job: it holds under an offset */
	bool set_used;

	struct nc_passes passes;
	enum interp_escape_mode escape;
	struct nc_tool_point tool;

	/* The electrode. */
	uint32_t electrode;		/* in force; 0: none */
	uint32_t next;			/* named by a T word, for the change */
	double electrode_by[INTERP_NAXES];	/* what it shifts the axes by:
					 * whole pulses; X Y at C 0 */
	uint32_t unplaced;		/* axes that it shifts otherwise than
					 * the one before, not named since */
	uint32_t nchanges;

	/* Probing. */
	uint32_t loose;			/* axes that count from a contact */
	uint32_t unnamed;		/* ... and whose place has no number
					 * yet */
	uint32_t once, twice;		/* axes with one and with two
					 * contacts */

	/* Flow. */
	struct nc_frame frame[INTERP_NC_DEPTH_MAX + 1];
	uint32_t depth;			/* frame in use; 0: the main program */
	struct nc_label *labels;	/* by O number; NULL before an M98 */
	struct nc_label *named;		/* by <NAME> */
	size_t nnamed, named_room;
	bool fresh;			/* this program has no words yet */
	bool tape;			/* the % that begins it was read */
	bool over;			/* the program has ended */

	struct nc_curve curve;
	uint32_t moved;			/* axes that the program has moved */
	uint32_t absent;		/* axes that the machine does not
					 * have */
	uint32_t segs, segs_max;
	uint32_t executed, executed_max;	/* nc_count_bytes() */

	/* What was noted already: codes, then letters by the place of their
	 * reason in d->text, then enum nc_told. */
	uint8_t told[(NC_NCODES + NC_TEXT_MAX) / 8 + 1];
	uint32_t told_once;

	const struct interp_nc_options *o;
	struct interp_build *build;
	struct interp_diag *diag;
};

/* A text of a few long lines that are repeated may not take longer than one of
 * many short lines.  Expressions take longer than words and comments. */
#define NC_COUNTED_BYTES	64
#define NC_COUNTED_MACRO	16

static inline void nc_count_bytes(struct nc_reader *r, size_t bytes, size_t as)
{
	r->executed += (uint32_t)(bytes / as);
}

static inline bool nc_has(const struct nc_reader *r, enum nc_slot slot)
{
	return r->block.words & NC_BIT(slot);
}

static inline bool nc_has_group(const struct nc_reader *r, enum nc_group group)
{
	return r->block.groups & NC_BIT(group);
}

/** nc_by_distance() - are the words of this block distances, as under G91? */
static inline bool nc_by_distance(const struct nc_reader *r)
{
	return nc_has_group(r, NC_DISTANCE) ?
	       r->block.code[NC_DISTANCE]->value : r->incremental;
}

/* a toward b is counter-clockwise.  ca and cb are the words of the centre;
 * `other` has no part; `normal` is square to both. */
struct nc_plane {
	enum interp_axis a, b, normal;
	enum nc_slot ca, cb, other;
	const char *name, *centre;
};

extern const struct nc_plane nc_planes[3];

/**
 * nc_scan_line() - scan the line at r->at into r->block; r->at is then the next
 * line.
 */
int nc_scan_line(struct nc_reader *r);

/**
 * nc_scan_again() - the same as nc_scan_line() and nc_check_line(), if the line
 * has the same words as the last one.  Return: it has, and they are right;
 * false: nothing is known about it.
 */
bool nc_scan_again(struct nc_reader *r);

/** nc_note_pattern() - r->block was carried out: the next may be like it. */
void nc_note_pattern(struct nc_reader *r);

/** nc_check_line() - do the words of r->block go together? */
int nc_check_line(struct nc_reader *r);

/**
 * nc_list_refusals() - send what r->diag has, and all other refusals, to
 * o->refused.
 */
void nc_list_refusals(struct nc_reader *r);

/** nc_has_no_code() - has the line places, a feed and a label at most? */
bool nc_has_no_code(const struct nc_reader *r);

/** nc_tell() - send what r->diag has to o->refused. */
void nc_tell(struct nc_reader *r);

/** nc_run_line() - check r->block, and carry it out. */
int nc_run_line(struct nc_reader *r);

/** nc_run_groups() - carry out the words of r->block that are in @groups. */
int nc_run_groups(struct nc_reader *r, uint32_t groups);

/**
 * nc_set_units(), nc_set_offset() - call these after a change of units; of
 * offsets.
 */
void nc_set_units(struct nc_reader *r, bool inches);
void nc_set_offset(struct nc_reader *r);

/** nc_origin() - for words: where it counts from, in pass @pass (from 1; 0:
 *  none) with the wire @wire_mm beside its contour. */
uint32_t nc_origin(const struct nc_reader *r, uint32_t pass, double wire_mm);

/** nc_set_turn() - another work system is in force, or is turned otherwise. */
int nc_set_turn(struct nc_reader *r);

/** nc_work_origin() - of the work system in force, with the electrode: a
 *  machine place. */
void nc_work_origin(const struct nc_reader *r, double ret_mm[INTERP_NAXES]);

/** nc_figure_turn() - of the figure, within its work system. */
struct interp_turn nc_figure_turn(const struct nc_figure *f);

/** nc_figure_origin() - @mm has the place of the work system from which
 *  programs count; it gets the one from which a figure does, turned back as the
 *  figure is turned. */
void nc_figure_origin(const struct nc_figure *f, double mm[INTERP_NAXES]);

static inline bool nc_figure_is_on(const struct nc_figure *f)
{
	return f->turn_deg != 0 || f->mirrored || f->exchanged || f->scale != 1;
}

/** nc_check_figure() - may the line stand in the figure as it is?  Return: 0,
 *  or -EINVAL. */
int nc_check_figure(struct nc_reader *r);

/** nc_decimals() - how many decimals the word at @at has. */
int nc_decimals(const struct nc_reader *r, const uint8_t *at);

/** nc_place_electrode() - the line moves axes that it names, or is a cut: one
 *  before each axis of r->unplaced was named is refused. */
int nc_place_electrode(struct nc_reader *r, bool rapid);

/** nc_electrode_at() - what the electrode shifts the axes by, where C stands
 *  at @c_deg. */
void nc_electrode_at(const struct nc_reader *r, double c_deg,
		     double ret_mm[INTERP_NAXES]);

/** nc_is_eccentric() - is its middle beside the axis that C turns about? */
static inline bool nc_is_eccentric(const struct nc_reader *r)
{
	return r->electrode_by[INTERP_X] != 0 || r->electrode_by[INTERP_Y] != 0;
}

/** nc_turns_electrode() - does C turn the electrode, and not the table? */
static inline bool nc_turns_electrode(const struct nc_reader *r)
{
	return !r->o->kinematics ||
	       !interp_kin_turns_work(r->o->kinematics, INTERP_C);
}

/** nc_check_eccentric() - may it be cut to @end_mm, as far as C turns? */
int nc_check_eccentric(struct nc_reader *r, const double end_mm[INTERP_NAXES]);

/* Functions of groups, called by nc_run_line(). */
int nc_run_motion(struct nc_reader *r);
int nc_run_one_shot(struct nc_reader *r);
int nc_run_mirror(struct nc_reader *r);
int nc_run_scale(struct nc_reader *r);
int nc_run_turn(struct nc_reader *r);
int nc_run_stop(struct nc_reader *r);
int nc_run_label(struct nc_reader *r);

/* cycles.c */
int nc_run_cycle(struct nc_reader *r);
int nc_run_escape(struct nc_reader *r);

/** nc_take_cycle() - A and B of a cycle are not axes. */
void nc_take_cycle(struct nc_reader *r);

/** nc_set_lift() - call this after a change of the plane or of the way out. */
void nc_set_lift(struct nc_reader *r);
int nc_run_tool_point(struct nc_reader *r);

/** nc_machine_place() - may the word at @at name a place of the machine?  Under
 *  G43.4, an offset or a taper it may not.  Return: 0, or -EINVAL. */
int nc_machine_place(struct nc_reader *r, const uint8_t *at);

/** nc_tool_length() - the tool is as long as its register and the electrode
 *  say; the axes stand. */
void nc_tool_length(struct nc_reader *r);

/* Under G43.4: like contour_line(), contour_arc() and contour_nurbs(), but for
 * the tip; r->word is filled.  A curve ends at r->curve.last_mm. */
int nc_tip_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		bool rapid);

/** nc_tip_turn() - as nc_tip_line(), for a turn in place: the tip goes on by
 *  less than can be seen. */
int nc_tip_turn(struct nc_reader *r, const double end_mm[INTERP_NAXES]);
int nc_tip_arc(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       const struct interp_build_arc *arc);
int nc_tip_curve(struct nc_reader *r, const struct interp_build_curve *c);

/**
 * nc_tool_vector() - for a line under G43.5: may it have I J K, and no angles
 * of the rotary axes that turn the tool?
 */
int nc_tool_vector(struct nc_reader *r);

/** nc_tool_looks() - set the direction of the tool to that of the axes. */
void nc_tool_looks(struct nc_reader *r);

/** nc_tool_line() - a line under G43.4 or G43.5. */
int nc_tool_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		 bool rapid);

/* probing.c */
int nc_run_probe(struct nc_reader *r);

/** nc_check_probed() - does the line name places that nobody knows? */
int nc_check_probed(struct nc_reader *r);

/* The same for wire machines. */
int nc_run_register(struct nc_reader *r);
int nc_run_offset(struct nc_reader *r);
int nc_run_taper(struct nc_reader *r);
/** nc_setting_begin(), nc_setting_end() - what is set for the job, before and
 *  behind its lines. */
int nc_setting_begin(struct nc_reader *r);
int nc_setting_end(struct nc_reader *r);
int nc_run_taper_corner(struct nc_reader *r);

/** nc_take_angle() - the A of a G51 or G52 is not an axis. */
int nc_take_angle(struct nc_reader *r);

/**
 * nc_here() - where the program has come to, in the frame in which it is
 * written.
 */
static inline const double *nc_here(const struct nc_reader *r)
{
	return r->tool.on ? r->tool.here_mm : r->contour.here_mm;
}

/** nc_has_guides() - are U V the contour on the second plane? */
static inline bool nc_has_guides(const struct nc_reader *r)
{
	return guides_on(&r->contour.guides);
}

/** nc_refuse_undelivered() - does all that @t gives reach the generator?
 *  Return: 0, or it is refused: @who is named. */
int nc_refuse_undelivered(struct nc_reader *r, const struct interp_tech *t,
			  const char *who, const uint8_t *at);

/** nc_call_condition() - call it from here on; the word is at @at. */
int nc_call_condition(struct nc_reader *r, char letter, uint32_t number,
		      const uint8_t *at);

/**
 * nc_define_condition() - define it by the numbers at @p; the word is at @at.
 * Return: the place behind them, or NULL.
 */
const uint8_t *nc_define_condition(struct nc_reader *r, const uint8_t *at,
				   const uint8_t *p, uint32_t number);

/** nc_forget_conditions() - forget those that the program has defined. */
void nc_forget_conditions(struct nc_reader *r);

/* passes.c: G150, G151, G152. */
int nc_pass(struct nc_reader *r);
int nc_cavity(struct nc_reader *r);
int nc_cut(struct nc_reader *r);

/**
 * nc_call() - continue in subprogram @number, and go through it so many @times,
 * 1 or more; the word is at @at.
 */
int nc_call(struct nc_reader *r, double number, uint32_t times,
	    const uint8_t *at);

/** nc_call_name() - the same for the one with the <NAME> at @at. */
int nc_call_name(struct nc_reader *r, uint32_t times, const uint8_t *at);

/** nc_name_end() - behind the <NAME> at @at; NULL: it is none. */
const uint8_t *nc_name_end(const uint8_t *at, const uint8_t *end);

/** nc_read_line() - read the next line and carry it out. */
int nc_read_line(struct nc_reader *r);

/** nc_sink() - G120: a straight motion by a sequence of conditions. */
int nc_sink(struct nc_reader *r);

/** nc_line_to() - a straight motion to @end_mm. */
int nc_line_to(struct nc_reader *r, const double end_mm[INTERP_NAXES],
	       bool rapid);

/**
 * nc_define_register() - set register @n of D or H to @value; the word is at
 * @at.
 */
int nc_define_register(struct nc_reader *r, const uint8_t *at, uint32_t n,
		       double value);

/**
 * nc_refuse_wire() - the word at @at needs guides, which the machine does not
 * have.
 */
int nc_refuse_wire(struct nc_reader *r, const uint8_t *at);

/** nc_arc() - G2 or G3. */
int nc_arc(struct nc_reader *r, bool clockwise);

/** nc_curve() - G5 ... G5.3 and G6.2. */
int nc_curve(struct nc_reader *r);

/** nc_curve_goes_on() - may the line stand inside the open curve? */
int nc_curve_goes_on(struct nc_reader *r);

/** nc_curve_free() */
void nc_curve_free(struct nc_curve *c);

/** nc_line_two() - G1 with a : for the top. */
int nc_line_two(struct nc_reader *r, const double end_mm[INTERP_NAXES]);

/**
 * nc_target() - the place to which the axis words of the line lead, machine mm.
 */
void nc_target(const struct nc_reader *r, double ret_end_mm[INTERP_NAXES]);

/** nc_word() - prepare r->word for a motion.
 *  @turns: only rotary axes move, so F is in degrees per minute, and inches do
 *  not apply to it. */
int nc_word(struct nc_reader *r, bool turns, bool rapid);

/** nc_refuse_room() - there are too many segments. */
int nc_refuse_room(struct nc_reader *r);

/** nc_room() - count a segment; refuse it if there are too many. */
static inline int nc_room(struct nc_reader *r)
{
	return r->segs++ + r->contour.guides.cuts < r->segs_max ?
	       0 : nc_refuse_room(r);
}

/** nc_blame() - point to the word to which the builder has said no. */
void nc_blame(struct nc_reader *r, const double end_mm[INTERP_NAXES]);

/** nc_goes() - the axes of the machine that the words of a line move. */
static inline uint32_t nc_goes(const struct nc_reader *r)
{
	const uint32_t xy = NC_BIT(NC_X) | NC_BIT(NC_Y);
	const uint32_t axes = r->block.words & NC_AXES;
	uint32_t both = interp_turn_is_on(&r->contour.guides.turn) ?
			xy : 0;

	if (nc_has_group(r, NC_MACHINE))
		return axes;
	if (nc_is_eccentric(r) && nc_turns_electrode(r))
		both |= NC_BIT(NC_C);
	return axes & both ? axes | xy : axes;
}

/** nc_placed() - what the builder said to a motion, together with its place. */
static inline int nc_placed(struct nc_reader *r, int rc,
			    const double end_mm[INTERP_NAXES])
{
	if (rc == -EINVAL)
		nc_blame(r, end_mm);
	r->moved |= nc_goes(r);
	return rc;
}

/**
 * nc_mcode() - the machine's own M@n; NULL if it has none.
 *
 * A number that the reader itself uses never belongs to the machine.
 */
const struct nc_code *nc_mcode(struct nc_reader *r, uint64_t n);

/** nc_electrode_begin() - the one that is in force as the program begins. */
int nc_electrode_begin(struct nc_reader *r);
int nc_run_electrode(struct nc_reader *r);
int nc_run_electrode_change(struct nc_reader *r);

/** nc_electrode_by_plc() - the PLC has put in the one named last. */
int nc_electrode_by_plc(struct nc_reader *r, const uint8_t *at);

/** nc_note_electrode() - note what a T word or a change is not, and why. */
void nc_note_electrode(struct nc_reader *r, enum nc_group group,
		       const char *why);

/** nc_run_mcode() - carry out the M code of the line. */
int nc_run_mcode(struct nc_reader *r, enum nc_group group);

/** nc_action() - add an action of the present line. */
int nc_action(struct nc_reader *r, enum interp_kind kind, uint32_t arg,
	      const uint8_t *at);

/** nc_end_of_text() - the text ends here: may it? */
int nc_end_of_text(struct nc_reader *r);

/** nc_skip_void() - the first byte from @p that is no blank and no comment. */
const uint8_t *nc_skip_void(const uint8_t *p, const uint8_t *end);

/** nc_begins_program() - has the line from @p to @end an O word or a <NAME> in
 *  front of all else? */
bool nc_begins_program(const struct nc_reader *r, const uint8_t *p,
		       const uint8_t *end);

/** nc_tape_end() - the % that ends the text: the second one that begins a line,
 *  or the first one behind words; @end: there is none.  Where words follow it,
 *  the end of its line, so that they are refused. */
const uint8_t *nc_tape_end(const uint8_t *text, const uint8_t *end);

/** nc_check_tape() - words behind that % are noted, or refused if no % begins
 *  the text.  Return: 0, or -EINVAL. */
int nc_check_tape(struct nc_reader *r);

void nc_forget_labels(struct nc_reader *r);

/** nc_column() - the column in the text of byte @at of the present line. */
uint32_t nc_column(const struct nc_reader *r, const uint8_t *at);

/** nc_is_computed() - does a macro's value begin at byte @at of the present
 *  line? */
bool nc_is_computed(const struct nc_reader *r, const uint8_t *at);

/** nc_line_end() - the line break at or after @p, or @end. */
const uint8_t *nc_line_end(const uint8_t *p, const uint8_t *end);

/** nc_go() - the line at @to is the next one. */
static inline void nc_go(struct nc_reader *r, struct nc_place to)
{
	r->at = r->text + to.offset;
	r->line = to.line - 1;
}

/** nc_go_behind() - the line behind @to is the next one. */
void nc_go_behind(struct nc_reader *r, struct nc_place to);

/** nc_next() - the place of the next line. */
static inline struct nc_place nc_next(const struct nc_reader *r)
{
	return (struct nc_place) { (size_t)(r->at - r->text), r->line + 1 };
}

/** nc_this() - the place of the present line. */
struct nc_place nc_this(const struct nc_reader *r);

/** nc_line_next() - behind the line break at @p. */
static inline const uint8_t *nc_line_next(const uint8_t *p, const uint8_t *end)
{
	if (p < end && *p == '\r' && p + 1 < end && p[1] == '\n')
		return p + 2;
	return p < end ? p + 1 : end;
}

/* The line at r->at is read from the text, at most up to r->stop ... */
static inline void nc_begin_line(struct nc_reader *r)
{
	const uint8_t *p = r->at;

	r->mapped = false;
	r->line_at = p;
	r->stop = r->end - p > INTERP_NC_LINE_MAX ? p + INTERP_NC_LINE_MAX :
						    r->end;
}

/* ... and ends at @p. */
static inline void nc_end_line(struct nc_reader *r, const uint8_t *p)
{
	nc_count_bytes(r, (size_t)(p - r->line_at), NC_COUNTED_BYTES);
	r->at = nc_line_next(p, r->end);
}

/* note.c.  Nothing is noted twice.  nc_note_point() and nc_note_line() make
 * notes only for those who ask before a run: notes->plan. */

/** nc_note_code() - there is a reason to mention the word at @at. */
void nc_note_code(struct nc_reader *r, const uint8_t *at,
		  const struct nc_code *code);

/** nc_note_skipped() - a line is not carried out because of its /. */
void nc_note_skipped(struct nc_reader *r);

/** nc_note_vacant() - common variable #@n is read, and has no value. */
void nc_note_vacant(struct nc_reader *r, uint32_t n);

/** nc_note_print() - DPRNT and its like, the first of them @word. */
void nc_note_print(struct nc_reader *r, const char *word);

/** nc_note_columns() - nobody says what the columns of a definition mean. */
void nc_note_columns(struct nc_reader *r, char letter, uint32_t number);

/** nc_note_title() - words behind the first %. */
void nc_note_title(struct nc_reader *r);

/** nc_note_tape() - words behind the % that ends the text, in line @line. */
void nc_note_tape(struct nc_reader *r, uint32_t line);

/** nc_note_rest() - words behind the end, in line @line. */
void nc_note_rest(struct nc_reader *r, uint32_t line);

/** nc_note_point() - the length at @at has no decimal point. */
void nc_note_point(struct nc_reader *r, const uint8_t *at);

/** nc_note_line() - note what the present line means here and not elsewhere. */
void nc_note_line(struct nc_reader *r);

/** nc_local_place() - G52: a shift of all work offsets. */
int nc_local_place(struct nc_reader *r);

/** nc_write_offset() - G10 L2 and L20: a work offset of this program. */
int nc_write_offset(struct nc_reader *r);

/** nc_refuse() - fill the diag for the byte at @at.  Return: -EINVAL. */
int nc_refuse(struct nc_reader *r, const uint8_t *at, const char *wanted,
	      const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/** nc_refuse_at() - the same for any place; @line 0 means the whole text. */
int nc_refuse_at(struct nc_reader *r, uint32_t line, const char *wanted,
		 const char *found, ...)
	__attribute__((cold, format(printf, 4, 5)));

/* A part of the text that can be quoted. */
struct nc_quote {
	char s[24];
};

/** nc_quote_word() - a letter and everything that can belong to its number. */
struct nc_quote nc_quote_word(const struct nc_reader *r, const uint8_t *at);

/** nc_quote_run() - everything up to a blank. */
struct nc_quote nc_quote_run(const struct nc_reader *r, const uint8_t *at);

/**
 * nc_letters_known() - write the letters with which a word may begin into @buf
 * and return it.
 */
const char *nc_letters_known(const struct nc_dialect *d, char *buf,
			     size_t size);

/**
 * nc_codes_known() - write the numbers that @letter may have, in words, into
 * @buf and return it.
 */
const char *nc_codes_known(const struct nc_letter *l, char letter, char *buf,
			   size_t size);

#endif /* CODE_READER_H */
