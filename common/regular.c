/* SPDX-License-Identifier: Apache-2.0 */
/* regular.c - opens nothing but regular files */
#include "regular.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

int regular_open(const char *path, int flags, mode_t mode)
{
	/* A fifo that nobody reads, and a folder, refuse by themselves.
	 * Nothing is cut off before it is known what it is. */
	const int fd = open(path, (flags & ~O_TRUNC) | O_NOFOLLOW |
			    O_NONBLOCK | O_NOCTTY | O_CLOEXEC, mode);
	struct stat st;
	int err = 0;

	if (fd < 0)
		return errno == ENXIO || errno == EISDIR ? -ELOOP : -errno;
	if (fstat(fd, &st) < 0)
		err = -errno;
	else if (!S_ISREG(st.st_mode))
		err = -ELOOP;
	else if (flags & O_TRUNC && ftruncate(fd, 0) < 0)
		err = -errno;
	if (err == 0)
		return fd;
	close(fd);
	return err;
}

int regular_check(const char *path)
{
	struct stat st;

	if (lstat(path, &st) < 0)
		return errno == ENOENT ? 0 : -errno;
	return S_ISREG(st.st_mode) ? 0 : -ELOOP;
}
