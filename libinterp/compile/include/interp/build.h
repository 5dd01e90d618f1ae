/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build.h - put a program together, segment by segment
 *
 * The readers of NC code call this.  Coordinates are absolute machine
 * coordinates of all eight axes.  Each call that adds a segment returns 0;
 * -EINVAL with found and wanted of @diag filled (the reader fills line and
 * column); or -ENOMEM.  After an error the builder can only be destroyed.
 *
 * Threads: allocates; one object belongs to one thread.  Never in the cycle.
 */
#ifndef INTERP_BUILD_H
#define INTERP_BUILD_H

#include "interp/diag.h"
#include "interp/program.h"

struct interp_build;
struct interp_build_from;

/* Lattice points: some minutes. */
#define INTERP_BUILD_WALKED_MAX	500000000u

/* Where a program is to be: at first @at is NULL. */
struct interp_build_memory {
	/* As realloc() does it; NULL: it is as it was. */
	void *(*grow)(void *arg, void *at, size_t bytes);
	void *arg;			/* what has been given belongs to it */
};

struct interp_build_options {
	const struct interp_machine *machine;	/* read at every call; lent */
	enum interp_strategy strategy;
	uint32_t tolerance_milli;	/* mu, 1/1000 pulse; main-direction and
					 * min-switch refuse a line that no walk
					 * can follow within mu */
	bool perpendicular;		/* mu is measured square to the line */
	enum interp_coupling coupling;	/* of three and more axes */
	double corner_mm;		/* of limits.h; 0: its defaults */
	double tolerance_mm, rotary_radius_mm;
	double start_mm[INTERP_NAXES];	/* where the machine stands */
	double points_per_s;		/* lattice points that the machine can
					 * make; 0: no limit */
	uint32_t walked_max;		/* lattice points that are walked to
					 * build the program, as those of curves
					 * are; 0: INTERP_BUILD_WALKED_MAX */
	double fit_mm;			/* cut lines in a row become curves that
					 * are this near to them; 0: they
					 * stay */
	bool begins_inside;		/* interp_build_from() will be called:
					 * before that no thread works on it,
					 * unless it is said by what: */
	const struct interp_build_from *from;	/* lent until then; NULL: it is
						 * not known */
	const struct interp_build_memory *memory;	/* lent; NULL: the
							 * heap */
};

/* What a segment carries beside its geometry. */
struct interp_build_word {
	uint32_t line;			/* of the source, from 1 */
	double feed_mm_s;		/* > 0; ignored for a rapid; along X Y
					 * Z; if none of these moves, U V; else
					 * A B C (degrees) */
	bool rapid;
	uint8_t ends;			/* INTERP_SEG_PROBE, _HALF or _LIMIT; 0:
					 * it ends at its end */
	bool out;			/* it leaves what a cycle has cut */
	char cond_letter;		/* 0: none */
	uint32_t cond_number;
	const struct interp_tech *tech;	/* of that condition, copied; NULL:
					 * nothing given */
	uint32_t origin;		/* of interp_build_origin(); 0: that of
					 * the last segment */
};

/*
 * An arc as a reader knows it.
 *
 * Rounded to pulses, both ends may become one place, or each the other: then
 * they do not tell whether the arc goes round or nowhere.  So it says itself
 * how far it turns.  The builder takes the turn between the rounded ends that
 * is nearest to it.
 */
struct interp_build_arc {
	enum interp_axis axis_a, axis_b;	/* plane */
	double centre_a_mm, centre_b_mm;
	double sweep;			/* radians, before its ends are rounded;
					 * + from a toward b */
};

/**
 * interp_build_sweep() - how far an arc turns that a text names by its ends,
 * its centre and its sense; for interp_build_arc.
 *
 * Each place is two mm in the plane.  Ends that are in one direction from the
 * centre, as far as a text can say it (1e-6 mm), make a full circle.
 */
double interp_build_sweep(const double from_mm[2], const double to_mm[2],
			  const double centre_mm[2], bool clockwise);

/** interp_build_create() - an empty program. Return: NULL if out of memory. */
struct interp_build *interp_build_create(const struct interp_build_options *o);

/* Reads the same text into another builder, and tells nobody what it notes. */
typedef int interp_build_again_fn(void *arg, struct interp_build *b,
				  struct interp_diag *diag);

/**
 * interp_build_again() - if there is much to walk, @read is called once, by a
 * call that adds a segment, to see whether it is too much.
 *
 * Then that call returns -E2BIG, and interp_build_refused() has the reason.
 */
void interp_build_again(struct interp_build *b, interp_build_again_fn *read,
			void *arg);

/** interp_build_refused() - Return: 0; or -EINVAL with @diag filled, line and
 *  column too. */
int interp_build_refused(const struct interp_build *b,
			 struct interp_diag *diag);

/** interp_build_destroy() - NULL is fine. */
void interp_build_destroy(struct interp_build *b);

/** interp_build_here() - the end of the last segment, mm, absolute. */
const double *interp_build_here(const struct interp_build *b);

/**
 * interp_build_fed_mm() - what the feed of a line is along, from place to
 * place; 0: it moves nothing.
 */
