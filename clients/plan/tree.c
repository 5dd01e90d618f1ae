/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.c - build a tree of oriented boxes, from the top
 *
 * The axes of a box are those of the spread of its triangles' corners, or lie
 * along an edge of a triangle if that makes the box smaller: a box that stands
 * out of a wall or beyond its rim makes the wall seem nearer than it is.  For
 * the same reason the triangles of a plane wall are cut from the others.  All
 * others are cut at their mean, across the longest axis of the box; in the
 * middle of the row where that leaves nearly all on one side.  All this is done
 * in single precision: a poor cut makes a tree slower, but never wrong.
 */
#include "tree.h"

#include <errno.h>
#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The spread of more triangles than that is told by so many of them. */
#define SAMPLE		512u
#define TRIED		32u		/* about so many boxes are compared */

#define WALLS		4u		/* triangles whose planes are tried */
#define WALL_LEAST	32u		/* triangles that can have a wall */
#define FLAT		1e-4f		/* of the size: what lies in a plane */

struct middle {
	float at[3];			/* of a triangle, as seen from the
					 * middle of the mesh */
	uint32_t id;			/* its number in the mesh */
};

struct build {
	struct tree *t;
	double mid[3];			/* of the mesh */
	struct middle *middle;		/* in the tree's order */
};

/* Triangles that follow each other in the tree's order. */
struct row {
	const struct tree *t;
	uint32_t from, n;
};

static void swap_tris(struct build *b, uint32_t i, uint32_t j)
{
	const struct triangle tri = b->t->tri[i];
	const struct middle middle = b->middle[i];

	b->t->tri[i] = b->t->tri[j];
	b->middle[i] = b->middle[j];
	b->t->tri[j] = tri;
	b->middle[j] = middle;
}

/* -- Axes of a spread ----------------------------------------------------- */

/* One of Jacobi's rotations: it makes m[p][q] zero. */
static void jacobi(double m[3][3], double v[3][3], int p, int q)
{
	const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
	const double t = copysign(1, theta) / (fabs(theta) +
					       sqrt(theta * theta + 1));
	const double c = 1 / sqrt(t * t + 1), s = t * c;

	for (int k = 0; k < 3; k++) {
		const double a = m[k][p], b = m[k][q];

		m[k][p] = c * a - s * b;
		m[k][q] = s * a + c * b;
	}
	for (int k = 0; k < 3; k++) {
		const double a = m[p][k], b = m[q][k];

		m[p][k] = c * a - s * b;
		m[q][k] = s * a + c * b;
	}
	for (int k = 0; k < 3; k++) {
		const double a = v[p][k], b = v[q][k];

		v[p][k] = c * a - s * b;
		v[q][k] = s * a + c * b;
	}
}

static void principal(double m[3][3], struct rot *ret)
{
	static const struct rot unit = { { { 1, 0, 0 }, { 0, 1, 0 },
					   { 0, 0, 1 } } };
	double (*axis)[3] = ret->m;
	const double trace = m[0][0] + m[1][1] + m[2][2];

	*ret = unit;
	for (int sweep = 0; sweep < 12; sweep++) {
		const double off = fabs(m[0][1]) + fabs(m[0][2]) +
				   fabs(m[1][2]);

		if (!(off > 1e-6 * trace))
			break;
		for (int p = 0; p < 2; p++)
			for (int q = p + 1; q < 3; q++)
				if (fabs(m[p][q]) > 1e-8 * trace)
					jacobi(m, axis, p, q);
	}
	/* Rotations leave it of length 1 but for rounding; mend that. */
	for (int i = 0; i < 2; i++) {
		const double n = 1 / v_length(axis[i]);

		for (int k = 0; k < 3; k++)
			axis[i][k] *= n;
	}
	v_madd(axis[1], -v_dot(axis[0], axis[1]), axis[0], axis[1]);
	v_cross(axis[0], axis[1], axis[2]);
}

/* In the plane of a triangle, along its edge @k.  Return: false if it is too
 * thin to have a normal. */
