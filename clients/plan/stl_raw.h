/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stl_raw.h - the triangles of an STL file, as they stand in it
 *
 * Units: the file's.  Any thread.
 */
#ifndef PLAN_STL_RAW_H
#define PLAN_STL_RAW_H

#include <stddef.h>
#include <stdint.h>

struct stl_raw {
	uint32_t n;
	size_t room;
	float (*corner)[3][3];		/* the caller calls free() */
};

/**
 * stl_raw_read() - read the file; its content shows whether it is binary or
 * text.
 *
 * Return: 0; else a sysexits code, and the reason is on stderr.
 */
int stl_raw_read(const char *path, struct stl_raw *ret);

/** stl_raw_drop_doubles() - remove triangles that are in the file twice.
 *  Return: 0 or EX_OSERR. */
int stl_raw_drop_doubles(struct stl_raw *raw, uint32_t *dropped);

struct stl_welded {
	uint32_t moved;			/* corners */
	double most;			/* ... by so much */
};

/** stl_raw_weld() - corners that are no more than @within apart become one: the
 *  first of them in the file.  Return: 0 or EX_OSERR. */
int stl_raw_weld(struct stl_raw *raw, double within, struct stl_welded *ret);

#endif /* PLAN_STL_RAW_H */
