/* SPDX-License-Identifier: Apache-2.0 */
/* standard.c - standard input, output and error, from the start to the exit */
#include "standard.h"

#include "written.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const char *name;

static void output_check(void)
{
	const int err = written_close(stdout);

	if (err == 0)
		return;
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
