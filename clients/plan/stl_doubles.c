/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stl_doubles.c - triangles that an STL file has more than once
 *
 * Programs that write a body twice are not rare.  One of two triangles with the
 * same corners in the same order says all; two leave each edge with four
 * neighbours.  Two with the corners in the reverse order are the two sides of
 * a sheet, and both stay.
 */
#include "stl_raw.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define NONE	UINT32_MAX

/* Which corner comes first is nobody's choice: the least one does. */
static void in_order(float from[3][3], float ret[3][3])
{
	int least = 0;

	for (int k = 1; k < 3; k++)
		if (memcmp(from[k], from[least], sizeof(from[k])) < 0)
			least = k;
	for (int k = 0; k < 3; k++)
		memcpy(ret[k], from[(least + k) % 3], sizeof(ret[k]));
}

/* FNV-1a over the words of a triangle. */
static uint64_t hash(float t[3][3])
{
	uint64_t h = UINT64_C(14695981039346656037);
	uint32_t word[9];

	memcpy(word, t[0], sizeof(word));
	for (int k = 0; k < 9; k++)
		h = (h ^ word[k]) * UINT64_C(1099511628211);
	return h ^ h >> 29;
}

/* Puts number @n, whose corners are @t, unless there is one like it. */
static bool is_new(uint32_t *table, size_t mask, float (*kept)[3][3],
		   uint32_t n, float t[3][3])
{
	size_t at = hash(t) & mask;

	for (; table[at] != NONE; at = (at + 1) & mask) {
		float other[3][3];

		in_order(kept[table[at]], other);
		if (memcmp(other, t, sizeof(other)) == 0)
			return false;
	}
	table[at] = n;
	return true;
}

int stl_raw_drop_doubles(struct stl_raw *raw, uint32_t *dropped)
{
	size_t size = 16;
	uint32_t *table, n = 0;

	while (size < 2 * (size_t)raw->n)
		size *= 2;
	table = malloc(size * sizeof(*table));
	if (!table)
		return EX_OSERR;
	memset(table, 0xff, size * sizeof(*table));
	for (uint32_t i = 0; i < raw->n; i++) {
		float t[3][3];

		in_order(raw->corner[i], t);
		if (!is_new(table, size - 1, raw->corner, n, t))
			continue;
		memmove(raw->corner[n++], raw->corner[i],
			sizeof(*raw->corner));
	}
	*dropped = raw->n - n;
	raw->n = n;
	free(table);
	return 0;
}
