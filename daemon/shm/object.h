/* SPDX-License-Identifier: Apache-2.0 */
/*
 * object.h - what the shared objects have in common: name, head, mapping
 *
 * Private to this folder.  Startup only.
 */
#ifndef EDM_SHM_OBJECT_H
#define EDM_SHM_OBJECT_H

#include "shm.h"

#include <pthread.h>

#define OBJECT_PATH_MAX	SHM_PATH_MAX

/** object_path() - places_path() of an object. */
int object_path(char path[OBJECT_PATH_MAX], const char *machine,
		const char *what);

/**
 * object_claim() - lock the empty object @what for this process.
 *
 * Only its maker may open it.  Otherwise a read lock, which any reader of an
 * object may take, would keep the next owner out.
 *
 * Return: a descriptor that holds the lock, until the end of the process at
 * most; -EBUSY another living process has it; -EPERM another user made it; else
 * -errno.
 */
int object_claim(const char *machine, const char *what);

/** object_leave() - remove the object and release the lock; -1 is fine. */
void object_leave(int fd, const char *machine, const char *what);

/** object_lock() - lock @fd for writing.  Return: 0, -EBUSY, else -errno. */
int object_lock(int fd);

/**
 * object_check() - 0 if @fd is ours and still has its name; -EAGAIN if it was
 * removed meanwhile; -EPERM if it belongs to another user; else -errno.
 */
int object_check(int fd);

/* Do not follow a link, and do not wait for the other end of a pipe. */
#define OBJECT_FLAGS	(O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)

/** object_size() - bytes of @fd, which must be a plain file; else -errno. */
int64_t object_size(int fd);

/** object_reserve() - give @fd the memory from @from on. */
int object_reserve(int fd, size_t from, size_t bytes);

/** object_grow() - give the empty @fd @bytes of memory and @mode. */
int object_grow(int fd, size_t bytes, unsigned int mode);

/** object_map() - map @bytes of @fd. */
int object_map(void **ret, int fd, size_t bytes, bool writable);

/**
 * object_head_fill() - fill the head; the magic comes last, so that a reader
 * sees all or nothing.
 */
void object_head_fill(struct shm_head *h, const char *machine,
		      uint64_t bytes, uint32_t instance);

/** object_head_check() - 0; -ENOENT not filled yet; -EPROTO not ours. */
int object_head_check(const struct shm_head *h, uint64_t bytes);

/** object_open() - map a whole object that another process made. */
int object_open(void **ret, const char *machine, const char *what,
		size_t bytes, bool writable);

/** object_thread_end() - tell it by the eventfd @end, and wait for it. */
void object_thread_end(pthread_t thread, int end);

#endif /* EDM_SHM_OBJECT_H */
