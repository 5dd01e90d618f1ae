/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ground.h - does the electrode stand on ground that was cut already?
 *
 * Where a program positions out of what it cut, a short is debris and no
 * collision.  Which ground that is, the program says: the segments behind, and
 * the cut that comes next, as far as it was cut before.
 *
 * Threads: RT-safe; looks at a bounded number of segments.
 */
#ifndef RT_GROUND_H
#define RT_GROUND_H

#include <stdbool.h>

struct cycle;

#define GROUND_SEGMENTS_MAX	512

/**
 * ground_is_cut() - is it, on every axis, as near to a cut behind as the
 * strategy keeps, or on the way out of an orbit?
 *
 * Of GROUND_SEGMENTS_MAX behind, up to a probing motion or another electrode.
 * What a time leaves out of a cycle counts as new.
 */
bool ground_is_cut(const struct cycle *c);

#endif /* RT_GROUND_H */
