/* SPDX-License-Identifier: Apache-2.0 */
/* build_curve_check.c - checks a NURBS before it is cut into pieces */
#include "path/build_arc.h"
#include "path/build_curve.h"
#include "path/builder.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

/* So many places of a span are looked at before any other work. */
#define FIRST_LOOKS	64

#define START_PULSES	2.0

int build_curve_refuse(struct curve_plan *p, const char *found,
		       const char *wanted)
{
	return interp_diag_say(p->diag, "%s; %s", found, wanted);
}

void build_curve_blame(struct curve_plan *p, double u)
{
	const struct interp_build_curve *c = p->c;
	size_t i = 0;

	while (i + 1 < c->nmarks && c->marks[i + 1].u <= u)
		i++;
	if (c->nmarks > 0)
		p->diag->line = c->marks[i].line;
}

static int refuse_flaw(struct curve_plan *p, enum interp_nurbs_flaw f,
		       uint32_t at)
{
	const struct interp_build_curve *c = p->c;
	const bool numbered = f == INTERP_NURBS_BAD_WEIGHT ||
			      f == INTERP_NURBS_WEIGHTS_PART ||
			      f == INTERP_NURBS_NOT_FINITE ||
			      f == INTERP_NURBS_KNOT_FALLS ||
			      f == INTERP_NURBS_KNOTS_NEAR ||
			      f == INTERP_NURBS_KNOT_REPEATS;
	char found[sizeof(p->diag->found)];

	snprintf(found, sizeof(found), "%s, number %u of the curve's",
		 interp_nurbs_flaw_text(f), at + 1);
	/* As long as there are points, point and knot of the same number stand
	 * in one block, and the line is that of the point. */
	if (numbered && c->nmarks == c->nurbs.npoints && at < c->nmarks)
		p->diag->line = c->marks[at].line;
	return build_curve_refuse(p, numbered ? found :
				     interp_nurbs_flaw_text(f),
				  interp_nurbs_flaw_wanted(f));
}

int build_curve_check_start(struct curve_plan *p)
{
	const struct interp_nurbs *c = &p->walk.eval.c;
	const bool loose = c->knots[0] != c->knots[c->degree];
	struct interp_nurbs_point at;

	interp_nurbs_at(&p->walk.eval, interp_nurbs_first(c), 0, &at);
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const int axis = p->curve.axis[k];
		const double off = at.d[0][k] - p->here_mm[axis];
		char found[sizeof(p->diag->found)];

		if (fabs(off) * p->pulses_mm[axis] <= START_PULSES)
			continue;
		snprintf(found, sizeof(found), "a curve that begins at %c %.4f,"
			 " not where the program stands: %.4f",
			 INTERP_AXIS_LETTERS[axis], at.d[0][k],
			 p->here_mm[axis]);
		build_curve_blame(p, interp_nurbs_first(c));
		return build_curve_refuse(p, found, loose ?
			"a first knot that stands as often as the order, or "
			"the program there" :
			"a first point where the last motion ended");
	}
	return 0;
}

static int check_place(struct curve_plan *p, double u)
{
	struct interp_nurbs_point at;

	interp_nurbs_at(&p->walk.eval, u, 0, &at);
	for (uint32_t k = 0; k < p->curve.naxes; k++) {
		const int axis = p->curve.axis[k];

		if (build_axis_ok(p->b, axis, at.d[0][k]))
			continue;
		build_curve_blame(p, u);
		return build_refuse_travel(p->b, axis, at.d[0][k], p->diag);
	}
	return 0;
}

/* A first look along the whole curve: a curve that leads far away is refused
 * before it is cut. */
static int check_travel(struct curve_plan *p)
{
	struct interp_nurbs_eval *e = &p->walk.eval;
	const double end = interp_nurbs_last(&e->c);
	double from = interp_nurbs_first(&e->c), to;
	int err = 0;

	for (; err == 0 && from < end; from = to) {
		err = check_place(p, from);
		to = e->to;
		for (int i = 1; err == 0 && i <= FIRST_LOOKS; i++)
			err = check_place(p, i < FIRST_LOOKS ?
				from + (to - from) * i / FIRST_LOOKS : to);
	}
	return err;
}

int build_curve_check(struct curve_plan *p)
{
	uint32_t at;
	const enum interp_nurbs_flaw f = interp_nurbs_check(&p->c->nurbs, &at);

	return f != INTERP_NURBS_SOUND ? refuse_flaw(p, f, at) : 0;
}

static int check_axes(struct curve_plan *p)
{
	const struct interp_machine *m = p->b->o.machine;

	if ((p->moved & ~m->present) == 0)
		return 0;
	return build_refuse_travel(p->b, __builtin_ctz(p->moved & ~m->present),
				   0, p->diag);
}

int build_curve_check_way(struct curve_plan *p)
{
	int err = check_axes(p);

	if (err == 0)
		err = build_curve_check_start(p);
	return err == 0 ? check_travel(p) : err;
}
