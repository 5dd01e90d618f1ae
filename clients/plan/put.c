/* SPDX-License-Identifier: Apache-2.0 */
/*
 * put.c - write a file whole or not at all
 *
 * Nobody must take the first half of a program, left by a full disk, for a
 * program.  So a file is written beside its place and then moved there.  A pipe
 * or a device is written to directly.  Where standard output is one of the
 * files, what is printed for a person goes to standard error.
 */
#include "plan.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

/* A file that is asked for as -. */
static int standard_output = STDOUT_FILENO;

static int say(const char *path, int err, int exit)
{
	fprintf(stderr, "edm-plan: %s: %s; a file to be written\n", path,
		strerror(err));
	return exit;
}

/* Return: 0 or an errno. */
static int put_stream(FILE *f, const char *text)
{
	int err = fputs(text, f) < 0 || fflush(f) ? errno : 0;

	if (err == 0 && fsync(fileno(f)) && errno != EINVAL && errno != EROFS)
		err = errno;
	return fclose(f) && err == 0 ? errno : err;
}

/* Is there something that is not a file, or a link to one? */
static bool is_special(const char *path)
{
	struct stat st;

	return stat(path, &st) == 0 && !S_ISREG(st.st_mode);
}

static int put_beside(const char *path, const char *text)
{
	char *fresh = NULL, *real = realpath(path, NULL);
	const char *place = real ? real : path;
	FILE *f = NULL;
	int err = 0;

	if (asprintf(&fresh, "%s.new", place) < 0)
		err = ENOMEM;
	if (err == 0) {
		unlink(fresh);		/* of a run that was killed */
		f = fopen(fresh, "wx");
		err = f ? 0 : errno;
	}
	if (f) {
		err = put_stream(f, text);
		if (err == 0 && rename(fresh, place))
			err = errno;
		if (err)
			unlink(fresh);
	}
	free(fresh);
	free(real);
	return err;
}

int put_text(const char *path, const char *text)
{
	const bool standard = strcmp(path, "-") == 0;
	int err;

	if (!standard && !is_special(path)) {
		err = put_beside(path, text);
	} else {
		FILE *f = standard ? fdopen(standard_output, "w") :
				     fopen(path, "w");

		err = f ? put_stream(f, text) : errno;
	}
	if (err == 0)
		return 0;
	return say(path, err, err == ENOSPC || err == EIO || err == EDQUOT ?
			      EX_IOERR : EX_CANTCREAT);
}

/* -- Before anything is planned ------------------------------------------- */

static bool same_file(const char *a, const char *b)
{
	struct stat x, y;

	return a && b && stat(a, &x) == 0 && stat(b, &y) == 0 &&
	       S_ISREG(x.st_mode) && x.st_dev == y.st_dev &&
	       x.st_ino == y.st_ino;
}

/* Can a file be made there? */
static int try_folder(const char *path)
{
	const char *slash = strrchr(path, '/');
	char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) :
			       strdup(".");
	int err = 0;

	if (!folder)
		return EX_OSERR;
	if (strcmp(path, "-") && !is_special(path) && access(folder, W_OK))
		err = say(path, errno, EX_CANTCREAT);
	else if (is_special(path) && access(path, W_OK))
		err = say(path, errno, EX_CANTCREAT);
	free(folder);
	return err;
}

static int keep_standard_output(void)
{
	standard_output = dup(STDOUT_FILENO);
	return standard_output < 0 ||
	       dup2(STDERR_FILENO, STDOUT_FILENO) < 0 ?
		       say("-", errno, EX_CANTCREAT) : 0;
}

int put_check(const struct job_options *o)
{
	const char *const out[] = { o->output, o->report, o->picture, o->view };
	const char *const in[] = { o->part, o->electrode, o->machine_file,
				   o->program };
	int err = 0;

	for (int i = 0; i < 4 && err == 0; i++) {
		for (int k = 0; k < 4 && out[i]; k++) {
			if (same_file(out[i], in[k])) {
				fprintf(stderr, "edm-plan: %s: it is read, "
					"too; another file to be written\n",
					out[i]);
				return EX_USAGE;
			}
			if (k < i && out[k] && strcmp(out[i], out[k]) == 0) {
				fprintf(stderr, "edm-plan: %s: asked for "
					"twice; a file of its own for each\n",
					out[i]);
				return EX_USAGE;
			}
		}
		err = out[i] ? try_folder(out[i]) : 0;
		if (err == 0 && out[i] && strcmp(out[i], "-") == 0)
			err = keep_standard_output();
	}
	return err;
}
