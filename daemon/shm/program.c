/* SPDX-License-Identifier: Apache-2.0 */
/*
 * program.c - program blocks: written once by one process, read by another
 */
#include "object.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define COPY_BYTES	(1 << 24)

static int program_path(char path[OBJECT_PATH_MAX], const char *machine,
			uint32_t n)
{
	char what[24];

	if (n == 0)
		return -EINVAL;
	snprintf(what, sizeof(what), "program.%u", n);
	return object_path(path, machine, what);
}

/* The folder of @path, which is changed. */
static const char *folder_of(char *path)
{
	*strrchr(path, '/') = '\0';
	return path;
}

int shm_program_begin(int *ret_fd, void **ret, const char *machine,
		      size_t bytes)
{
	char path[OBJECT_PATH_MAX];
	int err = program_path(path, machine, 1);
	int fd;

	if (err < 0)
		return err;
	if (bytes == 0)
		return -EINVAL;
	if (bytes > SHM_PROGRAM_MAX)
		return -EFBIG;
	fd = open(folder_of(path), O_RDWR | O_TMPFILE | O_CLOEXEC, 0640);
	if (fd < 0)
		return -errno;
	err = object_grow(fd, bytes, 0640);
	if (err == 0)
		err = object_map(ret, fd, bytes, true);
	if (err < 0)
		close(fd);
	else
		*ret_fd = fd;
	return err;
}

int shm_program_resize(int fd, void **at, size_t was, size_t bytes)
{
	int err = bytes == 0 ? -EINVAL : bytes > SHM_PROGRAM_MAX ? -EFBIG :
		  bytes > was ? object_reserve(fd, was, bytes - was) : 0;
	void *to = MAP_FAILED;

	if (err == 0) {
		to = mremap(*at, was, bytes, MREMAP_MAYMOVE);
		err = to == MAP_FAILED ? -errno : 0;
	}
	if (ftruncate(fd, (off_t)(err ? was : bytes)) < 0 && err == 0)
		err = -errno;
	if (to != MAP_FAILED)
		*at = to;
	return err;
}

int shm_program_name(int fd, const char *machine, uint32_t n)
{
	char path[OBJECT_PATH_MAX], of[32];
	int err = program_path(path, machine, n);

	if (err < 0)
		return err;
	/* The old one must not change for those who have it mapped. */
	if (unlink(path) < 0 && errno != ENOENT)
		return -errno;
	snprintf(of, sizeof(of), "/proc/self/fd/%d", fd);
	return linkat(AT_FDCWD, of, AT_FDCWD, path, AT_SYMLINK_FOLLOW) < 0 ?
	       -errno : 0;
}

int shm_program_create(void **ret, const char *machine, uint32_t n,
		       size_t bytes)
{
	int fd, err;

	if (n == 0)
		return -EINVAL;
	err = shm_program_begin(&fd, ret, machine, bytes);
	if (err < 0)
		return err;
	err = shm_program_name(fd, machine, n);
	close(fd);
	if (err < 0)
		shm_program_unmap(*ret, bytes);
	return err;
}

/* The file is read, not mapped.  If somebody truncates it, that is an error and
 * not a signal. */
static int copy_fill(char *to, int fd, size_t bytes)
{
	while (bytes > 0) {
		ssize_t n = read(fd, to,
				 bytes < COPY_BYTES ? bytes : COPY_BYTES);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return n < 0 ? -errno : -EPROTO;
		to += n;
		bytes -= (size_t)n;
	}
	return 0;
}

static int copy_make(void **ret, int fd, size_t bytes)
{
	void *at = mmap(NULL, bytes, PROT_READ | PROT_WRITE,
			MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	int err;

	if (at == MAP_FAILED)
		return -errno;
	err = copy_fill(at, fd, bytes);
	if (err == 0 && mprotect(at, bytes, PROT_READ) < 0)
		err = -errno;
	if (err < 0)
		munmap(at, bytes);
	else
		*ret = at;
	return err;
}

/*
 * The writer has reserved all the memory of a program.  A file with holes, or
 * one larger than any program, was not made by it, and would use up the memory.
 */
static int64_t program_size(int fd)
{
	const int64_t size = object_size(fd);
	struct stat st;

	if (size < 0)
		return size;
	if (fstat(fd, &st) < 0)
		return -errno;
	if (size > SHM_PROGRAM_MAX)
		return -EFBIG;
	return size > 0 && st.st_blocks * 512 >= size ? size : -EPROTO;
}

typedef int make_fn(void **ret, int fd, size_t bytes);

/* Nobody but its maker may write or truncate it. */
static int own_or_copy(void **ret, int fd, size_t bytes)
{
	return object_check(fd) == 0 ? object_map(ret, fd, bytes, false) :
				       copy_make(ret, fd, bytes);
}

static int program_open(const void **ret, size_t *ret_bytes,
			const char *machine, uint32_t n, make_fn *make)
{
	char path[OBJECT_PATH_MAX];
	int err = program_path(path, machine, n);
	int64_t size;
	void *at = NULL;
	int fd;

	if (err < 0)
		return err;
	fd = open(path, O_RDONLY | OBJECT_FLAGS, 0);
	if (fd < 0)
		return -errno;

	size = program_size(fd);
	err = size < 0 ? (int)size : make(&at, fd, (size_t)size);
	close(fd);
	if (err < 0)
		return err;
	*ret = at;
	*ret_bytes = (size_t)size;
	return 0;
}

int shm_program_open(const void **ret, size_t *ret_bytes, const char *machine,
		     uint32_t n)
{
	return program_open(ret, ret_bytes, machine, n, copy_make);
}

int shm_program_read(const void **ret, size_t *ret_bytes, const char *machine,
		     uint32_t n)
{
	return program_open(ret, ret_bytes, machine, n, own_or_copy);
}

int shm_program_map(const void **ret, size_t *ret_bytes, int fd)
{
	const int64_t size = program_size(fd);
	void *at = NULL;
	const int err = size < 0 ? (int)size :
			object_map(&at, fd, (size_t)size, false);

	if (err < 0)
		return err;
	*ret = at;
	*ret_bytes = (size_t)size;
	return 0;
}

struct shm_stamp shm_program_stamp(const char *machine, uint32_t n)
{
	char path[OBJECT_PATH_MAX];
	struct stat st;

	if (program_path(path, machine, n) < 0 || lstat(path, &st) < 0)
		return (struct shm_stamp) { .inode = 0 };
	return (struct shm_stamp) {
		.inode = st.st_ino, .s = st.st_mtim.tv_sec,
		.ns = st.st_mtim.tv_nsec,
	};
}

bool shm_is_stamp(const struct shm_stamp *stamp, const char *machine,
		  uint32_t n)
{
	const struct shm_stamp now = shm_program_stamp(machine, n);

	return now.inode && now.inode == stamp->inode && now.s == stamp->s &&
	       now.ns == stamp->ns;
}

void shm_program_unmap(const void *block, size_t bytes)
{
	shm_close(block, bytes);
}

void shm_program_remove(const char *machine, uint32_t n)
{
	char path[OBJECT_PATH_MAX];

	if (program_path(path, machine, n) == 0)
		unlink(path);
}
