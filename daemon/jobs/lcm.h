/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lcm.h - the LCM side of edmd-jobs: our structs in and out
 *
 * Only this module knows the generated messages. A message that comes in must
 * be signed (trust.h). Its shape is checked before it is decoded: lengths
 * inside the packet, strings with an end. What its fields mean is checked by
 * the function that takes them. What goes out is signed with the machine's key.
 *
 * Units: in every name. Threads: one, that of the event loop.
 */
#ifndef JOBS_LCM_H
#define JOBS_LCM_H

#include "trust.h"
#include "udpm.h"

#include "status_fields.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define JOBS_LCM_NAXES	8
#define JOBS_LCM_CLIENT_MAX	64		/* with its NUL */
#define JOBS_LCM_ID_MAX	64		/* with its NUL */
#define JOBS_LCM_CHUNK_MAX	32768
#define JOBS_LCM_AGAIN	100		/* ack code: sign it again */
/* What sets something in motion is taken so long after it was signed: who asked
 * may have given up since. */
#define JOBS_LCM_LATE_US	1500000

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
	int64_t signed_us;		/* when, by our clock */
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
	int32_t from_line;		/* as in edm.lcm */
	double from_mm;
	int32_t electrode;		/* 0: none was said */
	const char *setting;
	uint32_t size;
	const uint8_t *data;
	int64_t signed_us;		/* when, by our clock */
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

#define JOBS_LCM_WORD(name)	const char *name;
#define JOBS_LCM_COUNT(name)	uint32_t name;
#define JOBS_LCM_NUMBER(name)	double name;

/* The fields of words/status_fields.h; a word of NULL is "". */
struct jobs_lcm_status {
	STATUS_FIELDS(JOBS_LCM_WORD, JOBS_LCM_WORD, JOBS_LCM_COUNT,
		      JOBS_LCM_NUMBER)
	const char *faults;
	double pos_mm[JOBS_LCM_NAXES], work_mm[JOBS_LCM_NAXES];
	double contour_mm, contour_predicted_mm;
};

/* What lent pointers hold is gone when the function returns. */
struct jobs_lcm_handlers {
	void (*command)(void *arg, const struct jobs_lcm_command *c);
	void (*chunk)(void *arg, const struct jobs_lcm_chunk *c);
	/* What a verb wants; of one that is not known: TRUST_ASKS. */
	enum trust_want (*want)(const char *verb);
	/* A client with a known key came for the first time, and has been told
	 * the boot number.  What is sent now, it believes. */
	void (*guest)(void *arg);
	struct trust *trust;		/* lent */
	void *arg;
};

/**
 * jobs_lcm_open() - listen for clients of @machine: by a socket of this host
 * (local.h), and by multicast.  What is missing of these is in the log.
 *
 * Return: 0; -ENETUNREACH: there is neither; else -errno.
 */
int jobs_lcm_open(struct jobs_lcm **ret, const struct udpm_url *url,
	      const char *machine, const struct jobs_lcm_handlers *h);

/** jobs_lcm_close() - @w may be NULL. */
void jobs_lcm_close(struct jobs_lcm *w);

/** jobs_lcm_look() - join the group, if that was not possible before. */
void jobs_lcm_look(struct jobs_lcm *w, int64_t now_us);

/** jobs_lcm_fd() - readable when jobs_lcm_handle() has something to do. */
int jobs_lcm_fd(const struct jobs_lcm *w);

/** jobs_lcm_handle() - take one message, if it may be taken. */
void jobs_lcm_handle(struct jobs_lcm *w);

/** jobs_lcm_is_late() - too long ago to set something in motion? */
bool jobs_lcm_is_late(int64_t signed_us);

#define JOBS_LCM_LATE_TEXT "it came too late to be done; sign it again"

void jobs_lcm_ack(struct jobs_lcm *w, const struct jobs_lcm_ack *a);
void jobs_lcm_event(struct jobs_lcm *w, const struct jobs_lcm_event *e);
void jobs_lcm_status(struct jobs_lcm *w, const struct jobs_lcm_status *s);

#endif /* JOBS_LCM_H */
