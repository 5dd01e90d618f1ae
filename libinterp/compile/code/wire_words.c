/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire_words.c - the tables of the dialects of wire machines
 *
 * Each names what programs of that family are known to use, and no more: a
 * word that means something else there than here is not in its table, so it
 * is refused.
 */
#include "code/words.h"

#include "interp/program.h"

#define LETTER(upper, lower, class)	[upper] = (class), [lower] = (class)
#define SLOT(upper, lower, slot) \
	LETTER(upper, lower, NC_WORD + (slot))

/* clang-format off */
#define WIRE_CLASSES							\
	SLOT('X', 'x', NC_X), SLOT('Y', 'y', NC_Y),			\
	SLOT('I', 'i', NC_I), SLOT('J', 'j', NC_J),			\
	SLOT('F', 'f', NC_F), SLOT('N', 'n', NC_N),			\
	LETTER('G', 'g', NC_LETTER_G), LETTER('M', 'm', NC_LETTER_M),	\
	LETTER('U', 'u', NC_LETTER_U), LETTER('V', 'v', NC_LETTER_U),	\
	[' '] = NC_BLANK, ['\t'] = NC_BLANK,				\
	['\n'] = NC_EOL, ['\r'] = NC_EOL,				\
	['0'] = NC_NUMERIC, ['1'] = NC_NUMERIC, ['2'] = NC_NUMERIC,	\
	['3'] = NC_NUMERIC, ['4'] = NC_NUMERIC, ['5'] = NC_NUMERIC,	\
	['6'] = NC_NUMERIC, ['7'] = NC_NUMERIC, ['8'] = NC_NUMERIC,	\
	['9'] = NC_NUMERIC, ['.'] = NC_NUMERIC, ['+'] = NC_NUMERIC,	\
	['-'] = NC_NUMERIC,						\
	['('] = NC_OPEN, ['/'] = NC_SLASH, ['%'] = NC_PERCENT

/* The centre of the top's arc. */
#define TOP_CLASSES							\
	SLOT('K', 'k', NC_UI), SLOT('L', 'l', NC_UJ)

#define SUBPROGRAM_CLASSES						\
	SLOT('P', 'p', NC_P), SLOT('L', 'l', NC_L)

#define XY_	(NC_BIT(NC_X) | NC_BIT(NC_Y))
#define UV_	(NC_BIT(NC_U) | NC_BIT(NC_V))
#define LINE_	(XY_ | UV_)
#define ARC_	(LINE_ | NC_BIT(NC_I) | NC_BIT(NC_J) | \
		 NC_BIT(NC_UI) | NC_BIT(NC_UJ))

#define MOTION_G							\
	[0]   = { NC_MOTION, 0, LINE_ },				\
	[10]  = { NC_MOTION, 1, LINE_ },				\
	[20]  = { NC_MOTION, 2, ARC_ },					\
	[30]  = { NC_MOTION, 3, ARC_ },					\
	[900] = { NC_DISTANCE, false, 0 },				\
	[910] = { NC_DISTANCE, true, 0 },				\
	[920] = { NC_ONE_SHOT, NC_SET, XY_ }

#define OFFSET_G							\
	[400] = { NC_OFFSET, 0, 0 },					\
	[410] = { NC_OFFSET, 1, 0 },					\
	[420] = { NC_OFFSET, 2, 0 }

#define TAPER_G								\
	[500] = { NC_TAPER, 0, NC_BIT(NC_ANGLE) },			\
	[510] = { NC_TAPER, 1, NC_BIT(NC_ANGLE) },			\
	[520] = { NC_TAPER, 2, NC_BIT(NC_ANGLE) }

#define WORK_G								\
	[540] = { NC_WORK, 0, 0 }, [550] = { NC_WORK, 1, 0 },		\
	[560] = { NC_WORK, 2, 0 }, [570] = { NC_WORK, 3, 0 },		\
	[580] = { NC_WORK, 4, 0 }, [590] = { NC_WORK, 5, 0 }

