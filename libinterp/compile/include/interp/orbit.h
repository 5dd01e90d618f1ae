/* SPDX-License-Identifier: Apache-2.0 */
/*
 * orbit.h - planetary cycles of a sinker, as a path
 *
 * The electrode does not turn: all of it is moved round in the plane (a, b)
 * beside its way along the sink axis.  A place on a machine's path is one
 * number, so the orbit is not superimposed while it runs; it is the path:
 * lines, arcs and helices, and polylines within 0.4 pulse of the curve where
 * there is no such segment.  A cycle ends where it began, to the pulse.
 *
 *	shape	radius at height h over the bottom, of H in all
 *	circle	R
 *	square	R to each side, corners sharp; the electrode does not turn
 *	sphere	R - B + sqrt(B^2 - (B - h)^2) for h < B, R above
 *	cone	R + h tan(angle); without an angle R (H - h) / H
 *	vector	out to R and back, in each direction in turn
 *	expand	at the bottom, from 0 to R by a step each turn
 *
 * With a step, circle, square, sphere and cone sink as they go round: a step
 * of depth each turn, on a sphere a step along its profile.  Circle, square
 * and vector without one sink in the centre first.  Steps are shortened to be
 * equal.
 *
 * Ways out (struct interp_escape) are given where the path has cut them:
 *
 *	- back to the centre of the line that leads out, and of a vector;
 *	- anywhere on a turn whose last turn lies round it at the same depth, or
 *	  a step above it: then up by that step first.  A last turn that is
 *	  smaller leaves a gate, through which an electrode as wide as the orbit
 *	  meets no more than step^2 / 8R: if that is over a pulse, none.
 *
 * It takes an electrode that is nowhere thinner than the orbit is wide, 2R,
 * and has no undercut: without a core left standing in the middle.
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

/* Where it goes.  Each returns 0 or what ends the cycle. */
struct interp_orbit_to {
	void *arg;
	int (*line)(void *arg, const double end_mm[INTERP_NAXES], bool rapid);
	int (*arc)(void *arg, const double end_mm[INTERP_NAXES],
		   const struct interp_build_arc *arc);
	int (*escape)(void *arg, const struct interp_escape *e);
};

/**
 * interp_orbit_radius_mm() - of the orbit at @h_mm over the bottom.
 *
 * NAN where the shape has none, as above a cone's tip.
 */
double interp_orbit_radius_mm(const struct interp_orbit *o, double h_mm);

/**
 * interp_orbit_walk() - the whole cycle, from start_mm back to it.
 *
 * Return: 0, or the first return of @to that is not.
 */
int interp_orbit_walk(const struct interp_orbit *o,
		      const struct interp_machine *m,
		      const struct interp_orbit_to *to);

#endif /* INTERP_ORBIT_H */
