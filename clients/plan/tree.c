/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.c - build a tree of oriented boxes, from the top
 *
 * The axes of a box are those of the spread of its triangles' corners.  The
 * triangles are cut at their mean, across the longest axis of the box; in the
 * middle of the row where that leaves nearly all on one side.  Both are done in
 * single precision: a poor cut makes a tree slower, but never wrong.
 */
#include "tree.h"

#include <errno.h>
#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* The spread of more triangles than that is told by so many of them. */
#define SAMPLE		512u

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

/* One triangle lies along its longest edge. Return: false if it is too thin to
 * have a normal. */
static bool lie_along(const struct triangle *t, struct rot *ret)
{
	double edge[3][3], n[3], size[3];
	int k = 0;

	for (int i = 0; i < 3; i++) {
		v_sub(t->at[(i + 1) % 3], t->at[i], edge[i]);
		size[i] = v_length(edge[i]);
		k = size[i] > size[k] ? i : k;
	}
	v_cross(edge[0], edge[1], n);
	if (!(v_length(n) > 1e-6 * size[k] * size[k]))
		return false;
	for (int i = 0; i < 3; i++) {
		ret->m[0][i] = edge[k][i] / size[k];
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

/* The box along its axes that holds them. */
static void enclose(const struct tree *t, uint32_t from, uint32_t n,
		    struct box *b)
{
	const double *o = t->tri[from].at[0];
	box_v4 lo = { 0 }, hi = { 0 };

	for (uint32_t i = from; i < from + n; i++) {
		for (int k = 0; k < 3; k++) {
			const box_v4 d = seen_from(o, t->tri[i].at[k]);
			const box_v4 at = box_along(b->axis, d[0], d[1], d[2]);

			lo = choose(at < lo, at, lo);
			hi = choose(at > hi, at, hi);
		}
	}
	close_box(b, o, lo, hi);
}

/* -- Cutting -------------------------------------------------------------- */

static int longest(const struct box *b)
{
	int k = b->half[1] > b->half[0];

	return b->half[2] > b->half[k] ? 2 : k;
}

/* Those below the plane come first. Return: how many. */
static uint32_t cut(struct build *b, uint32_t from, uint32_t n,
		    const double normal[3], const double through[3])
{
	const float x = (float)normal[0], y = (float)normal[1];
	const float z = (float)normal[2];
	const float height = (float)(v_dot(normal, through) -
				     v_dot(normal, b->mid));
	uint32_t below = 0;

	for (uint32_t i = 0; i < n; i++) {
		const float *p = b->middle[from + i].at;

		if (x * p[0] + y * p[1] + z * p[2] >= height)
			continue;
		if (i != below)
			swap_tris(b, from + i, from + below);
		below++;
	}
	/* All on one side, or far too many: any halves will do. */
	if (below < n / 16 + 1 || below > n - n / 16 - 1)
		below = n / 2;
	return below;
}

static void split(struct build *b, uint32_t node, uint32_t from, uint32_t n)
{
	struct box *x = &b->t->node[node];
	double mean[3], m[3][3];
	struct rot axis;
	uint32_t below;
	int along;

	if (n > 1 || !lie_along(&b->t->tri[from], &axis)) {
		spread(b->t, from, n, mean, m);
		principal(m, &axis);
	}
	*x = (struct box) { 0 };
	take_axes(&axis, x);
	enclose(b->t, from, n, x);
	if (n <= TREE_LEAF) {
		x->first = from;
		x->n = n;
		return;
	}
	along = longest(x);
	below = cut(b, from, n, axis.m[along], mean);
	x->first = b->t->nnodes;
	x->n = 0;
	b->t->nnodes += 2;
	split(b, x->first, from, below);
	split(b, x->first + 1, from + below, n - below);
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
