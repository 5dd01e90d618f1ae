/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shape.h - the curve that a run of short lines stands for
 *
 * The ends of lines are rounded, so a rounding hides how the path bends there.
 * The shape is the smoothest curve that keeps within a box around each point.
 * It gives the derivatives of the path alone: the machine goes along the lines.
 *
 * It is a spline of degree 5 over intervals that are halved until each point is
 * in its box, found by least squares.  So a wave of 20 mm has some 27 intervals
 * whether it is written in lines of 5 or of 200 um.
 *
 * Units: mm; rotary axes degrees.  Private to libinterp/compile/speed.
 */
#ifndef SPEED_SHAPE_H
#define SPEED_SHAPE_H

#include <stddef.h>
#include <stdint.h>

/* The points of a run, @columns numbers for each in @x and @box. */
struct shape_points {
	size_t n;			/* 2 or more */
	uint32_t columns;
	const double *s_mm;		/* the way along the path; rising */
	const double *x;
	const double *box;		/* how far the shape may be off */
	const double *weight;
};

struct shape {
	uint32_t columns;
	size_t n;			/* intervals */
	double *knot_mm;		/* n + 11 of them */
	double *c;			/* 6 for each column of an interval: its
					 * powers there */
};

/**
 * shape_fit() - find the shape of @p.
 *
 * @ret_corner: a point beside which the path turns more than a shape can, or
 *		@p->n: there is none, and @ret is the shape.
 * Return: 0, -ENOMEM.
 */
int shape_fit(const struct shape_points *p, struct shape *ret,
	      size_t *ret_corner);

/** shape_way() - r', r'' and r''' of each column at @s_mm, as speed/along.h
 *  takes them. */
void shape_way(const struct shape *f, double s_mm, double *ret);

void shape_free(struct shape *f);

#endif /* SPEED_SHAPE_H */
