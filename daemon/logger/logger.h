/* SPDX-License-Identifier: Apache-2.0 */
/*
 * logger.h - lines on stderr that never hold their writer up
 *
 * Who reads stderr may stand still: a full pipe, a stopped terminal, a journal
 * under load.  So lines go into a bounded ring, and a thread of its own writes
 * them.  What does not fit is dropped and counted, and the count is told when
 * there is room again.  Of one cause no more than LOGGER_A_SECOND are told in a
 * second; how many more there were is told after it.
 *
 * Before logger_start(), and in a program that never calls it, a line is written
 * at once.
 *
 * Threads: any but the cycle.
 */
#ifndef EDM_LOGGER_H
#define EDM_LOGGER_H

#include <stdarg.h>

#define LOGGER_BYTES_MAX	1024		/* with prefix and newline */
#define LOGGER_SLOTS	256
#define LOGGER_A_SECOND	50

/** logger_start() - from now on by a thread.  Return: 0 or -errno. */
int logger_start(void);

/** logger_stop() - write what is left, if it can be written in 0.2 s. */
void logger_stop(void);

/**
 * logger_say() - @prefix and the text, a newline behind.
 * @format: also the cause by which lines are counted: a literal.
 */
void logger_say(const char *prefix, const char *format, va_list args)
	__attribute__((format(printf, 2, 0)));

#endif /* EDM_LOGGER_H */
