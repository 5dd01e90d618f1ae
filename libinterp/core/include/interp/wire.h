/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire.h - the wire of a wire-cut machine: its guides, its planes, its corners
 *
 * The wire runs straight from the lower guide to the upper one.  A program
 * speaks of two planes of the workpiece: X Y is the contour on the programmed
 * plane (the bottom), U V the contour on the second plane (the top).  The
 * machine moves the guides.  With heights z along the wire and
 *
 *	k(z) = (z - z_program) / (z_second - z_program)
 *
 * the wire at height z is, by similar triangles,
 *
 *	W(z) = P + k(z) * (Q - P)	P = (X, Y), Q = (U, V) of the program
 *
 *	axes X Y = W(z_lower)
 *	axes U V = W(z_upper)			guides absolute
 *	axes U V = W(z_upper) - W(z_lower)	guides relative: the upper slide
 *						rides on the lower one
 *
 * This is done in one place, wire/guide.c.  With guides off there are no
 * planes: U V are axes as any other, and a taper is refused.
 *
 * Units: mm, degrees.  Threads: plain data.
 */
#ifndef INTERP_WIRE_H
#define INTERP_WIRE_H

#include <stdbool.h>

enum interp_guides {
	INTERP_GUIDES_OFF,
	INTERP_GUIDES_ABSOLUTE,
	INTERP_GUIDES_RELATIVE,
	INTERP_NGUIDES
};

/* What is done with a part of a contour that is too narrow for the wire. */
enum interp_gouge { INTERP_GOUGE_REFUSE, INTERP_GOUGE_SKIP, INTERP_NGOUGES };

/* What becomes of corners and fillets on the second plane under a taper. */
enum interp_taper_corner {
	INTERP_CORNER_CONICAL,		/* fillets change their radius */
	INTERP_CORNER_CONSTANT,		/* fillets keep their radius */
	INTERP_CORNER_SHARP,		/* as conical, and sharp outer corners
					 * beyond a right angle stay sharp */
	INTERP_NCORNERS
};

struct interp_wire {
	int guides;			/* enum interp_guides */
	double z_lower_mm, z_upper_mm;	/* guides; lower below upper */
	double z_program_mm, z_second_mm;	/* planes; program below
						 * second */
	double angle_max_deg;		/* largest lean of the wire, < 90 */

	/* Corner control.  With corner_angle_deg of 180 or more there is
	 * none. */
	double corner_angle_deg;	/* a corner is where the contour turns
					 * by this or more */
	double corner_feed_percent;	/* of the programmed feed, before a
					 * corner */
	double corner_before_mm;	/* from this distance before it on */
	double corner_dwell_s;		/* wait on a corner; 0: no wait */

	int gouge;			/* enum interp_gouge */
	int corner;			/* enum interp_taper_corner, to start
					 * with */
};

#define INTERP_NOFFSETS	100		/* registers D0 ... D99, also called
					 * H */

#endif /* INTERP_WIRE_H */
