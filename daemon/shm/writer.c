/* SPDX-License-Identifier: Apache-2.0 */
/*
 * writer.c - one writer of commands and programs for a machine
 *
 * The lock is on an empty object of its own: edmd makes the command ring anew
 * when it starts, and programs come and go.
 */
#include "object.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

int shm_writer_claim(const char *machine)
{
	struct flock lock = { .l_type = F_WRLCK, .l_whence = SEEK_SET };
	char path[OBJECT_PATH_MAX];
	int err = object_path(path, machine, "writer");
	int fd;

	if (err < 0)
		return err;
	fd = open(path, O_RDWR | O_CREAT | OBJECT_FLAGS, 0640);
	if (fd < 0)
		return -errno;
	if (fcntl(fd, F_OFD_SETLK, &lock) == 0)
		return fd;
	err = errno == EAGAIN || errno == EACCES ? -EBUSY : -errno;
	close(fd);
	return err;
}

void shm_writer_leave(int fd, const char *machine)
{
	char path[OBJECT_PATH_MAX];

	if (fd < 0)
		return;
	if (object_path(path, machine, "writer") == 0)
		unlink(path);
	close(fd);
}
