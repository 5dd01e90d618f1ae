/* SPDX-License-Identifier: Apache-2.0 */
/*
 * written.h - did all of a file reach the disk, and if not, why?
 *
 * Threads: any.
 */
#ifndef COMMON_WRITTEN_H
#define COMMON_WRITTEN_H

#include <stdio.h>

/**
 * written_close() - close @f; stdout is flushed and stays open.
 *
 * Return: 0; -errno of the write that failed, such as -ENOSPC, also if that was
 * an earlier one.
 */
int written_close(FILE *f);

#endif /* COMMON_WRITTEN_H */
