/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stand.h - why a job stands, and whether what it asks for was done
 *
 * The first reason counts until the job sets off again: a hold, an emergency
 * stop or a reset in the middle of an electrode change does not answer it.
 *
 * Threads: RT-safe.
 */
#ifndef RT_STAND_H
#define RT_STAND_H

#include "stands.h"

#include <stdbool.h>

struct cycle;

struct stand {
	enum stand_reason why;		/* NONE while it has set off */
	uint32_t of;			/* what it asks for: the electrode's
					 * number; a bit of each field to set */
	bool confirmed;
	uint32_t n;			/* the number of this stand; the next
					 * one has one more */
};

/* What is shown. */
struct stand_now {
	enum stand_reason why;
	uint32_t of;
};

/** stand_begin() - the job comes to stand; a reason that is there stays. */
void stand_begin(struct cycle *c, enum stand_reason why, uint32_t of);

/** stand_end() - it sets off. */
void stand_end(struct cycle *c);

/** stand_asks() - has nobody confirmed what is asked for?  Then nothing goes on
 *  along the path: start is refused, and a step ahead. */
bool stand_asks(const struct cycle *c);

/** stand_is() - is it still stand @n?  0: whichever it is. */
bool stand_is(const struct cycle *c, uint32_t n);

/** stand_confirm() - somebody says that it is done; @of says what, where the
 *  stand is about a number, and is 0 elsewhere.  Return: false if that is not
 *  what was asked. */
bool stand_confirm(struct cycle *c, double of);

/** stand_now() - why it stands in this period, waits included. */
struct stand_now stand_now(const struct cycle *c);

#endif /* RT_STAND_H */
