/* SPDX-License-Identifier: Apache-2.0 */
/* profile.c - the quickest speed along a way from stand to stand */
#include "speed/profile.h"

#include "speed/caps.h"

#include "interp/smaller.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Places lie so near to each other beside a stand and beside a corner, and ever
 * farther apart away from it. */
#define STAND_MM	2e-5
#define CORNER_MM	1e-4
#define FARTHER		1.2
#define APART_MM	0.05
#define APART_LINE_MM	0.1

/* An interval that takes longer is divided where the acceleration changes. */
#define LONG_S		1e-3
#define SHORT_S		2e-4		/* no shorter one is divided */
#define MUCH_PARTS	3
#define ROUNDS		2

/* More than this of an axis: the ceiling there is lowered, some times. */
#define MOST_A		1.015
#define MOST_J		1.03
#define LOWER		0.8
#define LOWERINGS	3

/* -- Places ---------------------------------------------------------------- */

static double *way_at(const struct profile *p, size_t i)
{
	return p->way + i * p->columns * INTERP_AXES_WAY;
}

static bool is_corner(const struct profile *p, size_t i)
{
	return (i > 0 && p->s_mm[i] == p->s_mm[i - 1]) ||
	       (i + 1 < p->n && p->s_mm[i] == p->s_mm[i + 1]);
}

static int grow(struct profile *p)
{
	const size_t room = p->room ? 2 * p->room : 256;
	const size_t way = p->columns * INTERP_AXES_WAY;
	const struct {
		void *at;
		size_t bytes;
	} all[] = {
		{ &p->s_mm, sizeof(double) }, { &p->v_mm_s, sizeof(double) },
		{ &p->most_mm_s, sizeof(double) },
		{ &p->section, sizeof(uint32_t) },
		{ &p->way, way * sizeof(double) },
	};

	for (size_t k = 0; k < sizeof(all) / sizeof(all[0]); k++) {
		size_t has = p->room;

		if (grow_to(all[k].at, &has, room, all[k].bytes) < 0)
			return -ENOMEM;
	}
	p->room = room;
	return 0;
}

static int add(struct profile *p, const struct interp_axes *x,
	       const struct profile_section *sections, uint32_t section,
	       double s_mm)
{
	const struct profile_section *k = &sections[section];

	if (p->n == p->room && grow(p) < 0)
		return -ENOMEM;
	p->s_mm[p->n] = s_mm;
	p->section[p->n] = section;
	k->way(k->of, s_mm, way_at(p, p->n));
	p->most_mm_s[p->n] = smaller(interp_axes_mm_s(x, way_at(p, p->n)),
				     k->most_mm_s);
	p->n++;
	return 0;
}

static bool is_straight(const struct profile *p, const double *way)
{
	for (uint32_t k = 0; k < p->columns; k++, way += INTERP_AXES_WAY)
		if (way[1] != 0 || way[2] != 0)
			return false;
	return true;
}

/* Onward: the nearer to an end, the less. */
static double step_mm(const struct profile *p, double gone_mm, double left_mm,
		      const double least_mm[2])
{
	const double apart = is_straight(p, way_at(p, p->n - 1)) ?
			     APART_LINE_MM : APART_MM;
	const double a = larger((FARTHER - 1) * gone_mm, least_mm[0]);
	const double b = larger((FARTHER - 1) / FARTHER * left_mm,
				least_mm[1]);

	return smaller(apart, smaller(a, b));
}

static int add_section(struct profile *p, const struct interp_axes *x,
		       const struct profile_section *sections, uint32_t k,
		       uint32_t n)
{
	const double from = sections[k].from_mm, to = sections[k].to_mm;
	const double least_mm[] = { k == 0 ? STAND_MM : CORNER_MM,
				    k + 1 == n ? STAND_MM : CORNER_MM };
	int err = add(p, x, sections, k, from);

	for (double s = from; err == 0;) {
		const double step = step_mm(p, s - from, to - s, least_mm);

		if (s + 1.5 * step >= to)
			break;
		s += step;
		err = add(p, x, sections, k, s);
	}
	return err < 0 ? err : add(p, x, sections, k, to);
}

static void pass_corner(struct profile *p, size_t i, double most_mm_s)
{
	const double v = smaller(most_mm_s, smaller(p->most_mm_s[i],
						    p->most_mm_s[i + 1]));

	p->most_mm_s[i] = p->most_mm_s[i + 1] = v;
}

static int add_all(struct profile *p, const struct interp_axes *x,
		   const struct profile_section *sections, size_t n,
		   const double *corner_mm_s)
{
	int err = 0;

	for (size_t k = 0; err == 0 && k < n; k++) {
		const size_t at = p->n;

		err = add_section(p, x, sections, (uint32_t)k, (uint32_t)n);
		if (err == 0 && at > 0)
			pass_corner(p, at - 1, corner_mm_s[k - 1]);
	}
	if (err == 0)
		p->most_mm_s[0] = p->most_mm_s[p->n - 1] = 0;
	return err;
}

/* -- Passes ---------------------------------------------------------------- */

