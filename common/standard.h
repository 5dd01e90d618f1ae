/* SPDX-License-Identifier: Apache-2.0 */
/*
 * standard.h - standard input, output and error, from the start to the exit
 *
 * Threads: one, at the start of the program.
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

#endif /* COMMON_STANDARD_H */
