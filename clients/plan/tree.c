/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tree.c - build a tree of oriented boxes, from the top
 *
 * The axes of a box are those of the spread of its triangles' corners; it is cut
 * across the longest one at the mean, or in the middle of the row where the
 * mean leaves one side empty.
 */
#include "tree.h"

#include <errno.h>
#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Triangles. */
#define MANY		32

struct build {
	struct tree *t;
	double (*centre)[3];		/* of each triangle, in the tree's order */
};

static void swap_tris(struct build *b, uint32_t i, uint32_t j)
{
	struct tree *t = b->t;
	const struct triangle tri = t->tri[i];
	const uint32_t id = t->id[i];
	double centre[3];

	memcpy(centre, b->centre[i], sizeof(centre));
	t->tri[i] = t->tri[j];
	t->id[i] = t->id[j];
	memcpy(b->centre[i], b->centre[j], sizeof(centre));
	t->tri[j] = tri;
	t->id[j] = id;
	memcpy(b->centre[j], centre, sizeof(centre));
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

		if (!(off > 1e-13 * trace))
			break;
		for (int p = 0; p < 2; p++)
			for (int q = p + 1; q < 3; q++)
				if (fabs(m[p][q]) > 1e-15 * trace)
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

/* Of few triangles all corners count; of many the middle of each will do. */
static void spread(const struct build *b, uint32_t from, uint32_t n,
		   double mean[3], double m[3][3])
{
	double sum[3] = { 0 }, sq[6] = { 0 };
	const double *o = b->centre[from];
	const int corners = n > MANY ? 1 : 3;

	for (uint32_t i = from; i < from + n; i++) {
		for (int k = 0; k < corners; k++) {
			double d[3];

			v_sub(corners == 1 ? b->centre[i] :
					     b->t->tri[i].at[k], o, d);
			v_add(sum, d, sum);
			sq[0] += d[0] * d[0];
			sq[1] += d[1] * d[1];
			sq[2] += d[2] * d[2];
			sq[3] += d[0] * d[1];
			sq[4] += d[0] * d[2];
			sq[5] += d[1] * d[2];
		}
	}
	for (int k = 0; k < 3; k++)
		sum[k] /= corners * (double)n;
	v_add(o, sum, mean);
	for (int k = 0; k < 3; k++)
		m[k][k] = sq[k] / (corners * (double)n) - sum[k] * sum[k];
	m[0][1] = m[1][0] = sq[3] / (corners * (double)n) - sum[0] * sum[1];
	m[0][2] = m[2][0] = sq[4] / (corners * (double)n) - sum[0] * sum[2];
	m[1][2] = m[2][1] = sq[5] / (corners * (double)n) - sum[1] * sum[2];
}

/* The axes as the box has them: in single precision. */
static void take_axes(const struct rot *axis, struct box *b)
{
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			b->axis[k][i] = (float)axis->m[i][k];
}

/* The box along its axes that holds them, a little more for rounding: the axes
 * are of length 1 and square to each other to 2^-22. */
static void enclose(const struct tree *t, uint32_t from, uint32_t n,
		    struct box *b)
{
	const double *o = t->tri[from].at[0];
	double lo[3] = { 0 }, hi[3] = { 0 }, mid[3] = { 0 }, size = 0;
	double axis[3][3];

	for (int j = 0; j < 3; j++)
		for (int k = 0; k < 3; k++)
			axis[j][k] = (double)b->axis[k][j];
	for (uint32_t i = from; i < from + n; i++) {
		for (int k = 0; k < 3; k++) {
			double d[3];

			v_sub(t->tri[i].at[k], o, d);
			for (int j = 0; j < 3; j++) {
				const double at = v_dot(axis[j], d);

				lo[j] = at < lo[j] ? at : lo[j];
				hi[j] = at > hi[j] ? at : hi[j];
			}
		}
	}
	for (int j = 0; j < 3; j++) {
		size += 0x1p-20 * (hi[j] - lo[j]) +
			16 * DBL_EPSILON * fabs(o[j]);
		for (int k = 0; k < 3; k++)
			mid[k] += axis[j][k] * (lo[j] + hi[j]) / 2;
	}
	v_add(mid, o, b->centre);
	b->half[3] = 0;
	for (int j = 0; j < 3; j++) {
		b->half[j] = (float)(((hi[j] - lo[j]) / 2 + size) *
				     (1 + 0x1p-22));
		b->half[3] += b->half[j];
	}
}

/* -- Cutting -------------------------------------------------------------- */

static int longest(const struct box *b)
{
	int k = b->half[1] > b->half[0];

	return b->half[2] > b->half[k] ? 2 : k;
}

/* Put those below the plane first. Return: how many. */
static uint32_t cut(struct build *b, uint32_t from, uint32_t n,
		    const double normal[3], double at)
{
	uint32_t below = 0;

	for (uint32_t i = 0; i < n; i++) {
		if (v_dot(normal, b->centre[from + i]) >= at)
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
		spread(b, from, n, mean, m);
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
	below = cut(b, from, n, axis.m[along], v_dot(axis.m[along], mean));
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

	for (uint32_t i = 0; i < m->ntris; i++) {
		double *c = b->centre[i];

		b->t->id[i] = i;
		memset(c, 0, 3 * sizeof(*c));
		for (uint32_t k = 0; k < 3; k++) {
			memcpy(b->t->tri[i].at[k], mesh_corner(m, i, k),
			       3 * sizeof(double));
			v_madd(c, 1.0 / 3, b->t->tri[i].at[k], c);
		}
	}
}

int tree_build(struct tree *t, const struct mesh *m)
{
	struct build b = { .t = t };
	const size_t n = m->ntris;

	*t = (struct tree) { .mesh = m, .ntris = m->ntris, .nnodes = 1 };
	t->node = malloc(2 * n * sizeof(*t->node));
	t->tri = malloc(n * sizeof(*t->tri));
	t->id = malloc(n * sizeof(*t->id));
	t->plane = malloc(n * sizeof(*t->plane));
	b.centre = malloc(n * sizeof(*b.centre));
	if (!t->node || !t->tri || !t->plane || !t->id || !b.centre) {
		free(b.centre);
		tree_free(t);
		return -ENOMEM;
	}
	copy_tris(&b);
	split(&b, 0, 0, m->ntris);
	free(b.centre);
	lay_planes(t);
	return 0;
}

void tree_free(struct tree *t)
{
	free(t->node);
	free(t->tri);
	free(t->plane);
	free(t->id);
	*t = (struct tree) { 0 };
}
