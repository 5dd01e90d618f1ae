/* SPDX-License-Identifier: Apache-2.0 */
/*
 * proved.c - blocks that were proved, and how much they keep
 */
#include "proved.h"

#include <string.h>

void proved_init(struct proved *p)
{
	p->n = 0;
	pthread_mutex_init(&p->lock, NULL);
}

void proved_put(struct proved *p, const struct block *b, double mm)
{
	struct proved_block *to;

	if (!p)
		return;
	pthread_mutex_lock(&p->lock);
	to = &p->block[p->n++ % PROVED_MAX];
	memcpy(to->from, b->from, sizeof(to->from));
	memcpy(to->to, b->to, sizeof(to->to));
	to->mm = mm;
	pthread_mutex_unlock(&p->lock);
}

bool proved_keeps(struct proved *p, const struct block *b, double mm)
{
	bool ret = false;

	if (!p)
		return false;
	pthread_mutex_lock(&p->lock);
	for (uint32_t i = 0; i < PROVED_MAX && i < p->n && !ret; i++) {
		const struct proved_block *at = &p->block[i];

		ret = at->mm >= mm &&
		      memcmp(at->from, b->from, sizeof(at->from)) == 0 &&
		      memcmp(at->to, b->to, sizeof(at->to)) == 0;
	}
	pthread_mutex_unlock(&p->lock);
	return ret;
}
