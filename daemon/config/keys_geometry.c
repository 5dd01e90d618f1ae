/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys_geometry.c - keys of origins, a wire machine's guides, joints
 */
#include "keys_rows.h"

static const char *guides_word(int i)
{
	static const char *const words[INTERP_NGUIDES] = {
		[INTERP_GUIDES_OFF] = "off",
		[INTERP_GUIDES_ABSOLUTE] = "absolute",
		[INTERP_GUIDES_RELATIVE] = "relative",
	};

	return WORD_OF(words, i);
}

static const char *gouge_word(int i)
{
	static const char *const words[INTERP_NGOUGES] = {
		[INTERP_GOUGE_REFUSE] = "refuse",
		[INTERP_GOUGE_SKIP] = "skip",
	};

	return WORD_OF(words, i);
}

static const char *corner_word(int i)
{
	static const char *const words[INTERP_NCORNERS] = {
		[INTERP_CORNER_CONICAL] = "conical",
		[INTERP_CORNER_CONSTANT] = "constant",
		[INTERP_CORNER_SHARP] = "sharp",
	};

	return WORD_OF(words, i);
}

#define REGISTER(n) \
	NUMBER(WIRE, "offset_" #n "_mm", "mm", "0", -50, 50, AT(offset_mm[n]), \
	       "value of register D" #n ", H" #n " until a program sets it; " \
	       "0: not set")

#define ORIGIN(key, axis, unit) \
	NUMBER(WORK, key, unit, "0", -1e7, 1e7, \
	       EACH(work_offset_mm[0][INTERP_##axis], double[INTERP_NAXES]), \
	       "origin on " #axis)

/* clang-format off */
static const struct config_key row[] = {
	ORIGIN("x", X, "mm"),
	ORIGIN("y", Y, "mm"),
	ORIGIN("z", Z, "mm"),
	ORIGIN("a", A, "deg"),
	ORIGIN("b", B, "deg"),
	ORIGIN("c", C, "deg"),
	ORIGIN("u", U, "mm"),
	ORIGIN("v", V, "mm"),

	WORDS(WIRE, "guides", "off", AT(wire.guides), guides_word,
	      "what U V are: off, axes like any other; else the upper "
	       "guide, absolute or relative to X Y"),
	NUMBER(WIRE, "z_lower_mm", "mm", "-20", -2000, 2000,
	       AT(wire.z_lower_mm), "height of the lower guide"),
	NUMBER(WIRE, "z_upper_mm", "mm", "80", -2000, 2000, AT(wire.z_upper_mm),
	       "height of the upper guide"),
	NUMBER(WIRE, "z_program_mm", "mm", "0", -2000, 2000,
	       AT(wire.z_program_mm),
	       "height of the plane on which X Y are programmed"),
	NUMBER(WIRE, "z_second_mm", "mm", "40", -2000, 2000,
	       AT(wire.z_second_mm),
	       "height of the plane on which U V are programmed"),
	NUMBER(WIRE, "angle_max_deg", "deg", "30", 0, 80,
	       AT(wire.angle_max_deg),
	       "largest angle by which the wire may lean from upright"),
	NUMBER(WIRE, "corner_angle_deg", "deg", "180", 1, 180,
	       AT(wire.corner_angle_deg),
	       "a turn by at least this angle is a corner; 180: no corner "
	       "control"),
	NUMBER(WIRE, "corner_feed_percent", "%", "50", 1, 100,
	       AT(wire.corner_feed_percent),
	       "largest part of the feed in front of a corner"),
	NUMBER(WIRE, "corner_before_mm", "mm", "0.2", 0, 100,
	       AT(wire.corner_before_mm),
	       "distance in front of a corner at which the feed is lowered"),
	NUMBER(WIRE, "corner_dwell_s", "s", "0", 0, 3600,
	       AT(wire.corner_dwell_s),
	       "wait on a corner until the wire is straight again"),
	WORDS(WIRE, "taper_corner", "conical", AT(wire.corner), corner_word,
	      "form of corners on the second plane until G60 G61 G62"),
	WORDS(WIRE, "gouge", "refuse", AT(wire.gouge), gouge_word,
	      "a part of a contour that is too narrow for the wire: the "
	       "job is refused, or the part is skipped"),
	NUMBER(WIRE, "record_offset_mm", "mm", "0", -50, 50, AT(set.wire_mm),
	       "how far to the left of the contour of a 3B program the wire "
	       "runs; below 0: to the right"),
	NUMBER(WIRE, "record_taper_deg", "deg", "0", -80, 80,
	       AT(set.taper_deg),
	       "how far its top leans to the left along the contour of a 3B "
	       "or 4B program; below 0: to the right"),
	NUMBER(WIRE, "record_scale", "", "1", 0.001, 1000, AT(set.scale),
	       "by which a 3B or 4B program is larger"),
	NUMBER(WIRE, "record_turn_deg", "deg", "0", -360, 360,
	       AT(set.turn_deg),
	       "by which it is turned about its start, from X toward Y"),
	WORDS(WIRE, "record_mirror", "none", AT(set.mirror),
	      interp_mirror_name,
	      "which axis of it is mirrored before it is turned"),
	REGISTER(0), REGISTER(1), REGISTER(2), REGISTER(3), REGISTER(4),
	REGISTER(5), REGISTER(6), REGISTER(7), REGISTER(8), REGISTER(9),

	STRING(KINEMATICS, "chain", "none", kinematics.chain,
	       "joints from work to tool, as C(0 0 -120) A(0 15 -80) X Y Z"),
	NUMBER(KINEMATICS, "tip_x_mm", "mm", "0", -10000, 10000,
	       AT(kinematics.tip_mm[0]),
	       "tip of the tool with all axes at 0, X"),
	NUMBER(KINEMATICS, "tip_y_mm", "mm", "0", -10000, 10000,
	       AT(kinematics.tip_mm[1]), "the same, Y"),
	NUMBER(KINEMATICS, "tip_z_mm", "mm", "0", -10000, 10000,
	       AT(kinematics.tip_mm[2]), "the same, Z"),
	NUMBER(KINEMATICS, "tolerance_um", "um", "1", 0.001, 1000,
	       AT(kinematics.tolerance_um),
	       "under G43.4 the tip is no farther than this from its "
	       "programmed way"),
};
/* clang-format on */

const struct config_keys config_keys_geometry = { row, ROWS_IN(row) };
