/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mdi.h - lines that are carried out at once, on a machine that is idle
 *
 * They are a job like any other: compiled, checked against the travel, in the
 * history.  But they never wait: what cannot begin now is refused.  They are
 * checked in a thread of their own, and begin if nothing else has begun
 * meanwhile and the one who asked still asks.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_MDI_H
#define JOBS_MDI_H

#include "jobs.h"
#include "verb.h"

#define MDI_TEXT_MAX	4000

/* What is to be carried out. */
struct mdi {
	const char *id, *name, *text;
	const char *by;			/* who asks: mdi_run() knows it */
	const char *dialect;		/* lent, until the end; NULL: that of
					 * the machine file */
	uint32_t measures;		/* as in struct store_job */
};

/** mdi_why_not() - why nothing can begin at once; NULL: it can. */
const char *mdi_why_not(const struct jobs *j);

/**
 * mdi_run() - check it, and put it where it begins at once.  The sender of @c
 * is answered when it is checked.
 */
void mdi_run(struct jobs *j, const struct jobs_lcm_command *c,
	     const struct mdi *m);

/** mdi_heard() - @c came once more: the one who asked still waits. */
void mdi_heard(struct jobs *j, const struct jobs_lcm_command *c);

/** mdi_give_up() - what is being checked must not begin. */
void mdi_give_up(struct jobs *j);

/** mdi_fini() - forget what is being checked; a repeat checks it anew. */
void mdi_fini(struct jobs *j);

/** mdi_take() - the verb "mdi". */
void mdi_take(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c);

#endif /* JOBS_MDI_H */
