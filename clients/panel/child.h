/* SPDX-License-Identifier: Apache-2.0 */
/*
 * child.h - run other programs within limits, while the panel goes on
 *
 * A text from outside is read by a process of its own, with limits of memory,
 * processor time and time. Work that takes long is done in the same way.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_CHILD_H
#define PANEL_CHILD_H

#include <stddef.h>

#define CHILDREN_MAX	24	/* and those that are being ended */

struct children;

struct child_job {
	const char *const *argv;	/* argv[0] is searched for in PATH */
	int in_fd;			/* its standard input; -1: none */
	size_t memory_bytes;		/* 0: the same as the panel */
	unsigned int limit_s;
};

/**
 * It is called once. @status is the exit status; 128 and above means that a
 * signal or a limit ended the program. @out_fd is a file with all that it wrote
 * to its standard output; the callee closes it.
 */
typedef void (*child_done_fn)(void *arg, int status, int out_fd);

struct children *children_create(void);
/** children_destroy() - end all of them; no callback is called. */
void children_destroy(struct children *c);

/**
 * child_start() - run a program. Return: 0; -EBUSY: too many run already;
 * -errno.
 */
int child_start(struct children *c, const struct child_job *j,
		child_done_fn done, void *arg);

/**
 * child_forget() - end the program that runs for @arg; its callback is not
 * called.
 */
void child_forget(struct children *c, void *arg);

/**
 * children_look() - handle the programs that have ended; to be called every 20
 * ms or so.
 */
void children_look(struct children *c);

/** child_file() - make an empty file in memory. Return: it, or -errno. */
int child_file(const char *name);

/**
 * child_read() - the whole file as a text, at most @most bytes. The file stays
 * open. Return: NULL if it is too long, or if there is no memory.
 */
char *child_read(int fd, size_t most, size_t *ret_bytes);

#endif /* PANEL_CHILD_H */
