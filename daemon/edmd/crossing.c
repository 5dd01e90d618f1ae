/* SPDX-License-Identifier: Apache-2.0 */
/*
 * crossing.c - two rings between two threads
 */
#include "crossing.h"

CK_RING_PROTOTYPE(ask, ask)
CK_RING_PROTOTYPE(reply, reply)

void crossing_init(struct crossing *x)
{
	*x = (struct crossing) { .beats = 0 };
	ck_ring_init(&x->asks, CROSSING_SLOTS);
	ck_ring_init(&x->replies, CROSSING_SLOTS);
}

bool crossing_ask(struct crossing *x, const struct ask *a)
{
	struct ask copy = *a;

	return ck_ring_enqueue_spsc_ask(&x->asks, x->ask, &copy);
}

bool crossing_ask_take(struct crossing *x, struct ask *ret)
{
	return ck_ring_dequeue_spsc_ask(&x->asks, x->ask, ret);
}

bool crossing_reply(struct crossing *x, const struct reply *r)
{
	struct reply copy = *r;

	return ck_ring_enqueue_spsc_reply(&x->replies, x->reply, &copy);
}

bool crossing_reply_take(struct crossing *x, struct reply *ret)
{
	return ck_ring_dequeue_spsc_reply(&x->replies, x->reply, ret);
}
