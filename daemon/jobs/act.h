/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.h - a command that does something is done once, whoever dies when
 *
 * An act's id is made of its key, client and seq, so the client decides it.
 * It is written to the store before it is handed to edmd, under the same id;
 * edmd takes an id once (shm.h).  What the service does itself is written
 * together with its answer, in one transaction, and answered after that.
 *
 *	killed before it is written	it never came; a repeat does it
 *	... before edmd took it		a repeat hands it over again
 *	... after that			a repeat is told what became of it
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_ACT_H
#define JOBS_ACT_H

#include <stdint.h>

struct jobs;
struct verb;
struct jobs_lcm_command;

/** act_take() - do it, or say what became of it. */
void act_take(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c);

/** act_commit() - what was written so far is kept.  Before it is handed over,
 *  and before it is answered.  Return: 0, or STORE_KEPT: not on the disk. */
int act_commit(struct jobs *j);

/** act_answered() - remember what is answered to act @id.  Return: as
 *  act_commit(). */
int act_answered(struct jobs *j, uint64_t id, int code, const char *reason);

#endif /* JOBS_ACT_H */
