/* SPDX-License-Identifier: Apache-2.0 */
/*
 * live.h - what edmd does now, and what it did in the last hour
 *
 * It reads the shared memory of edmd and nothing else: the cycle does not know
 * that anybody looks. One reader serves every browser. If edmd is started anew,
 * the reader finds the new one by itself.
 *
 * Units: in every name; where a name says _mm, a rotary axis has degrees. Sign:
 * feed + toward the program's end.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_LIVE_H
#define PANEL_LIVE_H

#include "shm.h"

#include <jansson.h>

#define LIVE_POINT_MS	100		/* the time of one point of the
					 * history */
#define LIVE_POINTS	36000		/* points of one hour */

/* A summary of LIVE_POINT_MS. */
struct live_point {
	int64_t utime_ms;		/* when it ended; 0: there is no such
					 * point */
	float gap_v[3];			/* smallest, mean, largest */
	float feed_mm_s[3];
	float depth_mm;
	uint32_t state;			/* enum shm_state at its end; 0: no
					 * edmd */
};

struct machine_config;
struct live;

/** live_create() - follow the machine of @config, which must live as long. */
int live_create(struct live **ret, const struct machine_config *config);
/** live_destroy() - NULL is allowed. */
void live_destroy(struct live *l);

/** live_look() - take what is new; to be called every 20 to 50 ms. */
void live_look(struct live *l);

/** live_is_new_point() - did the last look end a point of the history? */
bool live_is_new_point(const struct live *l);

/** live_snapshot() - the newest snapshot; NULL if no edmd was ever seen. */
const struct shm_snapshot *live_snapshot(const struct live *l);

/** live_daemon() - "ok", "lost" (it is dead or stands still), "absent". */
const char *live_daemon(const struct live *l);

/**
 * live_latency() - the histogram of lateness in us, with SHM_LATENCY_BINS bins;
 * NULL if there is none.
 */
const uint32_t *live_latency(const struct live *l);

/** live_fill() - put the state of the machine into @to, key by key. */
void live_fill(struct live *l, json_t *to);

/** live_last_point() - the newest point as an array. */
json_t *live_last_point(const struct live *l);

/**
 * live_history() - the last @seconds, in at most @points points.
 *
 * Return: an object with arrays of the same length: t (ms since 1970), gap and
 * feed with their smallest and largest values, depth, state.
 */
json_t *live_history(const struct live *l, double seconds, int points);

#endif /* PANEL_LIVE_H */
