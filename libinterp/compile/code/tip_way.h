/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_way.h - a way of the tool's tip, walked by straight lines of the axes
 */
#ifndef CODE_TIP_WAY_H
#define CODE_TIP_WAY_H

#include "code/reader.h"

/* Smooth from t = 0 to t = 1; a corner is the end of one and the start of
 * another. */
struct nc_tip_way {
	/* X Y Z of the tip and all other axes at @t. */
	void (*at)(const void *of, double t, double ret_mm[INTERP_NAXES]);
	const void *of;
	double turn_deg;		/* no rotary turns farther */
	/* What its ends lack to be where the program says, less than anybody
	 * sees; it fades along the way. */
	double off_mm[2][INTERP_NAXES];
};

/**
 * nc_tip_way() - the axes so that the tip goes along @w, which begins where
 * it is; r->word has the rest.  r->tool.here_mm is left to the caller.
 *
 * It is cut into pieces so short that the tip stays within the tolerance of
 * its place on the way, and rotaries and axes of no joint within the same
 * number of theirs.  Refused with the line of r->word: a pose that cannot be
 * reached, an axis beyond its travel, too many pieces.
 */
int nc_tip_way(struct nc_reader *r, const struct nc_tip_way *w);

#endif /* CODE_TIP_WAY_H */
