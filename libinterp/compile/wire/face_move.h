/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face_move.h - the outline on the second plane: each piece moved to its side
 *
 *	face_move.c	the raw outline: moved pieces, joined at their corners
 *	face_side.c	which parts of it are the outline of the part
 *
 * Units: mm.  Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_FACE_MOVE_H
#define WIRE_FACE_MOVE_H

#include "wire/track.h"
#include "wire/wind.h"

/* The raw outline is judged by its sides. */
struct face_side {
	const struct face *still;	/* the outline before it is moved */
	uint32_t first, n;		/* its pieces that are no leads */
	struct wind moved, as_was;
	struct curve back[2];		/* an open outline is closed so */
	uint32_t *id;			/* element to moved curve */
};

/**
 * face_move() - fill @f, which is all zero, with the pieces of @still, each
 * moved by its shift_mm.
 * Return: 0, -ENOMEM, or -EINVAL with @fault filled.
 */
int face_move(struct face *f, const struct face_from *from,
	      const struct face *still, struct face_fault *fault);

/** face_side_init() - after the raw outline was laid. Return: 0 or -ENOMEM. */
int face_side_init(struct face_side *s, const struct track_work *w);

/** face_side_is() - is share @t0 to @t1 of element @e of @w on the outline? */
bool face_side_is(const struct face_side *s, const struct track_work *w,
		  uint32_t e, double t0, double t1);

/** face_side_is_near() - or is the outline no farther than the slack? */
bool face_side_is_near(const struct face_side *s, const struct track_work *w,
		       uint32_t e, double t0, double t1);

void face_side_free(struct face_side *s);

#endif /* WIRE_FACE_MOVE_H */
