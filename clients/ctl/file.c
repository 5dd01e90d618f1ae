/* SPDX-License-Identifier: Apache-2.0 */
/* file.c - a file that is there as a whole or not at all */
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

static int refuse(const struct ctl_file *o, const char *why)
{
	fprintf(stderr, "edmctl: %s: %s\n", o->path, why);
	return EX_CANTCREAT;
}

static const char is_there[] =
	"is there already; another name, or move it away";

int ctl_file_open(struct ctl_file *o, const char *path, bool replace)
{
	struct stat st;
	int fd;

	*o = (struct ctl_file) { .path = path, .replace = replace };
	if (!replace && lstat(path, &st) == 0)
		return refuse(o, is_there);
	if (snprintf(o->part, sizeof(o->part), "%s.%d.part", path,
		     (int)getpid()) >= (int)sizeof(o->part))
		return refuse(o, "too long a name; a shorter one");
	fd = open(o->part, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC,
		  replace ? 0666 : 0600);
	o->f = fd < 0 ? NULL : fdopen(fd, "w");
	if (o->f)
		return 0;
	return refuse(o, strerror(errno));
}

/* Not every file system can rename only if the new name is free. */
static int give_name(const struct ctl_file *o)
{
	struct stat st;
	int err;

	if (o->replace)
		return rename(o->part, o->path);
	err = renameat2(AT_FDCWD, o->part, AT_FDCWD, o->path, RENAME_NOREPLACE);
	if (err == 0 || (errno != EINVAL && errno != ENOSYS))
		return err;
	if (lstat(o->path, &st) == 0) {
		errno = EEXIST;
		return -1;
	}
	return rename(o->part, o->path);
}

int ctl_file_close(struct ctl_file *o, int err)
{
	const char *why = NULL;

	if (!o->f)
		return err;
	if (err == 0 && (ferror(o->f) || fflush(o->f) != 0 ||
			 fsync(fileno(o->f)) != 0))
		why = strerror(errno);
	if (fclose(o->f) != 0 && err == 0 && !why)
		why = strerror(errno);
	o->f = NULL;
	if (err == 0 && !why && give_name(o) != 0)
		why = errno == EEXIST ? is_there : strerror(errno);
	if (err == 0 && !why)
		return 0;
	unlink(o->part);
	if (!why)
		return err;
	refuse(o, why);
	return EX_IOERR;
}
