/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_curve_store.c - stores a NURBS in the program
 *
 * Columns that stand still are left out.  The axes that count for the length
 * come first: the linear axes, as elsewhere.  The others count a little, so
 * that a stretch where only they move has a length that can be walked; more
 * where they need it (build_curve.c).
 */
#include "path/build_curve.h"
#include "path/builder.h"

#include <errno.h>
#include <math.h>

#define OTHERS	1e-3			/* their weight in the length */

struct store {
	struct interp_build *b;
	const struct interp_build_curve *c;
	struct interp_curve curve;
	uint32_t moved;
};

static bool column_moves(const struct interp_nurbs *n, uint32_t j)
{
	const size_t row = n->naxes + 1;
	const double first = n->points[j] / n->points[n->naxes];

	for (uint32_t i = 1; i < n->npoints; i++) {
		const double *q = n->points + i * row;

		if (fabs(q[j] / q[n->naxes] - first) >
		    1e-12 * (1 + fabs(first)))
			return true;
	}
	return false;
}

/* Axes whose motion makes the length, as program.h says. */
static uint32_t counted_axes(uint32_t moved)
{
	const uint32_t xyz = 1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_Z;
	const uint32_t uv = 1u << INTERP_U | 1u << INTERP_V;

	return moved & xyz ? xyz : moved & uv ? uv : ~0u;
}

/* The columns that move; those that count come first. */
static uint32_t order(struct store *p, uint32_t from[INTERP_NAXES])
{
	const struct interp_nurbs *n = &p->c->nurbs;
	uint32_t counted, k = 0;

	p->moved = 0;
	for (uint32_t j = 0; j < n->naxes; j++)
		p->moved |= (uint32_t)column_moves(n, j) << p->c->axis[j];
	counted = counted_axes(p->moved);
	for (int others = 0; others < 2; others++) {
		for (uint32_t j = 0; j < n->naxes; j++) {
			const uint32_t bit = 1u << p->c->axis[j];

			if (p->moved & bit && others == !(counted & bit))
				from[k++] = j;
		}
		if (!others)
			p->curve.counted = k;
	}
	return k;
}

static int number_add(struct store *p, double x)
{
	double *to = build_table_add(&p->b->numbers);

	if (!to)
		return -ENOMEM;
	*to = x;
	return 0;
}

static int store_numbers(struct store *p, const uint32_t from[INTERP_NAXES])
{
	const struct interp_nurbs *n = &p->c->nurbs;
	int err = 0;

	p->curve.knots_at = p->b->numbers.n;
	for (uint32_t i = 0; err == 0 && i <= n->npoints + n->degree; i++)
		err = number_add(p, n->knots[i]);
	p->curve.points_at = p->b->numbers.n;
	for (uint32_t i = 0; err == 0 && i < n->npoints; i++) {
		const double *row = n->points + (size_t)i * (n->naxes + 1);

		for (uint32_t k = 0; err == 0 && k < p->curve.naxes; k++)
			err = number_add(p, row[from[k]]);
		err = err == 0 ? number_add(p, row[n->naxes]) : err;
	}
	return err;
}

int build_curve_store(struct interp_build *b,
		      const struct interp_build_curve *c,
		      struct interp_curve *ret, uint32_t *ret_moved)
{
	const struct interp_nurbs *n = &c->nurbs;
	struct store s = { .b = b, .c = c };
	struct interp_curve *stored;
	uint32_t from[INTERP_NAXES];

	s.curve = (struct interp_curve) {
		.degree = n->degree, .npoints = n->npoints, .others = OTHERS,
	};
	s.curve.naxes = order(&s, from);
	for (uint32_t k = 0; k < s.curve.naxes; k++)
		s.curve.axis[k] = c->axis[from[k]];
	*ret = s.curve;
	*ret_moved = s.moved;
	if (s.curve.naxes == 0)
		return 0;
	stored = build_table_add(&b->curves);
	if (!stored || store_numbers(&s, from) < 0)
		return -ENOMEM;
	*ret = *stored = s.curve;
	return 0;
}
