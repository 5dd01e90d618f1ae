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
	float (*corner)[3][3];		/* for free() */
};

/**
 * stl_raw_read() - binary or text, by what is in it.
 *
 * Return: 0; else a sysexits code, and the reason is on stderr.
 */
int stl_raw_read(const char *path, struct stl_raw *ret);

/** stl_raw_drop_doubles() - triangles that were there before go. Return: 0 or
 *  EX_OSERR. */
int stl_raw_drop_doubles(struct stl_raw *raw, uint32_t *dropped);

#endif /* PLAN_STL_RAW_H */
