/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mesh.h - a body as triangles: read, mended, judged
 *
 * Corners run counter-clockwise seen from outside.  A message names a triangle
 * by its number in the mended mesh, from 1, and by its corners.
 *
 * Units: mm.  Threads: a mesh is not changed once it is loaded; any thread may
 * read it.
 */
#ifndef PLAN_MESH_H
#define PLAN_MESH_H

#include <stdbool.h>
#include <stdint.h>

#define MESH_TRIS_MAX	20000000u

struct mesh {
	const char *name;		/* lent: the file's */
	uint32_t nverts, ntris;
	double (*vert)[3];
	uint32_t (*tri)[3];
	double min[3], max[3];
};

/* What was found in a file, and what was done about it. */
struct mesh_findings {
	uint32_t in_file;		/* triangles in the file */
	uint32_t doubled;		/* triangles that were there twice;
					 * removed */
	uint32_t degenerate;		/* triangles without area; removed */
	uint32_t joined;		/* corners that were moved onto
					 * others */
	double joined_mm;		/* the most that a corner was moved */
	uint32_t turned;		/* triangles that ran the other way than
					 * the first one of their shell */
	uint32_t shells;
	uint32_t inverted;		/* shells that were inside out */
	uint32_t inverted_tri;		/* the first triangle of the first */
	uint32_t open;			/* edges with one triangle only */
	uint32_t open_tri;		/* a triangle with one of them */
	uint32_t crossings;		/* pairs of triangles that cross */
	uint32_t cross_tri[2];		/* such a pair */
	double volume_mm3;
	double grain_mm;		/* the step of a float at the corner
					 * that is farthest from the origin */
	double chord_mm;		/* how far the true surface bulges out
					 * of the mesh, guessed from the angles
					 * between triangles */
};

struct mesh_load {
	const char *path;
	double unit_mm;			/* of the file's numbers */
	double shift_mm[3];		/* added to every corner */
};

/**
 * mesh_load() - read an STL file, binary or text, and mend what can be mended.
 *
 * Return: 0; else a sysexits code, and the reason is on stderr.
 */
int mesh_load(struct mesh *m, const struct mesh_load *from,
	      struct mesh_findings *f);

/** mesh_free() - free what mesh_load() allocated; @m may be all zeros. */
void mesh_free(struct mesh *m);

/** mesh_corner() - corner @k of triangle @i. */
static inline const double *mesh_corner(const struct mesh *m, uint32_t i,
					uint32_t k)
{
	return m->vert[m->tri[i][k]];
}

/** mesh_bounds() - fill min and max. */
void mesh_bounds(struct mesh *m);

/** mesh_size_mm() - the longest side of its box. */
double mesh_size_mm(const struct mesh *m);

/** mesh_volume_of() - what triangle @i adds to the volume of its shell.  The
 *  sum is less than 0 if the shell is inside out. */
double mesh_volume_of(const struct mesh *m, uint32_t i);

/** mesh_angle_of() - the solid angle of triangle @i as seen from @p.  It is
 *  more than 0 if @p is on the inner side. */
double mesh_angle_of(const struct mesh *m, uint32_t i, const double p[3]);

/** mesh_winding() - how often @m goes round @p: 0 outside, 1 inside. */
double mesh_winding(const struct mesh *m, const double p[3]);

/**
 * mesh_shells() - one vertex of each shell.
 *
 * @ret: allocated, for free().  Return: how many, or 0 if out of memory.
 */
uint32_t mesh_shells(const struct mesh *m, uint32_t **ret);

/**
 * mesh_turn_shells() - turn the shells that are inside out, and fill in what @f
 * says about shells and the volume.
 *
 * Return: 0 or -ENOMEM.
 */
int mesh_turn_shells(struct mesh *m, struct mesh_findings *f);

struct tree;

/**
 * mesh_crossings() - pairs of triangles that cross and share no corner.
 *
 * Return: how many, counted up to 1000; @ret is the first.
 */
uint32_t mesh_crossings(const struct tree *t, uint32_t ret[2]);

#endif /* PLAN_MESH_H */
