/* SPDX-License-Identifier: Apache-2.0 */
/*
 * asks.h - why the machine stands, and what it asks of whom, in words
 *
 * words/stands.h has the reasons.  What only this service knows is added: the
 * name of the electrode, the line of the program, who held it.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_ASKS_H
#define JOBS_ASKS_H

#include "shm.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct jobs;

#define ASKS_TEXT_MAX	400

struct asks_what {
	uint32_t why, of, line;		/* shm_snapshot: stand, stand_of */
	bool confirmed;
};

/* All 0 at first. */
struct asks {
	uint32_t program;		/* what `text` was made of */
	struct asks_what what;
	char text[ASKS_TEXT_MAX];
	char by[64];			/* who held */
};

/** asks_name() - the word of STATUS: "electrode"; "queue": jobs wait; only
 *  with a text. */
const char *asks_name(const struct jobs *j);

/** asks_text() - what it is, and what ends it; "" as above. */
const char *asks_text(struct jobs *j);

/** asks_stood_s() - how long; 0 if it does not. */
double asks_stood_s(const struct jobs *j);

/** asks_event() - take a SHM_EV_STAND of the loaded job. */
void asks_event(struct jobs *j, const struct shm_event *e);

/** asks_held() - a command of @by holds the machine; "": it goes on. */
void asks_held(struct jobs *j, const char *by);

/* What the loaded job stands for, and where. */
struct asks_stand {
	uint32_t why, line;
	double place_mm;
};

struct asks_stand asks_stand(const struct jobs *j);

/** asks_answered() - edmd has taken what @by said to stand @at: it is done; or,
 *  @starts, the job goes on. */
void asks_answered(struct jobs *j, const struct asks_stand *at, const char *by,
		   bool starts);

#endif /* JOBS_ASKS_H */
