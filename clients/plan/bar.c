/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bar.c - a bar while a person waits, and what Ctrl-C asks for
 */
#include "job.h"
#include "clocks.h"
#include "standard.h"

#include <signal.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define BAR	12

static volatile sig_atomic_t asked;

static void on_signal(int sig)
{
	(void)sig;
	/* A second one ends the program at once. */
	signal(SIGINT, SIG_DFL);
	asked = 1;
}

void bar_catch(void)
{
	struct sigaction a = { .sa_handler = on_signal,
			       .sa_flags = SA_RESTART };

	sigemptyset(&a.sa_mask);
	sigaction(SIGINT, &a, NULL);
	sigaction(SIGTERM, &a, NULL);
}

void bar_forget(void)
{
	asked = 0;
}

bool bar_interrupted(void)
{
	return asked != 0;
}

static struct {
	uint32_t blocks;		/* 0: none yet */
	double mm;
} best;

void bar_best(uint32_t blocks, double mm)
{
	best.blocks = blocks;
	best.mm = mm;
}

/* Of the terminal.  A longer line could not be rewritten. */
static int columns(void)
{
	struct winsize size;

	if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) || size.ws_col < 30)
		return 80;
	return size.ws_col;
}

static void say_bar(double share, const char *text)
{
	char line[200], so_far[60] = "", bar[BAR + 1];
	int full = (int)(share * BAR);

	full = full < 0 ? 0 : full > BAR ? BAR : full;
	for (int i = 0; i < BAR; i++)
		bar[i] = i < full ? '=' : ' ';
	bar[BAR] = '\0';
	if (best.blocks)
		snprintf(so_far, sizeof(so_far), "; best: %u blocks, %.3f mm",
			 best.blocks, best.mm);
	snprintf(line, sizeof(line), "[%s] %3.0f %% %.80s%s", bar, share * 100,
		 text, so_far);
	standard_control(stderr, "\r");
	fprintf(stderr, "%.*s", columns() - 1, line);
	standard_control(stderr, "\033[K");
}

void bar_show(const struct job *j, double share, const char *text)
{
	static double last;
	const double now = clock_s(CLOCK_MONOTONIC);

	if (j->o->quiet || !isatty(STDERR_FILENO) || now - last < 0.1)
		return;
	last = now;
	say_bar(share, text);
}

void bar_end(const struct job *j)
{
	if (!j->o->quiet && isatty(STDERR_FILENO))
		standard_control(stderr, "\r\033[K");
}
