/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_turn.h - whose turn it is in the queue, and lines of a job's text
 *
 * Jobs go in the order they came, unless one was moved.
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_STORE_TURN_H
#define JOBS_STORE_TURN_H

#include <stdbool.h>
#include <stdint.h>

struct store;

/* The order of the queue, in SQL. */
#define STORE_TURN	"coalesce(turn, n)"

/* The place of a job in the queue, as index job_by_turn has it; a smaller
 * number is earlier. */
#define STORE_IN_QUEUE	STORE_TURN " - loaded * 1e15"

#define STORE_LINES	200		/* at once */

/** store_move() - job @n changes places with the one before or behind it.
 *  To be called between store_together() and store_commit(): two jobs of one
 *  turn could not change places any more.
 *  Return: 0; -ENOENT if there is none; -EIO. */
int store_move(struct store *s, uint32_t n, bool ahead);

/** store_move_all() - the same, before or behind all of those that wait. */
int store_move_all(struct store *s, uint32_t n, bool ahead);

/**
 * store_lines() - STORE_LINES lines of job @n from line @first on, as JSON:
 * an object of `first` and `text`.  Fewer if they are long.
 * Return: to be freed; NULL: no memory, or no such line.
 */
char *store_lines(struct store *s, uint32_t n, uint32_t first);

#endif /* JOBS_STORE_TURN_H */
