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
	double start_mm[INTERP_NAXES];	/* where the machine stands */
};

/* What a segment carries beside its geometry. */
struct interp_build_word {
	uint32_t line;			/* of the source, from 1 */
	double feed_mm_s;		/* > 0; ignored for a rapid */
	bool rapid;
	char cond_letter;		/* 0: none */
	uint32_t cond_number;
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

/** interp_build_line() - a straight line to @end_mm; one of no length is
 *  dropped. */
int interp_build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag);

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

/** interp_build_action() - something done on the spot.
 *  @kind INTERP_DWELL or later, @arg as struct interp_seg says. */
int interp_build_action(struct interp_build *b, enum interp_kind kind,
			uint32_t arg, const struct interp_build_word *w,
			struct interp_diag *diag);

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
 */
void interp_build_write(struct interp_build *b,
			const struct interp_build_about *about, void *block);

#endif /* INTERP_BUILD_H */
