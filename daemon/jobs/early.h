/* SPDX-License-Identifier: Apache-2.0 */
/*
 * early.h - an interrupted job with a long text is compiled before it is
 * resumed
 *
 * After a power cut the axes are looked at and homed, which takes longer than
 * to compile millions of lines.  So as soon as no axis has to be homed any
 * more, the rest of the job is compiled as a resume would do it.  A resume
 * takes what was made if it asks for the same, byte for byte, and if technology
 * table and dialect are still the same.  Otherwise it compiles.
 *
 * At most one program is kept, in memory: a file would have to be trusted, and
 * is several times as long as the text that has to be read otherwise.  edmd is
 * told to copy it, because to copy and hash it takes longer than all else that
 * a resume does then.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_EARLY_H
#define JOBS_EARLY_H

#include "compiler.h"
#include "store.h"

struct jobs;

/* Fields are private; all 0 at first. */
struct early {
	struct store_job job;
	struct compiler_request request;	/* of it, as last looked at */
	bool tried;			/* it was compiled, or is */
	struct compiler *compile;	/* under way; else NULL */
	struct compiler_result *made;	/* on the heap; NULL: there is none */
	int64_t look_us;		/* not before */
	uint32_t looked;		/* the job that was looked at last */
};

/** early_step() - compile the interrupted job, if there is one and the machine
 *  stands; to be called every 20 ms. */
void early_step(struct jobs *j, int64_t now_us);

/**
 * early_take() - @job is to be compiled by @request: hand over what was made
 * by the same one, as request->made, or forget it.
 *
 * Return: 0; -EAGAIN: it is being made, so ask again.
 */
int early_take(struct jobs *j, const struct store_job *job,
	       struct compiler_request *request);

void early_fini(struct jobs *j);

#endif /* JOBS_EARLY_H */
