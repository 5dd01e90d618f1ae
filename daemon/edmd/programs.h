/* SPDX-License-Identifier: Apache-2.0 */
/*
 * programs.h - map a program for the cycle, and let it go
 *
 * Threads: main thread only.
 */
#ifndef EDMD_PROGRAMS_H
#define EDMD_PROGRAMS_H

#include "crossing.h"

#include "config.h"

/**
 * program_open() - map program.<n>, check it and keep it in memory.
 *
 * Return: NULL if this fails; the log says why.
 */
struct program *program_open(const struct machine_config *c, uint32_t n);

/** program_close() - @p may be NULL. */
void program_close(struct program *p);

/**
 * programs_serve() - do what the cycle has asked for.
 *
 * @ahead: the program that was copied before it is loaded; NULL: none.  Loading
 * takes it if it is of the same file, and closes it otherwise.
 */
void programs_serve(struct crossing *x, const struct machine_config *c,
		    struct program **ahead);

#endif /* EDMD_PROGRAMS_H */
