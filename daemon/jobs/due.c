/* SPDX-License-Identifier: Apache-2.0 */
/* due.c - when STATUS is sent */
#include "due.h"

#define STATUS_US	100000
#define GUEST_US	2000	/* apart at least, however many come */

bool due_now(const struct due *d, uint64_t key, int64_t now_us)
{
	return key != d->key ||
	       now_us - d->sent_us >= (d->owed ? GUEST_US : STATUS_US);
}

void due_sent(struct due *d, uint64_t key, int64_t now_us)
{
	*d = (struct due) { .sent_us = now_us, .key = key };
}

void due_guest(struct due *d)
{
	d->owed = true;
}