static bool lie_along(const struct triangle *t, int k, struct rot *ret)
{
	double u[3], v[3], n[3], size;

	v_sub(t->at[(k + 1) % 3], t->at[k], u);
	v_sub(t->at[(k + 2) % 3], t->at[k], v);
	v_cross(u, v, n);
	size = v_length(u);
	if (!(v_length(n) > 1e-6 * fmax(size * size, v_dot(v, v))))
		return false;
	for (int i = 0; i < 3; i++) {
		ret->m[0][i] = u[i] / size;
		ret->m[2][i] = n[i] / v_length(n);
	}
	v_cross(ret->m[2], ret->m[0], ret->m[1]);
	return true;
}

/* x y z of @p seen from @o. */
static box_v4 seen_from(const double o[3], const double p[3])
{
	return (box_v4){ (float)(p[0] - o[0]), (float)(p[1] - o[1]),
			 (float)(p[2] - o[2]) };
}

/* x y z as y z x. */
static box_v4 turned(box_v4 v)
{
	return __builtin_shufflevector(v, v, 1, 2, 0, 3);
}

/* The numbers are spread over all, and are the same in each run. */
static uint32_t sampled(uint32_t k, uint32_t n)
{
	return n <= SAMPLE ? k : (uint32_t)(k * UINT64_C(2654435761) % n);
}

/* The mean of the corners, and how they spread about it. */
static void spread(const struct tree *t, uint32_t from, uint32_t n,
		   double mean[3], double m[3][3])
{
	const uint32_t many = n < SAMPLE ? n : SAMPLE;
	const float share = 1 / (3 * (float)many);
	const double *o = t->tri[from].at[0];
	box_v4 sum = { 0 }, sq = { 0 }, mixed = { 0 };

	for (uint32_t i = 0; i < many; i++) {
		const struct triangle *x = &t->tri[from + sampled(i, n)];

		for (int k = 0; k < 3; k++) {
			const box_v4 d = seen_from(o, x->at[k]);

			sum += d;
			sq += d * d;
			mixed += d * turned(d);
		}
	}
	sum *= share;
	sq = sq * share - sum * sum;
	mixed = mixed * share - sum * turned(sum);
	for (int k = 0; k < 3; k++) {
		mean[k] = o[k] + (double)sum[k];
		m[k][k] = (double)sq[k];
		m[k][(k + 1) % 3] = m[(k + 1) % 3][k] = (double)mixed[k];
	}
}

/* The axes as the box has them: in single precision. */
static void take_axes(const struct rot *axis, struct box *b)
{
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			b->axis[k][i] = (float)axis->m[i][k];
}

static box_v4 choose(box_i4 which, box_v4 yes, box_v4 no)
{
	return (box_v4)(((box_i4)yes & which) | ((box_i4)no & ~which));
}

/* The box from @lo to @hi along its axes, as seen from @o, and a little more.
 * The axes have length 1 and are square to each other within 2^-22.  Each
 * place was rounded by less than 2^-21 of the sum of the sides. */
static void close_box(struct box *b, const double o[3], box_v4 lo, box_v4 hi)
{
	double mid[3] = { 0 }, more = 0;

	for (int j = 0; j < 3; j++) {
		more += 0x1p-19 * ((double)hi[j] - (double)lo[j]) +
			16 * DBL_EPSILON * fabs(o[j]);
		for (int k = 0; k < 3; k++)
			mid[k] += (double)b->axis[k][j] *
				  ((double)lo[j] + (double)hi[j]) / 2;
	}
	v_add(mid, o, b->centre);
	b->half[3] = 0;
	for (int j = 0; j < 3; j++) {
		const double side = (double)hi[j] - (double)lo[j];

		b->half[j] = (float)((side / 2 + more) * (1 + 0x1p-22));
		b->half[3] += b->half[j];
	}
}

/* From where to where @many of them reach along the axes of @b, as seen from
 * the first corner. */
