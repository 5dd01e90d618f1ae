/* SPDX-License-Identifier: Apache-2.0 */
/* build_arc_add.c - adds an arc as a segment, and its plan to the tables */
#include "path/build_arc.h"
#include "path/build_edge.h"
#include "path/builder.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <stdlib.h>

/* The runs of an arc that stores them. */
static int runs_add(struct interp_build *b, const struct build_arc *plan,
		    struct interp_arc *arc)
{
	struct table *t = &b->runs;

	arc->run_at = (uint32_t)t->n;
	if (arc->nruns == 0)
		return 0;
	if (build_table_room(t, arc->nruns) < 0)
		return -ENOMEM;
	build_arc_runs(plan, arc, (int32_t *)t->at + t->n);
	t->n += arc->nruns;
	return t->n > UINT32_MAX ? -ENOMEM : 0;
}

int interp_build_arc(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_arc *a,
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_ARC };
	struct build_arc plan = { .o = &b->o, .word = a, .loose = b->loose };
	const uint32_t plane = 1u << a->axis_a | 1u << a->axis_b;
	int64_t to[INTERP_NAXES];
	struct interp_arc *arc;
	struct build_measure m;
	int err = build_measure_next(b, end_mm, to, &m, diag);

	if (err < 0)
		return err;
	build_mm(b, m.moved | plane, b->here, plan.from_mm);
	build_mm(b, m.moved | plane, to, plan.to_mm);
	plan.way.longest_sub = m.longest;
	if (!pulse_strategy(b->o.strategy)->at_once)
		plan.way = build_way_to(b, to, &m);
	plan.way.except = plane;
	err = build_arc_plan(&plan, diag);
	if (err < 0)
		return err;
	if (plan.straight)
		return interp_build_line(b, end_mm, w, diag);
	if (plan.near_edge)
		err = build_edge_walk(b, &(struct build_edge) {
			.end_mm = end_mm, .arc = a, .word = w }, diag);
	if (err < 0)
		return err;
	seg.ticks = plan.ticks;
	seg.length_mm = plan.length_mm;
	build_seg_feed(&seg, w, plan.feed_max_mm_s);
	if (build_columns(b, m.moved | plane) < 0)
		return -ENOMEM;
	seg.arg = (uint32_t)b->arcs.n;
	arc = build_table_add(&b->arcs);
	if (!arc)
		return -ENOMEM;
	*arc = plan.arc;
	if (runs_add(b, &plan, arc) < 0)
		return -ENOMEM;
	build_descend(b, m.moved | plane, end_mm);
	b->stand_escape = b->escape;
	build_stand_at(b, end_mm, to);
	return build_seg_finish(b, &seg, w, diag);
}
