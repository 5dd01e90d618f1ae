/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lcm.h - the LCM side of edmd-jobs: our structs in and out
 *
 * The only place that knows the generated messages.  What comes in must be
 * signed (trust.h), and is checked for its shape before it is decoded: lengths
 * inside the packet, strings ended.  What the fields mean is checked by who
 * takes them.  What goes out is signed with the machine's key.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_LCM_H
#define JOBS_LCM_H

#include "trust.h"
#include "udpm.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define JOBS_LCM_NAXES	8
#define JOBS_LCM_CLIENT_MAX	64		/* with its NUL */
#define JOBS_LCM_ID_MAX	64		/* with its NUL */
#define JOBS_LCM_CHUNK_MAX	32768
#define JOBS_LCM_AGAIN	100		/* ack code: sign it again */

struct jobs_lcm;

struct jobs_lcm_command {
	const uint8_t *key;		/* who signed it */
	const char *client;
	int64_t seq;
	const char *verb, *job, *text;
	double arg;
	const struct trust_key *by;	/* the same key, in the table */
	const char *from;		/* address and port */
	uint64_t act;			/* its id, act.h; 0: none */
};

struct jobs_lcm_chunk {
	const uint8_t *key;
	const char *client;
	int64_t seq;
	const char *job, *name;
	int64_t bytes;			/* of the whole */
	const uint8_t *sha256;
	int32_t chunk, chunks;
	int64_t offset;
	bool hold;
	uint32_t size;
	const uint8_t *data;
	const struct trust_key *by;
	const char *from;
};

struct jobs_lcm_ack {
	const uint8_t *key;		/* of who is answered */
	const char *client;
	int64_t seq;
	int code;
	const char *reason, *body;	/* NULL is "" */
};

struct jobs_lcm_event {
	const char *kind, *job, *outcome, *text;	/* NULL is "" */
	double place_mm;
};

struct jobs_lcm_status {
	const char *daemon, *state, *fault, *faults;
	const char *job, *job_name, *job_state, *condition;
	uint32_t line, lines;
	double place_mm, length_mm, progress;
	double pos_mm[JOBS_LCM_NAXES];
	double gap_v, feed_mm_s, depth_mm;
	double contour_mm, contour_predicted_mm;
	uint32_t jumps, retracts, shorts;
	double job_s, eta_s;
	uint32_t queue_len, overruns, wake_late_max_us;
};

/* What lent pointers hold is gone when the function returns. */
struct jobs_lcm_handlers {
	void (*command)(void *arg, const struct jobs_lcm_command *c);
	void (*chunk)(void *arg, const struct jobs_lcm_chunk *c);
	struct trust *trust;		/* lent */
	void *arg;
};

/**
 * jobs_lcm_open() - join the channels of @machine.
 * Return: 0; -ENOMEM; -ENETUNREACH or another -errno if the group cannot be
 * joined.
 */
int jobs_lcm_open(struct jobs_lcm **ret, const struct udpm_url *url,
	      const char *machine, const struct jobs_lcm_handlers *h);

/** jobs_lcm_close() - NULL is fine. */
void jobs_lcm_close(struct jobs_lcm *w);

/** jobs_lcm_fd() - readable when jobs_lcm_handle() has something to do. */
int jobs_lcm_fd(const struct jobs_lcm *w);

/** jobs_lcm_handle() - take one message, if it is to be taken. */
void jobs_lcm_handle(struct jobs_lcm *w);

void jobs_lcm_ack(struct jobs_lcm *w, const struct jobs_lcm_ack *a);
void jobs_lcm_event(struct jobs_lcm *w, const struct jobs_lcm_event *e);
void jobs_lcm_status(struct jobs_lcm *w, const struct jobs_lcm_status *s);

#endif /* JOBS_LCM_H */
