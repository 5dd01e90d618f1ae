/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_escape.c - ways out that leave the path
 *
 * Straight up is free where the electrode came straight down: along one axis
 * only, without a motion of another axis in between.  How far it came is
 * recorded while the path is built, so no search is needed.
 */
#include "path/builder.h"

#include <errno.h>
#include <math.h>
#include <string.h>

void build_descend_one(struct interp_build *b, int axis,
		       const double end_mm[INTERP_NAXES])
{
	struct build_descent *d = &b->descent;

	if (interp_axis_is_rotary((enum interp_axis)axis)) {
		d->axis = -1;
		return;
	}
	if (d->axis != axis) {
		d->axis = axis;
		d->first_mm = d->low_mm = d->high_mm = b->here_mm[axis];
	}
	d->low_mm = fmin(d->low_mm, end_mm[axis]);
	d->high_mm = fmax(d->high_mm, end_mm[axis]);
}

double interp_build_came_mm(const struct interp_build *b, int axis, int side)
{
	const struct build_descent *d = &b->descent;

	if (d->axis != axis)
		return b->here_mm[axis];
	return side < 0 ? d->low_mm : d->high_mm;
}

void interp_build_lift(struct interp_build *b, int axis)
{
	b->lift_axis = axis;
}

/* What is given as 0 is not limited yet. */
static double lower(double given, double axis)
{
	return given > 0 ? fmin(given, axis) : axis;
}

/* As the weakest of its linear axes. */
static void bound(const struct interp_build *b, struct interp_escape *e)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &b->o.machine->axis[i];

		if (!((e->home | e->out) & 1u << i) ||
		    interp_axis_is_rotary((enum interp_axis)i))
			continue;
		e->v_max_mm_s = lower(e->v_max_mm_s, l->v_max_mm_s);
		e->a_max_mm_s2 = lower(e->a_max_mm_s2, l->a_max_mm_s2);
		e->j_max_mm_s3 = lower(e->j_max_mm_s3, l->j_max_mm_s3);
	}
}

/* So many of the last ones are searched for an equal one. */
#define LOOK_BACK	8

static int escape_add(struct interp_build *b, const struct interp_escape *e)
{
	struct interp_escape *at = b->escapes.at;
	const size_t n = b->escapes.n;

	for (size_t i = n; i-- > 0 && i + LOOK_BACK >= n; ) {
		if (memcmp(&at[i], e, sizeof(*e)) == 0)
			return (int)i;
	}
	if (b->escapes.n > UINT16_MAX)
		return 0;
	at = build_table_add(&b->escapes);
	if (!at)
		return -ENOMEM;
	*at = *e;
	return (int)b->escapes.n - 1;
}

int interp_build_escape(struct interp_build *b, const struct interp_escape *e)
{
	struct interp_escape bounded;
	int i;

	b->escape = 0;
	if (!e)
		return 0;
	bounded = *e;
	bound(b, &bounded);
	i = escape_add(b, &bounded);
	if (i < 0)
		return i;
	b->escape = (uint16_t)i;
	return 0;
}

/*
 * The way out is on the side from which the electrode came to this line, if the
 * whole motion lies on the other side.  Otherwise new ground lies inside.
 */
uint16_t build_escape_lift(struct interp_build *b,
			   const double end_mm[INTERP_NAXES])
{
	const struct build_descent *d = &b->descent;
	const int axis = b->lift_axis;
	struct interp_escape e = { .out = 1u << axis };
	int i;

	if (d->first_mm >= fmax(b->here_mm[axis], end_mm[axis]))
		e.out_mm[axis] = d->high_mm;
	else if (d->first_mm <= fmin(b->here_mm[axis], end_mm[axis]))
		e.out_mm[axis] = d->low_mm;
	else if (end_mm[axis] <= d->low_mm)
		e.out_mm[axis] = d->high_mm;
	else if (end_mm[axis] >= d->high_mm)
		e.out_mm[axis] = d->low_mm;
	else
		return 0;
	bound(b, &e);
	i = escape_add(b, &e);
	return i < 0 ? 0 : (uint16_t)i;
}