#define STOP_M								\
	[0]  = { NC_STOP, NC_HALT, 0 },					\
	[1]  = { NC_STOP, NC_OPTIONAL_HALT, 0 },			\
	[2]  = { NC_STOP, NC_FINISH, 0 }

#define SUBPROGRAM_M							\
	[98] = { NC_STOP, NC_CALL, NC_BIT(NC_P) | NC_BIT(NC_L) },	\
	[99] = { NC_STOP, NC_RETURN, 0 }

/* -- robofil --------------------------------------------------------------- */

static const uint8_t robofil_classes[256] = {
	WIRE_CLASSES, TOP_CLASSES, [';'] = NC_SEMICOLON,
	LETTER('D', 'd', NC_LETTER_D),
};

static const struct nc_code robofil_g[NC_NG] = {
	MOTION_G, OFFSET_G,
	[380] = { NC_TRANSITION, 0, 0 },
	[390] = { NC_TRANSITION, 1, 0 },
	[600] = { NC_CORNER, 0, 0 },
	[610] = { NC_CORNER, 1, 0 },
};

static const struct nc_code robofil_m[NC_NM] = { STOP_M };

const struct nc_dialect nc_robofil = {
	.classes = robofil_classes,
	.letter = {
		{ robofil_g, NC_NG, 10 },
		{ robofil_m, NC_NM, 1 },
	},
	.label = 'O', .arc_places = true, .point = true, .m2_ends = true,
	.no_feed = true, .lean = true,
};

/* -- skd2 ------------------------------------------------------------------ */

static const uint8_t skd2_classes[256] = {
	WIRE_CLASSES, SUBPROGRAM_CLASSES, [';'] = NC_SEMICOLON,
	SLOT('A', 'a', NC_ANGLE),
	LETTER('E', 'e', NC_LETTER_E), LETTER('H', 'h', NC_LETTER_D),
};

static const struct nc_code skd2_g[NC_NG] = { MOTION_G, OFFSET_G, TAPER_G };
static const struct nc_code skd2_m[NC_NM] = { STOP_M, SUBPROGRAM_M };

const struct nc_dialect nc_skd2 = {
	.classes = skd2_classes,
	.letter = {
		{ skd2_g, NC_NG, 10 },
		{ skd2_m, NC_NM, 1 },
	},
	.label = 'N', .decimals = 3, .no_feed = true, .defines = true,
	.lean = true,
};

/* -- sodick ---------------------------------------------------------------- */

static const uint8_t sodick_classes[256] = {
	WIRE_CLASSES, SUBPROGRAM_CLASSES, [';'] = NC_BLOCK_END,
	[':'] = NC_COLON,
	SLOT('A', 'a', NC_ANGLE), LETTER('C', 'c', NC_LETTER_C),
	LETTER('T', 't', NC_LETTER_T),
	LETTER('D', 'd', NC_LETTER_D), LETTER('H', 'h', NC_LETTER_D),
};

static const struct nc_code sodick_g[NC_NG] = {
	MOTION_G, OFFSET_G, TAPER_G, WORK_G,
	[170] = { NC_PLANE, 0, 0 },
	[200] = { NC_UNITS, true, 0 },
	[210] = { NC_UNITS, false, 0 },
	[800] = { NC_TOUCH, NC_TOUCH_ONE, XY_ },
	[810] = { NC_TOUCH, NC_TOUCH_LIMIT, XY_ },
	[820] = { NC_TOUCH, NC_TOUCH_HALF, XY_ },
};

static const struct nc_code sodick_m[NC_NM] = { STOP_M, SUBPROGRAM_M };

