/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build.h - put a program together, segment by segment
 *
 * What a reader of NC code calls.  Coordinates are absolute machine
 * coordinates of all eight axes.  Every call that adds a segment returns 0, or
 * -EINVAL with @diag's found and wanted filled (line and column are the
 * reader's to fill), or -ENOMEM.  After an error the builder can only be
 * destroyed.
 *
 * Threads: allocates; one object belongs to one thread.  Never in the cycle.
 */
#ifndef INTERP_BUILD_H
#define INTERP_BUILD_H

#include "interp/diag.h"
#include "interp/program.h"

struct interp_build;

struct interp_build_options {
	const struct interp_machine *machine;	/* read at every call; lent */
	enum interp_strategy strategy;
	uint32_t tolerance_milli;	/* mu, 1/1000 pulse; main-direction and
					 * min-switch refuse a line whose mu no
					 * path can keep to */
	bool perpendicular;		/* mu is measured square to the line */
	enum interp_coupling coupling;	/* of three and more axes */
	double corner_mm;		/* of limits.h; 0: its defaults */
	double tolerance_mm, rotary_radius_mm;
	double start_mm[INTERP_NAXES];	/* where the machine stands */
	double chord_error_mm;		/* of curves: between two cycles no */
	double period_s;		/* farther off; either 0: no limit */
	double fit_mm;			/* cut lines in a row are joined into
					 * curves this near to them; 0: not */
};

/* What a segment carries beside its geometry. */
struct interp_build_word {
	uint32_t line;			/* of the source, from 1 */
	double feed_mm_s;		/* > 0; ignored for a rapid */
	bool rapid;
	uint8_t ends;			/* INTERP_SEG_TOUCH, _HALF or _LIMIT; 0: it
					 * ends at its end */
	char cond_letter;		/* 0: none */
	uint32_t cond_number;
	const struct interp_tech *tech;	/* of that condition, copied; NULL:
					 * nothing given */
};

/* An arc as a reader knows it: the centre, the way round, the full turns. */
struct interp_build_arc {
	enum interp_axis axis_a, axis_b;	/* plane; a toward b is + */
	double centre_a_mm, centre_b_mm;
	bool clockwise;			/* seen from +(a x b) */
	uint32_t turns;			/* whole turns beside the rest; equal
					 * ends with 0 turns make a full circle */
};

/** interp_build_create() - an empty program. Return: NULL if out of memory. */
struct interp_build *interp_build_create(const struct interp_build_options *o);

/** interp_build_destroy() - NULL is fine. */
void interp_build_destroy(struct interp_build *b);

/** interp_build_here() - the end of the last segment, mm, absolute. */
const double *interp_build_here(const struct interp_build *b);

/**
 * interp_build_line() - a straight line to @end_mm; one of no length is
 * dropped.
 *
 * One that ends elsewhere (@w's ends) has a stop in front of it.  Its axes are
 * no longer held to their travel here: where they will be is not known.
 */
int interp_build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag);

/**
 * interp_build_flush() - lay down what is held back to be joined (fit_mm).
 *
 * Calls that add a segment do so first; before interp_build_escape() and
 * interp_build_lift(), and after the last call, it must be called.
 */
int interp_build_flush(struct interp_build *b, struct interp_diag *diag);

/** interp_build_arc() - an arc to @end_mm, helical if other axes move.
 *  The radii at start and end may differ by 2 pulses, or 0.1 % but 5
 *  pulses, no more. */
int interp_build_arc(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_arc *arc,
		     const struct interp_build_word *w,
		     struct interp_diag *diag);

/* One contour of a pair as a reader knows it. */
struct interp_build_contour {
	bool arc;
	bool clockwise;
	double centre_mm[2];		/* X and Y, or U and V; arcs only.  Equal
					 * ends make a full circle */
};

/**
 * interp_build_pair() - two contours at once: @contour[0] on X Y, [1] on U V.
 *
 * Each goes from where its axes stand to their places in @end_mm; no other
 * axis may move.  They are walked together: arcs of one sense, phase and sweep
 * by angle, all others by their shares of length.  If but one of them moves,
 * a plain line or arc is made of it.
 */
int interp_build_pair(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_contour contour[2],
		      const struct interp_build_word *w,
		      struct interp_diag *diag);

/* A NURBS as a reader knows it. */
struct interp_build_curve {
	struct interp_nurbs nurbs;	/* absolute; counted and others are the
					 * builder's to choose */
	uint8_t axis[INTERP_NAXES];	/* of each column, no axis twice */
	/* Lines of the source along it, by rising u; NULL: the word's. */
	const struct interp_build_mark {
		double u;
		uint32_t line;
	} *marks;
	size_t nmarks;
};

/**
 * interp_build_curve() - along a NURBS from its first point, within two pulses
 * of here, to its last.
 *
 * It becomes one segment or several: one ends at a cusp or a corner, and where
 * the curve asks for a feed of another order.  Each has the fastest feed that
 * keeps chord error and the limits of the axes.
 */
int interp_build_curve(struct interp_build *b,
		       const struct interp_build_curve *c,
		       const struct interp_build_word *w,
		       struct interp_diag *diag);

/** interp_build_action() - something done on the spot.
 *  @kind INTERP_DWELL or later, @arg as struct interp_seg says. */
int interp_build_action(struct interp_build *b, enum interp_kind kind,
			uint32_t arg, const struct interp_build_word *w,
			struct interp_diag *diag);

/**
 * interp_build_timed() - from here to interp_build_timed_end() the program
 * cuts for @ms milliseconds at most.
 *
 * When they are over it goes back along the path and on behind that end, which
 * must be the same lattice point: else the end is refused with -EINVAL.  Not
 * one inside another.
 */
int interp_build_timed(struct interp_build *b,
		       const struct interp_build_word *w,
		       struct interp_diag *diag);
int interp_build_timed_end(struct interp_build *b, uint32_t ms,
			   const struct interp_build_word *w,
			   struct interp_diag *diag);

/**
 * interp_build_escape() - the way out of the motions that follow; NULL: along
 * the path again.
 *
 * @e is free of material wherever they cut: the caller's promise.  Its speed
 * is bounded by its linear axes here.  Return: 0 or -ENOMEM; a program with
 * more than 65535 of them gives the rest none.
 */
int interp_build_escape(struct interp_build *b, const struct interp_escape *e);

/**
 * interp_build_lift() - straight cuts along @axis alone, from here on, leave
 * along it as far as the electrode came; -1: along the path again.
 */
void interp_build_lift(struct interp_build *b, int axis);

/**
 * interp_build_came_mm() - from where the electrode came straight here along
 * @axis, on the side @side (+1 or -1) of it; here, if it did not.
 */
double interp_build_came_mm(const struct interp_build *b, int axis, int side);

/* What only the whole text tells. */
struct interp_build_about {
	uint32_t lines;
	uint8_t hash[32];
	const char *name;		/* cut to 63 bytes; NULL is "" */
};

/**
 * interp_build_bytes() - size of the block interp_build_write() fills.
 */
size_t interp_build_bytes(const struct interp_build *b);

/**
 * interp_build_write() - lay the finished program out at @block.
 *
 * An INTERP_END is added if the last segment is none.  @block has room for
 * interp_build_bytes() bytes and is 8-aligned.
 *
 * What was built has moved there: the builder can only be destroyed.
 */
void interp_build_write(struct interp_build *b,
			const struct interp_build_about *about, void *block);

#endif /* INTERP_BUILD_H */
