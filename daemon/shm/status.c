/* SPDX-License-Identifier: Apache-2.0 */
/*
 * status.c - make, take over, open and remove the status object
 *
 * The owner holds a write lock, of its open file description, on an object of
 * its own, and another one on the status, about which readers may ask.  The
 * kernel releases both with the process, in whatever way it ends.
 */
#include "object.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#define CREATE_TRIES	8

/* The descriptors that hold the locks of the status made last. */
static struct {
	const struct shm_status *of;
	int status, owner;
} locks;

static uint32_t instance_draw(void)
{
	uint32_t n = 0;

	while (n == 0) {
		if (getrandom(&n, sizeof(n), 0) != sizeof(n))
			n = (uint32_t)getpid();
	}
	return n;
}

/*
 * The lock on the status itself only shows readers that its edmd lives.  If a
 * reader has a read lock on it, a new object is made.
 */
static int status_own(int fd)
{
	int err = object_check(fd);

	return err ? err : object_lock(fd);
}

/* Is it a whole object of this layout, left by a dead edmd of this machine? */
static bool status_fits(const struct shm_status *s, const char *machine)
{
	return object_head_check(&s->head, sizeof(*s)) == 0 &&
	       strcmp(s->head.machine, machine) == 0;
}

/*
 * The snapshots stay until the first new one, so an edmd that is killed before
 * that loses nothing.
 */
static void status_adopt(struct shm_status *s)
{
	memset(s->latency_us, 0, sizeof(s->latency_us));
	memset(s->took, 0, sizeof(s->took));
	s->drives_next = 0;
}

/* If the object cannot be completed, it is removed. */
static int status_make(void **ret, int fd, const char *path,
		       struct shm_status **before)
{
	int err = object_grow(fd, sizeof(struct shm_status), 0640);

	if (err == 0)
		err = object_map(ret, fd, sizeof(struct shm_status), true);
	if (err < 0)
		unlink(path);
	else if (*before)
		memcpy(*ret, *before, sizeof(struct shm_status));
	return err;
}

/* Keep the contents of the object, and make room for a new one with its
 * name. */
static int status_move(int fd, const char *path, struct shm_status **before)
{
	if (!*before)
		*before = malloc(sizeof(struct shm_status));
	if (!*before)
		return -ENOMEM;
	if (pread(fd, *before, sizeof(struct shm_status), 0) !=
	    sizeof(struct shm_status)) {
		free(*before);
		*before = NULL;
	}
	return unlink(path) < 0 && errno != ENOENT ? -errno : -EAGAIN;
}

/* Return: -EAGAIN if it had another layout and was removed; try again. */
static int status_take_over(void **ret, int fd, const char *path,
			    const char *machine)
{
	int err;

	if (object_size(fd) == (int64_t)sizeof(struct shm_status)) {
		err = object_map(ret, fd, sizeof(struct shm_status), true);
		if (err < 0)
			return err;
		if (status_fits(*ret, machine))
			return 0;
		munmap(*ret, sizeof(struct shm_status));
	}
	return unlink(path) < 0 && errno != ENOENT ? -errno : -EAGAIN;
}

/* One try.  Return: the descriptor, which holds the lock. */
static int status_try(void **ret, const char *path, const char *machine,
		      struct shm_status **before)
{
	int fd = open(path, O_RDWR | O_CREAT | OBJECT_FLAGS, 0640);
	int err;

	if (fd < 0)
		return -errno;

	err = status_own(fd);
	if (err == -EBUSY)
		err = status_move(fd, path, before);
	else if (err == 0 && object_size(fd) == 0)
		err = status_make(ret, fd, path, before);
	else if (err == 0)
		err = status_take_over(ret, fd, path, machine);
	if (err < 0) {
		close(fd);
		return err;
	}
	return fd;
}

int shm_status_create(struct shm_status **ret, const char *machine,
		      struct shm_snapshot *ret_before)
{
	char path[OBJECT_PATH_MAX];
	int err = object_path(path, machine, "status"), owner, fd = -EAGAIN;
	struct shm_status *s, *moved = NULL;
	void *at = NULL;

	if (err < 0)
		return err;
	owner = object_claim(machine, "owner");
	if (owner < 0)
		return owner;
	for (int i = 0; i < CREATE_TRIES && fd == -EAGAIN; i++)
		fd = status_try(&at, path, machine, &moved);
	free(moved);
	if (fd < 0) {
		close(owner);
		return fd;
	}

	s = at;
	if (!status_fits(s, machine) || !shm_snapshot(s, ret_before))
		*ret_before = (struct shm_snapshot) { .cycle = 0 };
	if (s->born == 0)
		s->born = (uint64_t)instance_draw() << 32 | instance_draw();
	status_adopt(s);
	object_head_fill(&s->head, machine, sizeof(*s), instance_draw());
	*ret = s;
	locks.of = s;
	locks.status = fd;
	locks.owner = owner;
	return 0;
}

void shm_status_destroy(struct shm_status *s, const char *machine)
{
	char path[OBJECT_PATH_MAX];

	if (!s)
		return;
	if (object_path(path, machine, "status") == 0)
		unlink(path);
	if (object_path(path, machine, "owner") == 0)
		unlink(path);
	if (locks.of == s) {
		close(locks.status);
		close(locks.owner);
		locks.of = NULL;
	}
	shm_close(s, sizeof(*s));
}

int shm_status_open(const struct shm_status **ret, const char *machine)
{
	void *at;
	int err = object_open(&at, machine, "status",
			      sizeof(struct shm_status), false);

	if (err == 0)
		*ret = at;
	return err;
}

/* Is it locked by another process, and is it the object that @s maps?  The
 * instance shows the latter. */
static bool status_is_owned(int fd, const struct shm_status *s)
{
	/* Only a write lock conflicts with a read lock. */
	struct flock lock = { .l_type = F_RDLCK, .l_whence = SEEK_SET };
	struct shm_head h;

	if (pread(fd, &h, sizeof(h), 0) != sizeof(h))
		return false;
	if (h.instance != __atomic_load_n(&s->head.instance, __ATOMIC_RELAXED))
		return false;
	return fcntl(fd, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool shm_alive(const struct shm_status *s)
{
	char path[OBJECT_PATH_MAX];
	bool alive;
	int fd;

	if (object_path(path, s->head.machine, "status") < 0)
		return false;
	fd = open(path, O_RDONLY | OBJECT_FLAGS, 0);
	if (fd < 0)
		return false;
	alive = status_is_owned(fd, s);
	close(fd);
	return alive;
}