static const struct nc_code sodick_t[NC_NM] = {
	[80] = { NC_SUPPLY, 0, 0 }, [81] = { NC_SUPPLY, 1, 0 },
	[82] = { NC_SUPPLY, 2, 0 }, [83] = { NC_SUPPLY, 3, 0 },
	[84] = { NC_PUMP, INTERP_AUX_PUMP_ON, 0 },
	[85] = { NC_PUMP, INTERP_AUX_PUMP_OFF, 0 },
	[86] = { NC_SUPPLY, 6, 0 }, [87] = { NC_SUPPLY, 7, 0 },
};

const struct nc_dialect nc_sodick = {
	.classes = sodick_classes,
	.letter = {
		{ sodick_g, NC_NG, 10 },
		{ sodick_m, NC_NM, 1 },
		{ sodick_t, NC_NM, 1 },
	},
	.label = 'N', .point = true, .no_feed = true, .defines = true,
	.touches = true, .lean = true,
};

/* -- chmer ----------------------------------------------------------------- */

static const uint8_t chmer_classes[256] = {
	WIRE_CLASSES, SUBPROGRAM_CLASSES, [';'] = NC_SEMICOLON,
	SLOT('A', 'a', NC_ANGLE), SLOT('O', 'o', NC_O), [':'] = NC_COLON,
	LETTER('S', 's', NC_LETTER_S), LETTER('H', 'h', NC_LETTER_D),
};

static const struct nc_code chmer_g[NC_NG] = {
	MOTION_G, OFFSET_G, TAPER_G, WORK_G,
	[200] = { NC_UNITS, true, 0 },
	[210] = { NC_UNITS, false, 0 },
};

static const struct nc_code chmer_m[NC_NM] = {
	STOP_M, SUBPROGRAM_M, [30] = { NC_STOP, NC_FINISH, 0 },
};

const struct nc_dialect nc_chmer = {
	.classes = chmer_classes,
	.letter = {
		{ chmer_g, NC_NG, 10 },
		{ chmer_m, NC_NM, 1 },
	},
	.label = 'O', .point = true, .no_feed = true, .defines = true,
	.lean = true,
};

/* -- fanuc ----------------------------------------------------------------- */

static const uint8_t fanuc_classes[256] = {
	WIRE_CLASSES, TOP_CLASSES, [';'] = NC_BLOCK_END,
	SLOT('T', 't', NC_ANGLE), SLOT('O', 'o', NC_O), SLOT('P', 'p', NC_P),
	LETTER('S', 's', NC_LETTER_S), LETTER('D', 'd', NC_LETTER_D),
};

static const struct nc_code fanuc_g[NC_NG] = {
	MOTION_G, OFFSET_G, TAPER_G, WORK_G,
	[200] = { NC_UNITS, true, 0 },
	[210] = { NC_UNITS, false, 0 },
};

static const struct nc_code fanuc_m[NC_NM] = {
	STOP_M, [30] = { NC_STOP, NC_FINISH, 0 },
	[98] = { NC_STOP, NC_CALL, NC_BIT(NC_P) },
	[99] = { NC_STOP, NC_RETURN, 0 },
};

const struct nc_dialect nc_fanuc = {
	.classes = fanuc_classes,
	.letter = {
		{ fanuc_g, NC_NG, 10 },
		{ fanuc_m, NC_NM, 1 },
	},
	.label = 'O', .point = true, .no_feed = true, .lean = true,
};

/* -- agie ------------------------------------------------------------------ */

static const uint8_t agie_classes[256] = {
	WIRE_CLASSES, [';'] = NC_BLOCK_END, LETTER('D', 'd', NC_LETTER_D),
};

static const struct nc_code agie_g[NC_NG] = {
	MOTION_G, OFFSET_G,
	[700] = { NC_UNITS, true, 0 },
	[710] = { NC_UNITS, false, 0 },
};

static const struct nc_code agie_m[NC_NM] = { STOP_M };

const struct nc_dialect nc_agie = {
	.classes = agie_classes,
	.letter = {
		{ agie_g, NC_NG, 10 },
		{ agie_m, NC_NM, 1 },
	},
	.label = 'O', .point = true, .no_feed = true, .lean = true,
};
/* clang-format on */
