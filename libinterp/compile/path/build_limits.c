/* SPDX-License-Identifier: Apache-2.0 */
/* build_limits.c - the limits of a program, if it is long while it is made */
#include "path/build_limits.h"

#include "both.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* A shorter program is done before a thread has begun. */
#define LONG		8192		/* segments */

/* After so many more the thread is told ... */
#define STEP		4096
/* ... or it is asked whether the place is passed where the program begins. */
#define STEP_BEFORE	16

uint32_t build_threads(const struct interp_build *b)
{
	return b->segs.n < LONG ? 1 :
	       b->o.threads ? b->o.threads : both_processors();
}

static struct interp_limits limits_of(const struct interp_build *b,
				      uint32_t threads)
{
	const struct interp_build_options *o = &b->o;

	return (struct interp_limits) {
		.machine = o->machine,
		.corner_mm = o->corner_mm > 0 ? o->corner_mm :
						INTERP_CORNER_MM,
		.tolerance_mm = o->tolerance_mm > 0 ? o->tolerance_mm :
						      INTERP_TOLERANCE_MM,
		.rotary_radius_mm = o->rotary_radius_mm > 0 ?
				    o->rotary_radius_mm : INTERP_ROTARY_MM,
		.points_per_s = o->points_per_s > 0 ? o->points_per_s :
						      INFINITY,
		.threads = threads,
	};
}

/* Lines that are held back may be joined to curves, and these be taken back. */
static bool may_follow(const struct interp_build *b)
{
	return b->pieces.n == 0 && !(b->o.fit_mm > 0) &&
	       (!b->o.begins_inside || b->inside.done) &&
	       build_threads(b) > 1;
}

static void note_tables(struct interp_build *b)
{
	b->seen.segs = b->segs.at;
	b->seen.nodes = b->nodes.at;
	b->seen.arcs = b->arcs.at;
	b->seen.couples = b->couples.at;
}

static void follow(struct interp_build *b)
{
	const struct interp_limits l = limits_of(b, 2);
	struct interp_program_head *h = &b->seen_head;

	h->naxes = b->naxes;
	memcpy(h->column, b->column, sizeof(h->column));
	for (int i = 0; i < INTERP_NAXES; i++)
		h->pulse_mm[i] = b->o.machine->axis[i].pulse_mm;
	b->seen.head = h;
	note_tables(b);
	b->follow = follow_begin(&l, &b->seen, b->segs.at);
	if (!b->follow)
		b->o.threads = 1;
}

/* A thread does not see curves. */
static void tell(struct interp_build *b)
{
	if (b->follow && b->pieces.n == 0)
		follow_known(b->follow, (uint32_t)b->segs.n);
}

/* A part of the room of the segments is given out, so that the thread is told
 * without a look at each of them. */
int build_segs_room(struct interp_build *b)
{
	struct table *t = &b->segs;
	size_t step;

	if (build_early(b) < 0)
		return -ENOMEM;
	t->room = b->segs_room;
	if (t->n == t->room && build_seen_room(b, t, 1) < 0)
		return -ENOMEM;
	b->segs_room = t->room;
	step = b->o.from && !b->inside.tried ? STEP_BEFORE : STEP;
	if (t->room > t->n + step)
		t->room = t->n + step;
	if (!b->follow && may_follow(b))
		follow(b);
	tell(b);
	return 0;
}

int build_seen_room(struct interp_build *b, struct table *t, size_t n)
{
	int err;

	if (b->follow)
		follow_hold(b->follow);
	err = build_table_room(t, n);
	note_tables(b);
	if (b->follow)
		follow_go_on(b->follow, b->segs.at);
	return err;
}

void build_limits_await(struct interp_build *b)
{
	tell(b);
	if (b->follow)
		follow_await(b->follow);
}

void build_limits_stop(struct interp_build *b)
{
	follow_stop(b->follow);
	b->follow = NULL;
}

void build_limits_write(struct interp_build *b, const struct interp_program *p,
			struct interp_seg *segs, struct interp_bends *bends,
			uint32_t threads)
{
	const struct interp_limits l = limits_of(b, threads);

	if (b->follow)
		follow_write(b->follow, p, segs, bends);
	else
		interp_limits_write(&l, p, segs, bends);
	b->follow = NULL;
}
