/* SPDX-License-Identifier: Apache-2.0 */
/*
 * object.c - names, heads and mappings of the shared objects
 */
#include "object.h"

#include "names.h"
#include "places.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define CLAIM_TRIES	8		/* somebody else may remove it
					 * meanwhile */


int object_path(char path[OBJECT_PATH_MAX], const char *machine,
		const char *what)
{
	_Static_assert(SHM_NAME_MAX == NAMES_MACHINE_MAX, "one rule of names");
	_Static_assert(OBJECT_PATH_MAX == PLACES_PATH_MAX, "one of paths");

	return places_path(path, machine, what);
}

void shm_path(char path[SHM_PATH_MAX], const char *machine, const char *what)
{
	if (object_path(path, machine, what) < 0)
		path[0] = '\0';
}

int64_t object_size(int fd)
{
	struct stat st;

	if (fstat(fd, &st) < 0)
		return -errno;
	return S_ISREG(st.st_mode) ? st.st_size : -EPROTO;
}

int object_lock(int fd)
{
	struct flock lock = { .l_type = F_WRLCK, .l_whence = SEEK_SET };

	if (fcntl(fd, F_OFD_SETLK, &lock) == 0)
		return 0;
	return errno == EACCES || errno == EAGAIN ? -EBUSY : -errno;
}

int object_check(int fd)
{
	struct stat st;

	if (fstat(fd, &st) < 0)
		return -errno;
	if (st.st_nlink == 0)
		return -EAGAIN;
	return st.st_uid == geteuid() ? 0 : -EPERM;
}

static int claim_try(const char *path)
{
	int fd = open(path, O_RDWR | O_CREAT | OBJECT_FLAGS, 0600);
	int err;

	if (fd < 0)
		return -errno;
	err = object_lock(fd);
	if (err == 0)
		err = object_check(fd);
	if (err == 0 && fchmod(fd, 0600) < 0)
		err = -errno;
	if (err == 0)
		return fd;
	close(fd);
	return err;
}

int object_claim(const char *machine, const char *what)
{
	char path[OBJECT_PATH_MAX];
	int fd = object_path(path, machine, what);

	if (fd < 0)
		return fd;
	fd = -EAGAIN;
	for (int i = 0; i < CLAIM_TRIES && fd == -EAGAIN; i++)
		fd = claim_try(path);
	return fd;
}

void object_leave(int fd, const char *machine, const char *what)
{
	char path[OBJECT_PATH_MAX];

	if (fd < 0)
		return;
	if (object_path(path, machine, what) == 0)
		unlink(path);
	close(fd);
}

/*
 * The memory is reserved at once.  A sparse object would end its writer with
 * SIGBUS when /dev/shm is full one day.
 */
int object_reserve(int fd, size_t from, size_t bytes)
{
	int err;

	do {
		err = posix_fallocate(fd, (off_t)from, (off_t)bytes);
	} while (err == EINTR);
	return -err;
}

int object_grow(int fd, size_t bytes, unsigned int mode)
{
	/* shm_open() has reduced the mode by the umask. */
	if (fchmod(fd, mode) < 0 || ftruncate(fd, (off_t)bytes) < 0)
		return -errno;
	return object_reserve(fd, 0, bytes);
}

int object_map(void **ret, int fd, size_t bytes, bool writable)
{
	int prot = writable ? PROT_READ | PROT_WRITE : PROT_READ;
	void *at = mmap(NULL, bytes, prot, MAP_SHARED, fd, 0);

	if (at == MAP_FAILED)
		return -errno;
	*ret = at;
	return 0;
}

void object_head_fill(struct shm_head *h, const char *machine,
		      uint64_t bytes, uint32_t instance)
{
	strncpy(h->machine, machine, sizeof(h->machine) - 1);
	h->layout = SHM_LAYOUT;
	h->bytes = bytes;
	__atomic_store_n(&h->pid, (int32_t)getpid(), __ATOMIC_RELAXED);
	__atomic_store_n(&h->instance, instance, __ATOMIC_RELAXED);
	__atomic_store_n(&h->magic, SHM_MAGIC, __ATOMIC_RELEASE);
}

int object_head_check(const struct shm_head *h, uint64_t bytes)
{
	uint32_t magic = __atomic_load_n(&h->magic, __ATOMIC_ACQUIRE);

	if (magic == 0 && h->layout == 0)
		return -ENOENT;
	if (magic != SHM_MAGIC || h->layout != SHM_LAYOUT ||
	    h->bytes != bytes || h->machine[SHM_NAME_MAX - 1] != '\0')
		return -EPROTO;
	return 0;
}

static int object_open_fd(void **ret, int fd, size_t bytes, bool writable)
{
	int64_t size = object_size(fd);
	void *at = NULL;
	struct stat st;
	int err;

	if (size < 0)
		return (int)size;
	if (size == 0)
		return -ENOENT;
	/* Another user could truncate the file and so end us by a signal. */
	if (fstat(fd, &st) < 0 || !places_is_trusted(st.st_uid, PLACES_EDMD))
		return -EPERM;
	if ((uint64_t)size != bytes)
		return -EPROTO;

	err = object_map(&at, fd, bytes, writable);
	if (err < 0)
		return err;
	err = object_head_check(at, bytes);
	if (err < 0) {
		munmap(at, bytes);
		return err;
	}
	*ret = at;
	return 0;
}

int object_open(void **ret, const char *machine, const char *what,
		size_t bytes, bool writable)
{
	char path[OBJECT_PATH_MAX];
	int err = object_path(path, machine, what);
	int fd;

	if (err < 0)
		return err;
	fd = open(path, (writable ? O_RDWR : O_RDONLY) | OBJECT_FLAGS);
	if (fd < 0)
		return -errno;
	err = object_open_fd(ret, fd, bytes, writable);
	close(fd);
	return err;
}

void object_thread_end(pthread_t thread, int end)
{
	const uint64_t one = 1;

	/* Writing 1 to an eventfd whose count is 0 cannot fail. */
	if (write(end, &one, sizeof(one)) != sizeof(one))
		abort();
	pthread_join(thread, NULL);
}

void shm_close(const void *object, size_t bytes)
{
	if (object)
		munmap((void *)(uintptr_t)object, bytes);
}
