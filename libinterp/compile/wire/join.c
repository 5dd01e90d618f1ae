/* SPDX-License-Identifier: Apache-2.0 */
/*
 * join.c - two neighbours of a contour on one plane, both at distance d
 *
 *	tangent		the one goes on where the other ends
 *	inner corner	both are cut off where they meet
 *	outer corner	up to a right angle both are prolonged until they meet,
 *			so that a tapered corner stays an edge; beyond it, or if
 *			they do not meet, an arc goes round the corner
 *
 * Where the distance changes over a motion (a lead-in, a lead-out), it runs
 * straight, square to its neighbours' ends.
 */
#include "wire/contour.h"

#include <math.h>

#define RIGHT_ANGLE	(3.14159265358979323846 / 2)

/* Turns up to this are the rounding of a right angle, of a tangent. */
#define ANGLE_SLACK	1e-6
#define TANGENT_MAX	0.1

/* A tangent point written to a pulse is this far off it at the most, as long
 * as the radius is no smaller than the offset: half of it either way. */
#define TANGENT_PULSES	1.5

struct vec contour_way(const struct contour_motion *m, int p, bool at_end)
{
	return curve_way(&m->c[m->point[p] ? !p : p], at_end);
}

double contour_turn(const struct contour_motion *a,
		    const struct contour_motion *b, int p)
{
	const struct vec v = contour_way(a, p, true);
	const struct vec w = contour_way(b, p, false);

	return atan2(v.x * w.y - v.y * w.x, v.x * w.x + v.y * w.y);
}

/* @at, moved to the left of the motion by its distance. */
static struct vec beside(const struct contour_motion *m, int p, bool at_end)
{
	const struct vec way = contour_way(m, p, at_end);
	const struct vec left = { -way.y, way.x };

	return vec_add(at_end ? m->c[p].to : m->c[p].from, m->d[p], left);
}

int contour_parallels(struct contour_motion *m)
{
	for (int p = 0; p < 2; p++) {
		if (m->point[p] || m->ramp[p])
			m->parallel[p] = curve_line(beside(m, p, false),
						    beside(m, p, true));
		else if (!curve_parallel(&m->c[p], m->d[p], &m->parallel[p]))
			return p;
	}
	return -1;
}

/* From the one's end to the other's start: round the corner, or straight
 * where a contour stands. */
static void fill_corner(const struct contour_motion *a, int p, bool round,
			struct contour_join *j)
{
	j->filled = curve_distance(j->end, j->start) > 1e-6;
	j->fill = round ? curve_arc(j->end, j->start, a->c[p].to, a->d[p] > 0) :
			  curve_line(j->end, j->start);
}

static bool join_corner(const struct contour_motion *a,
			const struct contour_motion *b, int p,
			struct contour_join *j)
{
	const double turn = contour_turn(a, b, p), d = a->d[p];
	const bool inner = turn * d > 0 &&
			   fabs(turn) < 2 * RIGHT_ANGLE - ANGLE_SLACK;
	const double reach = fabs(d) / cos(turn / 2);
	const bool mitre = !inner && fabs(turn) <= RIGHT_ANGLE + ANGLE_SLACK;
	struct vec at;
	bool met = (inner || mitre) &&
		   curve_meet(&a->parallel[p], &b->parallel[p], a->c[p].to,
			      &at);

	if (mitre && met)
		met = curve_distance(at, a->c[p].to) < 1.5 * reach;
	if (met)
		j->end = j->start = at;
	else if (!inner)
		fill_corner(a, p, true, j);
	return met || !inner;
}

bool contour_join(const struct contour_motion *a,
		  const struct contour_motion *b, int p, double pulse_mm,
		  struct contour_join *j)
{
	double turn;

	j->filled = false;
	j->end = j->start = a->parallel[p].to;
	if (!b || b->ramp[p])
		return true;
	j->start = b->parallel[p].from;
	if (a->ramp[p]) {
		j->end = j->start;
		return true;
	}
	turn = fabs(contour_turn(a, b, p));
	if (turn < TANGENT_MAX && turn * fabs(a->d[p]) < TANGENT_PULSES *
							 pulse_mm) {
		j->end = vec_add(j->end, 0.5, (struct vec) {
				 j->start.x - j->end.x,
				 j->start.y - j->end.y });
		j->start = j->end;
		return true;
	}
	if (a->point[p] || b->point[p]) {
		fill_corner(a, p, false, j);
		return true;
	}
	if (a->d[p] == 0)
		return true;
	return join_corner(a, b, p, j);
}
