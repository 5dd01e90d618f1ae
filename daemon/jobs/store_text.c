/* SPDX-License-Identifier: Apache-2.0 */
/* store_text.c - long texts of jobs, in files beside the database */
#include "store_text.h"

#include "regular.h"
#include "store_sql.h"
#include "upload.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEX		(2 * crypto_hash_sha256_BYTES)
#define PIECE		(1 << 20)

void store_text_path(const struct store *s, const char *sha256,
		     char ret[STORE_TEXT_PATH_MAX])
{
	/* Without the ".db". */
	snprintf(ret, STORE_TEXT_PATH_MAX, "%.*s.text-%s",
		 (int)strlen(s->path) - 3, s->path, sha256);
}

int store_text_file(struct store *s, uint32_t n, char ret[STORE_TEXT_PATH_MAX])
{
	int err;
	sqlite3_stmt *q = store_ask(s, &err, "SELECT sha256 FROM job JOIN text "
				    "USING(n) WHERE n=? AND typeof(text)="
				    "'integer'",
				    "i", (int64_t)n);

	if (!q)
		return err;
	store_text_path(s, (const char *)sqlite3_column_text(q, 0), ret);
	sqlite3_finalize(q);
	return 0;
}

/* -- Writing --------------------------------------------------------------- */

static int write_all(int fd, const char *at, size_t bytes)
{
	while (bytes > 0) {
		const ssize_t n = write(fd, at, bytes < PIECE ? bytes : PIECE);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			return -errno;
		at += n;
		bytes -= (size_t)n;
	}
	return fsync(fd) < 0 ? -errno : 0;
}

int store_text_sync_folder(const char *path)
{
	char dir[STORE_TEXT_PATH_MAX];
	int fd, err;

	snprintf(dir, sizeof(dir), "%.*s", (int)(strrchr(path, '/') - path),
		 path);
	fd = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	err = fsync(fd) < 0 ? -errno : 0;
	close(fd);
	return err;
}

int store_text_keep(const char *path, const char *text, size_t bytes)
{
	char fresh[STORE_TEXT_PATH_MAX + 8];
	int fd, err;

	snprintf(fresh, sizeof(fresh), "%s.XXXXXX", path);
	fd = mkstemp(fresh);
	if (fd < 0)
		return -errno;
	err = write_all(fd, text, bytes);
	close(fd);
	if (err == 0 && rename(fresh, path) < 0)
		err = -errno;
	if (err < 0)
		unlink(fresh);
	return err < 0 ? err : store_text_sync_folder(path);
}

/* -- Reading --------------------------------------------------------------- */

static int read_all(int fd, char **ret, size_t *ret_bytes)
{
	struct stat st;
	size_t have = 0;
	char *text;

	if (fstat(fd, &st) < 0)
		return -errno;
	if (st.st_size > UPLOAD_BYTES_MAX)
		return -EILSEQ;
	text = malloc((size_t)st.st_size + 1);
	if (!text)
		return -ENOMEM;
	while (have < (size_t)st.st_size) {
		const ssize_t n = read(fd, text + have,
				       (size_t)st.st_size - have);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0) {
			free(text);
			return n < 0 ? -errno : -EILSEQ;
		}
		have += (size_t)n;
	}
	*ret = text;
	*ret_bytes = have;
	return 0;
}

/* The name of the file says the hash. */
static bool is_whole(const char *path, const char *text, size_t bytes)
{
	unsigned char hash[crypto_hash_sha256_BYTES];
	char hex[HEX + 1];

	crypto_hash_sha256(hash, (const unsigned char *)text, bytes);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	return strlen(path) > HEX &&
	       strcmp(path + strlen(path) - HEX, hex) == 0;
}

int store_text_read(const char *path, char **ret, size_t *ret_bytes)
{
	const int fd = regular_open(path, O_RDONLY, 0);
	int err;

	if (fd < 0)
		return fd == -ENOENT || fd == -ELOOP ? -EILSEQ : fd;
	err = read_all(fd, ret, ret_bytes);
	close(fd);
	return err;
}

int store_text_fetch(const char *path, char **ret, size_t *ret_bytes)
{
	char *text = NULL;
	const int err = store_text_read(path, &text, ret_bytes);

	if (err < 0)
		return err;
	if (!is_whole(path, text, *ret_bytes)) {
		free(text);
		return -EILSEQ;
	}
	*ret = text;
	return 0;
}

/* -- All of them ----------------------------------------------------------- */

typedef bool (*each_fn)(void *arg, const char *path, const struct stat *st);

/* The files beside the database whose names begin with @stem, until @take says
 * false. */
static void each(const struct store *s, const char *stem, each_fn take,
		 void *arg)
{
	const char *name = strrchr(stem, '/') + 1;
	char path[2 * STORE_TEXT_PATH_MAX];
	bool more = true;
	struct dirent *e;
	struct stat st;
	DIR *d = opendir(s->dir);

	while (d && more && (e = readdir(d))) {
		if (strncmp(e->d_name, name, strlen(name)) != 0)
			continue;
		snprintf(path, sizeof(path), "%s/%s", s->dir, e->d_name);
		if (lstat(path, &st) == 0)
			more = take(arg, path, &st);
	}
	if (d)
		closedir(d);
}

static bool is_there(void *arg, const char *path, const struct stat *st)
{
	(void)path, (void)st;
	*(bool *)arg = true;
	return false;
}

/* A database that was set aside may have the jobs of any of them. */
static bool some_is_aside(const struct store *s)
{
	char stem[STORE_TEXT_PATH_MAX];
	bool there = false;

	snprintf(stem, sizeof(stem), "%s.damaged-", s->path);
	each(s, stem, is_there, &there);
	return there;
}

static bool is_wanted(struct store *s, const char *path)
{
	return store_number_of(s, 1, "SELECT count(*) FROM job WHERE sha256=?",
			       "s", strrchr(path, '-') + 1) > 0;
}

void store_text_drop(struct store *s, const char *sha256)
{
	char path[STORE_TEXT_PATH_MAX], one[HEX + 1];

	if (s->in_memory || some_is_aside(s))
		return;
	for (int n; sscanf(sha256, "%64s%n", one, &n) == 1; sha256 += n) {
		store_text_path(s, one, path);
		if (!is_wanted(s, path) && !s->in_memory)
			unlink(path);
	}
}

/* One whose writing was cut short has a name that is no hash. */
static bool sweep_one(void *arg, const char *path, const struct stat *st)
{
	struct store *s = arg;

	(void)st;
	if (!is_wanted(s, path) && !s->in_memory)
		unlink(path);
	return !s->in_memory;
}

void store_text_sweep(struct store *s)
{
	char stem[STORE_TEXT_PATH_MAX];

	if (s->in_memory || some_is_aside(s))
		return;
	store_text_path(s, "", stem);
	each(s, stem, sweep_one, s);
}

static bool add_bytes(void *arg, const char *path, const struct stat *st)
{
	(void)path;
	*(int64_t *)arg += st->st_size;
	return true;
}

int64_t store_text_bytes(const struct store *s)
{
	char stem[STORE_TEXT_PATH_MAX];
	int64_t bytes = 0;

	store_text_path(s, "", stem);
	each(s, stem, add_bytes, &bytes);
	return bytes;
}
