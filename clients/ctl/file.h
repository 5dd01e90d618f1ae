/* SPDX-License-Identifier: Apache-2.0 */
/*
 * file.h - a file that is there as a whole or not at all
 *
 * It is written under another name beside its place, and gets its name when it
 * is complete and on the disk.
 */
#ifndef CTL_FILE_H
#define CTL_FILE_H

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>

struct ctl_file {
	const char *path;
	char part[PATH_MAX];		/* its name while it is written */
	bool replace;
	FILE *f;
};

/**
 * ctl_file_open() - begin to write @path.
 *
 * @replace: a file that is there is replaced; otherwise it is refused, and only
 * its owner may read the new one.
 *
 * Return: 0, or an exit code after a message.
 */
int ctl_file_open(struct ctl_file *o, const char *path, bool replace);

/**
 * ctl_file_close() - @err 0: give it its name; otherwise forget it.
 *
 * Return: @err, or an exit code after a message.
 */
int ctl_file_close(struct ctl_file *o, int err);

#endif /* CTL_FILE_H */
