/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stl_weld.c - corners of an STL file that nearly meet become one
 *
 * The corners are sorted along a direction that no wall of a part follows, so
 * that few of them are near each other there.  Each is compared with those
 * behind it that are near along that direction.
 */
#include "stl_raw.h"
#include "vec.h"

#include <math.h>
#include <stdlib.h>
#include <sysexits.h>

static const double oblique[3] = { 0.6180, 0.5257, 0.5846 };

struct corner {
	double along;
	uint32_t n;			/* its number in the file */
};

static int by_place(const void *a, const void *b)
{
	const struct corner *p = a, *q = b;

	return p->along < q->along ? -1 : p->along > q->along ? 1 :
	       p->n < q->n ? -1 : p->n > q->n;
}

static float *corner_at(const struct stl_raw *raw, uint32_t n)
{
	return raw->corner[n / 3][n % 3];
}

static double apart(const struct stl_raw *raw, uint32_t a, uint32_t b)
{
	const float *p = corner_at(raw, a), *q = corner_at(raw, b);
	const double d[3] = { (double)p[0] - (double)q[0],
			      (double)p[1] - (double)q[1],
			      (double)p[2] - (double)q[2] };

	return v_length(d);
}

static uint32_t root_of(uint32_t *root, uint32_t n)
{
	while (root[n] != n) {
		root[n] = root[root[n]];
		n = root[n];
	}
	return n;
}

/* Each corner's root is the first corner in the file that it becomes. */
static void join(const struct stl_raw *raw, const struct corner *sorted,
		 uint32_t *root, double within)
{
	const uint32_t n = 3 * raw->n;

	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t k = i + 1; k < n && sorted[k].along -
		     sorted[i].along <= within; k++) {
			const uint32_t a = root_of(root, sorted[i].n);
			const uint32_t b = root_of(root, sorted[k].n);

			if (a != b && apart(raw, sorted[i].n, sorted[k].n) <=
				      within)
				root[a > b ? a : b] = a > b ? b : a;
		}
	}
}

static void put(struct stl_raw *raw, uint32_t *root, struct stl_welded *ret)
{
	for (uint32_t i = 0; i < 3 * raw->n; i++) {
		const uint32_t to = root_of(root, i);
		const double by = apart(raw, i, to);

		ret->moved += by > 0;
		ret->most = fmax(ret->most, by);
		for (int k = 0; k < 3; k++)
			corner_at(raw, i)[k] = corner_at(raw, to)[k];
	}
}

int stl_raw_weld(struct stl_raw *raw, double within, struct stl_welded *ret)
{
	const size_t n = 3 * (size_t)raw->n;
	struct corner *sorted = malloc(n * sizeof(*sorted));
	uint32_t *root = malloc(n * sizeof(*root));

	*ret = (struct stl_welded) { .moved = 0 };
	if (sorted && root) {
		for (uint32_t i = 0; i < n; i++) {
			const float *p = corner_at(raw, i);

			root[i] = i;
			sorted[i] = (struct corner) {
				.n = i,
				.along = (double)p[0] * oblique[0] +
					 (double)p[1] * oblique[1] +
					 (double)p[2] * oblique[2],
			};
		}
		qsort(sorted, n, sizeof(*sorted), by_place);
		join(raw, sorted, root, within);
		put(raw, root, ret);
	}
	free(sorted);
	free(root);
	return sorted && root ? 0 : EX_OSERR;
}
