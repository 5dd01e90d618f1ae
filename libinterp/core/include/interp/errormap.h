/* SPDX-License-Identifier: Apache-2.0 */
/*
 * errormap.h - geometric errors and thermal growth of a machine, and their cure
 *
 * Told to stand at x, the machine truly stands at x + error(x).  The error is
 * the sum of
 *
 *	rows		a table along an axis of the error of the same axis
 *			(pitch) or of another (straightness), straight between
 *			its points, which may be any distance apart, and
 *			constant beyond its ends
 *	squareness	an axis leans toward another by an angle
 *	growth		an axis grows from a fixed point with its temperature
 *
 * Servo compensation sees none of it: the encoders are inside.  The correction
 * is a function of the place alone (and of temperatures, which change slowly),
 * so walking back undoes exactly what walking there did.
 *
 * Units: mm; rotary axes degrees.
 * Threads: interp_errormap_apply() and _error() are RT-safe: a binary search in
 * each row, and at most INTERP_ERRORMAP_ROUNDS looks from there.
 */
#ifndef INTERP_ERRORMAP_H
#define INTERP_ERRORMAP_H

#include "interp/axis.h"

#include <stdbool.h>
#include <stdint.h>

#define INTERP_ERRORMAP_ROWS	16
#define INTERP_ERRORMAP_POINTS	128
#define INTERP_ERRORMAP_LEANS	8

/* Steeper than that is no machine, and could not be undone. */
#define INTERP_ERRORMAP_SLOPE_MAX	0.01

/* What is left after so many is at most 1e-8 of an error that steep. */
#define INTERP_ERRORMAP_ROUNDS	4

struct interp_errormap_row {
	uint8_t along, across;		/* axes; equal: pitch */
	uint16_t n;			/* points, 2 and more */
	double at_mm[INTERP_ERRORMAP_POINTS];	/* rising */
	double error_mm[INTERP_ERRORMAP_POINTS];
};

struct interp_errormap_lean {
	uint8_t along, across;		/* axes; not equal */
	double rad;			/* error of across per mm along */
};

struct interp_errormap_growth {
	double per_k;			/* 11.5e-6 for steel */
	double fixed_mm;		/* does not move */
	double over_k;			/* temperature over that of the maps */
};

struct interp_errormap {
	struct interp_errormap_row row[INTERP_ERRORMAP_ROWS];
	int nrows;
	struct interp_errormap_lean lean[INTERP_ERRORMAP_LEANS];
	int nleans;
	struct interp_errormap_growth growth[INTERP_NAXES];
};

/** interp_errormap_is_empty() - no error anywhere, at any temperature. */
bool interp_errormap_is_empty(const struct interp_errormap *m);

/** interp_errormap_check() - Return: 0, or -EINVAL if it is no such map. */
int interp_errormap_check(const struct interp_errormap *m);

/** interp_errormap_error() - of a machine told to stand at @place_mm. */
void interp_errormap_error(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm);

/**
 * interp_errormap_apply() - what to add to @place_mm so that the machine truly
 * stands there.
 */
void interp_errormap_apply(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm);

#endif /* INTERP_ERRORMAP_H */
