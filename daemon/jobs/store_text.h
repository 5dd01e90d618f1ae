/* SPDX-License-Identifier: Apache-2.0 */
/*
 * store_text.h - long texts of jobs, in files beside the database
 *
 * A text of more than STORE_TEXT_INSIDE bytes is a file MACHINE.text-SHA256, so
 * that a thread writes and reads it while the event loop goes on.  It is on the
 * disk before the row of its job is; the row of its text then has a 0 in its
 * place.  Jobs with the same text share a file.  One without a job is removed.
 *
 * Threads: each call says its own.  Calls return 0 or -errno.
 */
#ifndef JOBS_STORE_TEXT_H
#define JOBS_STORE_TEXT_H

#include <stddef.h>
#include <stdint.h>

#define STORE_TEXT_INSIDE	(256u << 10)
#define STORE_TEXT_PATH_MAX	600

struct store;

/** store_text_path() - where a text with this hash, in hex, is kept.  That of
 *  the store. */
void store_text_path(const struct store *s, const char *sha256,
		     char ret[STORE_TEXT_PATH_MAX]);

/** store_text_file() - the same for job @n; -ENOENT: its text is in the
 *  database.  That of the store. */
int store_text_file(struct store *s, uint32_t n,
		    char ret[STORE_TEXT_PATH_MAX]);

/** store_text_keep() - write it: whole and on the disk, or not at all.  Any. */
int store_text_keep(const char *path, const char *text, size_t bytes);

/**
 * store_text_fetch() - read it; @ret to be freed.  Any.
 *
 * Return: -EILSEQ: it is not there any more, is no file, or has another hash.
 */
int store_text_fetch(const char *path, char **ret, size_t *ret_bytes);

/** store_text_read() - the same, but for the hash: who reads has to compare it
 *  before anything is done with the text.  Any. */
int store_text_read(const char *path, char **ret, size_t *ret_bytes);

/** store_text_drop() - remove those of these hashes, in hex with a blank
 *  between them, that no job has any more.  That of the store. */
void store_text_drop(struct store *s, const char *sha256);

/**
 * store_text_sweep() - remove all that no job has: for the start, when none is
 * being written.
 *
 * As long as a damaged database is kept beside this one, they all stay: it may
 * have their jobs.  That of the store.
 */
void store_text_sweep(struct store *s);

/** store_text_bytes() - the size of all of them.  That of the store. */
int64_t store_text_bytes(const struct store *s);

/** store_text_sync_folder() - the name of @path is on the disk, too.  It has a
 *  slash.  Return: 0; -errno. */
int store_text_sync_folder(const char *path);

#endif /* JOBS_STORE_TEXT_H */
