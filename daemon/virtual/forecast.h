/* SPDX-License-Identifier: Apache-2.0 */
/*
 * forecast.h - how long a job will take, and to each place of its path
 *
 * The job is run once on the simulated machine of the machine file.  The path
 * is divided into parts, and each part has the time during which the farthest
 * place reached was in it: what went into cutting, with the jumps and retracts
 * of it, what went into positioning, and the rest, as the cycle counts them
 * (cycle.h).  Time does not run while a job is held or waits.
 *
 * A process that removes half or twice as much does not change all parts alike:
 * what is cut at the programmed feed takes no shorter.  So the job may be run
 * at both, too.
 *
 * A job whose place does not get on has no end: it is given up, and its reason
 * says where.  One that takes long may be put off: others come first.
 *
 * Threads: one object belongs to one thread.
 */
#ifndef VIRTUAL_FORECAST_H
#define VIRTUAL_FORECAST_H

#include "config.h"

#include <stdatomic.h>

struct interp_program;

#define FORECAST_PARTS	4096		/* at most; neighbours of more are put
					 * together */
#define FORECAST_S_MAX	1e6		/* a job that takes longer has none */
#define FORECAST_STUCK_S 3600.0		/* ... nor one whose place does not get
					 * on for so long, dwells left out */

/* What the process removes, of what [sim] has. */
enum forecast_removal { FORECAST_ALL, FORECAST_HALF, FORECAST_TWICE,
			FORECAST_REMOVALS };

struct forecast_part {
	double to_mm;			/* the last place in it */
	double cut_s[FORECAST_REMOVALS];	/* by what is removed */
	double moved_s, other_s;
	uint32_t cond;			/* in which it is cut: its index */
};

/* All 0: there is none.  Read, do not write. */
struct forecast {
	struct forecast_part *part;
	uint32_t nparts;
	double cut_s, moved_s, other_s;	/* of all parts, FORECAST_ALL */
	uint32_t nconds;
	char (*cond)[16];		/* their names; "" is that of 0; and
					 * "positioning" */
	char why_not[96];		/* it has no parts; "": it has */
};

/**
 * forecast_make() - run @p, FORECAST_ALL; @ret is filled and has to be freed.
 * @most_s: of the job's time; if it is not over by then, it gives up
 * @ends: it gives up when this becomes true; any thread may set it
 *
 * A job without end, or that the simulated machine cannot carry out, has no
 * parts, but a reason.
 *
 * Return: 0; -ENOMEM; -ECANCELED; -ETIME: by @most_s.
 */
int forecast_make(struct forecast *ret, const struct machine_config *c,
		  const struct interp_program *p, double most_s,
		  const atomic_bool *ends);

/**
 * forecast_vary() - run it FORECAST_HALF and FORECAST_TWICE, too.
 *
 * Until then, and where one of them comes to no end, half as much takes twice
 * as long.
 *
 * Return: 0; -ENOMEM; -ECANCELED.
 */
int forecast_vary(struct forecast *f, const struct machine_config *c,
		  const struct interp_program *p, const atomic_bool *ends);

/** forecast_part_at() - the part of place @far_mm, which is in part @at or one
 *  behind. */
uint32_t forecast_part_at(const struct forecast *f, uint32_t at, double far_mm);
void forecast_free(struct forecast *f);

#endif /* VIRTUAL_FORECAST_H */
