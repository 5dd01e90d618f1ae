/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plan.h - from a dense program or an end pose to the fewest blocks
 *
 * Units: mm and degrees; machine coordinates.  Threads: one.
 */
#ifndef PLAN_PLAN_H
#define PLAN_PLAN_H

#include "check.h"
#include "fewest.h"
#include "free.h"

/* A way in, as it is written and proved. */
struct plan_way {
	const char *how;		/* "greedy" ...; NULL: there is none */
	uint32_t n;			/* nodes */
	double q[FEWEST_NODES_MAX][INTERP_NAXES];
	double proved_mm[FEWEST_NODES_MAX];	/* the clearance of each block;
						 * stray pulses and chord errors
						 * are subtracted */
	double strays_mm[FEWEST_NODES_MAX];	/* subtracted for stray
						 * pulses */
	double t[FEWEST_NODES_MAX];	/* where the block is nearest */
	struct near_pair pair[FEWEST_NODES_MAX];
	double least_mm;		/* the least of proved_mm */
	double within_mm;		/* a clearance that is greater than
					 * proved_mm by more than this could not
					 * be proved */
	double time_pass_s, time_stop_s;	/* from edmsim; 0: it was not
						 * asked */
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
	struct route dense;		/* the given program, with what leads to
					 * the way in */
	uint32_t first, last;		/* the nodes of the way in */
	struct clearance c;
	double end_mm;			/* distance at the end pose */
	double dense_least_mm;		/* the least that was seen along the
					 * dense way */
	uint32_t repaired;		/* nodes that were moved or added by
					 * repair_nodes() */
	struct near_pair nearest;	/* of the last block that was refused */
	double dense_pass_s, dense_stop_s;
	struct plan_way greedy, fewest, best;
	const double *contact;		/* --check: the axes at the first
					 * contact of `best`; NULL: none */
	bool trial;			/* `best` will not be written */
	struct plan_pivot pivot;
	uint64_t queries;
	double seconds, planned_s;	/* when it began; how long it took */
	bool stopped;			/* by Ctrl-C */
	bool carried;			/* text_write() also wrote the other
					 * lines of the dense program */
	/* How to read the text of text_write(), for struct route_text. */
	const char *written_path, *written_dialect;
};

/** plan_program() - plan, prove and write. Return: 0; 1: there is no way; else
 *  a sysexits code. */
int plan_program(struct job *j);

/** plan_find_way_in() - find the nodes from the last positioning before the
 *  first cut to the last cut.  Return: 0; or EX_DATAERR, and the reason is on
 *  stderr. */
int plan_find_way_in(struct plan *p);

/**
 * plan_choose_nodes() - choose the nodes of the way in for the search.
 *
 * If there are more than FEWEST_NODES_MAX, it chooses some between which the
 * electrode moves equally far.  @at: their numbers in p->dense.  Return: how
 * many; 0: out of memory.
 */
uint32_t plan_choose_nodes(const struct plan *p, uint32_t at[FEWEST_NODES_MAX]);

/** plan_check_end() - may the way end at @end?  It fills end_mm.  Return: 0;
 *  or 1, and the reason is on stderr. */
int plan_check_end(struct plan *p, const double end[INTERP_NAXES]);

/** plan_over() - find the fewest blocks over the nodes @q, and then, if they
 *  may leave the path, move the inner nodes for more clearance. Return: 0; 1:
 *  there is no way; -ENOMEM. */
int plan_over(struct plan *p, const struct job *j,
	      double (*q)[INTERP_NAXES], uint32_t n);

/** plan_prove() - fill proved_mm and what belongs to it, to @within_mm. */
void plan_prove(const struct job *j, struct plan_way *w, double within_mm,
		uint64_t *queries);

/** plan_pivot() - look for a better place of the work. */
int plan_pivot(struct plan *p);

/* -- What is written ------------------------------------------------------ */

/**
 * text_write() - write the dense program with @w as its way in.  If its other
 * lines do not fit these blocks, only the positioning and the blocks are
 * written.  It sets p->carried and the dialect of the text: that of the dense
 * program, or else "generic".  Return: the text, for free(); NULL: out of
 * memory.
 */
char *text_write(struct plan *p, const struct plan_way *w);

/** put_text() - write @text to the file @path, whole or not at all; - is
 *  standard output. Return: 0; or a sysexits code, and the reason is on
 *  stderr. */
int put_text(const char *path, const char *text);

/** put_check() - can all output files be written, and is none of them also an
 *  input?  Return: as put_text(). */
int put_check(const struct job_options *o);

/** plan_describe() - print what was found and written on standard output. */
void plan_describe(const struct plan *p);

/** report_put(), picture_put(), view_put() - write these files if they are
 *  asked for. */
int report_put(const struct plan *p);
int report_put_check(const struct job *j, const struct route *w,
		     const struct check_result *r);
int picture_put(const struct plan *p);
int view_put(const struct plan *p);

/** times_ask() - ask edmsim how long each way takes. Return: 0 or a sysexits
 *  code. */
int times_ask(struct plan *p);

#endif /* PLAN_PLAN_H */