/* A motion in one direction, no slower than it must be. */
struct motion {
	double v_mm_s, a_mm_s2;
};

/* Accelerations in the direction of the motion. */
static double most_mm_s2(const struct profile *p, const struct interp_axes *x,
			 size_t i, double v_mm_s, int dir)
{
	const struct interp_range r = interp_axes_mm_s2(x, way_at(p, i),
							v_mm_s);

	return larger(dir > 0 ? r.most : -r.least, 0);
}

static double most_mm_s3(const struct profile *p, const struct interp_axes *x,
			 size_t i, const struct motion *m, int dir)
{
	return interp_axes_mm_s3(x, way_at(p, i), m->v_mm_s,
				 dir * m->a_mm_s2).most;
}

/* The time for @mm with a jerk: the least t > 0 of v t + a t^2/2 + j t^3/6. */
static double time_s(const struct motion *m, double j, double mm)
{
	double t = m->v_mm_s > 0 ? mm / m->v_mm_s : INFINITY;

	if (j > 0)
		t = smaller(t, cbrt(6 * mm / j));
	for (int i = 0; i < 12; i++) {
		const double is = ((j / 6 * t + m->a_mm_s2 / 2) * t +
				   m->v_mm_s) * t - mm;
		const double by = (j / 2 * t + m->a_mm_s2) * t + m->v_mm_s;
		const double dt = by > 0 ? is / by : 0;

		t -= dt;
		if (fabs(dt) < 1e-10 * t)
			break;
	}
	return t;
}

/* @mm on with the jerk @j; false: it stands before. */
static bool go(struct motion *m, double j, double mm)
{
	const double t = time_s(m, j, mm);

	if (isinf(t))
		return false;
	m->v_mm_s += (m->a_mm_s2 + j * t / 2) * t;
	m->a_mm_s2 += j * t;
	return true;
}

/* The same with the greatest jerk that the axes have at both ends, from place
 * @b to place @i. */
static bool go_on(const struct profile *p, const struct interp_axes *x,
		  struct motion *m, size_t b, size_t i)
{
	const int dir = i > b ? 1 : -1;
	const double mm = fabs(p->s_mm[i] - p->s_mm[b]);
	const double j = most_mm_s3(p, x, b, m, dir);
	struct motion there = *m;
	double end;

	if (!go(&there, j, mm))
		return false;
	there.v_mm_s = smaller(there.v_mm_s, p->v_mm_s[i]);
	end = most_mm_s3(p, x, i, &there, dir);
	return go(m, smaller(j, larger(end, INTERP_AXES_KEPT * j)), mm);
}

/* From place @b to place @i. */
static void step(struct profile *p, const struct interp_axes *x,
		 struct motion *m, size_t b, size_t i)
{
	const int dir = i > b ? 1 : -1;
	const double mm = fabs(p->s_mm[i] - p->s_mm[b]), v = m->v_mm_s;
	const double top = p->v_mm_s[i];
	const double a = smaller(m->a_mm_s2, most_mm_s2(p, x, b, v, dir));
	double most, rise;

	m->a_mm_s2 = a;
	if (mm > 0 && !go_on(p, x, m, b, i))
		*m = (struct motion) { 0, 0 };
	rise = m->a_mm_s2;
	most = most_mm_s2(p, x, i, smaller(m->v_mm_s, top), dir);
	if (mm > 0 && rise > most) {
		m->a_mm_s2 = most;
		m->v_mm_s = sqrt(larger(v * v + (a + most) * mm, 0));
	}
	if (m->v_mm_s > top) {
		m->v_mm_s = top;
		if (mm > 0)
			m->a_mm_s2 = larger(smaller((top * top - v * v) /
						    (2 * mm), rise), 0);
	}
	p->v_mm_s[i] = m->v_mm_s;
}

static void pass(struct profile *p, const struct interp_axes *x, int dir)
{
	const size_t last = p->n - 1;
	struct motion m = { 0, 0 };

	for (size_t q = 1; q <= last; q++) {
		if (dir > 0)
			step(p, x, &m, q - 1, q);
		else
			step(p, x, &m, last - q + 1, last - q);
	}
}

/* -- What it asks for ------------------------------------------------------ */

/* Of the interval behind place @i. */
static double a_behind(const struct profile *p, size_t i)
{
	const double *v = p->v_mm_s, *s = p->s_mm;

	return (v[i + 1] * v[i + 1] - v[i] * v[i]) / (2 * (s[i + 1] - s[i]));
}

struct profile_asked profile_asked(const struct profile *p,
				   const struct interp_axes *x, size_t i)
{
	struct profile_asked ret = { 0, 0, 0 };
	const double *way = way_at(p, i);
	const double v = p->v_mm_s[i];
	double a, j, before, behind;

	if (i == 0 || i + 1 >= p->n || is_corner(p, i))
		return ret;
	before = a_behind(p, i - 1);
	behind = a_behind(p, i);
	a = (before + behind) / 2;
	j = 2 * (behind - before) /
	    (caps_interval_s(p, i - 1) + caps_interval_s(p, i));
	for (uint32_t k = 0; k < p->columns; k++, way += INTERP_AXES_WAY) {
		const double by_v = way[0] * v;
		const double by_a = way[0] * a + way[1] * v * v;
		const double by_j = way[0] * j + 3 * way[1] * v * a +
				    way[2] * v * v * v;

		ret.v = larger(ret.v, fabs(by_v) / x->v_mm_s[k]);
		ret.a = larger(ret.a, fabs(by_a) / x->a_mm_s2[k]);
		ret.j = larger(ret.j, fabs(by_j) / x->j_mm_s3[k]);
	}
	return ret;
}

