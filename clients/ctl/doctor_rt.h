/* SPDX-License-Identifier: Apache-2.0 */
/*
 * doctor_rt.h - what a host does with the real-time threads of a living edmd
 *
 * Each function writes what it found into @found and judges it.  @root stands
 * before /proc and /sys: "" on a host.
 *
 * Threads: one.
 */
#ifndef CTL_DOCTOR_RT_H
#define CTL_DOCTOR_RT_H

#include <stdbool.h>
#include <stddef.h>

enum verdict { GOOD, UNUSED, BAD };

struct doctor_rt {
	const char *root;
	int pid;			/* of edmd; 0: none lives */
};

typedef enum verdict doctor_rt_fn(const struct doctor_rt *d, char *found,
				  size_t size);

/** doctor_rt_core() - are the cores of its threads isolated, and their own? */
doctor_rt_fn doctor_rt_core;

/** doctor_rt_governor() - do these cores keep their frequency? */
doctor_rt_fn doctor_rt_governor;

/** doctor_rt_throttle() - does the kernel stop real-time threads? */
doctor_rt_fn doctor_rt_throttle;

/**
 * doctor_rt_irqs() - the threads of the interrupts of CAN and of lines: above
 * those of others, and not above the cycle on its own core.
 */
doctor_rt_fn doctor_rt_irqs;

/* A host that is to be set up. */
struct doctor_fix {
	const char *file;		/* of its machine */
	const char *root;		/* files lie below this; NULL: "" */
};

/**
 * doctor_fix() - write what edmd's threads need into units and into the kernel,
 * and print the rest.  Return: an exit code.
 */
int doctor_fix(const struct doctor_fix *asked);

#endif /* CTL_DOCTOR_RT_H */
