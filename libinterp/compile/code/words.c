/* SPDX-License-Identifier: Apache-2.0 */
/*
 * words.c - words with values, and the bytes that mean the same in all dialects
 */
#include "code/words.h"

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
		   "P goes with G5 G5.2 G6.2 G6.3, G4, M98 or M99, and with G120" },
	[NC_L] = { 'L', true, 1, 9999, "1 to 9999 repeats; with G5.2 and G6.3 an order of 2 to 10",
		   "L goes with M98, G5.2, G6.3, G160 and G161" },
	[NC_O] = { 'O', true, 0, 99999999,
		   "a program number of 0 to 99999999; 1 to 9999 for one that "
		   "is called", "" },
	[NC_D] = { 'D', true, 0, 999, "a register of 0 to 999", "" },
	[NC_H] = { 'H', true, 0, 999, "a register of 0 to 999", "" },
	[NC_ANGLE] = { 'A', false, -90, 90, "-90 to 90 degrees",
		   "the angle of a taper goes with G51 or G52" },
	[NC_UI] = { 'I', false, ANY_PLACE, "I " CENTRE_LINES },
	[NC_UJ] = { 'J', false, ANY_PLACE, "J " CENTRE_LINES },
	[NC_Q] = { 'Q', false, ANY_PLACE,
		   "Q goes with G130 ... G135, G160 ... G162, G5 or G6.3" },
	[NC_NAME] = { '<', false, ANY_PLACE,
		      "<NAME> begins a line, or goes with M98 and G65" },
	[NC_COMMA_R] = { 'R', false, ANY_PLACE,
			 ",R rounds the corner behind G1 G2 G3 with X or Y" },
	[NC_COMMA_C] = { 'C', false, ANY_PLACE,
			 ",C cuts the corner behind G1 with X or Y" },
	[NC_SPARE] = { '?', false, ANY_PLACE, "only with a word that this "
		       "dialect ignores" },
};

const uint8_t nc_classes[256] = {
	[' '] = NC_BLANK, ['\t'] = NC_BLANK,
	['\n'] = NC_EOL, ['\r'] = NC_EOL,
	['0'] = NC_NUMERIC, ['1'] = NC_NUMERIC, ['2'] = NC_NUMERIC,
	['3'] = NC_NUMERIC, ['4'] = NC_NUMERIC, ['5'] = NC_NUMERIC,
	['6'] = NC_NUMERIC, ['7'] = NC_NUMERIC, ['8'] = NC_NUMERIC,
	['9'] = NC_NUMERIC, ['.'] = NC_NUMERIC, ['+'] = NC_NUMERIC,
	['-'] = NC_NUMERIC,
	['('] = NC_OPEN, ['/'] = NC_SLASH, ['%'] = NC_PERCENT,
};
/* clang-format on */
