/* SPDX-License-Identifier: Apache-2.0 */
/*
 * electrode.h - the electrode in the machine
 *
 * docs/electrodes.md has the equations and the signs.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_ELECTRODE_H
#define JOBS_ELECTRODE_H

#include "store_electrode.h"

struct jobs;
struct verb;
struct jobs_lcm_command;

/** electrode_held() - the number of the one in the holder; 0: nobody said. */
uint32_t electrode_held(struct jobs *j);

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

#endif /* JOBS_ELECTRODE_H */
