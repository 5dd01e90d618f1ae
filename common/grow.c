/* SPDX-License-Identifier: Apache-2.0 */
/* grow.c - an array that grows as it is filled */
#include "grow.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define FIRST	64		/* elements */

int grow_to(void *at, size_t *room, size_t wanted, size_t bytes)
{
	void *array;

	/* A pointer to another type may not be read as a void *. */
	memcpy(&array, at, sizeof(array));
	array = reallocarray(array, wanted, bytes);
	if (!array)
		return -ENOMEM;
	memcpy(at, &array, sizeof(array));
	*room = wanted;
	return 0;
}

int grow_array(void *at, size_t *room, size_t bytes)
{
	return grow_to(at, room, *room ? 2 * *room : FIRST, bytes);
}

int grow_read(FILE *f, size_t most, char **at, size_t *n)
{
	size_t room = 0, more;

	do {
		if (*n == room && grow_array(at, &room, sizeof(**at)))
			return -ENOMEM;
		more = fread(*at + *n, 1, room - *n, f);
		*n += more;
		if (*n > most)
			return -EFBIG;
	} while (more > 0);
	return ferror(f) ? -errno : 0;
}
