/* SPDX-License-Identifier: Apache-2.0 */
/* rt.c - everything that sets up real time */
#include "rt.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define PAGE_BYTES	4096
#define LATER_BYTES	((size_t)1 << 30)	/* a large program */

static const struct setup_item unasked[SETUP_NITEMS] = {
	[SETUP_MEMORY] = {
		.what = "memory lock",
		.mend = "ulimit -l unlimited, or LimitMEMLOCK=infinity "
			"in edmd.service",
	},
	[SETUP_STACK] = {
		.what = "stack in memory",
		.mend = "ulimit -s 8192",
	},
	[SETUP_CPU] = {
		.what = "core of its own",
		.mend = "[machine] cpu = one of `cat "
			"/sys/devices/system/cpu/online`",
	},
	[SETUP_PRIORITY] = {
		.what = "real-time priority",
		.mend = "ulimit -r 99, or LimitRTPRIO=99 in edmd.service, or "
			"setcap cap_sys_nice,cap_ipc_lock=ep on edmd",
	},
	[SETUP_SLEEP] = {
		.what = "processor kept awake",
		.mend = "chgrp edm /dev/cpu_dma_latency && "
			"chmod 660 /dev/cpu_dma_latency",
	},
};

/* @err 0: the host gave it. */
static void item_set(struct setup_report *r, enum setup_what what, int err,
		     const char *call)
{
	struct setup_item *i = &r->item[what];

	*i = unasked[what];
	i->wanted = true;
	i->got = err == 0;
	if (err)
		snprintf(i->why, sizeof(i->why), "%s: %s", call,
			 strerror(err));
}

static void item_unwanted(struct setup_report *r, enum setup_what what)
{
	r->item[what] = unasked[what];
}

/*
 * If there is a limit on locked memory, "lock what comes later" would make
 * later mappings fail.  Reserving address space counts against the limit and
 * costs nothing, so it shows whether there is room.
 */
static bool later_is_allowed(void)
{
	void *at = mmap(NULL, LATER_BYTES, PROT_NONE,
			MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);

	if (at == MAP_FAILED)
		return false;
	munmap(at, LATER_BYTES);
	return true;
}

static void memory_lock(struct setup_report *r)
{
	if (mlockall(MCL_CURRENT | MCL_FUTURE) < 0) {
		item_set(r, SETUP_MEMORY, errno, "mlockall");
		return;
	}
	if (later_is_allowed()) {
		item_set(r, SETUP_MEMORY, 0, NULL);
		return;
	}
	munlockall();
	if (mlockall(MCL_CURRENT) < 0)
		item_set(r, SETUP_MEMORY, errno, "mlockall");
	else
		item_set(r, SETUP_MEMORY, ENOMEM,
			 "memory is locked, but memory taken later is not");
}

/* The request is valid while the file is open, so it is never closed. */
static void keep_awake(struct setup_report *r)
{
	int fd = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
	int32_t none_us = 0;
	int err = 0;

	if (fd < 0) {
		item_set(r, SETUP_SLEEP, errno, "/dev/cpu_dma_latency");
		return;
	}
	if (write(fd, &none_us, sizeof(none_us)) != sizeof(none_us)) {
		err = errno;
		close(fd);
	}
	item_set(r, SETUP_SLEEP, err, "/dev/cpu_dma_latency");
}

void setup_process(struct setup_report *r)
{
	memory_lock(r);
	keep_awake(r);
}

static __attribute__((noinline)) void stack_touch(void)
{
	volatile char page[SETUP_STACK_TOUCHED];

	for (size_t i = 0; i < sizeof(page); i += PAGE_BYTES)
		page[i] = 0;
}

static void stack_prefault(struct setup_report *r)
{
	pthread_attr_t attr;
	size_t bytes = 0;

	if (pthread_getattr_np(pthread_self(), &attr) == 0) {
		pthread_attr_getstacksize(&attr, &bytes);
		pthread_attr_destroy(&attr);
	}
	if (bytes < 2 * SETUP_STACK_TOUCHED) {
		item_set(r, SETUP_STACK, ENOMEM, "stack too small to touch");
		return;
	}
	stack_touch();
	item_set(r, SETUP_STACK, 0, NULL);
}

static void core_pin(struct setup_report *r, int cpu)
{
	cpu_set_t set;

	if (cpu < 0) {
		item_unwanted(r, SETUP_CPU);
		return;
	}
	CPU_ZERO(&set);
	CPU_SET((size_t)cpu, &set);
	item_set(r, SETUP_CPU, pthread_setaffinity_np(pthread_self(),
						      sizeof(set), &set),
		 "sched_setaffinity");
}

static void priority_raise(struct setup_report *r, int priority)
{
	struct sched_param p = { .sched_priority = priority };

	if (priority <= 0) {
		item_unwanted(r, SETUP_PRIORITY);
		return;
	}
	item_set(r, SETUP_PRIORITY, pthread_setschedparam(pthread_self(),
							  SCHED_FIFO, &p),
		 "sched_setscheduler");
}

void setup_thread(struct setup_report *r, const struct setup_wanted *w)
{
	stack_prefault(r);
	core_pin(r, w->cpu);
	priority_raise(r, w->priority);
}
