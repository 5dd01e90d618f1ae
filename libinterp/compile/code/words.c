/* SPDX-License-Identifier: Apache-2.0 */
/*
 * words.c - words with values, and the tables of dialect `generic`
 *
 * A new word is a new row.
 */
#include "code/words.h"

#include "interp/orbit.h"
#include "interp/wire.h"

#define ANY_PLACE	-999999999, 999999999, "-999999999 to 999999999"
#define AXIS_LINES	"an axis word goes with G0 G1 G2 G3 G28 G92 G120 G6.2, X " \
			"and Y with G5 G5.1 G5.2 too, X with G4"
#define CENTRE_LINES	"goes with G2 or G3, a curve, or G0 and G1 under G43.5"

/* clang-format off */
const struct nc_word nc_words[NC_NSLOTS] = {
	[NC_X] = { 'X', false, ANY_PLACE, AXIS_LINES },
	[NC_Y] = { 'Y', false, ANY_PLACE, AXIS_LINES },
	[NC_Z] = { 'Z', false, ANY_PLACE, AXIS_LINES },
	[NC_A] = { 'A', false, ANY_PLACE, AXIS_LINES },
	[NC_B] = { 'B', false, ANY_PLACE, AXIS_LINES },
	[NC_C] = { 'C', false, ANY_PLACE, AXIS_LINES },
	[NC_U] = { 'U', false, ANY_PLACE, AXIS_LINES },
	[NC_V] = { 'V', false, ANY_PLACE, AXIS_LINES },
	[NC_I] = { 'I', false, ANY_PLACE, "I " CENTRE_LINES },
	[NC_J] = { 'J', false, ANY_PLACE, "J " CENTRE_LINES },
	[NC_K] = { 'K', false, ANY_PLACE, "K " CENTRE_LINES },
	[NC_R] = { 'R', false, ANY_PLACE, "R " CENTRE_LINES },
	[NC_F] = { 'F', false, 0.0001, 1000000,
		   "a feed of 0.0001 to 1000000 per minute", "" },
	[NC_N] = { 'N', true, 0, 999999999, "0 to 999999999", "" },
	[NC_S] = { 'S', false, 0, 999999999, "0 to 999999999", "" },
	[NC_P] = { 'P', false, -99999999, 99999999, "-99999999 to 99999999",
		   "P goes with G5 G5.2 G6.2 G6.3, G4 or M98, and with G120" },
	[NC_L] = { 'L', true, 1, 9999, "1 to 9999 repeats; with G5.2 and G6.3 an order of 2 to 10",
		   "L goes with M98, G5.2, G6.3, G160 and G161" },
	[NC_O] = { 'O', true, 1, 9999, "a program number of 1 to 9999", "" },
	[NC_D] = { 'D', true, 0, 999, "a register of 0 to 999", "" },
	[NC_H] = { 'H', true, 0, 999, "a register of 0 to 999", "" },
	[NC_ANGLE] = { 'A', false, -90, 90, "-90 to 90 degrees",
		   "A goes with G51 or G52" },
	[NC_UI] = { 'I', false, ANY_PLACE, "I " CENTRE_LINES },
	[NC_UJ] = { 'J', false, ANY_PLACE, "J " CENTRE_LINES },
	[NC_Q] = { 'Q', false, ANY_PLACE,
		   "Q goes with G130 ... G135, G160 ... G162, G5 or G6.3" },
};

#define LETTER(upper, lower, class)	[upper] = (class), [lower] = (class)
#define SLOT(upper, lower, slot) \
	LETTER(upper, lower, NC_WORD + (slot))

