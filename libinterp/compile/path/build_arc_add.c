/* SPDX-License-Identifier: Apache-2.0 */
/* build_arc_add.c - adds an arc as a segment, and its plan to the tables */
#include "path/builder.h"
#include "path/build_arc.h"
#include "path/build_edge.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <stdlib.h>

/* The runs of an arc that stores them, and what a seek begins at. */
static int runs_add(struct interp_build *b, const struct build_arc *plan,
		    struct interp_arc *arc)
{
	struct table *t = &b->runs;
	const uint64_t n = build_arc_kept(plan);

	arc->run_at = (uint32_t)t->n;
	if (n == 0)
		return 0;
	if (build_table_room(t, n) < 0)
		return -ENOMEM;
	build_arc_runs(plan, arc, (int32_t *)t->at + t->n);
	t->n += n;
	return t->n > UINT32_MAX ? -ENOMEM : 0;
}

int build_arc_add(struct interp_build *b, const struct build_arc *p,
		  const struct interp_build_word *w, struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_ARC, .ticks = p->ticks,
				  .length_mm = p->length_mm };
	struct interp_arc *arc;

	build_seg_feed(&seg, w, p->feed_max_mm_s);
	if (build_columns(b, p->moved) < 0)
		return -ENOMEM;
	seg.arg = (uint32_t)b->arcs.n;
	arc = build_table_add(&b->arcs);
	if (!arc)
		return -ENOMEM;
	*arc = p->arc;
	if (runs_add(b, p, arc) < 0)
		return -ENOMEM;
	build_descend(b, p->moved, p->end_mm);
	b->stand_escape = b->escape;
	build_stand_at(b, p->end_mm, p->to_sub);
	return build_seg_finish(b, &seg, w, diag);
}

/* What was walked to plan it, and will be at the end of the travel. */
static int walk(struct interp_build *b, const struct build_arc *p,
		struct interp_diag *diag)
{
	const bool at_once = pulse_strategy(b->o.strategy)->at_once;
	const int err = at_once ? 0 : build_walk(b, p->ticks, diag);

	return err == 0 && p->near_edge ?
	       build_walk(b, BUILD_EDGE_POINTS, diag) : err;
}

/* The other axes go half of their way. */
static int add_halves(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct build_arc *p,
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	struct interp_build_arc half = *p->word;
	double half_mm[INTERP_NAXES];
	int err;

	for (int i = 0; i < INTERP_NAXES; i++)
		half_mm[i] = (interp_build_here(b)[i] + end_mm[i]) / 2;
	half_mm[half.axis_a] = p->mid_mm[0];
	half_mm[half.axis_b] = p->mid_mm[1];
	half.sweep /= 2;
	err = interp_build_arc(b, half_mm, &half, w, diag);
	return err ? err : interp_build_arc(b, end_mm, &half, w, diag);
}

int interp_build_arc(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_arc *a,
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	int64_t to[INTERP_NAXES];
	struct build_arc plan = { .o = &b->o, .walks = b, .word = a,
				  .loose = b->loose, .end_mm = end_mm,
				  .to_sub = to };
	const uint32_t plane = 1u << a->axis_a | 1u << a->axis_b;
	struct interp_build_arc moved;
	struct build_measure m;
	int err = build_measure_next(b, end_mm, to, &m, diag);

	if (err < 0)
		return err;
	plan.moved = m.moved | plane;
	build_mm(b, plan.moved, b->here, plan.from_mm);
	build_mm(b, plan.moved, to, plan.to_mm);
	plan.way.longest_sub = m.longest;
	if (!pulse_strategy(b->o.strategy)->at_once)
		plan.way = build_way_to(b, to, &m);
	plan.way.except = plane;
	build_arc_shape(&plan);
	switch (build_arc_even(&plan, &moved)) {
	case BUILD_ARC_HALVES:
		return add_halves(b, end_mm, &plan, w, diag);
	case BUILD_ARC_MOVED:
		plan.word = &moved;
		build_arc_shape(&plan);
		break;
	case BUILD_ARC_AS_IT_IS:
		break;
	}
	err = build_arc_plan(&plan, diag);
	if (err < 0)
		return err;
	if (plan.straight)
		return interp_build_line(b, end_mm, w, diag);
	err = walk(b, &plan, diag);
	if (b->again.counts) {
		build_stand_at(b, end_mm, to);
		return err;
	}
	if (err == 0 && plan.near_edge)
		err = build_edge_look(b, &(struct build_edge) {
				      .arc = &plan, .word = w }, diag);
	return err < 0 ? err : build_arc_add(b, &plan, w, diag);
}
