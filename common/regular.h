/* SPDX-License-Identifier: Apache-2.0 */
/*
 * regular.h - opens a file in a folder where somebody may have left a symbolic
 * link, a fifo or a device under its name
 *
 * A link would lead to a file of somebody else; a fifo would keep who opens it
 * waiting.
 *
 * Threads: any.
 */
#ifndef COMMON_REGULAR_H
#define COMMON_REGULAR_H

#include <sys/types.h>

/**
 * regular_open() - open(), for a regular file under its own name; it never
 * waits.
 *
 * @mode: of a file that O_CREAT makes.
 *
 * Return: the file, closed on exec; -ELOOP: a symbolic link, or no regular
 * file; -errno.
 */
int regular_open(const char *path, int flags, mode_t mode);

/**
 * regular_check() - for a file that somebody else opens.
 *
 * Return: 0: it is regular, or there is none; -ELOOP; -errno.
 */
int regular_check(const char *path);

#endif /* COMMON_REGULAR_H */
