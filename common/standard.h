/* SPDX-License-Identifier: Apache-2.0 */
/*
 * standard.h - standard input, output and error, from the start to the exit
 *
 * Threads: one, at the start of the program, but for standard_interrupt().
 */
#ifndef COMMON_STANDARD_H
#define COMMON_STANDARD_H

#include <stdio.h>

/**
 * standard_guard() - descriptors 0 to 2 are open from here on, so none of them
 * becomes that of a socket or of shared memory; and if standard output cannot
 * take what was printed, the program says so at its exit, which is then
 * EX_IOERR.
 *
 * stdout and stderr print plain text (plain.h) from here on, with `?` for each
 * byte that is not.  So no name of a file, no machine file and no packet can
 * move the cursor of a terminal, whoever prints it.
 */
void standard_guard(const char *program);

/**
 * standard_control() - what moves the cursor: a constant of the program's own.
 * @f: stdout or stderr.
 */
void standard_control(FILE *f, const char *sequence);

/**
 * standard_raw() - stdout is data from here on, or that of a library which
 * draws: what is printed there is not looked at.
 */
void standard_raw(void);

/**
 * standard_interrupt() - a signal has come that ends the program.  If standard
 * output is not complete then, that is the reason, and the exit is EX_TEMPFAIL.
 * Any thread, also a handler of signals.
 */
void standard_interrupt(void);

#endif /* COMMON_STANDARD_H */
