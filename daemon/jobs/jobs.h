/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jobs.h - edmd-jobs as a whole: what its parts share
 *
 * One object, owned by main.c, passed to every part.
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_JOBS_H
#define JOBS_JOBS_H

#include "asks.h"
#include "begun.h"
#include "calls.h"
#include "checkpoint.h"
#include "config.h"
#include "due.h"
#include "early.h"
#include "electrode.h"
#include "eta.h"
#include "forecaster.h"
#include "link.h"
#include "origins.h"
#include "queue.h"
#include "reply.h"
#include "store.h"
#include "tally.h"
#include "trust.h"
#include "twin.h"
#include "upload.h"
#include "lcm.h"

#include <limits.h>
#include <sodium.h>
#include <systemd/sd-event.h>

struct jobs {
	const struct machine_config *config;
	const char *machine;
	struct udpm_url url;
	sd_event *event;
	struct jobs_lcm *lcm;
	struct store *store;
	struct link link;
	struct twin twin;
	struct uploads uploads;
	struct replies replies;
	struct begun begun;
	struct queue queue;
	struct asks asks;
	struct tally tally;
	struct calls calls;
	struct forecaster forecaster;
	struct eta eta;			/* made of its result */
	struct early early;
	struct electrode electrode;
	struct offset offset;
	struct trust trust;
	struct keyfile host_key;
	bool key_shared;		/* a copy of it is in /dev/shm */
	struct compiler *check[UPLOAD_SLOTS];	/* the check of
						 * uploads.slot[i] */
	struct mdi_check *mdi;		/* lines that are checked; NULL: none */
	struct due status;
	int64_t begun_us;		/* of this service */
	struct checkpoint_file *checkpoint;	/* NULL: there is none */
	const char *store_dir;
	char config_path[PATH_MAX];	/* of the machine file */
	int64_t checkpoint_again_us;	/* not before */
	int checkpoint_err;		/* of the last try */
	struct checkpoint last;		/* as it was found at the start */
	char interrupted[64];		/* id of the job that waits; or "" */
	uint32_t unseen;		/* axes that cannot be homed and were
					 * last seen at another place than
					 * edmd shows, and STORE_UNSEEN; a
					 * start or a resume answers for
					 * them */
	bool drives_to_ask;		/* interrupt_tick() */
	crypto_hash_sha256_state files;	/* files.h */
	uint8_t config_hash[32];	/* files_hash() for the job that is
					 * loaded */
	const char *store_told;		/* store_why() as it was last
					 * reported */
	bool act_open;			/* act.c: a transaction is open */
	bool note_open;			/* the same, up to a note */
	struct values *values;		/* NULL until they are asked for */
	int claim;			/* shm_writer_claim(); -1: none */
};

/**
 * jobs_now_us() - time of the monotonic clock; jobs_utime() - time since 1970.
 */
int64_t jobs_now_us(void);
int64_t jobs_utime(void);

/* Something that happened, for EVENT, store and journal. */
struct jobs_note {
	const char *kind, *job, *outcome;
	double place_mm;
};

/**
 * jobs_with_note() - what is written from here on is on the disk together with
 * the next jobs_note(), which comes before the loop goes on, or not at all.
 */
void jobs_with_note(struct jobs *j);

/** jobs_note() - record and publish it; @text is as for printf. */
void jobs_note(struct jobs *j, const struct jobs_note *n,
	       const char *text, ...)
	__attribute__((format(printf, 3, 4)));

/** jobs_add() - a new job, and publish its event, @n->told.  Return: as
 *  store_add() */
int jobs_add(struct jobs *j, const struct store_new *n);

/** jobs_answer() - answer a command; repeats of it get the same answer. */
void jobs_answer(struct jobs *j, const struct jobs_lcm_ack *a);

/** jobs_axes() - the letters of @axes, a bit for each, into @to.  Return: it */
const char *jobs_axes(uint32_t axes, char to[INTERP_NAXES + 1]);

/** status_tick() - publish STATUS if it is due or has changed. */
void status_tick(struct jobs *j, int64_t now_us);
/** status_guest() - publish it soon, for a client that has just come; called by
 * lcm.c. */
void status_guest(void *jobs);

/** verbs_take() - take a COMMAND; called by lcm.c. */
void verbs_take(void *jobs, const struct jobs_lcm_command *c);

/** verbs_want() - what a verb wants; called by lcm.c. */
enum trust_want verbs_want(const char *verb);

/** submit_take() - take a JOB chunk; called by lcm.c. */
void submit_take(void *jobs, const struct jobs_lcm_chunk *c);

/** submit_fini() - drop the texts that are being checked. */
void submit_fini(struct jobs *j);

#endif /* JOBS_JOBS_H */
