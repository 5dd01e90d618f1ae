/* SPDX-License-Identifier: Apache-2.0 */
/* due.c - when STATUS is sent */
#include "due.h"

#define STATUS_US	100000
/* Whoever can send a packet can be a client that has come.  So there are not
 * more than this. */
#define GUEST_US	10000
#define GUESTS_AT_ONCE	10

bool due_now(const struct due *d, uint64_t key, int64_t now_us)
{
	return key != d->key || now_us - d->sent_us >= STATUS_US ||
	       (d->owed && d->paid_us - now_us <= (GUESTS_AT_ONCE - 1) *
						   GUEST_US);
}

void due_sent(struct due *d, uint64_t key, int64_t now_us)
{
	if (d->owed)
		d->paid_us = (d->paid_us > now_us ? d->paid_us : now_us) +
			     GUEST_US;
	d->sent_us = now_us;
	d->key = key;
	d->owed = false;
}

void due_guest(struct due *d)
{
	d->owed = true;
}
