/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.h - between a reader and the builder: wire offset, taper, corners
 *
 * Takes programmed motions, moves each contour to its side by the offset and
 * the taper in force, joins neighbours at their corners and hands the result
 * to the guides.  One motion is held back until the next is known; memory is
 * bounded.  With nothing in force a motion goes straight to the builder.
 *
 * A function that refuses fills @diag's found, wanted and line (that of the
 * motion to blame, which may be the one held) and returns -EINVAL.
 *
 * Threads: allocates through the builder.  Never in the cycle.
 */
#ifndef WIRE_CONTOUR_H
#define WIRE_CONTOUR_H

#include "wire/guide.h"

#define CONTOUR_TODO_MAX	32	/* actions between two motions */

/* A motion as programmed, on both planes. */
struct contour_motion {
	struct curve c[2];
	double from_mm[INTERP_NAXES], end_mm[INTERP_NAXES];
	struct interp_build_word word;
	/* Set by the stage: */
	struct curve parallel[2];
	double d[2];			/* to the left of each contour */
	bool ramp[2];			/* d is reached over this motion */
	bool point[2];			/* stands on this plane */
};

struct contour_action {
	enum interp_kind kind;
	uint32_t arg;
	struct interp_build_word word;
};

struct contour {
	struct guides guides;
	double here_mm[INTERP_NAXES];	/* as programmed: U V on the top */
	double d[2];			/* in force for the next motion */
	double d_end[2];		/* in force where the path has come to */
	bool held;
	struct contour_motion m;	/* if one is */
	struct vec at[2];		/* where its parallels begin */
	struct contour_action todo[CONTOUR_TODO_MAX];
	uint32_t ntodo;			/* done behind the motion held */
};

void contour_init(struct contour *k, const struct interp_wire *w,
		  const struct interp_machine *m, struct interp_build *b);

/**
 * contour_side() - from the next motion on, @offset_mm to the left of the
 * contours and the wire leaning to the left by the tangent @slope; below 0 to
 * the right.
 */
void contour_side(struct contour *k, double offset_mm, double slope);

/** contour_tangent() - of a taper of @deg; -1 if beyond the machine. */
double contour_tangent(const struct contour *k, double deg);

/* As the builder's functions of these names. */
int contour_line(struct contour *k, const double end_mm[INTERP_NAXES],
		 const struct interp_build_word *w, struct interp_diag *diag);
int contour_arc(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_arc *arc,
		const struct interp_build_word *w, struct interp_diag *diag);
/* Refused with an offset, a taper, guides or corner control in force. */
int contour_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		  const struct interp_build_curve *c,
		  const struct interp_build_word *w, struct interp_diag *diag);
int contour_action(struct contour *k, enum interp_kind kind, uint32_t arg,
		   const struct interp_build_word *w, struct interp_diag *diag);

/**
 * contour_two() - bottom and top of different shape: contour[0] to X Y of
 * @end_mm, contour[1] to U V of it.
 */
int contour_two(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_contour contour[2],
		const struct interp_build_word *w, struct interp_diag *diag);

/** contour_flush() - nothing follows: end the motion held. */
int contour_flush(struct contour *k, struct interp_diag *diag);

/* -- join.c: two neighbours on one plane --------------------------------- */

struct contour_join {
	struct vec end, start;		/* of this motion; of the next */
	bool filled;			/* `fill` leads from end to start */
	struct curve fill;
};

/** contour_way() - unit vector along plane @p of @m, at its start or end. */
struct vec contour_way(const struct contour_motion *m, int p, bool at_end);

/** contour_turn() - the corner between the two: radian, + to the left. */
double contour_turn(const struct contour_motion *a,
		    const struct contour_motion *b, int p);

/** contour_parallels() - fill m->parallel; -1, or the plane whose inside
 *  radius is smaller than the offset. */
int contour_parallels(struct contour_motion *m);

/** contour_join() - false if an inner corner has no place for the offset.
 *  @b NULL: nothing follows. */
bool contour_join(const struct contour_motion *a,
		  const struct contour_motion *b, int p, double pulse_mm,
		  struct contour_join *ret);

#endif /* WIRE_CONTOUR_H */
