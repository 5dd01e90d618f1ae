/* SPDX-License-Identifier: Apache-2.0 */
/*
 * upload.h - put the text of a job together from chunks
 *
 * Chunks come in any order, twice, or never. An upload is whole when every
 * chunk is there; before that it has no effect. Whether the text fits its hash
 * is looked at before it is compiled (compiler.h), because that takes long. The
 * decision about an upload is remembered for a while, for a client that missed
 * the answer and repeats a chunk.
 *
 * Threads: one object belongs to one thread.
 */
#ifndef JOBS_UPLOAD_H
#define JOBS_UPLOAD_H

#include "lcm.h"

#include "interp/setting.h"

#define UPLOAD_SLOTS		8
#define UPLOAD_BYTES_MAX	(64 << 20)
#define UPLOAD_CHUNKS_MAX	65536
#define UPLOAD_IDLE_US		30000000	/* without a new chunk */
#define UPLOAD_STALE_US		2000000		/* the same, if others wait */
#define UPLOADS_A_CLIENT	2
#define UPLOAD_VERDICTS		32

enum upload_state { UPLOAD_FREE, UPLOAD_FILLING, UPLOAD_WHOLE };

struct upload {
	enum upload_state state;
	uint8_t key[SEAL_KEY_BYTES];
	char client[JOBS_LCM_CLIENT_MAX];
	char id[JOBS_LCM_ID_MAX];
	char name[JOBS_LCM_ID_MAX];
	uint8_t sha256[32];
	size_t bytes;
	uint32_t chunks, have;
	bool hold;
	uint32_t from_line;		/* where it begins, as in edm.lcm */
	double from_mm;
	uint32_t electrode;
	char setting[INTERP_SETTING_MAX];
	uint8_t *seen;			/* bit per chunk */
	char *text;
	int64_t last_us;		/* of the last new chunk, monotonic */
	int64_t seq_min, seq_max;	/* seen so far */
	int64_t seq;			/* of the chunk that made it whole */
};

/* What was said about an upload that is gone. */
struct upload_verdict {
	uint8_t key[SEAL_KEY_BYTES];
	char client[JOBS_LCM_CLIENT_MAX];
	char id[JOBS_LCM_ID_MAX];
	int64_t seq_min, seq_max;
	int code;
	char *reason, *body;
};

struct uploads {
	struct upload slot[UPLOAD_SLOTS];
	struct upload_verdict verdict[UPLOAD_VERDICTS];
	unsigned int next_verdict;
};

/* What to answer to a chunk. */
struct upload_answer {
	int code;
	char reason[192];
	const char *body;		/* NULL, or lent until the next call */
};

/**
 * upload_take() - take one chunk that is known to belong to no job in the
 * store.
 *
 * @ret is set to the upload if this chunk made it whole, else to NULL.
 */
void upload_take(struct uploads *u, const struct jobs_lcm_chunk *c,
		 int64_t now_us, struct upload **ret,
		 struct upload_answer *answer);

/** upload_check() - are the chunk's fields fit to be looked at?
 *  Return: true, or false with @answer filled. */
bool upload_check(const struct jobs_lcm_chunk *c, struct upload_answer *answer);

/**
 * upload_forget() - the upload is finished: remember the decision and free the
 * text.
 */
void upload_forget(struct uploads *u, struct upload *up, int code,
		   const char *reason, const char *body);

/**
 * upload_hold_all() - motion is ended: what is sent or checked now waits for a
 * start.  Return: is there any?
 */
bool upload_hold_all(struct uploads *u);

/**
 * upload_expire() - drop uploads that have waited too long.
 *
 * Return: how many were dropped.
 */
int upload_expire(struct uploads *u, int64_t now_us);

/** upload_fini() - free everything. */
void upload_fini(struct uploads *u);

#endif /* JOBS_UPLOAD_H */
