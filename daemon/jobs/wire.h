/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire.h - the LCM side of edmd-jobs: our structs in and out
 *
 * The only place that knows the generated messages.  What comes in must be
 * signed (trust.h), and is checked for its shape before it is decoded: lengths
 * inside the packet, strings ended.  What the fields mean is checked by who
 * takes them.  What goes out is signed with the machine's key.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_WIRE_H
#define JOBS_WIRE_H

#include "trust.h"
#include "udpm.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WIRE_NAXES	8
#define WIRE_CLIENT_MAX	64		/* with its NUL */
#define WIRE_ID_MAX	64		/* with its NUL */
#define WIRE_CHUNK_MAX	32768
#define WIRE_AGAIN	100		/* ack code: sign it again */

struct wire;

struct wire_command {
	const uint8_t *key;		/* who signed it */
	const char *client;
	int64_t seq;
	const char *verb, *job, *text;
	double arg;
	const struct trust_key *by;	/* the same key, in the table */
	const char *from;		/* address and port */
};

struct wire_chunk {
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

struct wire_ack {
	const uint8_t *key;		/* of who is answered */
	const char *client;
	int64_t seq;
	int code;
	const char *reason, *body;	/* NULL is "" */
};

struct wire_event {
	const char *kind, *job, *outcome, *text;	/* NULL is "" */
	double place_mm;
};

struct wire_status {
	const char *daemon, *state, *fault;
	const char *job, *job_name, *job_state, *condition;
	uint32_t line, lines;
	double place_mm, length_mm, progress;
	double pos_mm[WIRE_NAXES];
	double gap_v, feed_mm_s, depth_mm;
	double contour_mm, contour_predicted_mm;
	uint32_t jumps, retracts, shorts;
	double job_s, left_s;
	uint32_t queue_len, overruns, wake_late_max_us;
};

/* What lent pointers hold is gone when the function returns. */
struct wire_handlers {
	void (*command)(void *arg, const struct wire_command *c);
	void (*chunk)(void *arg, const struct wire_chunk *c);
	struct trust *trust;		/* lent */
	void *arg;
};

/**
 * wire_open() - join the channels of @machine.
 * Return: 0; -ENOMEM; -ENETUNREACH or another -errno if the group cannot be
 * joined.
 */
int wire_open(struct wire **ret, const struct udpm_url *url,
	      const char *machine, const struct wire_handlers *h);

/** wire_close() - NULL is fine. */
void wire_close(struct wire *w);

/** wire_fd() - readable when wire_handle() has something to do. */
int wire_fd(const struct wire *w);

/** wire_handle() - take one message, if it is to be taken. */
void wire_handle(struct wire *w);

void wire_ack(struct wire *w, const struct wire_ack *a);
void wire_event(struct wire *w, const struct wire_event *e);
void wire_status(struct wire *w, const struct wire_status *s);

#endif /* JOBS_WIRE_H */
