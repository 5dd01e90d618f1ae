/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spread.c - threads that take the next number until one was the answer
 */
#include "spread.h"

#include <pthread.h>
#include <stdatomic.h>
#include <unistd.h>

#define THREADS_MAX	16

struct spread {
	spread_ask *ask;
	void *arg;
	atomic_uint next, first;
};

static void *work(void *arg)
{
	struct spread *s = arg;
	uint32_t i;

	while ((i = atomic_fetch_add(&s->next, 1)) < atomic_load(&s->first)) {
		uint32_t was = atomic_load(&s->first);

		if (!s->ask(s->arg, i))
			continue;
		while (i < was &&
		       !atomic_compare_exchange_weak(&s->first, &was, i))
			;
	}
	return NULL;
}

uint32_t spread_first(uint32_t n, spread_ask *ask, void *arg)
{
	const long cpus = sysconf(_SC_NPROCESSORS_ONLN);
	struct spread s = { .ask = ask, .arg = arg, .first = n };
	pthread_t thread[THREADS_MAX];
	uint32_t more = 0;

	while (more < THREADS_MAX && more + 1 < n && (long)more + 1 < cpus &&
	       pthread_create(&thread[more], NULL, work, &s) == 0)
		more++;
	work(&s);
	while (more > 0)
		pthread_join(thread[--more], NULL);
	return s.first;
}
