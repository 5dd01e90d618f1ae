/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commission_file.c - set keys of the machine file
 *
 * The rest of the file stays as it is, with its comments.  The new file is read
 * as edmd reads it before it takes the place of the old one.
 */
#include "commission.h"

#include "output.h"

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
	const char *section;
	const struct tour_key *key;
	size_t n;
	uint32_t done;			/* a bit of each key */
	bool inside;
};

static void put(struct copy *c, size_t i)
{
	if (!(c->done >> i & 1))
		fprintf(c->to, "%s = %s\n", c->key[i].key, c->key[i].value);
	c->done |= 1u << i;
}

/* Which of the keys the line gives; else n. */
static size_t key_of(const struct copy *c, const char *line)
{
	size_t i = 0;

	while (i < c->n && !begins(line, c->key[i].key, " \t="))
		i++;
	return c->inside ? i : c->n;
}

static void copy_line(struct copy *c, const char *line)
{
	const size_t key = key_of(c, line);
	char head[64];

	snprintf(head, sizeof(head), "[%s]", c->section);
	if (line[strspn(line, " \t")] == '[') {
		c->inside = begins(line, head, " \t\r\n;");
		fputs(line, c->to);
	} else if (key < c->n) {
		/* One that is said again is left out. */
		put(c, key);
	} else {
		fputs(line, c->to);
	}
}

/* Behind a section that lacks one of the keys it begins once more. */
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
	if (c->done + 1 != 1u << c->n)
		fprintf(c->to, "%s[%s]\n", whole ? "" : "\n", c->section);
	for (size_t i = 0; i < c->n; i++)
		put(c, i);
	return ferror(from) ? -EIO : output_close(c->to);
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

/* It has taken the place of the old one. */
static void tell_written(struct tour *w, const struct copy *c)
{
	json_t *wrote = json_object_get(w->now, "wrote");
	char text[SAID_CHARS];

	if (!wrote) {
		wrote = json_array();
		json_object_set_new(w->now, "wrote", wrote);
	}
	for (size_t i = 0; i < c->n; i++) {
		snprintf(text, sizeof(text), "[%s] %s = %s", c->section,
			 c->key[i].key, c->key[i].value);
		json_array_append_new(wrote, json_string(text));
		printf("written: %s\n", text);
	}
	w->changed = true;
}

bool tour_write(struct tour *w, const char *section, const struct tour_key *key,
		size_t n)
{
	static struct machine_config trial;
	struct interp_diag diag;
	struct copy c = { .section = section, .key = key, .n = n };
	char fresh[PATH_MAX + 8], file[PATH_MAX];
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
	if (err == 0) {
		tell_written(w, &c);
		return true;
	}
	fprintf(stderr, "edmctl: %s: [%s] %s = %s is not written%s%s\n",
		w->path, section, key[0].key, key[0].value,
		err == -EINVAL ? "" : ": ",
		err == -EINVAL ? "" : strerror(-err));
	unlink(fresh);
	return false;
}
