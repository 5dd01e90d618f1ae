/* SPDX-License-Identifier: Apache-2.0 */
/*
 * guide.h - from contours on the two planes to motions of the two guides
 *
 * Threads: allocates through the builder.  Never in the cycle.
 */
#ifndef WIRE_GUIDE_H
#define WIRE_GUIDE_H

#include "interp/build.h"
#include "interp/turn.h"
#include "interp/wire.h"
#include "wire/curve.h"

/* What a guide does: from_bottom * P + from_top * Q. */
struct guide {
	double from_bottom, from_top;
};

struct guides {
	const struct interp_wire *wire;
	struct interp_build *build;
	struct interp_turn turn;	/* of the work, toward the builder */
	struct guide guide[2];		/* of the axes X Y, U V */
	double height_mm;		/* from plane to plane */
	double slope_max;		/* tangent of the largest angle */
	double pulse_mm;
	uint64_t cuts;			/* segments made so far */
};

void guides_init(struct guides *g, const struct interp_wire *w,
		 const struct interp_machine *m, struct interp_build *b);

static inline bool guides_on(const struct guides *g)
{
	return g->wire->guides != INTERP_GUIDES_OFF;
}

/** guides_planes() - where the wire at axes @at_mm crosses the two planes. */
void guides_planes(const struct guides *g, const double at_mm[INTERP_NAXES],
		   struct vec ret[2]);

/**
 * guides_cut() - both contours at once, c[0] at the bottom, c[1] on top; the
 * axes beside X Y U V go to @end_mm.
 * Return: 0, -ENOMEM, or -EINVAL with @diag's found and wanted filled.
 */
int guides_cut(struct guides *g, const struct curve c[2],
	       const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag);

#endif /* WIRE_GUIDE_H */
