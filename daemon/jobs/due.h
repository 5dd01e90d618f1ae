/* SPDX-License-Identifier: Apache-2.0 */
/* due.h - when STATUS is sent */
#ifndef JOBS_DUE_H
#define JOBS_DUE_H

#include <stdbool.h>
#include <stdint.h>

/** struct due - what decides it; all zero at the start */
struct due {
	int64_t sent_us;		/* when the last STATUS was sent */
	uint64_t key;			/* of what it said */
	bool owed;			/* a client has come since then */
	int64_t paid_us;		/* clients have had what is due until
					 * then */
};

/**
 * due_now() - whether STATUS is sent now
 * @key:	of what it would say; another key is sent at once
 *
 * Otherwise STATUS is sent every 100 ms, and to a client that has come: at once
 * to the first ten, to more of them 100 times a second.
 */
bool due_now(const struct due *d, uint64_t key, int64_t now_us);

/** due_sent() - STATUS was sent, with what @key says. */
void due_sent(struct due *d, uint64_t key, int64_t now_us);

/** due_guest() - a client has come; it waits for a STATUS. */
void due_guest(struct due *d);

#endif /* JOBS_DUE_H */
