/* SPDX-License-Identifier: Apache-2.0 */
/* parallel.c - two things at the same time */
#include "parallel.h"

#include "thread.h"

#include <sched.h>

uint32_t parallel_processors(void)
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

void parallel_run(void (*one)(void *), void (*other)(void *), void *arg)
{
	struct call c = { other, arg };
	pthread_t thread;
	const int err = thread_start(&thread, &(struct thread) {
		.name = "edm-parallel", .run = run, .arg = &c,
	});

	one(arg);
	if (err)
		other(arg);
	else
		pthread_join(thread, NULL);
}
