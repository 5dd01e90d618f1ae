/* SPDX-License-Identifier: Apache-2.0 */
/*
 * words.h - the words of the dialects, as tables
 *
 * A word is a letter and a number.  Words with a value have a slot.  G, M and T
 * words are codes, and each belongs to a modal group.  C with three digits, and
 * E, call a condition.  A dialect is a table of what bytes begin, tables of its
 * codes, and a few rules.  dialect_read.c reads all of it from a file of
 * dialects/.  What a code can mean is a row of meanings.h.  docs/nc-code.md
 * says what each one does.
 */
#ifndef CODE_WORDS_H
#define CODE_WORDS_H

#include <stdbool.h>
#include <stdint.h>

/* Words with a value.  The axes come first, in the order of enum interp_axis,
 * so that a mask of slots and a mask of axes agree. */
enum nc_slot {
	NC_X, NC_Y, NC_Z, NC_A, NC_B, NC_C, NC_U, NC_V,
	NC_I, NC_J, NC_K, NC_R,
	NC_F, NC_N, NC_S,
	NC_P, NC_L, NC_O,
	NC_D, NC_H, NC_ANGLE,		/* offset registers; A of a taper */
	NC_UI, NC_UJ,			/* I J behind a : */
	NC_Q,
	NC_NAME,			/* <NAME> of a program; only its place
					 * counts */
	NC_COMMA_R, NC_COMMA_C,		/* the corner behind a motion */
	NC_SPARE,			/* a letter that only ignored words
					 * use */
	NC_NSLOTS
};

#define NC_BIT(slot)	(1u << (slot))
#define NC_AXES		(NC_BIT(NC_I) - 1)
#define NC_CENTRE	(NC_BIT(NC_I) | NC_BIT(NC_J) | NC_BIT(NC_K))
#define NC_CORNER	(NC_BIT(NC_COMMA_R) | NC_BIT(NC_COMMA_C))
#define NC_MOVES	(NC_AXES | NC_CENTRE | NC_BIT(NC_R))
#define NC_LENGTHS	(NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z) | \
			 NC_BIT(NC_U) | NC_BIT(NC_V) | NC_BIT(NC_UI) | \
			 NC_BIT(NC_UJ) | NC_CENTRE | NC_BIT(NC_R) | NC_CORNER)
#define NC_ANGLES	(NC_BIT(NC_A) | NC_BIT(NC_B) | NC_BIT(NC_C) | \
			 NC_BIT(NC_ANGLE))
#define NC_OFFSETS	(NC_BIT(NC_D) | NC_BIT(NC_H))
#define NC_ANYWHERE	(NC_BIT(NC_F) | NC_BIT(NC_N) | NC_BIT(NC_S) | \
			 NC_BIT(NC_O) | NC_OFFSETS)

/* What may follow a letter. */
struct nc_word {
	char letter;
	bool whole;			/* it must be a whole number */
	double min, max;
	const char *range;		/* the same in words */
	const char *goes_with;		/* the lines it may stand on */
};

extern const struct nc_word nc_words[NC_NSLOTS];

/* What a byte can begin.  For the letter of a value it is NC_WORD + slot. */
enum nc_class {
	NC_BAD,
	NC_WORD,
	NC_OTHER = NC_WORD + NC_NSLOTS,
	NC_BLANK = NC_OTHER,
	NC_EOL,
	NC_LETTER_C,			/* an axis or a condition */
	NC_LETTER_E,
	NC_LETTER_G,
	NC_LETTER_M,
	NC_LETTER_T,
	NC_LETTER_S,			/* a condition, SC its definition */
	NC_LETTER_D,			/* D or H: an offset register */
	NC_LETTER_U,			/* U or V: only with a taper */
	NC_LETTER_R,			/* R; RA RI RJ: the turn of a figure */
	NC_NUMERIC,			/* a digit, point or sign without a
					 * letter */
	NC_OPEN,			/* ( comment ) */
	NC_SEMICOLON,			/* ; comment */
	NC_BLOCK_END,			/* ; and nothing behind it */
	NC_SLASH,
	NC_PERCENT,
	NC_COLON,
	NC_COMMA,			/* ,R ,C */
	NC_LETTER_NAME,			/* <NAME> of a program */
	NC_LETTER_REFUSED,		/* known in other dialects: there is a
					 * reason */
	NC_LETTER_REST,			/* the rest of the line is ignored */
	NC_NCLASSES
};

