/* SPDX-License-Identifier: Apache-2.0 */
/*
 * builder.h - a program while it is put together
 *
 * Private to libinterp/compile/path.
 */
#ifndef PATH_BUILDER_H
#define PATH_BUILDER_H

#include "interp/build_from.h"
#include "path/build_rule.h"
#include "interp/program.h"

struct table {
	void *at;
	size_t n, room, size;
	size_t lead;			/* bytes before `at`, in its memory */
	const struct interp_build_memory *memory;	/* NULL: the heap */
};

/* Where the segments are in a block, for which their table leaves room: it
 * becomes the block. */
#define BUILD_SEGS_AT	((sizeof(struct interp_program_head) + 7) & ~7ull)

/* Lines that are held back: see build_fit.c. */
struct build_fit {
	double *end_mm;			/* rows of all axes; the start comes
					 * first */
	uint32_t *lines;		/* of the source */
	uint32_t n;			/* points; 0: nothing is held back */
	struct interp_build_word word;
};

/* What was left out while the program was still read (build_early.c). */
struct build_inside {
	bool tried, done;
	uint32_t nway;			/* segments of the way in */
	double left_mm;			/* where the next one was along the
					 * whole program */
	struct interp_build_entry entry;
};

/* Consecutive motions along one linear axis only, up to here. */
struct build_descent {
	int axis;			/* -1: none */
	double first_mm, low_mm, high_mm;	/* where it began, and how far
						 * it reached */
};

/* The text may be read once more, to count what will be walked
 * (build_count.c). */
struct build_again {
	interp_build_again_fn *read;	/* NULL: it was, or cannot be */
	void *arg;
	bool counts;			/* this builder counts, and builds
					 * nothing */
	bool refused;			/* there is too much; with the diag for
					 * who asked */
	struct interp_diag diag;
};

struct interp_build {
	struct interp_build_options o;
	const struct pulse_strategy *how;	/* of o.strategy */
	double here_mm[INTERP_NAXES];
	int64_t here[INTERP_NAXES];	/* the same in subpulses */
	int64_t first[INTERP_NAXES];
	double sub_mm[INTERP_NAXES];	/* subpulses per mm */
	double v_max_mm_s[INTERP_NAXES];
	double above_mm[INTERP_NAXES];	/* the travel minus a pulse: places
					 * ... */
	double below_mm[INTERP_NAXES];	/* ... between them need no closer
					 * check; there is none, if the machine
					 * has not the axis */
	uint8_t column[INTERP_NAXES];
	uint32_t naxes, columns;	/* columns: mask of axes */
	uint32_t loose;			/* axes that moved by what the machine
					 * says */
	struct interp_probed probed;	/* before it begins */
	struct interp_depth depth;	/* ... likewise */
	double length_mm;
	uint64_t walked;		/* lattice points, to build it */
	struct build_again again;
	struct table segs, nodes, arcs;	/* nodes: n counts columns */
	struct table conds, escapes, runs, couples, bits;
	struct table curves, pieces, stops, numbers;
	struct table origins, known;	/* of segments; and all that have a
					 * number, which is their index + 1 */
	uint32_t origin;		/* of the last segment */
	uint32_t counts;		/* the number that was given last */
	struct build_fit fit;
	char cond_letter;
	uint32_t cond_number;
	uint16_t cond;
	struct build_descent descent;
	uint16_t escape;		/* set by interp_build_escape() */
	uint16_t stand_escape;		/* of the last motion */
	bool off;			/* M5 is in force */
	uint32_t said;			/* the last M3 or M4, enum interp_aux;
					 * 0: none */
	int lift_axis;			/* -1: none */
	size_t timed;			/* the INTERP_TIMED that was begun
					 * last */
	int64_t timed_at[INTERP_NAXES];	/* place of it, subpulses */
	const struct interp_tech *tech;	/* from this cond was made */
	struct build_inside inside;
	size_t segs_room;		/* of which segs.room is a part */
};

/** build_table_room() - make room for @n more.  Return: 0 or -ENOMEM. */
int build_table_room(struct table *t, size_t n);

/** build_table_size() - let its memory have @bytes, with what is before `at`.
 *  Return: 0 or -ENOMEM. */
int build_table_size(struct table *t, size_t bytes);

/** build_table_free() - it is empty then, and may be filled again. */
void build_table_free(struct table *t);

/** build_table_add() - make room for one more; NULL: out of memory. */
static inline void *build_table_add(struct table *t)
{
	if (t->n == t->room && build_table_room(t, 1) < 0)
		return NULL;
	return (char *)t->at + t->size * t->n++;
}

/* How far a motion goes. */
struct build_measure {
	uint32_t moved;			/* mask of axes */
	double length_mm;
	double fed_mm;			/* what F is along */
	double seconds;			/* at every axis's own v_max */
	int64_t longest;		/* subpulses */
};

/**
 * build_measure() - measure how far every axis goes to @end_mm; @to gets the
 * end in subpulses.
 *
 * Return: 0, or -EINVAL with @diag filled if an axis would leave its travel.
 */
int build_measure(const struct interp_build *b,
		  const double end_mm[INTERP_NAXES], int64_t to[INTERP_NAXES],
		  struct build_measure *ret, struct interp_diag *diag);

/**
 * build_measure_next() - the same for a motion before which lines are held
 * back: they are added first.
 */
