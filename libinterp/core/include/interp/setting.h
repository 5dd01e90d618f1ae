/* SPDX-License-Identifier: Apache-2.0 */
/*
 * setting.h - what is set at the machine for a contour whose program has no
 * words for it
 *
 * A 3B program says the way of a wire that stands upright and cuts nothing to
 * its sides.  The machine adds the rest: how far the wire runs beside that way,
 * how far it leans, and the figure's scale, turn and mirror image about the
 * place where the program starts.  Its first motion leads to the contour, and
 * its last one away from it.
 *
 * A job may bring settings of its own, as a text of words: "taper=3 turn=90".
 * They go before those of the machine.  For NC code, which has words for the
 * rest, it may set the taper and the heights of the planes.
 */
#ifndef INTERP_SETTING_H
#define INTERP_SETTING_H

enum interp_mirror {
	INTERP_MIRROR_NONE,
	INTERP_MIRROR_X,		/* X changes its sign */
	INTERP_MIRROR_Y,
	INTERP_MIRROR_EXCHANGE,		/* X for Y */
	INTERP_NMIRRORS
};

/* Zeros set nothing. */
struct interp_setting {
	double wire_mm;			/* beside the contour; + to the left */
	double taper_deg;		/* the top leans; + to the left */
	double scale;			/* 0: 1 */
	double turn_deg;		/* + from X toward Y, of the image */
	int mirror;			/* enum interp_mirror */
};

/* Words that a job may bring. */
enum interp_set {
	INTERP_SET_TAPER,
	INTERP_SET_WIRE,
	INTERP_SET_SCALE,
	INTERP_SET_TURN,
	INTERP_SET_MIRROR,
	INTERP_SET_PLANE,		/* z_program_mm of interp_wire */
	INTERP_SET_SECOND,		/* z_second_mm */
	INTERP_NSETS
};

#define INTERP_SETTING_MAX	192	/* bytes of such a text, with its NUL */

/** interp_set_name() - "taper", "wire-offset" ...; NULL past the last. */
const char *interp_set_name(int i);

/** interp_mirror_name() - "none", "x" ...; NULL past the last. */
const char *interp_mirror_name(int i);

#endif /* INTERP_SETTING_H */
