/* SPDX-License-Identifier: Apache-2.0 */
/* standard.c - standard input, output and error, from the start to the exit */
#include "standard.h"

#include "written.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const char *name;
static volatile sig_atomic_t interrupted;

void standard_interrupt(void)
{
	interrupted = 1;
}

/* The signal broke off a write, most likely into a pipe that nobody reads.  To
 * find out by another write could block again. */
static void interruption_check(bool failed)
{
	if (!interrupted || !failed)
		return;
	fprintf(stderr, "%s: interrupted; standard output is not complete\n",
		name);
	_exit(EX_TEMPFAIL);
}

static void output_check(void)
{
	int err;

	interruption_check(ferror(stdout));
	err = written_close(stdout);
	if (err == 0)
		return;
	interruption_check(err == -EINTR);
	fprintf(stderr, "%s: standard output: %s; it is not complete\n", name,
		strerror(-err));
	_exit(EX_IOERR);
}

void standard_guard(const char *program)
{
	/* The wrong way round: who reads or prints nevertheless is told. */
	static const int mode[] = { O_WRONLY, O_RDONLY, O_WRONLY };

	for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
		if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", mode[fd]) < 0)
			_exit(EX_OSERR);
	name = program;
	atexit(output_check);
}
