/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dispatch.h - gives a job to one machine of the hall
 *
 * It is a client of edmd-jobs as edmctl is, whose packets go over DDS (post.h):
 * signed with a key of the machine, judged by the machine's own edmd-jobs, and
 * answered with what that says.  So what fits a machine is decided where its
 * table, its electrodes and its generator are known.
 *
 * A job is in one queue, once, because
 *
 * - it has an id.  A machine that has it answers the same id and text with
 *   "is here already": what is repeated, replayed or sent twice adds nothing.
 *   Two dispatchers draw two ids, and neither needs to know of the other;
 * - a machine takes nothing before it has the whole text.  Before the last
 *   piece has gone out a machine that vanishes cannot have the job: the offer
 *   is back, and the next machine gets it.  A piece that is still under way
 *   then is refused a second and a half later, for its age;
 * - from the last piece on only that machine may have it, and no other one gets
 *   it before that one has refused.  While it is silent it is asked on, by the
 *   same id, also after its restart;
 * - a dispatcher that is killed has sent the last piece, or not: then the job
 *   is in that machine's queue, or nowhere.  It printed id and machine before;
 *   sent again to this machine by this id it is there once.  So an id is taken
 *   together with a machine only.
 *
 * Threads: one.
 */
#ifndef DDS_DISPATCH_H
#define DDS_DISPATCH_H

#include "hall.h"

struct dispatch_options {
	const char *path;		/* of the program; "-": stdin */
	const char *machine;		/* NULL: the first idle one that
					 * takes it */
	const char *keys;		/* folder of MACHINE.key */
	const char *id;			/* NULL: one is drawn */
	bool start;			/* else it waits for a start */
	bool json;
	double wait_s;			/* nothing new for so long: all are
					 * heard */
	size_t expect;			/* so many machines are there */
};

/**
 * dispatch_run() - returns when it is given, when nobody takes it, or at a
 * signal to stop.  Return: an exit code; it has said why.
 */
int dispatch_run(dds_entity_t participant, struct hall *h,
		 const struct dispatch_options *o);

#endif /* DDS_DISPATCH_H */
