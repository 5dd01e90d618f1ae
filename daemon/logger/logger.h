/* SPDX-License-Identifier: Apache-2.0 */
/*
 * logger.h - lines on stderr that never delay the thread that writes them
 *
 * The reader of stderr may stop reading: a full pipe, a stopped terminal, a
 * journal under load. So lines go into a bounded ring, and a thread of its own
 * writes them. Lines that do not fit are dropped and counted, and the count is
 * written when there is room again. At most LOGGER_A_SECOND lines of one cause
 * are written in a second; after them comes a line that says how many more
 * there were.
 *
 * Before logger_start(), and in a program that never calls it, a line is
 * written at once.
 *
 * Threads: any but the cycle.
 */
#ifndef EDM_LOGGER_H
#define EDM_LOGGER_H

#include <stdarg.h>

#define LOGGER_BYTES_MAX	1024		/* with prefix and newline */
#define LOGGER_SLOTS	256
#define LOGGER_A_SECOND	50

/**
 * logger_start() - from now on a thread writes the lines. Return: 0 or -errno.
 */
int logger_start(void);

/**
 * logger_stop() - write the lines that are left, if that takes no longer than
 * 0.2 s.
 */
void logger_stop(void);

/**
 * logger_say() - @prefix and the text, a newline behind.
 * @format: also the cause by which lines are counted: a literal.
 */
void logger_say(const char *prefix, const char *format, va_list args)
	__attribute__((format(printf, 2, 0)));

#endif /* EDM_LOGGER_H */
