/* SPDX-License-Identifier: Apache-2.0 */
/*
 * errormap.h - geometric errors and thermal growth of a machine, and how they
 * are corrected
 *
 * A machine that is sent to x really stands at x + error(x).  The error is the
 * sum of
 *
 *	rows		a table along an axis of the error of the same axis
 *			(pitch) or of another (straightness), straight between
 *			its points, which may be any distance apart, and
 *			constant beyond its ends
 *	squareness	an axis leans toward another by an angle
 *	growth		an axis grows from a fixed point with its temperature
 *
 * The drives cannot see these errors, because their encoders have the same
 * errors.  The correction depends on the place alone (and on temperatures,
 * which change slowly).  So a walk back undoes exactly what the walk there did.
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

/* No machine has a steeper error, and a steeper one could not be corrected. */
#define INTERP_ERRORMAP_SLOPE_MAX	0.01

/* After so many rounds at most 1e-8 of an error of that slope is left. */
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

/** interp_errormap_is_empty() - is there no error, at any temperature? */
bool interp_errormap_is_empty(const struct interp_errormap *m);

/**
 * interp_errormap_check() - Return: 0, or -EINVAL if a number is impossible.
 */
int interp_errormap_check(const struct interp_errormap *m);

/**
 * interp_errormap_error() - the error of a machine that is sent to @place_mm.
 */
void interp_errormap_error(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm);

/**
 * interp_errormap_apply() - what must be added to @place_mm so that the machine
 * really stands there.
 */
void interp_errormap_apply(const struct interp_errormap *m,
			   const double *place_mm, double *ret_mm);

#endif /* INTERP_ERRORMAP_H */
