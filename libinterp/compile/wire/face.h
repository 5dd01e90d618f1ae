/* SPDX-License-Identifier: Apache-2.0 */
/*
 * face.h - the outline of the part on one plane
 *
 * On the programmed plane it is the contour as written.  On the second plane
 * each piece is moved sideways by the tangent of its taper times the height
 * between the planes.  Neighbours then meet, and pieces for which there is no
 * room are left out.  The offset of the wire is not in it; track.h adds that.
 *
 * Units: mm, radian.  Threads: allocates.  Never in the cycle.
 */
#ifndef WIRE_FACE_H
#define WIRE_FACE_H

#include "interp/build.h"
#include "interp/wire.h"
#include "wire/curve.h"

/* What a word makes of the corner behind a motion. */
struct contour_corner {
	double mm;			/* 0: nothing */
	bool cut;			/* a straight line, so far from the
					 * corner; else an arc of that radius */
};

/* A motion as programmed, on both planes. */
struct contour_motion {
	struct curve c[2];
	double from_mm[INTERP_NAXES], end_mm[INTERP_NAXES];
	struct interp_build_word word;
	double offset_mm;		/* of the wire; + to the left */
	double slope;			/* tangent of the taper; + left */
	enum interp_taper_corner corner;
	struct contour_corner end;
	bool lead;			/* the offset is reached or left here */
	bool step;			/* from pass to pass, on the spot */
	uint32_t todo, ntodo;		/* actions behind it */
};

struct face_piece {
	struct curve c;
	uint32_t owner;			/* index of its motion */
	bool fill;			/* it leads from its own motion to the
					 * next one */
	bool lead;			/* not a surface of the part: a lead to
					 * or from it */
	double wire_mm;			/* distance of the wire's axis from
					 * it */
	double way_mm;			/* along the outline to its start */
	double shift_mm;		/* how far to the left the second plane
					 * has it */
};

struct face {
	struct face_piece *piece;
	size_t room;
	uint32_t n;
	bool closed;			/* it ends where it begins */
	bool written_closed;		/* so it does as it is written, before
					 * it is moved */
	uint32_t nconstant;		/* fillets that would turn inside out
					 * and keep their radius instead */
	uint32_t first_constant;	/* owner of the first of them */
};

/* What a face is made from: motions @first to @first + @n - 1 of @m. */
struct face_from {
	const struct contour_motion *m;
	uint32_t first, n;
	int plane;			/* 0: programmed, 1: second */
	double height_mm;		/* from plane to plane; 0: no guides */
	double pulse_mm;
};

/* Motions between which nothing is left. */
struct face_fault {
	uint32_t a, b;
	bool crowded;			/* too many crossings to look at */
};

/**
 * face_make() - fill @f, which is all zero.
 * Return: 0, -ENOMEM, or -EINVAL with @fault filled.
 */
int face_make(struct face *f, const struct face_from *from,
	      struct face_fault *fault);

void face_free(struct face *f);

/**
 * face_add() - add one more piece of motion @owner.
 * @fitted: it is a fillet that keeps its radius.
 * Return: the piece, or NULL without memory.
 */
struct face_piece *face_add(struct face *f, const struct face_from *from,
			    uint32_t owner, const struct curve *c, bool fitted);

enum face_fate {
	FACE_MOVED,
	FACE_FITTED,			/* a fillet that keeps its radius */
	FACE_GONE,			/* an arc that would turn inside out */
};

/**
 * face_piece_moved() - move motion @i to the plane of @from.
 * @ret: the moved curve.  With FACE_GONE its ends are those that the curve
 * would have.
 */
enum face_fate face_piece_moved(const struct face_from *from, uint32_t i,
				struct curve *ret);

#endif /* WIRE_FACE_H */
