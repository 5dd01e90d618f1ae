/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pass.h - one pass over a program, node by node: how fast each may be passed
 *
 * Private to compile/speed.
 */
#ifndef SPEED_PASS_H
#define SPEED_PASS_H

#include "interp/limits.h"
#include "speed/heading.h"

/*
 * A curve of short lines is seen over windows of so many corners' width, either
 * way; each is twice as wide as the one before.
 */
#define PASS_WINDOW	20
#define PASS_WINDOWS	6

/* What a rounding may turn a line of so many tolerances by is small. */
#define PASS_NEAR	20

/* Two nodes so far from here along the path, or a little farther. */
struct around {
	double mm;
	uint32_t behind, ahead;
};

struct pass {
	const struct interp_program *p;
	struct interp_seg *segs;
	double corner_mm;
	uint32_t n;			/* columns */
	struct ways ways;
	struct around windows[PASS_WINDOWS], near;
	/* Of each column: */
	double tol[INTERP_NAXES];	/* mm or degrees that are no change */
	double v_mm_s[INTERP_NAXES], a_mm_s2[INTERP_NAXES];
	double j_mm_s3[INTERP_NAXES];
	double step_mm_s[INTERP_NAXES];	/* at a node */
};

/** pass_round_mm_s() - the fastest round a bend, where the axes give so much. */
double pass_round_mm_s(double r_mm, double a_mm_s2, double j_mm_s3);

/** pass_is_short() - has segment @i a curve that its ends do not have? */
bool pass_is_short(const struct pass *w, uint32_t i);

/** pass_node_mm_s() - over the node in front of segment @i; @last is the one
 *  before that moves.  INFINITY: as fast as one likes. */
double pass_node_mm_s(struct pass *w, uint32_t last, uint32_t i,
		      const struct heading *a, const struct heading *b);

/* The most that each column moves by, a mm of a segment. */
struct rates {
	double by[INTERP_NAXES];
	uint32_t bends;			/* columns that go round a bend */
};

/** pass_rates() - those of segment @i. */
void pass_rates(struct pass *w, uint32_t i, const struct headings *h,
		struct rates *ret);

/** pass_rate_mm_s() - what the axes' own speeds allow at such rates. */
double pass_rate_mm_s(const struct pass *w, const struct rates *r);

#endif /* SPEED_PASS_H */
