/* SPDX-License-Identifier: Apache-2.0 */
/*
 * live.h - what edmd does now, and what it did in the last hour
 *
 * Reads edmd's shared memory, and nothing else: the cycle does not know that
 * anyone looks.  One reader serves every browser.  An edmd that is started
 * anew is found by itself.
 *
 * Units: in every name; a rotary axis has degrees where a name says _mm.
 * Sign: feed + toward the program's end.
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_LIVE_H
#define PANEL_LIVE_H

#include "shm.h"

#include <jansson.h>

#define LIVE_POINT_MS	100		/* a point of the history is so long */
#define LIVE_POINTS	36000		/* an hour of them */

/* All that happened in LIVE_POINT_MS. */
struct live_point {
	int64_t utime_ms;		/* when it ended; 0: no such point */
	float gap_v[3];			/* smallest, mean, largest */
	float feed_mm_s[3];
	float depth_mm;
	uint32_t state;			/* enum shm_state at its end; 0: no
					 * edmd */
};

struct machine_config;
struct live;

/** live_create() - for the machine of @config, which stays the caller's. */
int live_create(struct live **ret, const struct machine_config *config);
/** live_destroy() - NULL is fine. */
void live_destroy(struct live *l);

/** live_look() - take what is new; every 20 to 50 ms. */
void live_look(struct live *l);

/** live_is_new_point() - did the last look end a point of the history? */
bool live_is_new_point(const struct live *l);

/** live_snapshot() - the newest; NULL while edmd was never seen. */
const struct shm_snapshot *live_snapshot(const struct live *l);

/** live_daemon() - "ok", "lost" (it is dead or stands still), "absent". */
const char *live_daemon(const struct live *l);

/** live_latency() - counts of lateness in us, SHM_LATENCY_BINS of them; NULL. */
const uint32_t *live_latency(const struct live *l);

/** live_fill() - put the state of the machine into @to, key by key. */
void live_fill(struct live *l, json_t *to);

/** live_last_point() - the newest point as an array. */
json_t *live_last_point(const struct live *l);

/**
 * live_history() - the last @seconds, drawn together to @points at most.
 *
 * An object of equally long arrays: t (ms since 1970), gap and feed with their
 * smallest and largest, depth, state.
 */
json_t *live_history(const struct live *l, double seconds, int points);

#endif /* PANEL_LIVE_H */
