/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve.h - how a NURBS becomes a part of the program
 *
 * Private to libinterp/compile/path.
 */
#ifndef PATH_BUILD_CURVE_H
#define PATH_BUILD_CURVE_H

#include "interp/build.h"
#include "interp/nurbs_way.h"
#include "path/builder.h"
#include "pulse/pulse.h"
#include "speed/along.h"

/**
 * build_curve_store() - add those axes of a valid curve that move, and its
 * knots.
 *
 * @ret gets the curve as it is stored, with no axes if none moves.  @ret_moved
 * has a bit for each axis.  Return: 0 or -ENOMEM.
 */
int build_curve_store(struct interp_build *b,
		      const struct interp_build_curve *c,
		      struct interp_curve *ret, uint32_t *ret_moved);

/* What the looks at a piece have found; the largest of each. */
struct curve_seen {
	double counted;			/* mm of the axes that count, in one of
					 * the length */
	double d[INTERP_NAXES];		/* |x_s| of each column */
};

/* The feed that the axes allow at @u, and how far each axis goes in a mm there;
 * 0 at a cusp. */
struct curve_look {
	double u, mm_s;
	double heading[INTERP_NAXES];
};

/* A NURBS while it is cut into segments. */
struct curve_plan {
	struct interp_build *b;
	const struct interp_build_curve *c;
	struct interp_build_word word;
	struct interp_diag *diag;
	struct interp_curve curve;	/* as stored */
	const double *here_mm;		/* where the program stands */
	struct interp_axes along, beside;	/* of the columns that count,
						 * and of the others */
	double pulses_mm[INTERP_NAXES];	/* of each axis */
	double pulse_mm;		/* the finest */
	double slowest_mm_s;		/* bends make it no slower */
	double feed_mm_s;		/* as programmed: of axes that count */
	bool weighed;			/* those beside the path count more than
					 * on other curves */
	bool scouts;			/* only looks, adds no piece */
	double beside_mm_s;		/* the least that axes beside the path
					 * allow */
	uint32_t moved, turns;
	struct interp_curve_walk walk;
	size_t mark;
	double tried;			/* places so far */
	/* The piece in hand: */
	double from, least_mm_s, most_mm_s;
	struct curve_look last;
	struct curve_seen seen;
};

/* Of column @k. */
static inline const struct interp_axis_limits *
build_curve_axis(const struct curve_plan *p, uint32_t k)
{
	return &p->b->o.machine->axis[p->curve.axis[k]];
}

/** build_curve_refuse() - fill diag; -EINVAL. */
int build_curve_refuse(struct curve_plan *p, const char *found,
		       const char *wanted);

/** build_curve_blame() - set the line of diag to that of the curve at @u. */
void build_curve_blame(struct curve_plan *p, double u);

/** build_curve_line() - the line of the curve at @u; it never decreases. */
uint32_t build_curve_line(struct curve_plan *p, double u);

/**
 * build_curve_check() - is the curve valid?  Return: 0, or -EINVAL with diag
 * filled.
 */
int build_curve_check(struct curve_plan *p);

/**
 * build_curve_check_start() - does the curve, which is open, begin where the
 * program stands?  Return: 0, or -EINVAL with diag filled.
 */
int build_curve_check_start(struct curve_plan *p);

/**
 * build_curve_check_way() - for a stored curve: does the machine have its axes,
 * does it begin where the program stands, does it stay within the travel?
 *
 * Return: 0, or -EINVAL with diag filled.
 */
int build_curve_check_way(struct curve_plan *p);

/* build_curve_feed.c: */

/** build_curve_limit() - what the axes can do. */
void build_curve_limit(struct curve_plan *p);

/**
 * build_curve_look() - look at @u: find the feed that its axes allow.  The
 * piece in hand learns how its axes go there.
 */
struct curve_look build_curve_look(struct curve_plan *p, double u);

/** build_curve_look_between() - and where it is tightest between two looks. */
void build_curve_look_between(struct curve_plan *p, const struct curve_look *a,
			      const struct curve_look *b);

/** build_curve_rate() - the most pulses that one of its axes goes in a mm. */
double build_curve_rate(const struct curve_plan *p);

#endif /* PATH_BUILD_CURVE_H */
