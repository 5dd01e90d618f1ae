/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve.h - one line or arc of a contour in a plane, and its parallels
 *
 * Units: mm, radian.  Left and right as seen along the curve.
 * Threads: any thread; nothing here has state.
 */
#ifndef WIRE_CURVE_H
#define WIRE_CURVE_H

#include <stdbool.h>

struct vec {
	double x, y;
};

struct curve {
	bool arc;
	struct vec from, to;
	struct vec centre;		/* arcs only, as all below */
	double r;			/* > 0; 0: an arc shrunk to a point */
	double theta;			/* of `from`, seen from the centre */
	double sweep;			/* + counter-clockwise */
};

static inline struct vec vec_add(struct vec a, double k, struct vec b)
{
	return (struct vec) { a.x + k * b.x, a.y + k * b.y };
}

double curve_distance(struct vec a, struct vec b);

/** curve_line() - a straight one. */
struct curve curve_line(struct vec from, struct vec to);

/** curve_arc() - a circular one; equal ends make a full circle. */
struct curve curve_arc(struct vec from, struct vec to, struct vec centre,
		       bool clockwise);

double curve_length(const struct curve *c);

/** curve_way() - the unit vector along it, at its start or end. */
struct vec curve_way(const struct curve *c, bool at_end);

/** curve_at() - the place at share @t of its length. */
struct vec curve_at(const struct curve *c, double t);

/** curve_part() - from share @t0 to share @t1 of it. */
struct curve curve_part(const struct curve *c, double t0, double t1);

/**
 * curve_parallel() - @c moved @d mm to the left (right if below 0).
 * Return: false if an inside radius is smaller than @d.
 */
bool curve_parallel(const struct curve *c, double d, struct curve *ret);

/** curve_meet() - where the two, prolonged, meet nearest to @near. */
bool curve_meet(const struct curve *a, const struct curve *b, struct vec near,
		struct vec *ret);

/**
 * curve_trim() - let @c run from @from to @to, both on it or its prolongation.
 * Return: false if nothing is left of it, or it would run backwards.
 */
bool curve_trim(struct curve *c, struct vec from, struct vec to);

#endif /* WIRE_CURVE_H */
