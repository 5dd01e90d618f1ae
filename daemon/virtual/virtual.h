/* SPDX-License-Identifier: Apache-2.0 */
/*
 * virtual.h - a job on a simulated machine, in virtual time
 *
 * The cycle is edmd's own.  Time is the number of its periods, so a job takes
 * as long as the processor needs for them.  Nobody stands at this machine: what
 * a job asks for is confirmed at once, and it goes on.
 *
 * Threads: one object belongs to one thread; any number of objects.
 */
#ifndef VIRTUAL_VIRTUAL_H
#define VIRTUAL_VIRTUAL_H

#include "config.h"
#include "cycle.h"
#include "io.h"

struct virtual_options {
	const struct machine_config *config;
	const struct interp_program *program;
	uint64_t seed;
	bool dry_run;			/* without a gap */
	bool there_and_back;		/* it holds at the end of the program,
					 * and goes back fast */
};

/* All 0 at first.  Read, do not write. */
struct virtual {
	struct cycle cycle;
	struct io_machine io;
	struct io_inputs in;		/* of this cycle */
	struct io_outputs given;	/* to the machine, in this cycle */
};

/** virtual_at_once() - is there nothing to simulate: no gap, and axes that do
 *  not lag? */
bool virtual_at_once(const struct machine_config *c, bool dry_run);

/**
 * virtual_open() - the program is loaded, and held at its begin.
 *
 * Return: 0; -ENOMEM or another error of the simulated machine; -EINVAL: the
 * program is damaged.  Close it in any case.
 */
int virtual_open(struct virtual *v, const struct virtual_options *o);
void virtual_close(struct virtual *v);

/** virtual_stands() - is it held, and stands? */
bool virtual_stands(const struct virtual *v);
/** virtual_go_on() - confirm what it asks for, and start. */
void virtual_go_on(struct virtual *v);
/** virtual_step() - one period. */
void virtual_step(struct virtual *v);
/** virtual_is_over() - has the job ended, or is there a fault? */
bool virtual_is_over(const struct virtual *v);
/** virtual_s() - time since it was opened, also while it is held. */
double virtual_s(const struct virtual *v);

#endif /* VIRTUAL_VIRTUAL_H */