/* Digits, blanks, ends of lines, and everything else that all dialects
 * share. */
extern const uint8_t nc_classes[256];

/* Modal groups.  A line may have one word of each.  It is carried out in this
 * order, whatever the order of its words. */
enum nc_group {
	NC_UNKNOWN,
	NC_LABEL,			/* O, <NAME> */
	NC_UNITS,			/* G20 G21 */
	NC_PLANE,			/* G17 G18 G19 */
	NC_DISTANCE,			/* G90 G91 */
	NC_ARC_DISTANCE,		/* G90.1 G91.1 */
	NC_WORK,			/* G54 ... G59.3 */
	NC_ELECTRODE,			/* T1 */
	NC_ELECTRODE_CHANGE,		/* M6, where T alone changes nothing */
	NC_FEED_MODE,			/* G94 */
	NC_FEED,			/* F */
	NC_CONDITION,			/* C120 E001 */
	NC_REGISTER,			/* D H */
	NC_OFFSET,			/* G40 G41 G42 */
	NC_TAPER,			/* G50 G51 G52 */
	NC_TAPER_CORNER,		/* G60 G61 G62 */
	NC_MIRROR,			/* G51.1 G50.1, G5 ... G9 of Sodick */
	NC_SCALE,			/* G51 G50 of Fanuc's mills */
	NC_TURN,			/* G68 G69 */
	NC_MCODE,			/* for the PLC, before the motion */
	NC_POWER,			/* M3 M4 M5 */
	NC_PUMP,			/* T84 T85 */
	NC_ESCAPE,			/* G140 ... G143 */
	NC_TOOL_POINT,			/* G43.4 G43.5 G49 */
	NC_MACHINE,			/* G53 */
	NC_CYCLE,			/* G130 ... G135 */
	NC_PROBE,			/* G38.2 G80 G81 G82 G160 ... G162 */
	NC_ONE_SHOT,			/* G4 G10 G28 G92 G92.1 G120 */
	NC_MOTION,			/* G0 ... G3, G5 ... G5.3, G6.2, G6.3 */
	NC_MCODE_AFTER,			/* for the PLC, after the motion */
	NC_WIRE_STOP,			/* M20 M21 M50 M60: a person threads or
					 * cuts the wire */
	NC_STOP,			/* M0 M1 M2 M30 M98 M99 */
	NC_NGROUPS,
	NC_IGNORED = NC_NGROUPS,	/* not carried out; a note says so */
	NC_REFUSED			/* known in other dialects: the file
					 * says what it means there */
};

/* What a member of NC_MOTION does; G0 ... G3 have their own numbers. */
enum nc_motion {
	NC_SPLINE = 5,			/* G5: a cubic */
	NC_PARABOLA,			/* G5.1 */
	NC_NURBS_BLOCK,			/* G5.2: a control point */
	NC_NURBS_END,			/* G5.3 */
	NC_NURBS,			/* G6.2: a control point or a knot */
	NC_BODY,			/* the same for a rigid body */
};

/*
 * Words that act once.  A row has the name in a dialect's file, an id, the
 * function that carries it out, and the slots that it uses.  A new one is a row
 * and a function.  A dialect has it when its file in dialects/ names it.
 */
#define NC_ONE_SHOTS(W) \
	W("dwell", DWELL, dwell, NC_BIT(NC_P) | NC_BIT(NC_X)) \
	W("write-offset", WRITE, nc_write_offset, \
	  NC_AXES | NC_BIT(NC_L) | NC_BIT(NC_P) | NC_BIT(NC_R)) \
	W("home", HOME, home, NC_AXES) \
	W("set-place", SET, set_here, NC_AXES) \
	W("set-place-off", SET_CANCEL, set_cancel, 0) \
	W("local-place", LOCAL, nc_local_place, NC_AXES) \
	W("sink", SINK, nc_sink, NC_AXES | NC_BIT(NC_P)) \
	W("pass", PASS, nc_pass, 0) \
	W("cavity", CAVITY, nc_cavity, \
	  NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_P)) \
	W("cut", CUT, nc_cut, NC_BIT(NC_R) | NC_BIT(NC_L))

