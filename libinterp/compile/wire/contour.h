/* SPDX-License-Identifier: Apache-2.0 */
/*
 * contour.h - between a reader and the builder: wire offset, taper, corners
 *
 * Takes programmed motions, moves each contour to its side by the offset and
 * the taper in force, joins neighbours at their corners and hands the result
 * to the guides.
 *
 * What is cut under one G41 or G42, lead to lead, is collected first: no part
 * of it may come too near to another, and pieces for which there is no room
 * are left out, so all of it must be known.  With nothing in force one motion
 * is held back until the next is known, or none.
 *
 * A function that refuses fills @diag's found, wanted and line (that of the
 * motion to blame, which may be one collected before) and returns -EINVAL.
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
	double offset_mm, slope;	/* in force for the next motion ... */
	enum interp_taper_corner corner;
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
 * contour_side() - from the next motion on, @offset_mm to the left of the
 * contours and the wire leaning to the left by the tangent @slope; below 0 to
 * the right.
 */
void contour_side(struct contour *k, double offset_mm, double slope);

/** contour_tangent() - of a taper of @deg; NAN if beyond the machine. */
double contour_tangent(const struct contour *k, double deg);

/* As the builder's functions of these names. */
int contour_line(struct contour *k, const double end_mm[INTERP_NAXES],
		 const struct interp_build_word *w, struct interp_diag *diag);
int contour_arc(struct contour *k, const double end_mm[INTERP_NAXES],
		const struct interp_build_arc *arc,
		const struct interp_build_word *w, struct interp_diag *diag);
/* With anything in force it is cut into arcs and lines and 1 is returned; a
 * curve of other axes than X and Y is refused then. */
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

/** contour_flush() - nothing follows: end what is collected. */
int contour_flush(struct contour *k, struct interp_diag *diag);

/** contour_leads() - is the next motion a lead?  The offset is reached or left
 *  over it, or a taper without an offset. */
bool contour_leads(const struct contour *k);

/** contour_keep() - put @m behind what is collected. */
int contour_keep(struct contour *k, const struct contour_motion *m,
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
