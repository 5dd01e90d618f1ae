/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop-thread.c - stop one thread of another process until that one ends
 *
 *	stop-thread TID
 *
 * Prints when it stood, on CLOCK_MONOTONIC, in s.
 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <time.h>

/* It stands now, and nobody lets it go on: the next is its end. */
static void say_stopped(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	printf("%lld.%09ld\n", (long long)t.tv_sec, t.tv_nsec);
	fflush(stdout);
}

int main(int argc, char **argv)
{
	pid_t tid = argc == 2 ? atoi(argv[1]) : 0;
	int status;

	if (tid <= 0 || ptrace(PTRACE_SEIZE, tid, NULL, NULL) < 0 ||
	    ptrace(PTRACE_INTERRUPT, tid, NULL, NULL) < 0) {
		perror("stop-thread");
		return 1;
	}
	while (waitpid(tid, &status, __WALL) == tid &&
	       !WIFEXITED(status) && !WIFSIGNALED(status))
		say_stopped();
	return 0;
}