#define NC_ONE_SHOT_ID(name, id, run, takes)	NC_##id,
enum nc_one_shot { NC_ONE_SHOTS(NC_ONE_SHOT_ID) };

/* What a member of NC_PROBE does. */
enum nc_probe {
	NC_PROBE_FEED,			/* not faster than the programmed
					 * feed */
	NC_PROBE_ONE, NC_PROBE_LIMIT, NC_PROBE_HALF,
	NC_PROBE_HOLE, NC_PROBE_PILLAR, NC_PROBE_CORNER,
	NC_NPROBES
};
/* What a member of NC_TOOL_POINT does. */
enum nc_tool { NC_TOOL_OFF, NC_TOOL_ANGLES, NC_TOOL_VECTOR };

/* What a member of NC_MIRROR does. */
enum nc_mirror {
	NC_MIRROR_OFF,			/* every image, and the exchange */
	NC_MIRROR_END,			/* that of the axes that are named */
	NC_MIRROR_PLACES,		/* at the places that are named */
	NC_MIRROR_X, NC_MIRROR_Y,	/* X, Y change their sign */
	NC_MIRROR_EXCHANGE,		/* of X and Y */
};

/* What a member of NC_TURN does. */
enum nc_turn { NC_TURN_OFF, NC_TURN_ABOUT_XY, NC_TURN_ABOUT_IJ };

#define NC_M_CHANGE	6		/* M6 of a PLC changes the electrode */

/* When the electrode that a member of NC_ELECTRODE names is in force. */
enum nc_electrode { NC_ELECTRODE_NOW, NC_ELECTRODE_NEXT };

/* What a member of NC_STOP does. */
enum nc_stop { NC_HALT, NC_OPTIONAL_HALT, NC_FINISH, NC_CALL, NC_RETURN };

/* One G, M or T word. */
struct nc_code {
	uint8_t group;			/* enum nc_group */
	uint8_t value;			/* for the function of the group */
	uint16_t text;			/* the reason, in nc_dialect.text; 0:
					 * none */
	uint32_t takes;			/* slots that it uses on its line */
	uint32_t drops;			/* ... and slots that it ignores */
};

/* Index: ten times the number for G, the number itself for M and T. */
#define NC_NG	2000
#define NC_NM	1000
#define NC_NT	100
#define NC_NCODES	(NC_NG + NC_NM + NC_NT)

/* The codes of a letter. */
struct nc_letter {
	struct nc_code *codes;
	uint32_t ncodes;
	uint32_t scale;			/* 10: one decimal may follow */
	struct nc_code other;		/* for every number without a code */
};

#define NC_TEXT_MAX	12288

/* A length without a decimal point is taken as it is, or in the last of its
 * decimals, or is refused unless it is 0. */
enum nc_point { NC_POINT_FREE, NC_POINT_LAST, NC_POINT_WANTED };

/* Variables, expressions and jumps: none, Fanuc's or LinuxCNC's. */
enum nc_macros { MACRO_NONE, MACRO_FANUC, MACRO_LINUXCNC };

struct nc_dialect {
	uint8_t classes[256];		/* of bytes */
	struct nc_letter letter[3];	/* G M T */
	uint8_t label;			/* of subprograms: O or N */
	uint8_t point;			/* enum nc_point */
	uint8_t arc_places;		/* I J are places */
	uint8_t m2_ends;		/* M2 ends the text, and nothing else
					 * does */
	uint8_t no_feed;		/* F is optional: the gap decides */
	uint8_t defines;		/* E001= and H001= lines */
	uint8_t registers;		/* H001=0.11 alone */
	uint8_t lone_ways;		/* X- and X without a number are
					 * allowed */
	uint8_t lean;			/* U V: how far the top of the wire is
					 * from X Y, not its place */
	uint8_t dwell_ms;		/* P of a dwell is in ms, not s */
	uint8_t g91_sets;		/* G10 L2 under G91 sets an origin, it
					 * does not move it */
	uint8_t inches;			/* a program begins in them */
	uint8_t macros;			/* enum nc_macros */
	uint16_t reason[26];		/* of letters, in text */
	struct nc_code code[NC_NCODES];	/* G, M, T */
	uint16_t used;			/* of text */
	char text[NC_TEXT_MAX];		/* begins with an empty one */
};

#endif /* CODE_WORDS_H */
