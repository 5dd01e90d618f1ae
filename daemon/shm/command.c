/* SPDX-License-Identifier: Apache-2.0 */
/*
 * command.c - the command ring, between two processes that differ in trust
 *
 * ck_ring keeps its size and mask beside the indices, in memory that the other
 * side may write.  So each side works on a copy of the ring's head with its
 * own size and mask, and exchanges nothing but the two indices, which are
 * masked before use: a bad index yields a stale command, never a bad address.
 * The indices go through C11 atomics, whose order a thread sanitizer can see.
 */
#include "object.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

CK_RING_PROTOTYPE(command, shm_command)

static int command_make(void **ret, const char *path)
{
	int fd = shm_open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0660);
	int err;

	if (fd < 0)
		return -errno;
	err = object_grow(fd, sizeof(struct shm_command_ring), 0660);
	if (err == 0)
		err = object_map(ret, fd, sizeof(struct shm_command_ring),
				 true);
	close(fd);
	if (err < 0)
		shm_unlink(path);
	return err;
}

int shm_command_create(struct shm_command_ring **ret, const char *machine,
		       uint32_t instance)
{
	char path[OBJECT_PATH_MAX];
	int err = object_path(path, machine, "command");
	struct shm_command_ring *r;
	void *at = NULL;

	if (err < 0)
		return err;
	if (shm_unlink(path) < 0 && errno != ENOENT)
		return -errno;
	err = command_make(&at, path);
	if (err < 0)
		return err;

	r = at;
	ck_ring_init(&r->ring, SHM_COMMAND_SLOTS);
	object_head_fill(&r->head, machine, sizeof(*r), instance);
	*ret = r;
	return 0;
}

void shm_command_destroy(struct shm_command_ring *r, const char *machine)
{
	char path[OBJECT_PATH_MAX];

	if (!r)
		return;
	if (object_path(path, machine, "command") == 0)
		shm_unlink(path);
	shm_close(r, sizeof(*r));
}

int shm_command_open(struct shm_command_ring **ret, const char *machine)
{
	void *at;
	int err = object_open(&at, machine, "command",
			      sizeof(struct shm_command_ring), true);

	if (err == 0)
		*ret = at;
	return err;
}

static struct ck_ring ring_copy(const struct shm_command_ring *r)
{
	struct ck_ring own;

	ck_ring_init(&own, SHM_COMMAND_SLOTS);
	own.c_head = __atomic_load_n(&r->ring.c_head, __ATOMIC_ACQUIRE);
	own.p_tail = __atomic_load_n(&r->ring.p_tail, __ATOMIC_ACQUIRE);
	return own;
}

bool shm_command_take(struct shm_command_ring *r, struct shm_command *ret)
{
	struct ck_ring own = ring_copy(r);

	if (!ck_ring_dequeue_spsc_command(&own, r->slot, ret))
		return false;
	__atomic_store_n(&r->ring.c_head, own.c_head, __ATOMIC_RELEASE);
	return true;
}

int shm_command_put(struct shm_command_ring *r, const struct shm_command *c)
{
	struct ck_ring own = ring_copy(r);
	struct shm_command copy = *c;

	if (!ck_ring_enqueue_spsc_command(&own, r->slot, &copy))
		return -EAGAIN;
	__atomic_store_n(&r->ring.p_tail, own.p_tail, __ATOMIC_RELEASE);
	return 0;
}