int build_measure_next(struct interp_build *b,
		       const double end_mm[INTERP_NAXES],
		       int64_t to[INTERP_NAXES], struct build_measure *ret,
		       struct interp_diag *diag);

/**
 * build_counts() - is a way of this length, squared, far enough beside the
 * others of the same motion that it makes the length?  See program.h.
 */
static inline bool build_counts(double own2, double others2)
{
	return own2 > 0 &&
	       own2 * (INTERP_FAR_BESIDE * INTERP_FAR_BESIDE) >= others2;
}

#define BUILD_ALL_AXES	((1u << INTERP_NAXES) - 1)

/** build_mm() - subpulses as mm, of the axes in the mask @axes. */
void build_mm(const struct interp_build *b, uint32_t axes,
	      const int64_t at[INTERP_NAXES], double ret_mm[INTERP_NAXES]);

/** build_way_to() - the way from here to @to, as the strategies need it. */
struct build_way build_way_to(const struct interp_build *b,
			      const int64_t to[INTERP_NAXES],
			      const struct build_measure *m);

/**
 * build_seg_feed() - set the feeds: the programmed one, and the fastest that
 * its axes allow.
 */
void build_seg_feed(struct interp_seg *seg, const struct interp_build_word *w,
		    double feed_max_mm_s);

/**
 * build_columns() - give each axis in @moved a column.  Return: 0 or -ENOMEM.
 */
int build_columns(struct interp_build *b, uint32_t moved);

/**
 * build_stand_at() - the path now ends at @end_mm, which is @to in subpulses.
 */
void build_stand_at(struct interp_build *b, const double end_mm[INTERP_NAXES],
		    const int64_t to[INTERP_NAXES]);

/**
 * build_seg_finish() - add @seg, with everything that is the same for all
 * segments: line, condition, place, end node.
 *
 * Return: 0, -ENOMEM, or -EINVAL with @diag filled.
 */
int build_seg_finish(struct interp_build *b, struct interp_seg *seg,
		     const struct interp_build_word *w,
		     struct interp_diag *diag);

/* A segment whose way is known. */
struct build_step {
	struct interp_seg seg;
	double feed_max_mm_s;
	uint32_t moved;			/* bit per axis that moves on the way */
	const double *end_mm;		/* of all axes */
};

/**
 * build_walk() - so many lattice points are walked to build it: are these still
 * few enough, with all before?  A short text may ask for days of them.
 *
 * Return: 0; -EINVAL with @diag filled; or as build_count_rest().
 */
int build_walk(struct interp_build *b, double points,
	       struct interp_diag *diag);

/** build_walk_may() - the same, but they are not counted yet: what has at least
 *  so many is refused before it is walked. */
int build_walk_may(struct interp_build *b, double points,
		   struct interp_diag *diag);

/** build_count_rest() - a part of what may be walked was walked: is there too
 *  much in the rest of the text?  Then -E2BIG, else 0 or -ENOMEM. */
int build_count_rest(struct interp_build *b);

/** build_count_line(), build_count_curve() - in a builder that counts. */
int build_count_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_word *w,
		     struct interp_diag *diag);
int build_count_curve(struct interp_build *b,
		      const struct interp_build_curve *c,
		      struct interp_diag *diag);

/** build_segs_room() - make room for one more segment.  All others are whole.
 *  Return: 0 or -ENOMEM. */
int build_segs_room(struct interp_build *b);

/** build_early_entry() - how that begins, now that all is read. */
void build_early_entry(const struct interp_build *b,
		       struct interp_build_entry *ret);

/** build_leave_out() - interp_build_from(), of what is there so far. */
int build_leave_out(struct interp_build *b, const struct interp_build_from *o,
		    struct interp_build_entry *ret, struct interp_diag *diag);

/** build_step() - add it; the path then stands at its end. */
int build_step(struct interp_build *b, const struct build_step *s,
	       const struct interp_build_word *w, struct interp_diag *diag);

/** build_line() - interp_build_line() without holding the line back. */
int build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
	       const struct interp_build_word *w, struct interp_diag *diag);

/**
 * build_travel() - the first and the last pulse at which axis @axis of the
 * machine may stand.
 */
void build_travel(const struct interp_build *b, int axis, double ret[2]);

/** build_axis_ok() - may axis @axis stand at @at_mm? */
bool build_axis_ok(const struct interp_build *b, int axis, double at_mm);

/** build_descend_one() - build_descend() along one axis only. */
void build_descend_one(struct interp_build *b, int axis,
		       const double end_mm[INTERP_NAXES]);

/** build_descend() - the next motion moves the axes in @moved to @end_mm. */
static inline void build_descend(struct interp_build *b, uint32_t moved,
				 const double end_mm[INTERP_NAXES])
{
	if (moved & (moved - 1))
		b->descent.axis = -1;
	else
		build_descend_one(b, __builtin_ctz(moved), end_mm);
}

/** build_escape_lift() - build_escape_of() along the axis of the lift only. */
uint16_t build_escape_lift(struct interp_build *b,
			   const double end_mm[INTERP_NAXES]);

/** build_escape_of() - the index of the escape of that motion. */
static inline uint16_t build_escape_of(struct interp_build *b, uint32_t moved,
				       const double end_mm[INTERP_NAXES])
{
	if (b->escape || b->lift_axis < 0 || moved != 1u << b->lift_axis)
		return b->escape;
	return build_escape_lift(b, end_mm);
}

#endif /* PATH_BUILDER_H */
