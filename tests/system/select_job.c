/* SPDX-License-Identifier: Apache-2.0 */
/*
 * select_job.c - writes what edmd writes when its PLC selects a job, into the
 * memory of an edmd that stands
 *
 *	select_job STATUS N
 */
#include "shm.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>

int main(int argc, char **argv)
{
	const int fd = argc == 3 ? open(argv[1], O_RDWR) : -1;
	struct shm_status *s = mmap(NULL, sizeof(*s), PROT_READ | PROT_WRITE,
				    MAP_SHARED, fd, 0);

	if (s == MAP_FAILED)
		return 1;
	shm_event(s, &(struct shm_event) {
		.kind = SHM_EV_SELECT, .code = atoi(argv[2]),
	});
	return 0;
}
