/* SPDX-License-Identifier: Apache-2.0 */
/* ways.c - the columns of a program, and which of them make its length */
#include "speed/ways.h"

#include "interp/smaller.h"

#include <math.h>

/* The square of what those columns go by that make the length is 1 on each mm
 * of a line, of others before them far less. */
#define COUNTS		0.25

static uint32_t columns_of(const struct interp_program *p, uint32_t axes)
{
	uint32_t columns = 0;

	for (uint32_t j = 0; j < p->head->naxes; j++)
		columns |= (axes >> p->head->column[j] & 1) << j;
	return columns;
}

static double tolerance(const struct interp_limits *l,
			const struct interp_program *p, uint32_t axis)
{
	const double by = interp_axis_is_rotary((enum interp_axis)axis) ?
			  180 / M_PI / l->rotary_radius_mm : 1;

	return larger(p->head->pulse_mm[axis], l->tolerance_mm * by);
}

void ways_init(struct ways *w, const struct interp_limits *l,
	       const struct interp_program *p)
{
	*w = (struct ways) {
		.p = p,
		.xyz = columns_of(p, 1u << INTERP_X | 1u << INTERP_Y |
				     1u << INTERP_Z),
		.uv = columns_of(p, 1u << INTERP_U | 1u << INTERP_V),
	};
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const uint32_t axis = p->head->column[j];

		w->sub_mm[j] = p->head->pulse_mm[axis] / INTERP_SUB;
		w->tol[j] = tolerance(l, p, axis);
	}
}

double ways_rate_off(const struct ways *w, uint32_t i, uint32_t k)
{
	const double size = smaller(larger(fabs(ways_rate(w, i, k)), 1),
				    WAYS_RATE_MOST);

	return w->tol[k] * (1 + size) / w->p->segs[i].length_mm;
}

uint32_t ways_column(const struct interp_program *p, uint32_t axis)
{
	uint32_t j = 0;

	while (j + 1 < p->head->naxes && p->head->column[j] != axis)
		j++;
	return j;
}

/* The axes that make the length of a path, as program.h says. */
static uint32_t along_of(const struct ways *w, uint32_t moving)
{
	return moving & w->xyz ? w->xyz :
	       moving & w->uv ? w->uv : ~(w->xyz | w->uv);
}

/* Those of @columns that make the length of a line: beside others that go much
 * farther they do not. */
static uint32_t counting(const struct ways *w, uint32_t i, uint32_t columns)
{
	double sum = 0;

	for (uint32_t j = 0; j < w->p->head->naxes; j++)
		if (columns >> j & 1) {
			const double by = ways_rate(w, i, j);

			sum += by * by;
		}
	return sum < COUNTS ? 0 : columns;
}

/* Columns that move between the nodes of segment @i. */
static uint32_t moving(const struct ways *w, uint32_t i)
{
	const uint32_t n = w->p->head->naxes;
	const int64_t *a = w->p->nodes + (uint64_t)i * n;
	uint32_t ret = 0;

	for (uint32_t j = 0; j < n; j++)
		ret |= (uint32_t)(a[j] != a[n + j]) << j;
	return ret;
}

static uint32_t curve_along(const struct ways *w, const struct interp_seg *s)
{
	const struct interp_curve *c =
		&w->p->curves[w->p->pieces[s->arg].curve];
	uint32_t axes = 0;

	for (uint32_t k = 0; k < c->naxes && k < INTERP_NAXES; k++)
		axes |= 1u << (c->axis[k] % INTERP_NAXES);
	return along_of(w, columns_of(w->p, axes));
}

uint32_t ways_along(const struct ways *w, uint32_t i)
{
	const struct interp_program *p = w->p;
	const struct interp_seg *s = &p->segs[i];
	uint32_t columns;

	/* All of the axes make it, if any. */
	if (w->xyz == (1u << p->head->naxes) - 1)
		return w->xyz;
	if (s->kind == INTERP_CURVE)
		return curve_along(w, s);
	columns = moving(w, i);
	if (s->kind == INTERP_ARC)
		columns |= columns_of(p, 1u << p->arcs[s->arg].axis_a |
					 1u << p->arcs[s->arg].axis_b);
	if (s->kind == INTERP_PAIR && p->couples[s->arg].side[0].r_mm > 0)
		columns |= columns_of(p, 1u << INTERP_X);
	if (s->kind == INTERP_LINE && columns & ~w->xyz)
		columns &= ~w->xyz | counting(w, i, w->xyz);
	if (s->kind == INTERP_LINE && columns & ~(w->xyz | w->uv))
		columns &= ~w->uv | counting(w, i, w->uv);
	return along_of(w, columns);
}
