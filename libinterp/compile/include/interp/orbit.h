/* SPDX-License-Identifier: Apache-2.0 */
/*
 * orbit.h - planetary cycles of a sinker, as a path
 *
 * The electrode does not turn.  It is moved round as a whole in the plane (a,
 * b), while it moves along the sink axis.  A place on a machine's path is one
 * number, so the orbit is not added to a motion while it runs: the orbit is the
 * path.  It is made of lines, arcs and helices; where none of them fits, of
 * short lines within 0.4 pulse of the curve.  A cycle ends exactly where it
 * began.
 *
 *	shape	radius at height h over the bottom, of H in all
 *	circle	R
 *	square	R to each side, corners sharp; the electrode does not turn
 *	sphere	R - B + sqrt(B^2 - (B - h)^2) for h < B, R above
 *	cone	R + h tan(angle); without an angle R (H - h) / H
 *	vector	out to R and back, in each direction in turn
 *	expand	at the bottom, from 0 to R by a step each turn
 *
 * With a step, the shapes circle, square, sphere and cone sink while they go
 * round: one step of depth in each turn, on a sphere one step along its
 * profile.  Without a step, circle, square and vector sink in the centre first.
 * The steps are made a little shorter so that all of them are equal.
 *
 * Ways out (struct interp_escape) are given where the path has already cut
 * them:
 *
 *	- back to the centre, from the line that leads out, and from a vector;
 *	- anywhere on a turn, if the turn before it lies around it at the same
 *	  depth, or one step above it: then first up by that step.  If the turn
 *	  before is smaller, the way is a narrow gate.  An electrode as wide as
 *	  the orbit meets at most step^2 / 8R of material there.  If that is
 *	  more than a pulse, no way out is given.
 *
 * The electrode must nowhere be thinner than the orbit is wide (2R), and must
 * have no undercut.  Otherwise a core would be left standing in the middle.
 *
 * Units: mm, degrees.  Threads: any thread; no state.  Never in the cycle.
 */
#ifndef INTERP_ORBIT_H
#define INTERP_ORBIT_H

#include "interp/build.h"

enum interp_orbit_shape {
	INTERP_ORBIT_CIRCLE,
	INTERP_ORBIT_SQUARE,
	INTERP_ORBIT_SPHERE,
	INTERP_ORBIT_CONE,
	INTERP_ORBIT_VECTOR,
	INTERP_ORBIT_EXPAND,
	INTERP_NORBITS
};

struct interp_orbit {
	enum interp_orbit_shape shape;
	enum interp_axis a, b, sink;	/* a toward b is counter-clockwise */
	double start_mm[INTERP_NAXES];	/* on the centre line */
	double end_mm;			/* of the sink axis: the bottom */
	double c_end_deg;		/* C there: turns as it sinks, without
					 * a step; start_mm's: stands */
	double radius_mm;		/* R, a pulse or more */
	double step_mm;			/* 0: sinks in the centre first */
	uint32_t turns;			/* at the bottom, in the end */
	double angle_deg;		/* of a cone's wall, + is wider above;
					 * of the first vector */
	bool angle_given;
	uint32_t directions;		/* of vectors, evenly spread */
	double bottom_mm;		/* B, up to R */
	enum interp_escape_mode escape;
	double top_mm;			/* it came straight down from there, or
					 * the start */
};

/* Where the path goes.  If one of these returns anything but 0, the cycle
 * ends. */
struct interp_orbit_to {
	void *arg;
	int (*line)(void *arg, const double end_mm[INTERP_NAXES], bool rapid);
	int (*arc)(void *arg, const double end_mm[INTERP_NAXES],
		   const struct interp_build_arc *arc);
	int (*escape)(void *arg, const struct interp_escape *e);
};

/**
 * interp_orbit_radius_mm() - the radius of the orbit at @h_mm above the bottom.
 *
 * It is NAN where the shape has no radius, for example above the tip of a cone.
 */
double interp_orbit_radius_mm(const struct interp_orbit *o, double h_mm);

/**
 * interp_orbit_walk() - make the whole cycle, from start_mm back to start_mm.
 *
 * Return: 0, or the first number that @to returned and that is not 0.
 */
int interp_orbit_walk(const struct interp_orbit *o,
		      const struct interp_machine *m,
		      const struct interp_orbit_to *to);

#endif /* INTERP_ORBIT_H */
