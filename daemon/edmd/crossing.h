/* SPDX-License-Identifier: Apache-2.0 */
/*
 * crossing.h - between the cycle of edmd and its main thread
 *
 * The cycle may not map, allocate or print. For work that needs one of these it
 * asks the main thread over one ring, and gets the answer over another.
 *
 * Threads: each function names the one it belongs to; those of the cycle are
 * RT-safe.
 */
#ifndef EDMD_CROSSING_H
#define EDMD_CROSSING_H

#include "cycle.h"
#include "shm.h"

#include <ck_ring.h>

#define CROSSING_SLOTS	16

/* A program in memory, ready to walk.  Made and freed by the main thread. */
struct program {
	uint32_t n;			/* of program.<n> */
	uint64_t key;			/* of all its bytes; never 0 */
	struct shm_stamp stamp;		/* of its file; none: it changed */
	const void *block;
	size_t bytes;
	struct interp_cursor cursor;
};

/* Cycle to main thread. */
struct ask {
	uint64_t id;			/* of the command behind it */
	uint32_t n;			/* open program.<n>, ... */
	struct program *close;		/* ... unless there is one to close */
	bool ahead;			/* to be kept until it is loaded */
};

/* Main thread to cycle: an opened program, or why not. */
struct reply {
	uint64_t id;
	enum cycle_answer answer;
	struct program *program;	/* NULL unless ANSWER_DONE */
	bool ahead;			/* nothing but: that ask is done */
};

struct crossing {
	ck_ring_t asks, replies;
	struct ask ask[CROSSING_SLOTS];
	struct reply reply[CROSSING_SLOTS];
	uint64_t beats;			/* periods the cycle has run */
	bool hold;			/* main: bring the machine to a stand */
	bool stands;			/* cycle: it does */
	bool quit;			/* main: leave the loop */
};

void crossing_init(struct crossing *x);

/** Cycle. Return: false if the ring is full. */
bool crossing_ask(struct crossing *x, const struct ask *a);
bool crossing_reply_take(struct crossing *x, struct reply *ret);

/** Main thread. */
bool crossing_ask_take(struct crossing *x, struct ask *ret);
bool crossing_reply(struct crossing *x, const struct reply *r);

static inline bool crossing_flag(const bool *flag)
{
	return __atomic_load_n(flag, __ATOMIC_ACQUIRE);
}

static inline void crossing_flag_set(bool *flag, bool value)
{
	__atomic_store_n(flag, value, __ATOMIC_RELEASE);
}

#endif /* EDMD_CROSSING_H */
