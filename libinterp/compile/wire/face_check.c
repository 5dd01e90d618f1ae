/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face_check.c - does the outline on the second plane keep off the programmed one?
 *
 * The outline is joined piece by piece.  Where pieces vanish between others, as
 * the walls of a rib that is lower than the faces move, what lies behind them may
 * be left out with them.  With one sense of taper all round no piece may come
 * nearer to the programmed contour than the least that a face moves; so what is
 * left out wrongly is found, and nothing is cut too deep.
 */
#include "wire/face.h"
#include "wire/grid.h"

#include <errno.h>
#include <math.h>

struct check {
	const struct face_from *from;
	const struct face *f;
	uint32_t piece;			/* asked about */
	double least_mm;
	struct face_fault *fault;
	bool found;
};

/* The least that a face moves; 0 if they move to both sides, or not all. */
static double least_of(const struct face_from *from)
{
	double low = INFINITY, high = -INFINITY;

	for (uint32_t i = 0; i < from->n; i++) {
		const double slope = from->m[from->first + i].slope;

		low = fmin(low, slope * from->height_mm);
		high = fmax(high, slope * from->height_mm);
	}
	return low > 0 ? low : high < 0 ? -high : 0;
}

static bool ask(void *arg, uint32_t id)
{
	struct check *k = arg;
	const struct face_piece *p = &k->f->piece[k->piece];
	const struct contour_motion *m = &k->from->m[k->from->first + id];

	if (curve_gap(&p->c, &m->c[1]) >= k->least_mm)
		return true;
	id += k->from->first;
	*k->fault = (struct face_fault) { p->owner < id ? p->owner : id,
					  p->owner < id ? id : p->owner };
	k->found = true;
	return false;
}

static int enter(struct grid *g, const struct face_from *from, double least)
{
	int err = 0;

	grid_init(g, fmax(least, 0.05), from->m[from->first].c[1].from);
	for (uint32_t i = 0; !err && i < from->n; i++)
		err = grid_add(g, &from->m[from->first + i].c[1], i);
	if (!err)
		grid_sort(g);
	return err;
}

int face_check(const struct face *f, const struct face_from *from,
	       struct face_fault *fault)
{
	struct check k = { .from = from, .f = f, .fault = fault };
	const double least = from->plane ? least_of(from) : 0;
	struct grid g;
	int err;

	k.least_mm = least - 5 * from->pulse_mm;
	if (!(k.least_mm > 0))
		return 0;
	err = enter(&g, from, least);
	for (; !err && !k.found && k.piece < f->n; k.piece++) {
		if (!f->piece[k.piece].lead)
			grid_near(&g, &f->piece[k.piece].c, least, ask, &k);
	}
	grid_free(&g);
	return err ? err : k.found ? -EINVAL : 0;
}
