/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop-latency.c - hold a machine by edmd's own socket, and say when
 *
 *	stop-latency SOCKET [crowd]
 *
 * Prints when it connected to send an act, when its answer was there, on
 * CLOCK_MONOTONIC, in s, and the answer's code.  It has a real-time priority:
 * what it times is behind the socket.  As a crowd it connects again and again,
 * says nothing, and ends by a signal.
 */
#include "stop_act.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

static double now_s(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int connect_to(const char *path)
{
	struct sockaddr_un at = { .sun_family = AF_UNIX };
	const int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);

	strncpy(at.sun_path, path, sizeof(at.sun_path) - 1);
	if (connect(fd, (struct sockaddr *)&at, sizeof(at)) < 0) {
		perror("stop-latency: connect");
		_exit(1);
	}
	return fd;
}

static void crowd(const char *path)
{
	int fd[64];

	for (unsigned int i = 0;; i++) {
		if (i >= 64)
			close(fd[i % 64]);
		fd[i % 64] = connect_to(path);
	}
}

int main(int argc, char **argv)
{
	const char *path = argc > 1 ? argv[1] : "";
	struct stop_act act = {
		.magic = STOP_ACT_MAGIC, .verb = STOP_ACT_HOLD,
		.id = ((uint64_t)getpid() << 32) + 1,
	};
	const struct sched_param before = { .sched_priority = 2 };
	struct stop_answer answer = { 0 };
	double sent;
	int fd;

	if (argc > 2)
		crowd(path);
	if (sched_setscheduler(0, SCHED_FIFO, &before) < 0)
		perror("stop-latency: SCHED_FIFO");
	sent = now_s();
	fd = connect_to(path);
	if (send(fd, &act, sizeof(act), MSG_NOSIGNAL) != sizeof(act) ||
	    recv(fd, &answer, sizeof(answer), 0) != sizeof(answer)) {
		perror("stop-latency");
		return 1;
	}
	printf("%.6f %.6f %d\n", sent, now_s(), answer.code);
	return 0;
}
