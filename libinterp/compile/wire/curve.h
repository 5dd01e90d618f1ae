/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve.h - one line or arc of a contour in a plane, and its parallels
 *
 * Units: mm, radian.  Left and right as seen along the curve.
 * Threads: any thread; nothing here has state.
 */
#ifndef WIRE_CURVE_H
#define WIRE_CURVE_H

#include <math.h>
#include <stdbool.h>

/* Places this near are one; the finest pulse is 0.0001 mm. */
#define CURVE_SAME_MM	1e-7

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

/* hypot() guards against squares that overflow, at ten times the price; places
 * are far from that. */
static inline double curve_hypot(double x, double y)
{
	return sqrt(x * x + y * y);
}

static inline double curve_distance(struct vec a, struct vec b)
{
	return curve_hypot(b.x - a.x, b.y - a.y);
}

/* fmin() and fmax() of numbers that are no NAN. */
static inline double curve_min(double a, double b)
{
	return a < b ? a : b;
}

static inline double curve_max(double a, double b)
{
	return a > b ? a : b;
}

/** curve_line() - make a straight line. */
struct curve curve_line(struct vec from, struct vec to);

/** curve_arc() - make an arc that turns by nearly @sweep radians: by so much
 *  that it comes to @to. */
struct curve curve_arc(struct vec from, struct vec to, struct vec centre,
		       double sweep);

/** curve_round() - make an arc of less than a turn. */
struct curve curve_round(struct vec from, struct vec to, struct vec centre,
			 bool clockwise);

/** curve_evened() - an arc with both ends on its circle; a line as it is. */
struct curve curve_evened(const struct curve *c);

/** curve_uneven() - how far curve_evened() moves its centre along the chord. */
double curve_uneven(const struct curve *c);

/** curve_halved() - divide it into two halves.  All ends stay where they are;
 *  the radius of an arc changes in the middle. */
void curve_halved(const struct curve *c, struct curve ret[2]);

double curve_length(const struct curve *c);

/** curve_way() - its direction at the start or the end, as a unit vector. */
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

/** curve_meets() - where the two meet if they are prolonged: up to two places.
 *  Return: how many.  Curves that miss each other by up to 1.5 um meet too. */
int curve_meets(const struct curve *a, const struct curve *b,
		struct vec ret[2]);

/** curve_meet() - of these places, the one nearest to @near. Return: false if
 *  there is none. */
bool curve_meet(const struct curve *a, const struct curve *b, struct vec near,
		struct vec *ret);

/**
 * curve_trim() - let @c run from @from to @to, both on it or its prolongation.
 * Return: false if nothing is left of it, or it would run backwards.
 */
bool curve_trim(struct curve *c, struct vec from, struct vec to);

/** curve_reversed() - the same way back. */
struct curve curve_reversed(const struct curve *c);

/** curve_turn() - from the end of @a to the start of @b: radian, + to the
 *  left, in (-pi, pi]. */
double curve_turn(const struct curve *a, const struct curve *b);

/** curve_share() - the share of @c's length at which @at, a place on it,
 *  lies; below 0 and above 1 on its prolongation. */
double curve_share(const struct curve *c, struct vec at);

/* -- gap.c: two curves ----------------------------------------------------- */

struct curve_box {
	struct vec lo, hi;
};

/** curve_bounds() - the smallest box with sides along X and Y around @c. */
struct curve_box curve_bounds(const struct curve *c);

/* Where two curves cross: the shares of their lengths. */
struct curve_hit {
	double t[2];
	struct vec at;
};

/** curve_cross() - where @a and @b cross or touch.
 *  Return: how many places there are; curves that lie on each other have
 *  none. */
int curve_cross(const struct curve *a, const struct curve *b,
		struct curve_hit ret[2]);

/** curve_cross_near() - where they cross, nearest to @near.
 *  Return: false if they do not. */
bool curve_cross_near(const struct curve *a, const struct curve *b,
		      struct vec near, struct vec *ret);

/** curve_from() - the distance of @at from @c. */
double curve_from(const struct curve *c, struct vec at);

/** curve_gap() - the distance of the two; 0 if they cross. */
double curve_gap(const struct curve *a, const struct curve *b);

#endif /* WIRE_CURVE_H */