const uint8_t nc_classes[256] = {
	SLOT('X', 'x', NC_X), SLOT('Y', 'y', NC_Y), SLOT('Z', 'z', NC_Z),
	SLOT('A', 'a', NC_A), SLOT('B', 'b', NC_B),
	SLOT('U', 'u', NC_U), SLOT('V', 'v', NC_V),
	SLOT('I', 'i', NC_I), SLOT('J', 'j', NC_J), SLOT('K', 'k', NC_K),
	SLOT('R', 'r', NC_R), SLOT('F', 'f', NC_F), SLOT('N', 'n', NC_N),
	SLOT('S', 's', NC_S), SLOT('P', 'p', NC_P), SLOT('L', 'l', NC_L),
	SLOT('O', 'o', NC_O), SLOT('Q', 'q', NC_Q),
	LETTER('C', 'c', NC_LETTER_C), LETTER('E', 'e', NC_LETTER_E),
	LETTER('G', 'g', NC_LETTER_G), LETTER('M', 'm', NC_LETTER_M),
	LETTER('T', 't', NC_LETTER_T),
	LETTER('D', 'd', NC_LETTER_D), LETTER('H', 'h', NC_LETTER_D),
	[' '] = NC_BLANK, ['\t'] = NC_BLANK,
	['\n'] = NC_EOL, ['\r'] = NC_EOL,
	['0'] = NC_NUMERIC, ['1'] = NC_NUMERIC, ['2'] = NC_NUMERIC,
	['3'] = NC_NUMERIC, ['4'] = NC_NUMERIC, ['5'] = NC_NUMERIC,
	['6'] = NC_NUMERIC, ['7'] = NC_NUMERIC, ['8'] = NC_NUMERIC,
	['9'] = NC_NUMERIC, ['.'] = NC_NUMERIC, ['+'] = NC_NUMERIC,
	['-'] = NC_NUMERIC,
	['('] = NC_OPEN, [';'] = NC_SEMICOLON, ['/'] = NC_SLASH,
	['%'] = NC_PERCENT, [':'] = NC_COLON,
};

#define P_	NC_BIT(NC_P)
#define XY_	(NC_BIT(NC_X) | NC_BIT(NC_Y))
#define IJ_	(NC_BIT(NC_I) | NC_BIT(NC_J))
#define SINK_	(NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z) | NC_BIT(NC_C))
#define ORBIT_	(SINK_ | NC_CENTRE | NC_BIT(NC_R) | NC_BIT(NC_Q) | P_)
#define XYZ_	(NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z))
#define LQ_	(NC_BIT(NC_L) | NC_BIT(NC_Q))
#define ARC_	(NC_AXES | NC_CENTRE | NC_BIT(NC_R))

