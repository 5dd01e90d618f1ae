/* SPDX-License-Identifier: Apache-2.0 */
/*
 * eta.h - how long the job in the machine will still take
 *
 * The forecast (forecast.h) says how long each part of the path takes.  What
 * the parts that are done have taken while they were cut is compared with it,
 * condition by condition, and the parts to come are corrected by that.  So a
 * process that removes half of what was believed is noticed in the condition
 * in which it does, and no jump, retract or stand is taken for progress.  What
 * was positioned is compared, too: it takes longer by an override.
 *
 * How much slower the process is than was believed is found so that forecasts
 * of other removals explain what was cut: what is cut at the programmed feed
 * says little of it, and has little of it.  What is left unexplained is a plain
 * factor.  A condition that was not cut yet has both of the others.
 *
 * A factor is what cutting takes of its forecast: 2 is twice as long.  Those
 * that earlier jobs had are where the job begins.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_ETA_H
#define JOBS_ETA_H

#include "forecast.h"

#include <stdbool.h>
#include <stdint.h>

struct eta_cond {
	double learnt;			/* factor of earlier jobs; 0: none */
	double passed_s, expected_s;	/* of the parts that are done; expected:
					 * as forecast */
	double late_passed_s, late_s[FORECAST_REMOVALS];	/* what is long
					 * ago counts less */
	double all_s[FORECAST_REMOVALS];	/* of all parts, as forecast */
	double left_s[FORECAST_REMOVALS];	/* ... and of those to come */
	bool told;			/* that the job takes longer by it */
};

/* What the job has taken so far, as the cycle counts it (cycle.h). */
struct eta_spent {
	double cut_s, moved_s, other_s;
};

/* Read, do not write; all 0 at first. */
struct eta {
	uint32_t n;			/* the program it is of; 0: none */
	struct forecast forecast;
	struct eta_cond *cond;		/* as many as the forecast has, and then
					 * that of positioning */
	uint32_t at;			/* the part that it is in, ... */
	struct eta_spent entered, now;	/* ... when it came there; at the last
					 * look */
	double least_s;			/* smallest left_s since it was told
					 * that the job takes longer */
};

/* What it comes to. */
enum eta_by {
	ETA_NONE,			/* there is no estimate */
	ETA_FORECAST,			/* nothing was cut yet */
	ETA_LEARNT,			/* ... but earlier jobs were */
	ETA_CUT,			/* by what was cut of this job */
};

struct eta_told {
	enum eta_by by;
	double left_s;			/* -1: not known */
	double min_s, max_s;		/* it lies between these */
	uint32_t cond;			/* that changes most, ... */
	double factor;			/* ... its factor, ... */
	double by_s;			/* ... and by how much */
};

/** eta_give() - use @of for program @n; @of has nothing any more.
 *  Return: 0; -ENOMEM: there is no estimate. */
int eta_give(struct eta *l, struct forecast *of, uint32_t n);

/** eta_learnt() - earlier jobs had this factor in condition @cond. */
void eta_learnt(struct eta *l, uint32_t cond, double factor);

/** eta_look() - the farthest place is @far_mm, after @spent of the job.  It may
 *  be called for the first time anywhere in the job. */
void eta_look(struct eta *l, double far_mm, const struct eta_spent *spent);

/** eta_passed_s() - what the job has taken until then, without waits. */
double eta_passed_s(const struct eta *l);

/** eta_tell() - the estimate at the last look. */
void eta_tell(const struct eta *l, struct eta_told *ret);

/** eta_rose() - does it take a tenth longer than it ever seemed to since this
 *  was so, by a condition that was not told yet?  Then somebody should be told;
 *  @ret is the estimate. */
bool eta_rose(struct eta *l, struct eta_told *ret);

/** eta_word() - "", "forecast", "learnt", "cut". */
const char *eta_word(enum eta_by by);

/** eta_fini() - free everything. */
void eta_fini(struct eta *l);

#endif /* JOBS_ETA_H */
