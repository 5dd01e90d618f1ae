/* SPDX-License-Identifier: Apache-2.0 */
/*
 * writer.c - only one process may write commands and programs for a machine
 *
 * The lock is on an empty object of its own, because edmd makes the command
 * socket again at each start, and programs come and go.
 */
#include "object.h"

int shm_writer_claim(const char *machine)
{
	return object_claim(machine, "writer");
}

void shm_writer_leave(int fd, const char *machine)
{
	object_leave(fd, machine, "writer");
}
