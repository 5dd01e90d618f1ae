/* SPDX-License-Identifier: Apache-2.0 */
/*
 * standard.h - standard input, output and error, from the start to the exit
 *
 * Threads: one, at the start of the program, but for standard_interrupt().
 */
#ifndef COMMON_STANDARD_H
#define COMMON_STANDARD_H

/**
 * standard_guard() - descriptors 0 to 2 are open from here on, so none of them
 * becomes that of a socket or of shared memory; and if standard output cannot
 * take what was printed, the program says so at its exit, which is then
 * EX_IOERR.
 */
void standard_guard(const char *program);

/**
 * standard_interrupt() - a signal has come that ends the program.  If standard
 * output is not complete then, that is the reason, and the exit is EX_TEMPFAIL.
 * Any thread, also a handler of signals.
 */
void standard_interrupt(void);

#endif /* COMMON_STANDARD_H */
