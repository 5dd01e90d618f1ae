/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_pair_add.c - adds two contours as a segment, and their plan to the
 * tables
 */
#include "path/builder.h"
#include "path/build_pair.h"
#include "path/build_edge.h"
#include "pulse/pulse.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#define XY	(1u << INTERP_X | 1u << INTERP_Y)
#define UV	(1u << INTERP_U | 1u << INTERP_V)

/* What a seek along contour @i begins at. */
static int places_add(struct interp_build *b, const struct build_pair *p, int i,
		      struct interp_arc *arc)
{
	struct table *t = &b->runs;
	const size_t n = (size_t)circle_places(arc) * CIRCLE_PLACE;

	arc->run_at = (uint32_t)t->n;
	if (n == 0)
		return 0;
	if (build_table_room(t, n) < 0)
		return -ENOMEM;
	circle_keep_places(arc, p->start[i], p->end[i],
			   (int32_t *)t->at + t->n);
	t->n += n;
	return t->n > UINT32_MAX ? -ENOMEM : 0;
}

/* Add the couple and its bits to the tables. */
static int couple_add(struct interp_build *b, const struct build_pair *p)
{
	const size_t words = p->bits ? pulse_string_words(p->ticks) : 0;
	struct interp_couple *c = build_table_add(&b->couples);

	if (!c)
		return -ENOMEM;
	*c = p->couple;
	c->bits_at = b->bits.n;
	for (int i = 0; i < 2; i++)
		if (places_add(b, p, i, &c->side[i]) < 0)
			return -ENOMEM;
	for (size_t i = 0; i < words; i++) {
		uint64_t *w = build_table_add(&b->bits);

		if (!w)
			return -ENOMEM;
		*w = p->bits[i];
	}
	return 0;
}

int build_pair_add(struct interp_build *b, const struct build_pair *p,
		   const struct interp_build_word *w, struct interp_diag *diag)
{
	struct interp_seg seg = { .kind = INTERP_PAIR, .ticks = p->ticks,
				  .length_mm = p->length_mm,
				  .arg = (uint32_t)b->couples.n };

	build_stand_at(b, p->end_mm, p->to_sub);
	build_seg_feed(&seg, w, p->feed_max_mm_s);
	if (!w->rapid)
		seg.feed_mm_s *= (float)(p->length_mm / p->fed_mm);
	b->descent.axis = -1;
	b->stand_escape = 0;
	if (build_columns(b, XY | UV) < 0 || couple_add(b, p) < 0)
		return -ENOMEM;
	return build_seg_finish(b, &seg, w, diag);
}

static int refuse_others(struct interp_diag *diag)
{
	return interp_diag_say(diag, "another axis beside two contours; X Y U "
			       "V alone");
}

/* Only one contour moves, the other stands still.  Return: -ENOENT if both
 * move. */
static int pair_alone(struct interp_build *b, const struct build_pair *p,
		      const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	const struct interp_build_contour *c = p->contour;
	const int i = p->moved & XY || c[0].arc ? 0 : 1;
	const struct interp_build_arc arc = {
		.axis_a = i ? INTERP_U : INTERP_X,
		.axis_b = i ? INTERP_V : INTERP_Y,
		.centre_a_mm = c[i].centre_mm[0],
		.centre_b_mm = c[i].centre_mm[1], .sweep = c[i].sweep,
	};
	const bool other = i == 0 && (p->moved & ~XY || c[1].arc);

	if (other && (c[0].arc || c[1].arc ||
		      !pulse_strategy(b->o.strategy)->at_once))
		return -ENOENT;
	return c[i].arc ? interp_build_arc(b, end_mm, &arc, w, diag) :
			  interp_build_line(b, end_mm, w, diag);
}

int interp_build_pair(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_contour contour[2],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	int64_t to[INTERP_NAXES];
	struct build_pair plan = { .walks = b, .machine = b->o.machine,
				   .contour = contour,
				   .strategy = b->o.strategy,
				   .end_mm = end_mm, .to_sub = to,
				   .loose = b->loose };
	struct build_measure m;
	int err = build_measure_next(b, end_mm, to, &m, diag);

	if (err < 0)
		return err;
	if (m.moved & ~(XY | UV))
		return refuse_others(diag);
	plan.moved = m.moved;
	err = pair_alone(b, &plan, end_mm, w, diag);
	if (err != -ENOENT)
		return err;
	if (b->again.counts) {
		build_stand_at(b, end_mm, to);
		return build_walk(b, (double)(m.longest >> INTERP_SUB_BITS),
				  diag);
	}
	build_mm(b, BUILD_ALL_AXES, b->here, plan.from_mm);
	build_mm(b, BUILD_ALL_AXES, to, plan.to_mm);
	for (int i = 0; i < INTERP_NAXES; i++) {
		plan.from[i] = interp_round_sub(b->here[i]);
		plan.to[i] = interp_round_sub(to[i]);
	}
	plan.longest_sub = m.longest;
	err = build_pair_plan(&plan, diag);
	if (err == 0 && !pulse_strategy(b->o.strategy)->at_once)
		err = build_walk(b, plan.ticks, diag);
	if (err == 0 && plan.near_edge)
		err = build_walk(b, BUILD_EDGE_POINTS, diag);
	if (err == 0 && plan.near_edge)
		err = build_edge_look(b, &(struct build_edge) {
				      .pair = &plan, .word = w }, diag);
	/* Two circles of less than a pulse go nowhere, as a line without
	 * length. */
	if (err == 0 && plan.ticks == 0)
		build_stand_at(b, end_mm, to);
	else if (err == 0)
		err = build_pair_add(b, &plan, w, diag);
	free(plan.bits);
	return err;
}
