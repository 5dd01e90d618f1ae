/* SPDX-License-Identifier: Apache-2.0 */
/*
 * offset.h - work offsets: touched off, kept, given to the compiler
 *
 *	machine place = R(turn) * programmed place + work offset
 *			+ shift of the electrode
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_OFFSET_H
#define JOBS_OFFSET_H

#include "compiler.h"
#include "jobs.h"
#include "verb.h"

/**
 * offset_request() - fill in the offsets for the compiler.
 *
 * @job: NULL if it is not in the store yet.  One that is loaded for the first
 * time keeps those in force, for when it is interrupted.
 *
 * Return: 0; -errno: they cannot be known, or kept.
 */
int offset_request(struct jobs *j, const struct store_job *job,
		   struct compiler_request *ret);

/** offset_touched() - the job is done: if it felt for an offset or an
 *  electrode, write down what it found.  Return: what was and what is; "". */
const char *offset_touched(struct jobs *j);

/** offset_now() - where places are counted from at the line that is cut, or, if
 *  no job is loaded, where a program would.  Return: it is known. */
bool offset_now(struct jobs *j, struct interp_origin *ret);

/** offset_place_mm() - the place that a program has for where @s stands. */
void offset_place_mm(const struct interp_origin *o,
		     const struct shm_snapshot *s,
		     double ret_mm[INTERP_NAXES]);

void offset_fini(struct jobs *j);

/* -- Functions of rows in verbs.c -- */

/* The array of all systems. */
void offset_list(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);
/* text: touch.h. */
void offset_set(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);

#endif /* JOBS_OFFSET_H */
