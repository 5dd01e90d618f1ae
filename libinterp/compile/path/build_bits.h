/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_bits.h - lines whose changes of axis are planned and stored
 *
 * min-switch sends bursts (pulse/pair.h), which need no memory.  They may have
 * many more changes of axis than the tolerance requires.  Then the program
 * stores the walk with the fewest changes, one bit for each pulse of each pair
 * of the line.
 */
#ifndef PATH_BUILD_BITS_H
#define PATH_BUILD_BITS_H

#include "path/builder.h"

/* Bursts are kept if they have at most so many changes of axis, in percent of
 * the fewest. */
#define BUILD_BITS_ENOUGH	103

/**
 * build_bits_add() - plan the line @w of so many @ticks and put its bits into
 * the table.
 *
 * @ret_arg: for interp_seg.arg; 0: the line uses bursts.
 *
 * Return: 0; or as build_walk(), before it is planned.  A builder that counts
 * does no more than that.
 */
int build_bits_add(struct interp_build *b, const struct build_way *w,
		   uint32_t ticks, uint32_t *ret_arg, struct interp_diag *diag);

#endif /* PATH_BUILD_BITS_H */
