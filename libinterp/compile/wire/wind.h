/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wind.h - how often closed curves go round a place
 *
 * The winding number of a place is the number of turns that the curves make
 * round it, counter-clockwise.  It is counted along a ray from the place: +1
 * for a curve that crosses the ray from right to left, -1 for the other sense.
 * An index of rows along both axes holds the number of curves that a ray may
 * meet small.
 *
 * Units: mm.  Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_WIND_H
#define WIRE_WIND_H

#include "wire/curve.h"

#include <stddef.h>
#include <stdint.h>

/* Curves by the rows that they pass, along one axis. */
struct wind_rows {
	double low, size;
	uint32_t n;
	uint32_t *start;		/* of row i in id[]; n + 1 of them */
	uint32_t *id;
};

struct wind {
	struct curve *c;
	uint32_t n;
	size_t room;
	struct wind_rows rows[2];	/* rays to +X, to +Y */
};

#define WIND_NO_CURVE	UINT32_MAX

/** wind_add() - one more curve.  It begins where the one before it ends, but
 *  for rounding. Return: 0 or -ENOMEM. */
int wind_add(struct wind *w, const struct curve *c);

/** wind_ready() - after the last wind_add(), which ends where the first one
 *  begins.  Return: 0 or -ENOMEM. */
int wind_ready(struct wind *w);

/** wind_at() - the winding number at a place off the curves. */
int wind_at(const struct wind *w, struct vec at);

/** wind_left() - the winding number just to the left of share @t of @c, which
 *  is a part of curve @id, or @id is WIND_NO_CURVE. */
int wind_left(const struct wind *w, const struct curve *c, double t,
	      uint32_t id);

/** wind_free() - it may be all zero. */
void wind_free(struct wind *w);

#endif /* WIRE_WIND_H */
