/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_edge.c - does an arc stay within the travel, at each lattice point?
 *
 * A circle that touches the end of the travel is inside, but its lattice points
 * may not be: they are rounded, and a strategy that moves one axis at a time
 * goes to both sides of the circle.  How far it goes just there, only the walk
 * tells.
 *
 * In a tick an axis makes a pulse at most.  So where it is n pulses from the
 * end of its travel, the next n ticks stay inside, and are left out.  A circle
 * of radius R that touches the end takes about the root of R looks.
 */
#include "path/build_edge.h"
#include "path/builder.h"

#include "interp/cursor.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As many ticks are walked faster than they are sought. */
#define NEAR_TICKS	32

/* -- The travel ------------------------------------------------------------ */

struct look {
	const struct interp_build *b;
	struct interp_diag *diag;
	struct interp_cursor c;		/* at the start of the arc */
};

static bool try_axis(const struct look *l, int axis, int64_t at, double *room)
{
	const struct interp_machine *m = l->b->o.machine;
	double ends[2];

	build_travel(l->b, axis, ends);
	if ((double)at < ends[0] || (double)at > ends[1]) {
		build_refuse_travel(l->b, axis,
				    (double)at * m->axis[axis].pulse_mm,
				    l->diag);
		return false;
	}
	*room = fmin(*room, fmin((double)at - ends[0], ends[1] - (double)at));
	return true;
}

/* Return: how many ticks on is the next point to look at; 0 if this one is
 * outside. */
static uint32_t try_plane(const struct look *l, const struct interp_arc *arc,
			  int64_t a, int64_t b)
{
	double room = INTERP_PULSES_MAX;

	if (!try_axis(l, arc->axis_a, a, &room) ||
	    !try_axis(l, arc->axis_b, b, &room))
		return 0;
	return room < 1 ? 1 : (uint32_t)room;
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

/* -- A circle, one axis at a time ------------------------------------------ */

/* A run is straight, so its end tells. */
static int look_along_runs(const struct look *l, const struct interp_arc *arc,
			   const struct interp_circle *k)
{
	int64_t at[2] = { l->c.pos[arc->axis_a], l->c.pos[arc->axis_b] };

	for (uint32_t i = 0; i < k->nruns; i++) {
		at[(i + k->run_first) & 1] += k->runs[i];
		if (!try_plane(l, arc, at[0], at[1]))
			return -EINVAL;
	}
	return 0;
}

static int look_along_circle(const struct look *l, const struct interp_arc *arc,
			     const struct interp_circle *start)
{
	const int64_t a = l->c.pos[arc->axis_a] - start->x;
	const int64_t b = l->c.pos[arc->axis_b] - start->y;
	uint32_t tick = 0, room = 1;

	if (start->runs)
		return look_along_runs(l, arc, start);
	while (tick < start->ticks) {
		struct interp_circle k = *start;

		tick += least(room, start->ticks - tick);
		if (!circle_stand(&k, tick))
			return -EBADMSG;
		room = try_plane(l, arc, a + k.x, b + k.y);
		if (!room)
			return -EINVAL;
	}
	return 0;
}

static int look_along_sides(const struct look *l)
{
	int err = 0;

	for (int i = 0; i < 2 && err == 0; i++) {
		if (l->c.side[i].arc)
			err = look_along_circle(l, &l->c.couple.side[i],
						&l->c.side[i].circle);
	}
	return err;
}

/* -- All axes at once ------------------------------------------------------ */

static bool go_on(struct interp_cursor *c, uint32_t ticks)
{
	uint16_t pulses[NEAR_TICKS];
	const uint32_t to = c->tick + least(ticks, c->seg.ticks - c->tick);

	if (ticks > NEAR_TICKS)
		return interp_cursor_seek(c, c->index, to) == 0;
	interp_cursor_aim(c, c->seg.length_mm);
	interp_cursor_run(c, pulses, ticks);
	return c->walk;
}

/* One arc, or those of two contours. */
static uint32_t try_arcs(const struct look *l)
{
	const struct interp_cursor *c = &l->c;
	const bool pair = c->seg.kind == INTERP_PAIR;
	const struct interp_arc *arc = pair ? c->couple.side : &c->arc;
	uint32_t room = UINT32_MAX;

	for (int i = 0; i <= pair && room > 0; i++, arc++) {
		if (arc->r_mm > 0)
			room = least(room, try_plane(l, arc,
						     c->pos[arc->axis_a],
						     c->pos[arc->axis_b]));
	}
	return room;
}

static int look_at_once(struct look *l)
{
	uint32_t room = 1;

	while (l->c.tick < l->c.seg.ticks) {
		if (!go_on(&l->c, room))
			return -EBADMSG;
		room = try_arcs(l);
		if (!room)
			return -EINVAL;
	}
	return 0;
}

static int look_along(struct look *l)
{
	const struct interp_walk *w = l->c.walk;

	if (w == &pulse_circle || w == &pulse_helix)
		return look_along_circle(l, &l->c.arc, &l->c.circle);
	if (w == &pulse_pair)
		return look_along_sides(l);
	return look_at_once(l);
}

/* -- A program that has only this ------------------------------------------ */

/* A builder that stands there, too, and minds no travel. */
static struct interp_build *stand_there(const struct interp_build *b)
{
	struct interp_build_options o = b->o;
	struct interp_build *alone;

	o.memory = NULL;
	alone = interp_build_create(&o);
	if (!alone)
		return NULL;
	memcpy(alone->here_mm, b->here_mm, sizeof(b->here_mm));
	memcpy(alone->here, b->here, sizeof(b->here));
	memcpy(alone->first, b->here, sizeof(b->here));
	alone->loose = BUILD_ALL_AXES;
	return alone;
}

/* Return: its block; NULL with an error. */
static void *block_of(const struct interp_build *b, const struct build_edge *e,
		      struct interp_program *ret, int *err,
		      struct interp_diag *diag)
{
	const struct interp_build_about about = { .lines = 1 };
	struct interp_build *alone = stand_there(b);
	void *block = NULL;
	size_t bytes;

	*err = -ENOMEM;
	if (!alone)
		return NULL;
	*err = e->arc ? build_arc_add(alone, e->arc, e->word, diag) :
			build_pair_add(alone, e->pair, e->word, diag);
	if (*err == 0) {
		block = interp_build_take(alone, &about, &bytes);
		*err = block ? interp_program_map(ret, block, bytes) : -ENOMEM;
	}
	interp_build_destroy(alone);
	return block;
}

int build_edge_look(const struct interp_build *b, const struct build_edge *e,
		    struct interp_diag *diag)
{
	struct look l = { .b = b, .diag = diag };
	struct interp_program p;
	int err;
	void *block = block_of(b, e, &p, &err, diag);

	if (err == 0)
		err = interp_cursor_init(&l.c, &p);
	if (err == 0)
		err = interp_cursor_seek(&l.c, 1, 0);
	if (err == 0)
		err = look_along(&l);
	free(block);
	return err;
}
