/* SPDX-License-Identifier: Apache-2.0 */
/*
 * feed.h - how far to walk this cycle, by state
 *
 * Threads: RT-safe.
 */
#ifndef RT_FEED_H
#define RT_FEED_H

#include <stdbool.h>

struct cycle;

/** feed_distance() - signed distance along the path for this cycle, mm. */
double feed_distance(struct cycle *c);

/** feed_done() - has the mover come to the place it was sent to? */
bool feed_done(struct cycle *c);

#endif /* RT_FEED_H */
