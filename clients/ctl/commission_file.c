/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_file.c - set a key of the machine file
 *
 * The rest of the file stays as it is, with its comments.  The new file is read
 * as edmd reads it before it takes the place of the old one.
 */
#include "commission.h"

#include "written.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Does the line begin with this word, and what ends it? */
static bool begins(const char *line, const char *word, const char *ends)
{
	const size_t n = strlen(word);

	line += strspn(line, " \t");
	return strncmp(line, word, n) == 0 && strchr(ends, line[n]);
}

struct copy {
	FILE *to;
	const char *section, *key, *value;
	bool inside, done;
};

static void put(struct copy *c)
{
	if (!c->done)
		fprintf(c->to, "%s = %s\n", c->key, c->value);
	c->done = true;
}

static void copy_line(struct copy *c, const char *line)
{
	char head[64];

	snprintf(head, sizeof(head), "[%s]", c->section);
	if (line[strspn(line, " \t")] == '[') {
		c->inside = begins(line, head, " \t\r\n;");
		fputs(line, c->to);
	} else if (c->inside && begins(line, c->key, " \t=")) {
		/* One that is said again is left out. */
		put(c);
	} else {
		fputs(line, c->to);
	}
}

/* Behind a section that has no such key yet it begins once more. */
static int copy_all(FILE *from, struct copy *c)
{
	char *line = NULL;
	size_t room = 0;
	bool whole = true;

	while (getline(&line, &room, from) > 0) {
		copy_line(c, line);
		whole = strchr(line, '\n') != NULL;
	}
	free(line);
	if (!c->done)
		fprintf(c->to, "%s[%s]\n", whole ? "" : "\n", c->section);
	put(c);
	return ferror(from) ? -EIO : written_close(c->to);
}

static int make(const struct tour *w, const char *fresh, struct copy *c)
{
	FILE *from = fopen(w->path, "re");
	struct stat as;
	int err = from ? 0 : -errno;

	if (err == 0) {
		c->to = fopen(fresh, "we");
		if (c->to && (fstat(fileno(from), &as) < 0 ||
			      fchmod(fileno(c->to), as.st_mode & 07777) < 0 ||
			      fchown(fileno(c->to), as.st_uid, as.st_gid) < 0))
			fprintf(stderr, "edmctl: %s: its owner or its rights "
				"are new: %s\n", w->path, strerror(errno));
		err = c->to ? copy_all(from, c) : -errno;
		fclose(from);
	}
	return err;
}

bool tour_write(struct tour *w, const char *section, const char *key,
		const char *value)
{
	static struct machine_config trial;
	struct interp_diag diag;
	struct copy c = { .section = section, .key = key, .value = value };
	char fresh[PATH_MAX + 8], file[PATH_MAX], text[SAID_CHARS];
	json_t *wrote;
	int err;

	/* A link stays one. */
	if (!realpath(w->path, file))
		snprintf(file, sizeof(file), "%s", w->path);
	snprintf(fresh, sizeof(fresh), "%s.new", file);
	err = make(w, fresh, &c);
	if (err == 0)
		err = config_read(&trial, fresh, &diag);
	if (err == -EINVAL)
		interp_diag_tell(&diag, fresh);
	if (err == 0 && rename(fresh, file) < 0)
		err = -errno;
	snprintf(text, sizeof(text), "[%s] %s = %s", section, key, value);
	if (err < 0) {
		fprintf(stderr, "edmctl: %s: %s is not written%s%s\n", w->path,
			text, err == -EINVAL ? "" : ": ",
			err == -EINVAL ? "" : strerror(-err));
		unlink(fresh);
		return false;
	}
	wrote = json_object_get(w->now, "wrote");
	if (!wrote) {
		wrote = json_array();
		json_object_set_new(w->now, "wrote", wrote);
	}
	json_array_append_new(wrote, json_string(text));
	printf("written: %s\n", text);
	w->changed = true;
	return true;
}
