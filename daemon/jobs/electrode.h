/* SPDX-License-Identifier: Apache-2.0 */
/*
 * electrode.h - the electrode in the machine: which one a job needs, by how
 * much it shifts the path, and how much the job wears it
 *
 * docs/electrodes.md has the equations and the signs.  A loaded job is divided
 * into parts, each cut by one electrode, and each part has a row in the store
 * (struct store_worn).  The shift is fixed when the job is first loaded, and
 * stays the same when the job is resumed.  The wear of a part is estimated from
 * the farthest place that the path has reached.  So no wear is counted twice,
 * even if edmd or edmd-jobs dies.
 *
 * Units: in every name; mm along Z.  Threads: one, that of the event loop.
 */
#ifndef JOBS_ELECTRODE_H
#define JOBS_ELECTRODE_H

#include "shm.h"
#include "store_electrode.h"

#include "interp/nc.h"
#include "interp/wear.h"

#define ELECTRODE_WHY_MAX	400

struct jobs;
struct verb;
struct jobs_lcm_command;
struct checkpoint_base;
struct compiler_request;
struct compiler_result;

/* All 0 at first. */
struct electrode {
	uint32_t n;			/* the program that this is about; 0:
					 * none */
	struct interp_wear wear;
	struct store_worn worn[INTERP_ELECTRODES_MAX];	/* one for each change
							 * of electrode */
	double cut_mm;			/* the path was cut up to here before
					 * the job was resumed */
	int now;			/* the last change; -1: none yet */
	/* The table that the job was compiled with. */
	struct interp_electrode asked[STORE_ELECTRODES_MAX];
	size_t nasked;
	/* The job that was not loaded because an electrode is missing, and
	 * why; "": none. */
	uint32_t refused;
	char why[ELECTRODE_WHY_MAX];
};

/** electrode_held() - the number of the electrode in the holder; 0: not
 *  known. */
uint32_t electrode_held(struct jobs *j);

/** electrode_request() - fill in the table for the compiler.  @job: NULL if it
 *  is not in the store yet; then @chosen is the electrode that it names. */
void electrode_request(struct jobs *j, const struct store_job *job,
		       uint32_t chosen, struct compiler_request *ret);

/** electrode_check() - may the compiled text be accepted?
 *  Return: NULL; or why not, and what would be accepted. */
const char *electrode_check(struct jobs *j, const struct compiler_result *r);

/** electrode_load() - the program of the loaded job wears its electrodes by
 *  @wear, which now belongs to this module: may it begin?  Return: NULL; or why
 *  not, and what would be accepted. */
const char *electrode_load(struct jobs *j, struct interp_wear *wear);

/** electrode_wait() - job @n does not begin, and is not tried again before the
 *  table changes. */
void electrode_wait(struct jobs *j, uint32_t n, const char *why);

/** electrode_waits() - does the next job wait for a change of the table? */
bool electrode_waits(struct jobs *j);

/** electrode_take() - divide the program of the loaded job into its parts, if
 *  that was not done.  Of a long one it takes some 20 ms. */
void electrode_take(struct jobs *j);

/** electrode_follow() - follow the loaded job; to be called every 20 ms. */
void electrode_follow(struct jobs *j);

/** electrode_used_mm() - the wear of the present part so far. */
double electrode_used_mm(const struct jobs *j);

/** electrode_book() - store the wear of the present part, so far or at its
 *  end. */
void electrode_book(struct jobs *j);

/** electrode_tell() - the job is over: send an event with its wear. */
void electrode_tell(struct jobs *j);

/** electrode_interrupted() - the same for a job whose last checkpoint is @b. */
void electrode_interrupted(struct jobs *j, const struct checkpoint_base *b);

/** electrode_settle() - the same for job @n, which ended as @ended says while
 *  this service was away. */
void electrode_settle(struct jobs *j, uint32_t n,
		      const struct shm_ended *ended);

/** electrode_is_worn() - is its life used up? */
bool electrode_is_worn(const struct store_electrode *e);

/** electrode_forget() - the job is gone from edmd. */
void electrode_forget(struct jobs *j);

/* -- verbs_electrode.c: functions of rows -- */

/* Answers with the electrodes whose number is above arg. */
void electrode_list(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c);
/* arg is the number; text has lines KEY=VALUE. */
void electrode_add(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);
void electrode_set(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);
void electrode_remove(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c);
/* arg is the number of the electrode in the holder; 0: it is empty. */
void electrode_use(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);

/** electrode_find_named() - find the electrode that a command names.
 *  Return: false if there is none, and the sender was told. */
bool electrode_find_named(struct jobs *j, const struct jobs_lcm_command *c,
			  struct store_electrode *ret);

/* -- electrode_measure.c -- */

/** electrode_no_length() - why its length cannot be taken, as that of a new
 *  one or not; NULL: it can. */
const char *electrode_no_length(const struct store_electrode *e, bool is_new);

/** electrode_put_length() - electrode @number was felt, and is so long now.
 *  @told: what was and what is.  Return: that of the store. */
int electrode_put_length(struct jobs *j, uint32_t number, double length_mm,
			 bool is_new, char told[ELECTRODE_WHY_MAX]);

/* Puts a job into the queue that measures the electrode.  If the text is "new",
 * the result is its length when it was new. */
void electrode_measure(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c);

#endif /* JOBS_ELECTRODE_H */