static void reach(const struct row *r, uint32_t many, const struct box *b,
		  box_v4 ret[2])
{
	const double *o = r->t->tri[r->from].at[0];
	box_v4 lo = { 0 }, hi = { 0 };

	for (uint32_t i = 0; i < many; i++) {
		const struct triangle *t = &r->t->tri[r->from];

		t += many < r->n ? sampled(i, r->n) : i;
		for (int k = 0; k < 3; k++) {
			const box_v4 d = seen_from(o, t->at[k]);
			const box_v4 x = box_along(b->axis, d[0], d[1], d[2]);

			lo = choose(x < lo, x, lo);
			hi = choose(x > hi, x, hi);
		}
	}
	ret[0] = lo;
	ret[1] = hi;
}

/* A box round a row, or round some of it. */
struct trial {
	struct box b;			/* its axes */
	box_v4 to[2];			/* from where to where it reaches */
	float sides;			/* their sum */
};

/* @best is the box along @axis if that is smaller. */
static void try_axes(const struct row *r, const struct rot *axis,
		     struct trial *best)
{
	struct trial t = { .sides = 0 };
	box_v4 side;

	take_axes(axis, &t.b);
	reach(r, r->n < TRIED ? r->n : TRIED, &t.b, t.to);
	side = t.to[1] - t.to[0];
	t.sides = side[0] + side[1] + side[2];
	if (t.sides < best->sides)
		*best = t;
}

/* Along an edge of the first of them, or along the axes of their spread: where
 * their box is smallest.  That of one triangle is smallest along an edge. */
static void choose_box(const struct row *r, double mean[3], struct trial *ret)
{
	const struct triangle *first = &r->t->tri[r->from];
	struct rot axis;
	double m[3][3];

	ret->sides = FLT_MAX;
	for (int k = 0; k < 3; k++)
		if (lie_along(first, k, &axis))
			try_axes(r, &axis, ret);
	if (r->n > 1 || ret->sides == FLT_MAX) {
		spread(r->t, r->from, r->n, mean, m);
		principal(m, &axis);
		try_axes(r, &axis, ret);
	}
	if (r->n > TRIED)
		reach(r, r->n, &ret->b, ret->to);
}

/* -- Cutting -------------------------------------------------------------- */

static int longest(const struct box *b)
{
	int k = b->half[1] > b->half[0];

	return b->half[2] > b->half[k] ? 2 : k;
}

/* What lies between two planes, as seen from the middle of the mesh. */
struct slab {
	float normal[3], low, high;
};

static bool is_in(const struct slab *s, const float p[3])
{
	const float at = s->normal[0] * p[0] + s->normal[1] * p[1] +
			 s->normal[2] * p[2];

	return at >= s->low && at < s->high;
}

static float take_normal(const struct build *b, const double normal[3],
			 const double through[3], struct slab *s)
{
	for (int k = 0; k < 3; k++)
		s->normal[k] = (float)normal[k];
	return (float)(v_dot(normal, through) - v_dot(normal, b->mid));
}

/* The plane in which most of them lie, of some. Return: is it a wall, with
 * enough on it and beside it? */
static bool find_wall(const struct build *b, uint32_t from, uint32_t n,
		      float size, struct slab *ret)
{
	const uint32_t many = n < SAMPLE ? n : SAMPLE;
	uint32_t most = 0;

	for (uint32_t c = 0; c < WALLS && n >= WALL_LEAST; c++) {
		const struct triangle *x = &b->t->tri[from + c * n / WALLS];
		struct slab s;
		struct rot lie;
		uint32_t in = 0;
		float height;

		if (!lie_along(x, 0, &lie))
			continue;
		height = take_normal(b, lie.m[2], x->at[0], &s);
		s.low = height - FLAT * size;
		s.high = height + FLAT * size;
		for (uint32_t i = 0; i < many; i++)
			in += is_in(&s, b->middle[from + sampled(i, n)].at);
		if (in > most) {
			most = in;
			*ret = s;
		}
	}
	return most > many / 8 && most < many - many / 8;
}

