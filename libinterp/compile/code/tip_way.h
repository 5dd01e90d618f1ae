/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_way.h - a way of the tool's tip, walked by straight lines of the axes
 */
#ifndef CODE_TIP_WAY_H
#define CODE_TIP_WAY_H

#include "code/reader.h"

/* A way is smooth from t = 0 to t = 1.  At a corner one way ends and another
 * begins. */
struct nc_tip_way {
	/* X Y Z of the tip and all other axes at @t. */
	void (*at)(const void *of, double t, double ret_mm[INTERP_NAXES]);
	const void *of;
	double turn_deg;		/* no rotary turns farther */
	bool in_place;			/* the tip goes on by a quarter of the
					 * tolerance at most: F belongs to the
					 * turn */
	/* The difference between its ends and the places that the program
	 * names, too small to be seen.  It is spread along the way. */
	double off_mm[2][INTERP_NAXES];
};

/**
 * nc_tip_way() - move the axes so that the tip goes along @w, which begins
 * where the tip is; r->word has the rest.  The caller sets r->tool.here_mm.
 *
 * The way is cut into pieces so short that the tip stays within the tolerance
 * of its place on the way.  Rotary axes, and axes that belong to no joint, stay
 * within the same number in their own unit.  Refused with the line of r->word:
 * a pose that cannot be reached, an axis beyond its travel, too many pieces.
 */
int nc_tip_way(struct nc_reader *r, const struct nc_tip_way *w);

#endif /* CODE_TIP_WAY_H */
