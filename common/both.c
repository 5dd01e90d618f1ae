/* SPDX-License-Identifier: Apache-2.0 */
/* both.c - two things at the same time */
#include "both.h"

#include "thread.h"

#include <sched.h>

uint32_t both_processors(void)
{
	cpu_set_t set;

	return sched_getaffinity(0, sizeof(set), &set) == 0 ?
	       (uint32_t)CPU_COUNT(&set) : 1;
}

struct call {
	void (*f)(void *);
	void *arg;
};

static void *run(void *arg)
{
	const struct call *c = arg;

	c->f(c->arg);
	return NULL;
}

void both(void (*one)(void *), void (*other)(void *), void *arg)
{
	struct call c = { other, arg };
	pthread_t thread;
	const int err = thread_start(&thread, &(struct thread) {
		.name = "edm-both", .run = run, .arg = &c,
	});

	one(arg);
	if (err)
		other(arg);
	else
		pthread_join(thread, NULL);
}
