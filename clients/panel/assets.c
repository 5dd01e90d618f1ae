/* SPDX-License-Identifier: Apache-2.0 */
/*
 * assets.c - the files of the page, read once into memory
 */
#include "assets.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ASSETS_MAX	128
#define ASSETS_BYTES	(32u << 20)

struct assets {
	struct asset asset[ASSETS_MAX];
	size_t n, bytes;
};

static const char *type_of(const char *name)
{
	static const struct { const char *end, *type; } types[] = {
		{ ".html", "text/html; charset=utf-8" },
		{ ".js", "text/javascript; charset=utf-8" },
		{ ".css", "text/css; charset=utf-8" },
		{ ".svg", "image/svg+xml" },
		{ ".png", "image/png" },
		{ ".woff2", "font/woff2" },
		{ ".json", "application/json" },
	};
	const char *dot = strrchr(name, '.');

	for (size_t i = 0; dot && i < sizeof(types) / sizeof(types[0]); i++)
		if (strcmp(dot, types[i].end) == 0)
			return types[i].type;
	return "application/octet-stream";
}

static int read_bytes(const char *path, struct asset *a)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
	struct stat st;
	ssize_t n = -1;

	if (fd < 0)
		return -errno;
	if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode) &&
	    st.st_size < (off_t)ASSETS_BYTES) {
		a->bytes = malloc((size_t)st.st_size + 1);
		n = a->bytes ? read(fd, a->bytes, (size_t)st.st_size) : -1;
	}
	close(fd);
	if (n < 0)
		return -EIO;
	a->size = (size_t)n;
	return 0;
}

static int add(struct assets *s, const char *path, const char *name)
{
	struct asset *a = &s->asset[s->n];
	const size_t len = strlen(name);
	int err;

	if (s->n == ASSETS_MAX || len >= sizeof(a->name))
		return -EFBIG;
	err = read_bytes(path, a);
	if (err)
		return err;
	s->bytes += a->size;
	s->n++;
	if (s->bytes > ASSETS_BYTES)
		return -EFBIG;
	snprintf(a->name, sizeof(a->name), "%s", name);
	a->gzip = len > 3 && strcmp(name + len - 3, ".gz") == 0;
	if (a->gzip)
		a->name[len - 3] = '\0';
	a->type = type_of(a->name);
	a->hashed = strncmp(a->name, "/assets/", 8) == 0;
	return 0;
}

static int read_folder(struct assets *s, const char *folder, const char *under)
{
	DIR *d = opendir(folder);
	struct dirent *e;
	int err = 0;

	if (!d)
		return -errno;
	while (err == 0 && (e = readdir(d))) {
		char path[512], name[128];

		if (e->d_name[0] == '.')
			continue;
		snprintf(path, sizeof(path), "%s/%s", folder, e->d_name);
		snprintf(name, sizeof(name), "%.30s/%.90s", under, e->d_name);
		if (e->d_type == DT_DIR)
			err = under[0] ? 0 : read_folder(s, path, name);
		else
			err = add(s, path, name);
	}
	closedir(d);
	return err;
}

int assets_read(struct assets **ret, const char *folder)
{
	struct assets *s = calloc(1, sizeof(*s));
	int err;

	if (!s)
		return -ENOMEM;
	err = read_folder(s, folder, "");
	if (err == 0 && !assets_find(s, "/"))
		err = -ENOENT;
	if (err) {
		assets_free(s);
		return err;
	}
	*ret = s;
	return 0;
}

void assets_free(struct assets *a)
{
	for (size_t i = 0; a && i < a->n; i++)
		free(a->asset[i].bytes);
	free(a);
}

const struct asset *assets_find(const struct assets *a, const char *name)
{
	if (strcmp(name, "/") == 0)
		name = "/index.html";
	for (size_t i = 0; i < a->n; i++)
		if (strcmp(a->asset[i].name, name) == 0)
			return &a->asset[i];
	return NULL;
}
