/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lines.h - lines on stderr that never hold their writer up
 *
 * Who reads stderr may stand still: a full pipe, a stopped terminal, a journal
 * under load.  So lines go into a bounded ring, and a thread of its own writes
 * them.  What does not fit is dropped and counted, and the count is told when
 * there is room again.  Of one cause no more than LINES_A_SECOND are told in a
 * second; how many more there were is told after it.
 *
 * Before lines_start(), and in a program that never calls it, a line is written
 * at once.
 *
 * Threads: any but the cycle.
 */
#ifndef EDM_LINES_H
#define EDM_LINES_H

#include <stdarg.h>

#define LINES_MAX_BYTES	1024		/* with prefix and newline */
#define LINES_SLOTS	256
#define LINES_A_SECOND	50

/** lines_start() - from now on by a thread.  Return: 0 or -errno. */
int lines_start(void);

/** lines_stop() - write what is left, if it can be written in 0.2 s. */
void lines_stop(void);

/**
 * lines_say() - @prefix and the text, a newline behind.
 * @format: also the cause by which lines are counted: a literal.
 */
void lines_say(const char *prefix, const char *format, va_list args)
	__attribute__((format(printf, 2, 0)));

#endif /* EDM_LINES_H */
