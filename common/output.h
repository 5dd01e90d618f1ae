/* SPDX-License-Identifier: Apache-2.0 */
/*
 * output.h - did all of a file reach the disk, and if not, why?
 *
 * Threads: any.
 */
#ifndef COMMON_OUTPUT_H
#define COMMON_OUTPUT_H

#include <stdio.h>

/**
 * output_close() - close @f; stdout is flushed and stays open.
 *
 * Return: 0; -errno of the write that failed, such as -ENOSPC, also if that was
 * an earlier one.
 */
int output_close(FILE *f);

#endif /* COMMON_OUTPUT_H */
