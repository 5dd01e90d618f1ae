/* SPDX-License-Identifier: Apache-2.0 */
/*
 * failing_disk.c - a library to preload: it makes the disk of a folder fail on
 * demand
 *
 * While the file $EDM_DISK_ERRNO exists, every call that changes a file below
 * $EDM_DISK fails with the error number in that file.  If the number is -N, the
 * process ends at the Nth call instead, as if it was killed.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static int failure(void)
{
	const char *name = getenv("EDM_DISK_ERRNO");
	static int calls;
	char text[16] = "";
	int fd = name ? (int)syscall(257, AT_FDCWD, name, O_RDONLY, 0) : -1;

	if (fd < 0)
		return 0;
	if (read(fd, text, sizeof(text) - 1) < 0)
		text[0] = '\0';
	close(fd);
	if (atoi(text) >= 0)
		return atoi(text);
	if (++calls >= -atoi(text))
		_exit(137);
	return 0;
}

static int is_ours(const char *path)
{
	const char *dir = getenv("EDM_DISK");

	return dir && path && strncmp(path, dir, strlen(dir)) == 0;
}

static int fails(int fd)
{
	const int before = errno;
	char link[64], path[512];
	ssize_t n;
	int err;

	snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
	n = readlink(link, path, sizeof(path) - 1);
	path[n > 0 ? n : 0] = '\0';
	err = is_ours(path) ? failure() : 0;
	errno = err ? err : before;
	return err;
}

#define REAL(name)	(*(__typeof__(&name) *)(void *)&real)
#define WRAP(type, name, with, call)				\
	type name with						\
	{							\
		static void *real;				\
								\
		if (!real)					\
			real = dlsym(RTLD_NEXT, #name);		\
		return fails(fd) ? -1 : REAL(name) call;	\
	}

WRAP(ssize_t, pwrite64, (int fd, const void *b, size_t n, off64_t at),
     (fd, b, n, at))
WRAP(ssize_t, pwrite, (int fd, const void *b, size_t n, off_t at),
     (fd, b, n, at))
WRAP(ssize_t, write, (int fd, const void *b, size_t n), (fd, b, n))
WRAP(int, fsync, (int fd), (fd))
WRAP(int, fdatasync, (int fd), (fd))
WRAP(int, ftruncate64, (int fd, off64_t n), (fd, n))
WRAP(int, ftruncate, (int fd, off_t n), (fd, n))

/* A disk that takes nothing takes no new file, and none for writing if it is
 * read-only. */
static int open_fails(const char *path, int flags)
{
	int err;

	if (!is_ours(path))
		return 0;
	err = failure();
	if (err == EROFS ? (flags & (O_WRONLY | O_RDWR)) != 0 :
	    (flags & O_CREAT) && access(path, F_OK) < 0)
		errno = err;
	else
		err = 0;
	return err;
}

#define WRAP_OPEN(name)						\
	int name(const char *path, int flags, ...)		\
	{							\
		static void *real;				\
		mode_t mode = 0;				\
		va_list ap;					\
								\
		if (!real)					\
			real = dlsym(RTLD_NEXT, #name);		\
		va_start(ap, flags);				\
		if (flags & (O_CREAT | O_TMPFILE))		\
			mode = va_arg(ap, mode_t);		\
		va_end(ap);					\
		if (open_fails(path, flags))			\
			return -1;				\
		return REAL(name)(path, flags, mode);		\
	}

WRAP_OPEN(open)
WRAP_OPEN(open64)
