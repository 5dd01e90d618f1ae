/* SPDX-License-Identifier: Apache-2.0 */
/*
 * air.c - how far it is from any place round a part to the open, through air
 *
 * Ways are counted from cell to cell over faces, edges and corners, in sweeps
 * through the grid in both directions until nothing changes.
 */
#include "air.h"

#include "vec.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>

#define CELLS		110		/* along the longest side */
#define SWEEPS		400
#define ASIDE		4		/* cells looked at round a wall */

static size_t at(const struct air *a, int x, int y, int z)
{
	return ((size_t)z * (size_t)a->n[1] + (size_t)y) * (size_t)a->n[0] +
	       (size_t)x;
}

static bool cell_of(const struct air *a, const double p[3], int c[3])
{
	for (int k = 0; k < 3; k++) {
		const double x = floor((p[k] - a->from[k]) / a->cell_mm);

		if (!(x >= 0 && x < a->n[k]))
			return false;
		c[k] = (int)x;
	}
	return true;
}

/* Points so dense that no cell the triangle passes is left out but for its
 * corners. */
static void wall(struct air *a, const struct mesh *m, uint32_t i)
{
	double u[3], v[3];
	int n;

	v_sub(mesh_corner(m, i, 1), mesh_corner(m, i, 0), u);
	v_sub(mesh_corner(m, i, 2), mesh_corner(m, i, 0), v);
	n = 1 + (int)(2 * fmax(v_length(u), v_length(v)) / a->cell_mm);
	for (int k = 0; k <= n; k++) {
		for (int l = 0; k + l <= n; l++) {
			double p[3];
			int c[3];

			v_madd(mesh_corner(m, i, 0), (double)k / n, u, p);
			v_madd(p, (double)l / n, v, p);
			if (cell_of(a, p, c))
				a->way[at(a, c[0], c[1], c[2])] = -1;
		}
	}
}

/* Shorter by way of a neighbour? @dir: those before it or behind it. */
static bool shorten(struct air *a, const int c[3], int dir)
{
	float *mine = &a->way[at(a, c[0], c[1], c[2])];
	bool changed = false;

	if (*mine < 0)
		return false;
	for (int k = 0; k < 13; k++) {
		const int o[3] = { c[0] + dir * (k % 3 - 1),
				   c[1] + dir * (k / 3 % 3 - 1),
				   c[2] + dir * (k / 9 - 1) };
		const int d = abs(k % 3 - 1) + abs(k / 3 % 3 - 1) +
			      abs(k / 9 - 1);
		float way;

		if (o[0] < 0 || o[1] < 0 || o[2] < 0 || o[0] >= a->n[0] ||
		    o[1] >= a->n[1] || o[2] >= a->n[2])
			continue;
		way = a->way[at(a, o[0], o[1], o[2])];
		if (way < 0)
			continue;
		way += (float)(a->cell_mm * sqrt(d));
		if (way < *mine) {
			*mine = way;
			changed = true;
		}
	}
	return changed;
}

static bool sweep(struct air *a, int dir)
{
	bool changed = false;

	for (int z = 0; z < a->n[2]; z++)
		for (int y = 0; y < a->n[1]; y++)
			for (int x = 0; x < a->n[0]; x++) {
				const int c[3] = {
					dir > 0 ? x : a->n[0] - 1 - x,
					dir > 0 ? y : a->n[1] - 1 - y,
					dir > 0 ? z : a->n[2] - 1 - z,
				};

				changed |= shorten(a, c, dir);
			}
	return changed;
}

static void empty(struct air *a)
{
	for (size_t i = 0; i < a->cells; i++)
		a->way[i] = FLT_MAX / 2;
}

int air_cut(struct air *a, const struct mesh *part)
{
	size_t cells = 1;

	a->cell_mm = mesh_size_mm(part) / CELLS;
	for (int k = 0; k < 3; k++) {
		a->from[k] = part->min[k] - 2.5 * a->cell_mm;
		a->n[k] = 5 + (int)((part->max[k] - part->min[k]) /
				    a->cell_mm);
		cells *= (size_t)a->n[k];
	}
	a->way = malloc(cells * sizeof(*a->way));
	if (!a->way)
		return -ENOMEM;
	a->cells = cells;
	a->opened = false;
	empty(a);
	for (uint32_t i = 0; i < part->ntris; i++)
		wall(a, part, i);
	return 0;
}

bool air_open(struct air *a, const double p[3])
{
	bool outside = false;
	int c[3];

	for (int k = 0; k < 3; k++) {
		const double x = floor((p[k] - a->from[k]) / a->cell_mm);

		outside |= !(x >= 0 && x < a->n[k]);
		c[k] = (int)fmin(fmax(x, 0), a->n[k] - 1);
	}
	if (outside) {
		a->way[at(a, c[0], c[1], c[2])] = 0;
		a->opened = true;
	}
	return outside;
}

void air_fill(struct air *a)
{
	for (size_t i = 0; i < a->cells && !a->opened; i++) {
		const int x = (int)(i % (size_t)a->n[0]);
		const int y = (int)(i / (size_t)a->n[0] % (size_t)a->n[1]);
		const int z = (int)(i / (size_t)a->n[0] / (size_t)a->n[1]);

		if (x == 0 || y == 0 || z == 0 || x == a->n[0] - 1 ||
		    y == a->n[1] - 1 || z == a->n[2] - 1)
			a->way[i] = 0;
	}
	for (int i = 0; i < SWEEPS; i++) {
		const bool forward = sweep(a, 1);

		if (!sweep(a, -1) && !forward)
			break;
	}
	for (size_t i = 0; i < a->cells; i++)
		if (a->way[i] >= FLT_MAX / 4)
			a->way[i] = -1;
}

void air_free(struct air *a)
{
	free(a->way);
	a->way = NULL;
}

double air_way(const struct air *a, const double p[3], double toward[3])
{
	double here = -1, least = DBL_MAX;
	int c[3], best[3] = { 0, 0, 0 };

	memset(toward, 0, 3 * sizeof(*toward));
	if (!cell_of(a, p, c))
		return 0;
	for (int k = 0; k < (2 * ASIDE + 1) * (2 * ASIDE + 1) *
			    (2 * ASIDE + 1); k++) {
		const int o[3] = { k % (2 * ASIDE + 1) - ASIDE,
				   k / (2 * ASIDE + 1) % (2 * ASIDE + 1) -
				   ASIDE,
				   k / (2 * ASIDE + 1) / (2 * ASIDE + 1) -
				   ASIDE };
		double way;

		if (c[0] + o[0] < 0 || c[1] + o[1] < 0 || c[2] + o[2] < 0 ||
		    c[0] + o[0] >= a->n[0] || c[1] + o[1] >= a->n[1] ||
		    c[2] + o[2] >= a->n[2])
			continue;
		way = (double)a->way[at(a, c[0] + o[0], c[1] + o[1],
					c[2] + o[2])];
		if (way >= 0 && way < least) {
			least = way;
			memcpy(best, o, sizeof(best));
		}
		if (way >= 0 && !o[0] && !o[1] && !o[2])
			here = way;
	}
	if (least == DBL_MAX)
		return 0;
	for (int i = 0; i < 3; i++)
		toward[i] = best[i];
	least += v_length(toward) * a->cell_mm;
	if (v_length(toward) > 0) {
		const double n = v_length(toward);

		for (int i = 0; i < 3; i++)
			toward[i] /= n;
	}
	return here >= 0 ? here : least;
}
