/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop-thread.c - stop one thread of another process until that one ends
 *
 *	stop-thread TID
 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/ptrace.h>
#include <sys/wait.h>

int main(int argc, char **argv)
{
	pid_t tid = argc == 2 ? atoi(argv[1]) : 0;
	int status;

	if (tid <= 0 || ptrace(PTRACE_SEIZE, tid, NULL, NULL) < 0 ||
	    ptrace(PTRACE_INTERRUPT, tid, NULL, NULL) < 0) {
		perror("stop-thread");
		return 1;
	}
	/* Stopped, and nobody lets it go on: the next is its end. */
	while (waitpid(tid, &status, __WALL) == tid)
		if (WIFEXITED(status) || WIFSIGNALED(status))
			break;
	return 0;
}
