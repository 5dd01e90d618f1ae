/* SPDX-License-Identifier: Apache-2.0 */
/*
 * surface.h - NURBS surfaces: points, normals, iso-curves, offset points
 *
 *	S(u, v) = sum N_i(u) N_j(v) w_ij P_ij / sum N_i(u) N_j(v) w_ij
 *
 * Units: mm in X Y Z; u and v have none.
 * Threads: RT-safe unless marked; nothing is allocated.
 * Source: Piegl and Tiller, The NURBS Book, eq. 4.11 and 4.20.
 */
#ifndef INTERP_SURFACE_H
#define INTERP_SURFACE_H

#include "tried/nurbs_edit.h"

struct interp_surface {
	uint32_t degree[2];		/* along u, along v */
	uint32_t npoints[2];
	const double *knots[2];		/* npoints + degree + 1 each */
	const double *points;		/* row i of u, column j of v: four
					 * numbers w x, w y, w z, w at
					 * 4 * (i * npoints[1] + j) */
};

/** interp_surface_check() - as interp_nurbs_check(), in either direction. */
enum interp_nurbs_flaw interp_surface_check(const struct interp_surface *s);

struct interp_surface_point {
	double at_mm[3], du[3], dv[3];
};

/** interp_surface_at() - the point and its first derivatives. */
void interp_surface_at(const struct interp_surface *s, double u, double v,
		       struct interp_surface_point *ret);

/**
 * interp_surface_offset() - the point @d_mm along the normal dS/du x dS/dv.
 * Return: 0, or -EDOM where the surface has no normal.
 */
int interp_surface_offset(const struct interp_surface *s, double u, double v,
			  double d_mm, double ret_mm[3]);

/**
 * interp_surface_iso() - the curve in the surface where u (@along 1) or v
 * (@along 0) is @fixed; @along says which parameter goes on.  Startup only.
 * Return: 0, or -ENOSPC.
 */
int interp_surface_iso(const struct interp_surface *s, int along, double fixed,
		       struct interp_nurbs_own *ret);

#endif /* INTERP_SURFACE_H */
