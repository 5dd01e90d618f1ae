/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.h - does the electrode stand on ground that was cut already?
 *
 * Where a program positions out of what it cut, a short is debris and no
 * collision.  Which ground that is, the program says: the segments behind.
 *
 * Threads: RT-safe; looks at a bounded number of segments.
 */
#ifndef RT_GROUND_H
#define RT_GROUND_H

#include <stdbool.h>

struct cycle;

#define GROUND_SEGMENTS_MAX	512

/**
 * ground_is_cut() - within two pulses of a line or an arc behind that is no
 * rapid, on every axis.
 *
 * Of GROUND_SEGMENTS_MAX behind; curves and pairs of contours are not looked
 * at: there the ground counts as new.
 */
bool ground_is_cut(const struct cycle *c);

#endif /* RT_GROUND_H */
