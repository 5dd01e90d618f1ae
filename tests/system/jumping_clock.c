/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jumping_clock.c - a library to preload: the time of day jumps on demand
 *
 * The file $EDM_CLOCK has a number of seconds; the time of day is so much
 * later.  Without the file it is right.  CLOCK_MONOTONIC is left alone, as it
 * is when somebody sets a host's clock.
 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static long ahead_s(void)
{
	const char *name = getenv("EDM_CLOCK");
	char text[32] = "";
	int fd = name ? (int)syscall(SYS_openat, AT_FDCWD, name, O_RDONLY, 0) :
			-1;

	if (fd < 0)
		return 0;
	if (read(fd, text, sizeof(text) - 1) < 0)
		text[0] = '\0';
	close(fd);
	return atol(text);
}

int clock_gettime(clockid_t clock, struct timespec *t)
{
	const int err = (int)syscall(SYS_clock_gettime, clock, t);

	if (!err && clock == CLOCK_REALTIME)
		t->tv_sec += ahead_s();
	return err;
}

int gettimeofday(struct timeval *restrict t, void *restrict zone)
{
	struct timespec now;

	(void)zone;
	clock_gettime(CLOCK_REALTIME, &now);
	t->tv_sec = now.tv_sec;
	t->tv_usec = now.tv_nsec / 1000;
	return 0;
}

time_t time(time_t *ret)
{
	struct timespec now;

	clock_gettime(CLOCK_REALTIME, &now);
	if (ret)
		*ret = now.tv_sec;
	return now.tv_sec;
}
