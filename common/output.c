/* SPDX-License-Identifier: Apache-2.0 */
/* output.c - did all of a file reach the disk, and if not, why? */
#include "output.h"

#include <errno.h>
#include <unistd.h>

/* stdio remembers that a write failed, but not why: try once more, with a
 * block, for which a disk that is full has no room either. */
static int why_failed(FILE *f)
{
	static const char block[4096];
	const int fd = f == stdout ? STDOUT_FILENO : fileno(f);

	errno = 0;
	if (write(fd, block, sizeof(block)) == (ssize_t)sizeof(block))
		return -EIO;
	return errno ? -errno : -ENOSPC;
}

int output_close(FILE *f)
{
	const int failed = ferror(f) ? why_failed(f) : 0;
	const int last = fflush(f) != 0 ? -errno : 0;

	if (f != stdout && fclose(f) != 0 && !failed && !last)
		return -errno;
	return failed ? failed : last;
}
