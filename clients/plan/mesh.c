/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mesh.c - questions about a mesh
 */
#include "mesh.h"

#include "tree.h"
#include "vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void mesh_free(struct mesh *m)
{
	free(m->vert);
	free(m->tri);
	*m = (struct mesh) { 0 };
}

void mesh_bounds(struct mesh *m)
{
	memcpy(m->min, m->vert[0], sizeof(m->min));
	memcpy(m->max, m->vert[0], sizeof(m->max));
	for (uint32_t i = 1; i < m->nverts; i++) {
		for (int k = 0; k < 3; k++) {
			m->min[k] = fmin(m->min[k], m->vert[i][k]);
			m->max[k] = fmax(m->max[k], m->vert[i][k]);
		}
	}
}

double mesh_size_mm(const struct mesh *m)
{
	double size = 0;

	for (int k = 0; k < 3; k++)
		size = fmax(size, m->max[k] - m->min[k]);
	return size;
}

/* By A. van Oosterom and J. Strackee, 1983. */
double mesh_angle_of(const struct mesh *m, uint32_t i, const double p[3])
{
	double a[3], b[3], c[3], x[3], na, nb, nc;

	v_sub(mesh_corner(m, i, 0), p, a);
	v_sub(mesh_corner(m, i, 1), p, b);
	v_sub(mesh_corner(m, i, 2), p, c);
	v_cross(b, c, x);
	na = v_length(a);
	nb = v_length(b);
	nc = v_length(c);
	return 2 * atan2(v_dot(a, x), na * nb * nc + v_dot(a, b) * nc +
				      v_dot(a, c) * nb + v_dot(b, c) * na);
}

double mesh_winding(const struct mesh *m, const double p[3])
{
	double sum = 0;

	for (uint32_t i = 0; i < m->ntris; i++)
		sum += mesh_angle_of(m, i, p);
	return sum / (4 * M_PI);
}

double mesh_volume_of(const struct mesh *m, uint32_t i)
{
	double a[3], b[3], c[3], x[3];

	v_sub(mesh_corner(m, i, 0), m->min, a);
	v_sub(mesh_corner(m, i, 1), m->min, b);
	v_sub(mesh_corner(m, i, 2), m->min, c);
	v_cross(b, c, x);
	return v_dot(a, x) / 6;
}

/* -- Does it cross itself? ------------------------------------------------ */

#define CROSSINGS_MAX	1000

struct crossing {
	const struct tree *t;
	uint32_t n, *first;
};

static bool share_corner(const struct mesh *m, uint32_t i, uint32_t j)
{
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++)
			if (memcmp(m->vert[m->tri[i][a]], m->vert[m->tri[j][b]],
				   sizeof(*m->vert)) == 0)
				return true;
	return false;
}

static void cross_leaves(struct crossing *c, const struct box *a,
			 const struct box *b)
{
	for (uint32_t i = a->first; i < a->first + a->n; i++) {
		for (uint32_t j = b->first; j < b->first + b->n; j++) {
			const uint32_t ti = c->t->id[i], tj = c->t->id[j];
			double p[3], q[3];

			if (i == j || share_corner(c->t->mesh, ti, tj) ||
			    tri_distance(&c->t->tri[i], &c->t->tri[j], p,
					 q) > 0)
				continue;
			if (c->n++ == 0) {
				c->first[0] = ti;
				c->first[1] = tj;
			}
		}
	}
}

static void cross(struct crossing *c, const struct box *a,
		  const struct box *b)
{
	const struct box *node = c->t->node;

	if (c->n >= CROSSINGS_MAX || (a != b && box_distance(a, b) > 0))
		return;
	if (a->n && b->n) {
		cross_leaves(c, a, b);
	} else if (a == b) {
		cross(c, &node[a->first], &node[a->first]);
		cross(c, &node[a->first], &node[a->first + 1]);
		cross(c, &node[a->first + 1], &node[a->first + 1]);
	} else if (b->n || (!a->n && a->half[3] > b->half[3])) {
		cross(c, &node[a->first], b);
		cross(c, &node[a->first + 1], b);
	} else {
		cross(c, a, &node[b->first]);
		cross(c, a, &node[b->first + 1]);
	}
}

uint32_t mesh_crossings(const struct tree *t, uint32_t ret[2])
{
	struct crossing c = { .t = t, .first = ret };

	cross(&c, &t->node[0], &t->node[0]);
	return c.n;
}
