/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tally.h - the sums of the job in the machine: for each condition, with the
 * trail of the axes and the places of the retracts
 *
 * edmd counts for the job as a whole.  Every 20 ms, what was added since the
 * last look is counted for the condition in force.  So the sums of all
 * conditions always add up to the sums of the job.  What edmd counted while
 * this service was away belongs to the condition that is in force when the
 * service comes back.  What a checkpoint has and the store has not belongs to
 * the condition of that checkpoint.
 *
 * The trail is the way that X Y Z went, as at most TALLY_POINTS places.  If
 * there are more, every second one is dropped, and from then on they are twice
 * as far apart.  Retracts are counted in TALLY_SPOTS equal parts of the path.
 *
 * Sums and trail are stored at the end of the job.  Before that they are stored
 * seldom, to spare the disk.  Places are those of the whole program, also for a
 * job that was resumed.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_TALLY_H
#define JOBS_TALLY_H

#include "inside_kept.h"

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
	char condition[16];		/* "": before the first one */
	struct tally_sums sums;
};

struct tally_spot {
	double place_mm;		/* of the last one in this part */
	uint32_t line, retracts;
};

struct tally_point {
	double mm[3], place_mm;
	bool cut;			/* the axes went to it with power on */
};

struct tally {
	uint32_t n;			/* of the job; 0: none */
	bool goes_on;			/* it did not begin at the start of its
					 * text, but as ... */
	struct inside again;		/* ... this says */
	struct tally_sums seen;		/* the sum of the rows */
	struct tally_row row[TALLY_CONDITIONS];
	uint32_t nrows;
	struct tally_spot spot[TALLY_SPOTS];
	struct tally_point point[TALLY_POINTS];
	uint32_t npoints;
	double step_mm, length_mm;
	bool under_power;		/* at the last look */
	int64_t retracted_ns;		/* time of the last retract that was
					 * counted */
	char written[16];		/* condition when `used` was written */
	int64_t used_us, trail_us;	/* when they were written, monotonic */
	bool stood;			/* the job was held, or in a fault,
					 * then */
};

/** tally_look() - take the snapshot of the job; to be called every 20 ms. */
void tally_look(struct jobs *j, int64_t now_us);

/** tally_event() - take an event of edmd about the job in the machine.
 *  @again: it may have been taken before. */
void tally_event(struct jobs *j, const struct shm_event *e, bool again);

/** tally_end() - the job is @over, or else interrupted; @whole has its sums.
 *  If it is interrupted, the part of its trail that is not stored yet is
 *  recorded again when the job comes to its place again. */
void tally_end(struct jobs *j, const struct shm_snapshot *whole, bool over);

/** tally_forget() - the job is not in the machine any more. */
void tally_forget(struct jobs *j);

/** tally_settle() - job @n ended while this service was away. */
void tally_settle(struct jobs *j, uint32_t n, const struct shm_ended *e);

/* -- tally_json.c --------------------------------------------------------- */

/** tally_read() - read the tally of job t->n.  What is not stored is empty. */
void tally_read(struct jobs *j, struct tally *t);
void tally_write_used(struct jobs *j, const struct tally *t);
void tally_write_trail(struct jobs *j, const struct tally *t);

#endif /* JOBS_TALLY_H */
