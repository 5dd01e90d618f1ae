/* SPDX-License-Identifier: Apache-2.0 */
/*
 * grow.h - an array that grows as it is filled
 *
 * Its owner keeps a pointer to it and how much room it has, both 0 at first.
 * Before it adds an element to a full array it calls
 *
 *	if (a->n == a->room && grow_array(&a->at, &a->room, sizeof(*a->at)))
 *		return -ENOMEM;
 *
 * Threads: any, one at a time for an array; it allocates.
 */
#ifndef COMMON_GROW_H
#define COMMON_GROW_H

#include <stddef.h>
#include <stdio.h>

/**
 * grow_array() - double the room of an array, which may move.
 *
 * @at: the address of the pointer to it, of any type
 * @room: elements
 * @bytes: of an element
 *
 * Return: 0, or -ENOMEM: the array is as it was.
 */
int grow_array(void *at, size_t *room, size_t bytes);

/** grow_to() - the same, but give it room for @wanted elements. */
int grow_to(void *at, size_t *room, size_t wanted, size_t bytes);

/**
 * grow_read() - read all that is left of @f.
 *
 * @most: bytes that are taken
 * @at, @n: NULL and 0 at first; ret: the bytes and their number, to be freed
 *	    even if it fails
 *
 * Return: 0; -EFBIG: there are more; -ENOMEM; -errno of the reading.
 */
int grow_read(FILE *f, size_t most, char **at, size_t *n);

#endif /* COMMON_GROW_H */
