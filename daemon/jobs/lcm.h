/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire.h - the LCM side of edmd-jobs: our structs in and out
 *
 * The only place that knows the generated messages.  What comes in is checked
 * for its shape before it is decoded: lengths inside the packet, strings
 * ended.  What the fields mean is checked by who takes them.
 *
 * Units: in every name.  Threads: one, that of the event loop.
 */
#ifndef JOBS_WIRE_H
#define JOBS_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WIRE_NAXES	8
#define WIRE_CLIENT_MAX	64		/* with its NUL */
#define WIRE_ID_MAX	64		/* with its NUL */
#define WIRE_CHUNK_MAX	32768

struct wire;

struct wire_command {
	const char *client;
	int64_t seq;
	const char *verb, *job, *text;
	double arg;
};

struct wire_chunk {
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
};

struct wire_ack {
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
	const char *daemon, *state, *fault, *faults;
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
	void *arg;
};

/**
 * wire_url_check() - does what is sent to @url stay on this host?
 * Return: NULL if so, else what is wrong with it, in words.
 */
const char *wire_url_check(const char *url);

/**
 * wire_open() - join the channels of @machine.
 * Return: 0; -ENETUNREACH if LCM cannot open @url; -ENOMEM.
 */
int wire_open(struct wire **ret, const char *url, const char *machine,
	      const struct wire_handlers *h);

/** wire_close() - NULL is fine. */
void wire_close(struct wire *w);

/** wire_fd() - readable when wire_handle() has something to do. */
int wire_fd(const struct wire *w);

/** wire_handle() - take one message. Return: 0 or -EIO. */
int wire_handle(struct wire *w);

void wire_ack(struct wire *w, const struct wire_ack *a);
void wire_event(struct wire *w, const struct wire_event *e);
void wire_status(struct wire *w, const struct wire_status *s);

/** wire_refused() - packets dropped for their shape, so far. */
uint64_t wire_refused(const struct wire *w);

#endif /* JOBS_WIRE_H */
