/* SPDX-License-Identifier: Apache-2.0 */
/*
 * assets.h - the files of the page, read once into memory
 *
 * A file that is not in the folder at the start does not exist: no name from
 * outside ever becomes a path.
 *
 * Threads: one.
 */
#ifndef PANEL_ASSETS_H
#define PANEL_ASSETS_H

#include <stdbool.h>
#include <stddef.h>

struct asset {
	char name[96];			/* as a browser asks for it:
					 * "/assets/x.js" */
	const char *type;
	char *bytes;
	size_t size;
	bool gzip;			/* the bytes are compressed */
	bool hashed;			/* its name changes with its bytes */
};

struct assets;

/**
 * assets_read() - read all files of @folder. Return: 0, -ENOENT, -EFBIG,
 * -errno.
 */
int assets_read(struct assets **ret, const char *folder);
void assets_free(struct assets *a);

/**
 * assets_find() - find a file; "/" means index.html. Return: NULL if there is
 * none.
 */
const struct asset *assets_find(const struct assets *a, const char *name);

#endif /* PANEL_ASSETS_H */
