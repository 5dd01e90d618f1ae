/* SPDX-License-Identifier: Apache-2.0 */
/* child.c - run other programs within limits */
#include "child.h"
#include "clocks.h"
#include "grow.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define OUT_BYTES_MAX	(64u << 20)
#define SIGNAL_BASE	128

#ifdef __SANITIZE_ADDRESS__
#define SANITIZED	1
#else
#define SANITIZED	0
#endif

struct child {
	pid_t pid;			/* 0: free */
	int out_fd;
	time_t until_s;
	child_done_fn done;		/* NULL: nobody waits for it any more */
	void *arg;
};

struct children {
	struct child child[CHILDREN_MAX];
};

struct children *children_create(void)
{
	return calloc(1, sizeof(struct children));
}

static void reap(struct child *c, int status)
{
	const int out_fd = c->out_fd;
	const child_done_fn done = c->done;

	c->pid = 0;
	c->done = NULL;
	if (!done) {
		close(out_fd);
		return;
	}
	done(c->arg, WIFEXITED(status) ? WEXITSTATUS(status) :
	     SIGNAL_BASE + WTERMSIG(status), out_fd);
}

void children_destroy(struct children *c)
{
	if (!c)
		return;
	for (int i = 0; i < CHILDREN_MAX; i++) {
		if (c->child[i].pid == 0)
			continue;
		kill(c->child[i].pid, SIGKILL);
		waitpid(c->child[i].pid, NULL, 0);
		close(c->child[i].out_fd);
	}
	free(c);
}

int child_file(const char *name)
{
	const int fd = memfd_create(name, MFD_CLOEXEC);

	return fd < 0 ? -errno : fd;
}

static void limit(enum __rlimit_resource what, rlim_t most)
{
	const struct rlimit l = { .rlim_cur = most, .rlim_max = most };

	setrlimit(what, &l);
}

/* If the host runs out of memory, it kills a child and not the panel. */
static void be_first_to_go(void)
{
	const int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);

	if (fd < 0)
		return;
	if (write(fd, "1000", 4) < 0)
		_exit(127);
	close(fd);
}

/* This runs in the child: it may only make system calls, because the panel has
 * other threads. */
static void become(const struct child_job *j, int out_fd)
{
	const int null_fd = open("/dev/null", O_RDWR);

	if (dup2(j->in_fd >= 0 ? j->in_fd : null_fd, 0) < 0 ||
	    dup2(out_fd, 1) < 0)
		_exit(127);
	close_range(3, ~0u, 0);
	/* The sanitizer's own memory is larger than any limit. */
	if (j->memory_bytes && !SANITIZED)
		limit(RLIMIT_AS, j->memory_bytes);
	limit(RLIMIT_CPU, j->limit_s);
	limit(RLIMIT_FSIZE, OUT_BYTES_MAX);
	limit(RLIMIT_CORE, 0);
	be_first_to_go();
	setpgid(0, 0);
	execvp(j->argv[0], (char *const *)(uintptr_t)j->argv);
	_exit(127);
}

static struct child *free_one(struct children *c)
{
	for (int i = 0; i < CHILDREN_MAX; i++)
		if (c->child[i].pid == 0)
			return &c->child[i];
	return NULL;
}

int child_start(struct children *c, const struct child_job *j,
		child_done_fn done, void *arg)
{
	struct child *n = free_one(c);
	int out_fd;
	pid_t pid;

	if (!n)
		return -EBUSY;
	out_fd = child_file("panel-out");
	if (out_fd < 0)
		return out_fd;
	if (j->in_fd >= 0)
		lseek(j->in_fd, 0, SEEK_SET);
	pid = fork();
	if (pid < 0) {
		close(out_fd);
		return -errno;
	}
	if (pid == 0)
		become(j, out_fd);
	*n = (struct child) {
		.pid = pid, .out_fd = out_fd, .done = done, .arg = arg,
		.until_s = clock_ms(CLOCK_MONOTONIC) / 1000 +
			   (time_t)j->limit_s + 1,
	};
	return 0;
}

void child_forget(struct children *c, void *arg)
{
	for (int i = 0; i < CHILDREN_MAX; i++) {
		struct child *n = &c->child[i];

		if (n->pid == 0 || n->arg != arg)
			continue;
		n->done = NULL;
		kill(n->pid, SIGKILL);
	}
}

void children_look(struct children *c)
{
	for (int i = 0; i < CHILDREN_MAX; i++) {
		struct child *n = &c->child[i];
		int status;

		if (n->pid == 0)
			continue;
		if (waitpid(n->pid, &status, WNOHANG) == n->pid)
			reap(n, status);
		else if (clock_ms(CLOCK_MONOTONIC) / 1000 > n->until_s)
			kill(n->pid, SIGKILL);
	}
}

char *child_read(int fd, size_t most, size_t *ret_bytes)
{
	char *text = NULL;
	size_t n = 0;
	FILE *f;

	/* Others read it too: from its begin, unless it is a pipe. */
	lseek(fd, 0, SEEK_SET);
	f = fdopen(dup(fd), "r");
	if (!f || grow_read(f, most, &text, &n) < 0) {
		free(text);
		text = NULL;
	}
	if (f)
		fclose(f);
	if (text)
		text[n] = '\0';
	if (ret_bytes)
		*ret_bytes = n;
	return text;
}