double interp_build_fed_mm(const struct interp_build *b,
			   const double from_mm[INTERP_NAXES],
			   const double to_mm[INTERP_NAXES]);

/**
 * interp_build_line() - a straight line to @end_mm.  A line without length is
 * dropped.
 *
 * If the machine decides where the line ends (@w's ends), a stop is put before
 * it.  From then on the travel of its axes is not checked here, because nobody
 * knows yet where they will be.
 */
int interp_build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag);

/**
 * interp_build_flush() - add the lines that were held back to be joined
 * (fit_mm).
 *
 * Each call that adds another kind of segment does this first.  The caller must
 * do it before interp_build_escape() and interp_build_lift(), and at the end.
 */
int interp_build_flush(struct interp_build *b, struct interp_diag *diag);

/**
 * interp_build_arc() - an arc to @end_mm; a helix if other axes move too.
 *
 * Ends and centre may be rounded, so that the radii at both ends differ; the
 * reader has checked that it is no more.  The arc goes through both ends: its
 * centre moves along the chord, or it becomes two segments, or a line.
 */
int interp_build_arc(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_arc *arc,
		     const struct interp_build_word *w,
		     struct interp_diag *diag);

/* One contour of a pair as a reader knows it. */
struct interp_build_contour {
	bool arc;
	double sweep;			/* arcs only, as of interp_build_arc */
	double centre_mm[2];		/* X and Y, or U and V; arcs only */
};

/**
 * interp_build_pair() - two contours at once: @contour[0] on X Y, [1] on U V.
 *
 * Each goes from where its axes stand to their places in @end_mm.  No other
 * axis may move.  They are walked together: two arcs of the same sense, phase
 * and sweep by their angle, all others by their shares of the length.  If only
 * one of them moves, it becomes a simple line or arc; if
 * neither comes to another pulse, they are dropped.
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
 * interp_build_curve() - follow a NURBS from its first point, which must be
 * within two pulses of here, to its last point.
 *
 * It becomes one or several segments.  A segment ends at a cusp or a corner,
 * and where the curve needs a slower or faster feed.  Each segment gets
 * the fastest feed that its axes allow.
 */
int interp_build_curve(struct interp_build *b,
		       const struct interp_build_curve *c,
		       const struct interp_build_word *w,
		       struct interp_diag *diag);

/**
 * interp_build_origin() - the number of @o (its seg does not count) for the
 * words of motions; equal ones have one number.  What comes next is refused in
 * the coordinates of the last one.  Return: 0: it is not told.
 */
uint32_t interp_build_origin(struct interp_build *b,
			     const struct interp_origin *o);

/** interp_build_action() - something that is done without motion.
 *  @kind INTERP_DWELL or later, @arg as struct interp_seg says. */
int interp_build_action(struct interp_build *b, enum interp_kind kind,
			uint32_t arg, const struct interp_build_word *w,
			struct interp_diag *diag);

/**
 * interp_build_timed() - from here to interp_build_timed_end() the program
 * cuts for @ms milliseconds at most.
 *
 * When the time is over, the machine goes back along the path to this place and
 * goes on after that end.  Both must be the same lattice point, else the end is
 * refused with -EINVAL.  A timed part cannot contain another one.
 */
int interp_build_timed(struct interp_build *b,
		       const struct interp_build_word *w,
		       struct interp_diag *diag);
int interp_build_timed_end(struct interp_build *b, uint32_t ms,
			   const struct interp_build_word *w,
			   struct interp_diag *diag);

/**
 * interp_build_escape() - set the way out for the motions that follow; NULL:
 * along the path again.
 *
 * The caller promises that no material is in the way of @e wherever these
 * motions cut.  Its speed is limited here by its linear axes.  A program can
 * have 65535 different ways out; motions after that go out along the path.
 * Return: 0 or -ENOMEM.
 */
int interp_build_escape(struct interp_build *b, const struct interp_escape *e);

/**
 * interp_build_lift() - from here on, straight cuts along @axis alone are left
 * along that axis, as far as the electrode came along it; -1: along the path
 * again.
 */
void interp_build_lift(struct interp_build *b, int axis);

/**
 * interp_build_came_mm() - the place on @axis where the electrode began its
 * straight way to here, from the side @side (+1 or -1).  If it did not come
 * that way, the place where it is.
 */
double interp_build_came_mm(const struct interp_build *b, int axis, int side);

/* What is known only after the whole text has been read. */
struct interp_build_about {
	uint32_t lines;
	uint8_t hash[32];
	const char *name;		/* cut to 63 bytes; NULL is "" */
};

/**
 * interp_build_bytes() - size of the block that interp_build_take() makes.
 */
size_t interp_build_bytes(const struct interp_build *b);

/**
 * interp_build_take() - the finished program as a block of @ret_bytes bytes.
 *
 * An INTERP_END is added if the last segment is not one.  The memory in which
 * the program was put together becomes the block, and belongs to the caller,
 * who frees it if it is of the heap.  After this call the builder can only be
 * destroyed.
 *
 * Return: NULL: out of memory.
 */
void *interp_build_take(struct interp_build *b,
			const struct interp_build_about *about,
			size_t *ret_bytes);

#endif /* INTERP_BUILD_H */
