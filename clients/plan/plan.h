/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.h - from a dense program or an end pose to the fewest blocks
 *
 * Units: mm and degrees; machine coordinates.  Threads: one.
 */
#ifndef PLAN_PLAN_H
#define PLAN_PLAN_H

#include "fewest.h"
#include "free.h"

/* A way in, as it is written and proved. */
struct plan_way {
	const char *how;		/* "greedy" ...; NULL: there is none */
	uint32_t n;			/* nodes */
	double q[FEWEST_NODES_MAX][INTERP_NAXES];
	double proved_mm[FEWEST_NODES_MAX];	/* of each block; what strays
						 * and the chords taken off */
	double strays_mm[FEWEST_NODES_MAX];	/* taken off for pulses */
	double t[FEWEST_NODES_MAX];	/* where it is nearest */
	struct near_pair pair[FEWEST_NODES_MAX];
	double least_mm;		/* of all blocks, proved */
	double within_mm;		/* more than that could not be proved
					 * over proved_mm */
	double time_pass_s, time_stop_s;	/* by edmsim; 0: not asked */
};

/* A better place of the work, or of the electrode in its holder. */
struct plan_pivot {
	double part_mm[3], tool_mm[3];	/* shifts */
	struct plan_way way;
	bool outside;			/* an axis would leave its travel */
	char why[120];
};

struct plan {
	struct job *j;
	struct route dense;		/* as given, with what leads to it */
	uint32_t first, last;		/* its nodes of the way in */
	struct clearance c;
	double end_mm;			/* distance at the end pose */
	double dense_least_mm;		/* least seen along the dense way */
	uint32_t repaired;		/* nodes that repair moved or put in */
	struct near_pair nearest;	/* of the last block that it refused */
	double dense_pass_s, dense_stop_s;
	struct plan_way greedy, fewest, best;
	bool trial;			/* best is not what will be written */
	struct plan_pivot pivot;
	uint64_t queries;
	double seconds, planned_s;	/* when it began; how long it took */
	bool stopped;			/* by Ctrl-C */
	bool carried;			/* text_write(): with the other lines of
					 * the dense program */
	/* How the text of text_write() is to be read: struct route_text. */
	const char *written_path, *written_dialect;
};

/** plan_program() - plan, prove, write. Return: 0, 1 no way; else sysexits. */
int plan_program(struct job *j);

/** plan_find_way_in() - from the last positioning before the first cut to the
 *  last cut.  Return: 0; or EX_DATAERR, and the reason is on stderr. */
int plan_find_way_in(struct plan *p);

/**
 * plan_choose_nodes() - the nodes of the way in that the search goes over.
 *
 * If there are more than FEWEST_NODES_MAX, those between which the electrode
 * goes equally far.  @at: their numbers in p->dense.  Return: how many; 0: out
 * of memory.
 */
uint32_t plan_choose_nodes(const struct plan *p, uint32_t at[FEWEST_NODES_MAX]);

/** plan_check_end() - may the way end at @end?  It fills end_mm.  Return: 0;
 *  or 1, and the reason is on stderr. */
int plan_check_end(struct plan *p, const double end[INTERP_NAXES]);

/** plan_over() - the fewest blocks over the nodes @q; then, if @free, with
 *  inner nodes off them. Return: 0, 1 none, -ENOMEM. */
int plan_over(struct plan *p, const struct job *j,
	      double (*q)[INTERP_NAXES], uint32_t n);

/** plan_prove() - fill proved_mm and what belongs to it, within @within_mm. */
void plan_prove(const struct job *j, struct plan_way *w, double within_mm,
		uint64_t *queries);

/** plan_pivot() - look for a better place of the work. */
int plan_pivot(struct plan *p);

/* -- What is written ------------------------------------------------------ */

/**
 * text_write() - the dense program with @w as its way in, allocated; where its
 * other lines cannot stand beside those blocks, its positioning and the blocks
 * alone.  It sets p->carried and what the text is to be read with: the dialect
 * of the dense program, or else "generic".  Return: NULL if out of memory.
 */
char *text_write(struct plan *p, const struct plan_way *w);

/** put_text() - @text into the file @path, whole or not at all; - is standard
 *  output. Return: 0 or a sysexits code, and the reason is on stderr. */
int put_text(const char *path, const char *text);

/** put_check() - can all that is asked for be written, and is none of it read?
 *  Return: as put_text(). */
int put_check(const struct job_options *o);

/** plan_describe() - what was found and written, on standard output. */
void plan_describe(const struct plan *p);

/** report_put(), picture_put(), view_put() - the files asked for. */
int report_put(const struct plan *p);
int picture_put(const struct plan *p);
int view_put(const struct plan *p);

/** times_ask() - how long each way takes, by edmsim. Return: 0 or sysexits. */
int times_ask(struct plan *p);

#endif /* PLAN_PLAN_H */
