/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_edge.c - does an arc stay within the travel, at each lattice point?
 *
 * A circle that touches the end of the travel is inside, but its lattice points
 * may not be: they are rounded, and a strategy that moves one axis at a time
 * goes to both sides of the circle.  How far it goes just there, only the walk
 * tells.
 */
#include "path/build_edge.h"
#include "path/build_arc.h"
#include "path/builder.h"

#include "interp/cursor.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* A builder that stands there, too, and minds no travel. */
static struct interp_build *stand_there(const struct interp_build *b)
{
	struct interp_build_options o = b->o;
	struct interp_build *alone;

	o.fit_mm = 0;
	alone = interp_build_create(&o);
	if (!alone)
		return NULL;
	memcpy(alone->here_mm, b->here_mm, sizeof(b->here_mm));
	memcpy(alone->here, b->here, sizeof(b->here));
	memcpy(alone->first, b->here, sizeof(b->here));
	alone->loose = BUILD_ALL_AXES;
	return alone;
}

/* Return: the block of a program that has only this; NULL with an error. */
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
	*err = e->arc ? interp_build_arc(alone, e->end_mm, e->arc, e->word,
					 diag) :
			interp_build_pair(alone, e->end_mm, e->contour,
					  e->word, diag);
	bytes = interp_build_bytes(alone);
	if (*err == 0) {
		block = malloc(bytes);
		*err = block ? 0 : -ENOMEM;
	}
	if (block) {
		interp_build_write(alone, &about, block);
		*err = interp_program_map(ret, block, bytes);
	}
	interp_build_destroy(alone);
	return block;
}

static int try_point(const struct interp_build *b,
		     const struct interp_cursor *c, struct interp_diag *diag)
{
	const struct interp_machine *m = b->o.machine;

	for (uint32_t axes = c->moved; axes; axes &= axes - 1) {
		const int axis = __builtin_ctz(axes);
		const double at = c->pos[axis] * m->axis[axis].pulse_mm;

		if (!build_axis_ok(b, axis, at))
			return build_refuse_travel(m, axis, at, diag);
	}
	return 0;
}

static int walk(const struct interp_build *b, const struct interp_program *p,
		struct interp_diag *diag)
{
	struct interp_cursor c;
	int err = interp_cursor_init(&c, p);

	if (err < 0)
		return err;
	interp_cursor_aim(&c, p->head->length_mm);
	while (err == 0 && interp_cursor_step(&c) == INTERP_MOVED)
		err = try_point(b, &c, diag);
	return err;
}

int build_edge_walk(const struct interp_build *b, const struct build_edge *e,
		    struct interp_diag *diag)
{
	struct interp_program p;
	int err;
	void *block = block_of(b, e, &p, &err, diag);

	if (err == 0)
		err = walk(b, &p, diag);
	free(block);
	return err;
}
