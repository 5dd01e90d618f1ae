/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tally.h - what the job in the machine comes to: by condition, where it was,
 * where it retracted
 *
 * edmd counts for the job as a whole.  Every 20 ms, what was added since the
 * last look goes to the condition in force.  So the conditions of a job add up
 * to the sums of the job, whatever was missed: what was counted while this
 * service was away goes to the condition that is in force when it comes back,
 * and what a checkpoint knows and the store does not goes to the condition of
 * that checkpoint.
 *
 * The trail is the way of X Y Z as it was gone, at most TALLY_POINTS places: if
 * there are more, every second one is dropped, and the distance between two of
 * them doubles.  Retracts are counted in TALLY_SPOTS equal parts of the path.
 *
 * Both go to the store at the end of the job; before that seldom, so that they
 * are no load on the disk.  Places are those of the whole program, also of a
 * job that was resumed.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_TALLY_H
#define JOBS_TALLY_H

#include "again_kept.h"

#include <stdbool.h>
#include <stdint.h>

#define TALLY_CONDITIONS	100	/* one more is counted as "others" */
#define TALLY_POINTS		512
#define TALLY_SPOTS		256

struct jobs;

/* Units as in edmd's sums; energy_j NAN: not counted by the machine. */
struct tally_sums {
	double job_s, erode_s, energy_j;
	uint32_t jumps, retracts, shorts, arcs;
};

struct tally_row {
	char condition[16];		/* "": none was called yet */
	struct tally_sums sums;
};

struct tally_spot {
	double place_mm;		/* of the last one in this part */
	uint32_t line, retracts;
};

struct tally_point {
	double mm[3], place_mm;
	bool cut;			/* the way to it was under power */
};

struct tally {
	uint32_t n;			/* of the job; 0: none */
	bool goes_on;			/* not from its beginning, but as ... */
	struct again again;		/* ... this says */
	struct tally_sums seen;		/* the sum of the rows */
	struct tally_row row[TALLY_CONDITIONS];
	uint32_t nrows;
	struct tally_spot spot[TALLY_SPOTS];
	struct tally_point point[TALLY_POINTS];
	uint32_t npoints;
	double step_mm, length_mm;
	bool under_power;		/* at the look before */
	int64_t retracted_ns;		/* time of the last one counted */
	char written[16];		/* condition when `used` was written */
	int64_t used_us, trail_us;	/* when, monotonic */
	bool stood;			/* it was held, or in a fault, then */
};

/** tally_look() - every 20 ms: the snapshot of the job in the machine. */
void tally_look(struct jobs *j, int64_t now_us);

/** tally_event() - one of edmd's events, of the job in the machine.
 *  @again: it may have been heard before. */
void tally_event(struct jobs *j, const struct shm_event *e, bool again);

/** tally_end() - the job is @over, or interrupted; @whole has its sums.  The
 *  trail of an interrupted one that was not written yet is made again on its
 *  way in. */
void tally_end(struct jobs *j, const struct shm_snapshot *whole, bool over);

/** tally_forget() - the job is no more in the machine. */
void tally_forget(struct jobs *j);

/** tally_settle() - job @n ended while this service was away. */
void tally_settle(struct jobs *j, uint32_t n, const struct shm_ended *e);

/* -- tally_json.c --------------------------------------------------------- */

/** tally_read() - of job t->n, from the store.  What is not there is empty. */
void tally_read(struct jobs *j, struct tally *t);
void tally_write_used(struct jobs *j, const struct tally *t);
void tally_write_trail(struct jobs *j, const struct tally *t);

#endif /* JOBS_TALLY_H */
