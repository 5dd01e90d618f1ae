/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.h - between a reader and the builder: wire offset, taper, corners
 *
 * It takes programmed motions, moves each contour sideways by the offset and
 * the taper in force, joins neighbours at their corners, and hands the result
 * to the guides.
 *
 * The motions under one G41 or G42, from lead to lead, are collected first,
 * because all of them must be known: no part of the way may come too near to
 * another part, and pieces for which there is no room are left out.  If neither
 * an offset nor a taper is in force, at most one motion is held back until the
 * next one is known.
 *
 * A function that refuses fills found, wanted and line of @diag, and returns
 * -EINVAL.  The line is that of the motion to blame, which may be one that was
 * collected before.
 *
 * Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_CONTOUR_H
#define WIRE_CONTOUR_H

#include "wire/face.h"
#include "wire/guide.h"

#define CONTOUR_MOTIONS_MAX	1000000u	/* under one offset */

struct contour_action {
	enum interp_kind kind;
	uint32_t arg;
	struct interp_build_word word;
};

struct contour {
	struct guides guides;
	double here_mm[INTERP_NAXES];	/* as programmed: U V on the top */
	bool plain;			/* no guides, and no corners to round:
					 * most motions are passed on */
	double offset_mm, slope;	/* in force for the next motion ... */
	enum interp_taper_corner corner;
	struct contour_corner end;	/* of the next motion */
	double last_offset_mm, last_slope;	/* ... and for the last one */
	struct contour_motion *m;	/* collected */
	uint32_t n;
	struct contour_action *todo;	/* behind them */
	uint32_t ntodo;
	size_t room, todo_room;
	bool recording;			/* nothing is cut: replay.h */
	struct vec at[2];		/* where the wire crosses the planes */
	const struct interp_notes *notes;	/* lent; NULL: nobody listens */
};

void contour_init(struct contour *k, const struct interp_wire *w,
		  const struct interp_machine *m, struct interp_build *b);

void contour_free(struct contour *k);

/**
 * contour_side() - from the next motion on, the wire is @offset_mm to the left
 * of the contour, and leans to the left by the tangent @slope.  Values below 0
 * mean to the right.
 */
void contour_side(struct contour *k, double offset_mm, double slope);

/** contour_corner() - the next motion ends in a corner that is rounded or
 *  cut. */
static inline void contour_corner(struct contour *k, struct contour_corner end)
{
	k->end = end;
}

/** contour_tangent() - the tangent of a taper of @deg; NAN: the machine cannot
 *  cut it. */
double contour_tangent(const struct contour *k, double deg);

/**
 * contour_set_taper() - the slope, + to the left, of a taper of @deg that is
 * set at the machine.
 *
 * Return: 0, or -EINVAL with @diag filled: the machine cannot cut it.
 */
int contour_set_taper(const struct contour *k, double deg, double *ret,
		      struct interp_diag *diag);

/** contour_turn() - from here on the places of the program are turned by @deg
 *  and mirrored (interp/turn.h); cut what is collected, and see here_mm
 *  again. */
int contour_turn(struct contour *k, double deg, bool mirrored,
		 struct interp_diag *diag);

/* These are as the builder's functions of the same names. */
int contour_line(struct contour *k, const double end_mm[INTERP_NAXES],
		 const struct interp_build_word *w, struct interp_diag *diag);
int contour_arc(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_arc *arc,
		const struct interp_build_word *w, struct interp_diag *diag);
/* If an offset or a taper is in force, the curve is divided into arcs and
 * lines, and 1 is returned.  Then a curve of other axes than X and Y is
 * refused. */
int contour_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		  const struct interp_build_curve *c,
		  const struct interp_build_word *w, struct interp_diag *diag);
int contour_action(struct contour *k, enum interp_kind kind, uint32_t arg,
		   const struct interp_build_word *w, struct interp_diag *diag);

/**
 * contour_two() - bottom and top have different shapes: contour[0] leads to X Y
 * of @end_mm, contour[1] to its U V.
 */
int contour_two(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_contour contour[2],
		const struct interp_build_word *w, struct interp_diag *diag);

/** contour_flush() - nothing follows: cut what is collected. */
int contour_flush(struct contour *k, struct interp_diag *diag);

/** contour_leads() - is the next motion a lead?  On a lead the offset, or a
 *  taper without an offset, is reached or left. */
bool contour_leads(const struct contour *k);

/** contour_keep() - put @m behind what is collected. */
int contour_keep(struct contour *k, const struct contour_motion *m,
		 struct interp_diag *diag);

/** contour_keep_step() - keep a step on the spot where @m ends. */
int contour_keep_step(struct contour *k, const struct contour_motion *m,
		      struct interp_diag *diag);

/* -- corner_word.c --------------------------------------------------------- */

/** contour_cut_corner() - put what the last motion's corner asks for between it
 *  and @b, which follows.  Return: also 1 if nothing is left of @b. */
int contour_cut_corner(struct contour *k, struct contour_motion *b,
		       struct interp_diag *diag);

/** contour_refuse_corner() - nothing follows the last motion's corner. */
int contour_refuse_corner(const struct contour *k, struct interp_diag *diag);

/** contour_refuse_still() - @m has a corner, and no length. */
int contour_refuse_still(const struct contour_motion *m,
			 struct interp_diag *diag);

/* -- contour_curve.c ------------------------------------------------------ */

int contour_cut_nurbs(struct contour *k, const double end_mm[INTERP_NAXES],
		      const struct interp_build_curve *c,
		      const struct interp_build_word *w,
		      struct interp_diag *diag);

/* -- release.c ------------------------------------------------------------- */

/** contour_release() - cut what is collected; @next follows, or NULL. */
int contour_release(struct contour *k, const struct contour_motion *next,
		    struct interp_diag *diag);

/* -- contour_refuse.c ----------------------------------------------------- */

struct track_fault;

/* Tell the user about a contour that is not cut as it is written. */
void contour_note_left(const struct contour *k, const struct track_fault *f,
		       int plane);
void contour_note_constant(const struct contour *k, const struct face *f);
int contour_refuse_track(const struct contour *k, const struct track_fault *f,
			 int plane, struct interp_diag *diag);
int contour_refuse_faces(const struct contour *k, const struct face_fault *f,
			 struct interp_diag *diag);
int contour_refuse_lead(const struct contour_motion *m, double by_mm,
			struct interp_diag *diag);
int contour_refuse_alone(const struct interp_build_word *w,
			 struct interp_diag *diag);
int contour_refuse_plane(const struct interp_build_word *w,
			 struct interp_diag *diag);
int contour_refuse_length(const struct interp_build_word *w,
			  struct interp_diag *diag);

#endif /* WIRE_CONTOUR_H */
