/* SPDX-License-Identifier: Apache-2.0 */
/*
 * child.h - other programs, run within bounds while the panel goes on
 *
 * What reads a text of strangers, or takes long, is done by a process of its
 * own with limits of memory, processor time and time.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_CHILD_H
#define PANEL_CHILD_H

#include <stddef.h>

#define CHILDREN_MAX	6
#define CHILDREN_KEPT	2	/* not for those with a limit of memory */

struct children;

struct child_job {
	const char *const *argv;	/* argv[0] is looked for in PATH */
	int in_fd;			/* its standard input; -1: none */
	size_t memory_bytes;		/* 0: as the panel has it */
	unsigned int limit_s;
};

/**
 * Called once.  @status: what it exited with; 128 and above: a signal ended
 * it, or the limits did.  @out_fd: a file of all it wrote to its standard
 * output; whoever gets it closes it.
 */
typedef void (*child_done_fn)(void *arg, int status, int out_fd);

struct children *children_create(void);
/** children_destroy() - ends them all; no one is called. */
void children_destroy(struct children *c);

/** child_start() - Return: 0; -EBUSY: too many run already; -errno. */
int child_start(struct children *c, const struct child_job *j,
		child_done_fn done, void *arg);

/** child_forget() - end what runs for @arg; it is not called. */
void child_forget(struct children *c, void *arg);

/** children_look() - has one ended?  Every 20 ms or so. */
void children_look(struct children *c);

/** child_file() - an empty file in memory; -errno. */
int child_file(const char *name);

/** child_read() - all of a file as text, at most @most bytes; NULL: too long,
 *  or no memory.  The file stays open. */
char *child_read(int fd, size_t most, size_t *ret_bytes);

#endif /* PANEL_CHILD_H */
