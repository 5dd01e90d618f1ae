/* SPDX-License-Identifier: Apache-2.0 */
/* support_run.c - texts that grow, and what other programs print */
#include "support.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define RUN_S		30.0
#define LOOK_MS		200

void support_add(struct support_text *t, const char *from, size_t bytes)
{
	if (bytes > SUPPORT_FILE_MAX - t->bytes)
		bytes = SUPPORT_FILE_MAX - t->bytes;
	if (t->bytes + bytes + 1 > t->room) {
		const size_t room = 2 * (t->bytes + bytes) + 1024;
		char *at = realloc(t->at, room);

		if (!at)
			return;
		t->at = at;
		t->room = room;
	}
	memcpy(t->at + t->bytes, from, bytes);
	t->bytes += bytes;
	t->at[t->bytes] = '\0';
}

void support_say(struct support_text *t, const char *text, ...)
{
	char line[2000];
	va_list ap;

	va_start(ap, text);
	vsnprintf(line, sizeof(line), text, ap);
	va_end(ap);
	support_add(t, line, strlen(line));
}

/* In the child.  It does not come back. */
static void become(char *const argv[], int out)
{
	const int none = open("/dev/null", O_RDONLY);

	dup2(none, 0);
	dup2(out, 1);
	dup2(out, 2);
	/* A Ctrl-C is for the parent, which ends this one. */
	setpgid(0, 0);
	signal(SIGINT, SIG_DFL);
	signal(SIGTERM, SIG_DFL);
	execvp(argv[0], argv);
	dprintf(2, "%s: %s\n", argv[0], strerror(errno));
	_exit(127);
}

/* Until its end.  Return: false: it took too long, or was interrupted. */
static bool listen_to(struct support_text *to, int in)
{
	const double end_s = talk_now_s() + RUN_S;
	char some[65536];
	ssize_t n = 1;

	while (n > 0 && talk_now_s() < end_s && !talk_interrupted()) {
		struct pollfd p = { .fd = in, .events = POLLIN };

		if (poll(&p, 1, LOOK_MS) <= 0)
			continue;
		n = read(in, some, sizeof(some));
		if (n > 0)
			support_add(to, some, (size_t)n);
	}
	return n == 0;
}

void support_run(struct support_text *to, char *const argv[])
{
	int fd[2];
	pid_t pid;

	if (pipe2(fd, O_CLOEXEC) < 0) {
		support_say(to, "%s: %s\n", argv[0], strerror(errno));
		return;
	}
	fflush(NULL);
	pid = fork();
	if (pid == 0)
		become(argv, fd[1]);
	close(fd[1]);
	if (pid < 0) {
		support_say(to, "%s: %s\n", argv[0], strerror(errno));
	} else if (!listen_to(to, fd[0])) {
		kill(pid, SIGKILL);
		support_say(to, "\n%s: not complete\n", argv[0]);
	}
	close(fd[0]);
	if (pid > 0)
		waitpid(pid, NULL, 0);
}