#define ONE_SHOT(number, id, run, takes) \
	[number] = { NC_ONE_SHOT, NC_##id, takes },

static const struct nc_code g[NC_NG] = {
	NC_ONE_SHOTS(ONE_SHOT)
	[0]   = { NC_MOTION, 0, NC_AXES },
	[10]  = { NC_MOTION, 1, NC_AXES },
	[20]  = { NC_MOTION, 2, ARC_ },
	[30]  = { NC_MOTION, 3, ARC_ },
	[50]  = { NC_MOTION, NC_SPLINE, XY_ | IJ_ | P_ | NC_BIT(NC_Q) },
	[51]  = { NC_MOTION, NC_PARABOLA, XY_ | IJ_ },
	[52]  = { NC_MOTION, NC_NURBS_BLOCK, XY_ | P_ | NC_BIT(NC_L) },
	[53]  = { NC_MOTION, NC_NURBS_END, 0 },
	[62]  = { NC_MOTION, NC_NURBS,
		  NC_AXES | P_ | NC_BIT(NC_K) | NC_BIT(NC_R) },
	[63]  = { NC_MOTION, NC_BODY, XYZ_ | P_ | NC_BIT(NC_L) | NC_BIT(NC_Q) |
		  NC_CENTRE | NC_BIT(NC_R) },
	[170] = { NC_PLANE, 0, 0 },
	[180] = { NC_PLANE, 1, 0 },
	[190] = { NC_PLANE, 2, 0 },
	[200] = { NC_UNITS, true, 0 },
	[210] = { NC_UNITS, false, 0 },
	[382] = { NC_TOUCH, NC_TOUCH_FEED, XYZ_ },
	[400] = { NC_OFFSET, 0, 0 },
	[410] = { NC_OFFSET, 1, 0 },
	[420] = { NC_OFFSET, 2, 0 },
	[434] = { NC_TOOL_POINT, NC_TOOL_ANGLES, 0 },
	[435] = { NC_TOOL_POINT, NC_TOOL_VECTOR, 0 },
	[490] = { NC_TOOL_POINT, NC_TOOL_OFF, 0 },
	[500] = { NC_TAPER, 0, 0 },
	[510] = { NC_TAPER, 1, NC_BIT(NC_A) },
	[520] = { NC_TAPER, 2, NC_BIT(NC_A) },
	[530] = { NC_MACHINE, 0, 0 },
	[540] = { NC_WORK, 0, 0 },
	[550] = { NC_WORK, 1, 0 },
	[560] = { NC_WORK, 2, 0 },
	[570] = { NC_WORK, 3, 0 },
	[580] = { NC_WORK, 4, 0 },
	[590] = { NC_WORK, 5, 0 },
	[600] = { NC_TAPER_CORNER, INTERP_CORNER_CONICAL, 0 },
	[610] = { NC_TAPER_CORNER, INTERP_CORNER_CONSTANT, 0 },
	[620] = { NC_TAPER_CORNER, INTERP_CORNER_SHARP, 0 },
	[800] = { NC_TOUCH, NC_TOUCH_ONE, XYZ_ },
	[810] = { NC_TOUCH, NC_TOUCH_LIMIT, XYZ_ },
	[820] = { NC_TOUCH, NC_TOUCH_HALF, XYZ_ },
	[860] = { NC_CYCLE, INTERP_NORBITS, SINK_ | P_ },
	[900] = { NC_DISTANCE, false, 0 },
	[910] = { NC_DISTANCE, true, 0 },
	[901] = { NC_ARC_DISTANCE, false, 0 },
	[911] = { NC_ARC_DISTANCE, true, 0 },
	[940] = { NC_FEED_MODE, 0, 0 },
	[1300] = { NC_CYCLE, INTERP_ORBIT_CIRCLE, ORBIT_ },
	[1310] = { NC_CYCLE, INTERP_ORBIT_SQUARE, ORBIT_ },
	[1320] = { NC_CYCLE, INTERP_ORBIT_SPHERE, ORBIT_ },
	[1330] = { NC_CYCLE, INTERP_ORBIT_CONE, ORBIT_ },
	[1340] = { NC_CYCLE, INTERP_ORBIT_VECTOR, ORBIT_ | NC_BIT(NC_L) },
	[1350] = { NC_CYCLE, INTERP_ORBIT_EXPAND, ORBIT_ },
	[1400] = { NC_ESCAPE, INTERP_ESCAPE_PATH, 0 },
	[1410] = { NC_ESCAPE, INTERP_ESCAPE_CENTRE, 0 },
	[1420] = { NC_ESCAPE, INTERP_ESCAPE_AXIS, 0 },
	[1430] = { NC_ESCAPE, INTERP_ESCAPE_NORMAL, 0 },
	[1600] = { NC_TOUCH, NC_TOUCH_HOLE, NC_BIT(NC_R) | LQ_ },
	[1610] = { NC_TOUCH, NC_TOUCH_PILLAR, NC_CENTRE | LQ_ },
	[1620] = { NC_TOUCH, NC_TOUCH_CORNER, NC_BIT(NC_X) | NC_BIT(NC_Y) |
		   NC_BIT(NC_I) | NC_BIT(NC_J) | NC_BIT(NC_R) | NC_BIT(NC_Q) },
};

static const struct nc_code m[NC_NM] = {
	[0]  = { NC_STOP, NC_HALT, 0 },
	[1]  = { NC_STOP, NC_OPTIONAL_HALT, 0 },
	[2]  = { NC_STOP, NC_FINISH, 0 },
	[3]  = { NC_POWER, INTERP_AUX_POWER_POSITIVE, 0 },
	[4]  = { NC_POWER, INTERP_AUX_POWER_NEGATIVE, 0 },
	[5]  = { NC_POWER, INTERP_AUX_POWER_OFF, 0 },
	[30] = { NC_STOP, NC_FINISH, 0 },
	[98] = { NC_STOP, NC_CALL, P_ | NC_BIT(NC_L) },
	[99] = { NC_STOP, NC_RETURN, 0 },
};

static const struct nc_code t[NC_NM] = {
	[84] = { NC_PUMP, INTERP_AUX_PUMP_ON, 0 },
	[85] = { NC_PUMP, INTERP_AUX_PUMP_OFF, 0 },
};

const struct nc_dialect nc_generic = {
	.classes = nc_classes,
	.letter = {
		{ g, NC_NG, 10 },
		{ m, NC_NM, 1 },
		{ t, NC_NM, 1 },
	},
	.registers = true,
	.touches = true,
	.label = 'O',
};
/* clang-format on */