/* On a bend.  Along a line it is what the places are too far apart for.
 * Return: how many ceilings were lowered. */
static size_t lower_ceilings(struct profile *p, const struct interp_axes *x)
{
	size_t some = 0;

	for (size_t i = 1; i + 1 < p->n; i++) {
		const struct profile_asked k = profile_asked(p, x, i);
		double by = 1;

		if (k.a > MOST_A)
			by = smaller(by, sqrt(1 / k.a));
		if (k.j > MOST_J)
			by = smaller(by, cbrt(1 / k.j));
		by = larger(by, LOWER) * p->v_mm_s[i];
		if (by < p->v_mm_s[i] && !is_straight(p, way_at(p, i))) {
			p->most_mm_s[i] = by;
			some++;
		}
	}
	return some;
}

static int find_speeds(struct profile *p, const struct interp_axes *x,
		       int lowerings)
{
	for (int turn = 0;; turn++) {
		memcpy(p->v_mm_s, p->most_mm_s, p->n * sizeof(double));
		pass(p, x, 1);
		pass(p, x, -1);
		if (caps_round(p, x) < 0)
			return -ENOMEM;
		if (turn == lowerings || lower_ceilings(p, x) == 0)
			return 0;
	}
}

/* -- More places ----------------------------------------------------------- */

/* Do the axes need more than they have, beside that interval? */
static bool asks_much(const struct profile *p, const struct interp_axes *x,
		      size_t i)
{
	return profile_asked(p, x, i).j > MOST_J ||
	       profile_asked(p, x, i + 1).j > MOST_J;
}

/* Into how many parts the interval behind place @i is divided. */
static int parts_of(const struct profile *p, const struct interp_axes *x,
		    size_t i)
{
	const double t = p->s_mm[i + 1] > p->s_mm[i] ? caps_interval_s(p, i) :
						       0;
	double a, change = 0;

	if (!(t > SHORT_S))
		return 1;
	if (asks_much(p, x, i))
		return MUCH_PARTS;
	if (!(t > LONG_S))
		return 1;
	a = a_behind(p, i);
	if (i > 0 && p->s_mm[i] > p->s_mm[i - 1])
		change = fabs(a - a_behind(p, i - 1));
	if (i + 2 < p->n && p->s_mm[i + 2] > p->s_mm[i + 1])
		change = larger(change, fabs(a - a_behind(p, i + 1)));
	return change > 0.3 * LONG_S *
			interp_axes_straight(x, way_at(p, i)).j_mm_s3 ?
	       (int)smaller(ceil(t / (0.7 * LONG_S)), 8) : 1;
}

static int divide(struct profile *p, const struct interp_axes *x,
		  const struct profile_section *sections)
{
	struct profile more = { .columns = p->columns };
	int err = 0;

	for (size_t i = 0; err == 0 && i < p->n; i++) {
		const int n = i + 1 < p->n ? parts_of(p, x, i) : 1;
		const double mm = i + 1 < p->n ? p->s_mm[i + 1] - p->s_mm[i] :
						 0;

		err = add(&more, x, sections, p->section[i], p->s_mm[i]);
		if (err == 0)
			more.most_mm_s[more.n - 1] =
				smaller(p->most_mm_s[i],
					more.most_mm_s[more.n - 1]);
		for (int k = 1; err == 0 && k < n; k++)
			err = add(&more, x, sections, p->section[i],
				  p->s_mm[i] + mm * k / n);
	}
	if (err < 0) {
		profile_free(&more);
		return err;
	}
	profile_free(p);
	*p = more;
	return 0;
}

int profile_solve(struct profile *p, const struct interp_axes *x,
		  const struct profile_section *sections, size_t n,
		  const double *corner_mm_s)
{
	int err;

	*p = (struct profile) { .columns = x->n };
	err = add_all(p, x, sections, n, corner_mm_s);
	for (int round = 0; err == 0; round++) {
		err = find_speeds(p, x, round == ROUNDS ? LOWERINGS : 0);
		if (err < 0 || round == ROUNDS)
			break;
		err = divide(p, x, sections);
	}
	if (err < 0)
		profile_free(p);
	return err;
}

double profile_s(const struct profile *p)
{
	double sum = 0;

	for (size_t i = 0; i + 1 < p->n; i++)
		sum += caps_interval_s(p, i);
	return sum;
}

void profile_free(struct profile *p)
{
	free(p->s_mm);
	free(p->v_mm_s);
	free(p->most_mm_s);
	free(p->way);
	free(p->section);
	*p = (struct profile) { .columns = p->columns };
}
