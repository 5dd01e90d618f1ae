/* SPDX-License-Identifier: Apache-2.0 */
/*
 * resume.h - come back after a kill: held, at the recorded place
 *
 * Threads: startup only, before the loop.
 */
#ifndef EDMD_RESUME_H
#define EDMD_RESUME_H

#include "loop.h"

#include "config.h"

/**
 * resume() - stand where the snapshot @before says, if a job was under way.
 *
 * The state is held, whatever it was: nothing moves until a command says so.
 * The log tells what was found and what was done.
 */
void resume(struct loop *l, const struct machine_config *c,
	    const struct shm_snapshot *before);

#endif /* EDMD_RESUME_H */
