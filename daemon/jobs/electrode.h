/* SPDX-License-Identifier: Apache-2.0 */
/*
 * electrode.h - the electrode in the machine: what a job asks for, what it
 * shifts, what the job takes off it
 *
 * docs/electrodes.md has the equations and the signs.  A job that is loaded has
 * a row for each part of it that one electrode cuts (struct store_worn): its
 * shift is fixed when the job is first loaded, and holds when it is resumed.
 * What a part takes off its electrode is estimated by the farthest place of the
 * path, so nothing is counted twice, whichever program dies.
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
	uint32_t n;			/* the program it is of; 0: none */
	struct interp_wear wear;
	struct store_worn worn[INTERP_ELECTRODES_MAX];	/* by change */
	double cut_mm;			/* up to here it was cut before it was
					 * resumed */
	int now;			/* the change in force; -1: none yet */
	/* As the job that is being compiled got it. */
	struct interp_electrode asked[STORE_ELECTRODES_MAX];
	size_t nasked;
	/* The job that was not loaded for want of an electrode, and why; "":
	 * none. */
	uint32_t refused;
	char why[ELECTRODE_WHY_MAX];
};

/** electrode_held() - the number of the one in the holder; 0: nobody said. */
uint32_t electrode_held(struct jobs *j);

/** electrode_request() - fill in the table for the compiler.  @job: NULL if it
 *  is not in the store yet; then @chosen is what it asks for. */
void electrode_request(struct jobs *j, const struct store_job *job,
		       uint32_t chosen, struct compiler_request *ret);

/** electrode_check() - may the text that was compiled be taken?
 *  Return: NULL; else why not, and what would be. */
const char *electrode_check(struct jobs *j, const struct compiler_result *r);

/** electrode_load() - the program of the loaded job has this @wear, which is
 *  taken: may it begin?  Return: NULL; else why not, and what would be. */
const char *electrode_load(struct jobs *j, struct interp_wear *wear);

/** electrode_wait() - the job @n does not begin; nothing is tried again before
 *  the table changes. */
void electrode_wait(struct jobs *j, uint32_t n, const char *why);

/** electrode_waits() - does the job that is next wait for the table? */
bool electrode_waits(struct jobs *j);

/** electrode_follow() - every 20 ms, with the snapshot of the loaded job. */
void electrode_follow(struct jobs *j);

/** electrode_used_mm() - what the present part has taken off so far. */
double electrode_used_mm(const struct jobs *j);

/** electrode_book() - write down what the present part took off, so far or at
 *  its end. */
void electrode_book(struct jobs *j);

/** electrode_tell() - the job is over: say what it took off. */
void electrode_tell(struct jobs *j);

/** electrode_interrupted() - the same of a job whose last checkpoint is @b. */
void electrode_interrupted(struct jobs *j, const struct checkpoint_base *b);

/** electrode_settle() - the same of job @n, which ended as @ended says,
 *  unseen. */
void electrode_settle(struct jobs *j, uint32_t n,
		      const struct shm_ended *ended);

/** electrode_measured() - the job is done: if it measured one, write that
 *  down. */
void electrode_measured(struct jobs *j);

/** electrode_is_worn() - is its life used up? */
bool electrode_is_worn(const struct store_electrode *e);

/** electrode_forget() - the job is gone from edmd. */
void electrode_forget(struct jobs *j);

/* -- verbs_electrode.c: functions of rows -- */

/* The array of those above number arg. */
void electrode_list(struct jobs *j, const struct verb *v,
		    const struct jobs_lcm_command *c);
/* arg is the number; text has lines KEY=VALUE. */
void electrode_add(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);
void electrode_set(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);
void electrode_remove(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c);
/* 0: none. */
void electrode_use(struct jobs *j, const struct verb *v,
		   const struct jobs_lcm_command *c);

/** electrode_find_named() - the one that a command names.  Return: false: the
 *  sender was told why not. */
bool electrode_find_named(struct jobs *j, const struct jobs_lcm_command *c,
			  struct store_electrode *ret);

/* -- electrode_measure.c -- */

/* Makes a job that measures it.  The text is "new": it becomes the length of a
 * new one. */
void electrode_measure(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c);

#endif /* JOBS_ELECTRODE_H */
