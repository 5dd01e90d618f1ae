/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_bits.h - lines whose changes of axis are planned and kept
 *
 * min-switch sends bursts (pulse/pair.h), which need no memory.  They may have
 * many more changes of axis than the tolerance demands: then the program keeps
 * the fewest, a bit for each pulse of each pair of the line.
 */
#ifndef PATH_BUILD_BITS_H
#define PATH_BUILD_BITS_H

#include "path/builder.h"

/* Changes of axis of bursts, in percent of the fewest, that are let be. */
#define BUILD_BITS_ENOUGH	103

/**
 * build_bits_add() - plan the line @w and put its bits into the table.
 *
 * @ret_arg: for interp_seg.arg; 0: the line goes by bursts.
 * Return: 0 or -ENOMEM.
 */
int build_bits_add(struct interp_build *b, const struct build_way *w,
		   uint32_t *ret_arg);

#endif /* PATH_BUILD_BITS_H */