/* Those in the slab come first. Return: how many. */
static uint32_t cut(struct build *b, uint32_t from, uint32_t n,
		    const struct slab *s)
{
	uint32_t in = 0;

	for (uint32_t i = 0; i < n; i++) {
		if (!is_in(s, b->middle[from + i].at))
			continue;
		if (i != in)
			swap_tris(b, from + i, from + in);
		in++;
	}
	/* All on one side, or far too many: any halves will do. */
	if (in < n / 16 + 1 || in > n - n / 16 - 1)
		in = n / 2;
	return in;
}

static void split(struct build *b, uint32_t node, uint32_t from, uint32_t n)
{
	const struct row r = { b->t, from, n };
	struct box *x = &b->t->node[node];
	struct trial best;
	double mean[3], normal[3];
	struct slab s;
	uint32_t in;
	int along;

	choose_box(&r, mean, &best);
	*x = best.b;
	close_box(x, b->t->tri[from].at[0], best.to[0], best.to[1]);
	if (n <= TREE_LEAF) {
		x->first = from;
		x->n = n;
		return;
	}
	along = longest(x);
	if (!find_wall(b, from, n, x->half[along], &s)) {
		for (int k = 0; k < 3; k++)
			normal[k] = (double)x->axis[k][along];
		s.low = -FLT_MAX;
		s.high = take_normal(b, normal, mean, &s);
	}
	in = cut(b, from, n, &s);
	x->first = b->t->nnodes;
	x->n = 0;
	b->t->nnodes += 2;
	split(b, x->first, from, in);
	split(b, x->first + 1, from + in, n - in);
}

static void lay_planes(struct tree *t)
{
	for (uint32_t i = 0; i < t->ntris; i++) {
		const struct triangle *x = &t->tri[i];
		double u[3], v[3], n[3], size;

		v_sub(x->at[1], x->at[0], u);
		v_sub(x->at[2], x->at[0], v);
		v_cross(u, v, n);
		size = v_length(n);
		memset(t->plane[i], 0, sizeof(t->plane[i]));
		if (!(size > 1e-9 * v_length(u) * v_length(v)))
			continue;
		for (int k = 0; k < 3; k++)
			t->plane[i][k] = n[k] / size;
		t->plane[i][3] = v_dot(t->plane[i], x->at[0]);
	}
}

static void copy_tris(struct build *b)
{
	const struct mesh *m = b->t->mesh;

	for (int k = 0; k < 3; k++)
		b->mid[k] = (m->min[k] + m->max[k]) / 2;
	for (uint32_t i = 0; i < m->ntris; i++) {
		struct triangle *x = &b->t->tri[i];

		for (uint32_t k = 0; k < 3; k++)
			memcpy(x->at[k], mesh_corner(m, i, k),
			       sizeof(x->at[k]));
		b->middle[i].id = i;
		for (int k = 0; k < 3; k++) {
			const double sum = x->at[0][k] + x->at[1][k] +
					   x->at[2][k];

			b->middle[i].at[k] = (float)(sum / 3 - b->mid[k]);
		}
	}
}

static int build(struct tree *t)
{
	struct build b = { .t = t };

	b.middle = malloc(t->ntris * sizeof(*b.middle));
	if (!b.middle)
		return -ENOMEM;
	copy_tris(&b);
	split(&b, 0, 0, t->ntris);
	for (uint32_t i = 0; i < t->ntris; i++)
		t->id[i] = b.middle[i].id;
	free(b.middle);
	lay_planes(t);
	return 0;
}

int tree_build(struct tree *t, const struct mesh *m)
{
	const size_t n = m->ntris;
	int err = -ENOMEM;

	*t = (struct tree) { .mesh = m, .ntris = m->ntris, .nnodes = 1 };
	t->node = malloc(2 * n * sizeof(*t->node));
	t->tri = malloc(n * sizeof(*t->tri));
	t->id = malloc(n * sizeof(*t->id));
	t->plane = malloc(n * sizeof(*t->plane));
	if (t->node && t->tri && t->plane && t->id)
		err = build(t);
	if (err)
		tree_free(t);
	return err;
}

void tree_free(struct tree *t)
{
	free(t->node);
	free(t->tri);
	free(t->plane);
	free(t->id);
	*t = (struct tree) { 0 };
}
