/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keyfile.c - read, check and write key files
 */
#include "keyfile.h"

#include "places.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define STORE		"/var/lib/edmd"
#define FILE_MAX	2048
#define NAME_CHARS	"ABCDEFGHIJKLMNOPQRSTUVWXYZ" \
			"abcdefghijklmnopqrstuvwxyz0123456789._-"

/* One line of the file: its word, and where its value goes. */
struct entry {
	const char *word;
	char *name;			/* a name, or ... */
	uint8_t *key;			/* ... 32 bytes as hex digits */
	bool seen;
};

static int say(char said[KEYFILE_SAID_MAX], int err, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

static int say(char said[KEYFILE_SAID_MAX], int err, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	vsnprintf(said, KEYFILE_SAID_MAX, format, ap);
	va_end(ap);
	return err;
}

void keyfile_draw(struct keyfile *k)
{
	crypto_sign_keypair(k->public, k->secret);
}

bool keyfile_name_fits(const char *name)
{
	size_t n = strlen(name);

	return n > 0 && n < KEYFILE_NAME_MAX && strspn(name, NAME_CHARS) == n;
}

void keyfile_hex(char to[KEYFILE_HEX], const uint8_t key[SEAL_KEY_BYTES])
{
	sodium_bin2hex(to, KEYFILE_HEX, key, SEAL_KEY_BYTES);
}

bool keyfile_unhex(uint8_t key[SEAL_KEY_BYTES], const char *text)
{
	uint8_t got[SEAL_KEY_BYTES];
	const char *end;
	size_t bytes;

	if (sodium_hex2bin(got, sizeof(got), text, strlen(text), NULL, &bytes,
			   &end) < 0 || *end || bytes != sizeof(got))
		return false;
	memcpy(key, got, sizeof(got));
	return true;
}

void keyfile_shared_path(char path[KEYFILE_PATH_MAX], const char *machine)
{
	snprintf(path, KEYFILE_PATH_MAX, "/dev/shm/edmd.%.31s.key", machine);
}

/* -- Reading -------------------------------------------------------------- */

static int mode_check(const struct stat *st, const char *path, char *said)
{
	if (!S_ISREG(st->st_mode))
		return say(said, -EINVAL, "key file %s is not a plain file",
			   path);
	if (st->st_mode & 0007)
		return say(said, -EPERM,
			   "key file %s has mode %04o: everyone on this host "
			   "may use it, and it counts as known to all; take "
			   "the key back (edmctl keys remove NAME, or remove "
			   "the host's key file and start edmd-jobs again), "
			   "make a new one, and keep it at 0640 or 0600",
			   path, st->st_mode & 07777u);
	if (st->st_mode & 0020)
		return say(said, -EPERM, "key file %s has mode %04o: its group "
			   "may write it; chmod g-w %s", path,
			   st->st_mode & 07777u, path);
	return 0;
}

static int owner_check(const struct stat *st, const char *path, char *said)
{
	if (places_is_trusted(st->st_uid, PLACES_JOBS))
		return 0;
	return say(said, -EPERM, "key file %s belongs to user %u, who is "
		   "neither root nor " PLACES_JOBS " nor you, so it is not "
		   "used; remove it, or name the right one with --key FILE",
		   path, (unsigned int)st->st_uid);
}

/* @shared: the file is where anybody may have made it.  It is checked after it
 * was opened, because a moment later its name may belong to another file. */
static int open_check(int *ret, const char *path, bool shared, char *said)
{
	struct stat st;
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK |
		      (shared ? O_NOFOLLOW : 0)), err = 0;

	if (fd < 0 && errno == ENOENT)
		return say(said, -ENOENT, "there is no key file %s; edmd-jobs "
			   "makes the host's key when it starts, and edmctl "
			   "keys add NAME makes others", path);
	if (fd < 0 && errno == EACCES)
		return say(said, -EACCES, "key file %s may not be read by this "
			   "user; who is in group edm may command: usermod -aG "
			   "edm NAME, then log in again", path);
	if (fd < 0)
		return say(said, -errno, "key file %s: %s", path,
			   strerror(errno));
	if (fstat(fd, &st) < 0)
		err = -errno;
	if (err == 0 && shared)
		err = owner_check(&st, path, said);
	if (err == 0)
		err = mode_check(&st, path, said);
	if (err < 0) {
		close(fd);
		return err;
	}
	*ret = fd;
	return 0;
}

static bool entry_take(struct entry *entry, const char *word,
		       const char *value)
{
	for (; entry->word; entry++) {
		if (strcmp(entry->word, word) != 0)
			continue;
		entry->seen = true;
		if (entry->key)
			return keyfile_unhex(entry->key, value);
		snprintf(entry->name, KEYFILE_NAME_MAX, "%s", value);
		return keyfile_name_fits(value);
	}
	return false;
}

static int line_take(struct entry *entry, char *line, int number,
		     const char *path, char *said)
{
	char *word, *value, *rest;

	line[strcspn(line, "#")] = '\0';
	word = strtok_r(line, " \t\r", &rest);
	if (!word)
		return 0;
	value = strtok_r(NULL, " \t\r", &rest);
	if (value && !strtok_r(NULL, " \t\r", &rest) &&
	    entry_take(entry, word, value))
		return 0;
	return say(said, -EINVAL, "key file %s:%d: no such line; edmd-key 1, "
		   "or machine, name, role with a name, or machine-key, "
		   "public, secret with 64 hex digits", path, number);
}

static int text_take(struct keyfile *k, char *text, const char *path,
		     char *said)
{
	char version[KEYFILE_NAME_MAX] = "";
	uint8_t seed[SEAL_KEY_BYTES], public[SEAL_KEY_BYTES];
	struct entry entry[] = {
		{ "edmd-key", version, NULL, false },
		{ "machine", k->machine, NULL, false },
		{ "name", k->name, NULL, false },
		{ "role", k->role, NULL, false },
		{ "machine-key", NULL, k->machine_key, false },
		{ "public", NULL, k->public, false },
		{ "secret", NULL, seed, false },
		{ NULL, NULL, NULL, false },
	};
	char *rest = text;
	int err = 0;

	for (int n = 1; rest && err == 0; n++)
		err = line_take(entry, strsep(&rest, "\n"), n, path, said);
	for (struct entry *e = entry; e->word && err == 0; e++)
		if (!e->seen)
			err = say(said, -EINVAL, "key file %s has no line "
				  "'%s'; it is cut short, or no key file", path,
				  e->word);
	if (err == 0 && strcmp(version, "1") != 0)
		err = say(said, -EINVAL, "key file %s is of version %s; this "
			  "program reads version 1", path, version);
	if (err < 0)
		return err;
	crypto_sign_seed_keypair(public, k->secret, seed);
	sodium_memzero(seed, sizeof(seed));
	if (memcmp(public, k->public, sizeof(public)) != 0)
		return say(said, -EINVAL, "key file %s: its public key is not "
			   "that of its secret; it was changed by hand: make a "
			   "new one", path);
	return 0;
}

static int fd_take(struct keyfile *k, int fd, const char *path, char *said)
{
	char text[FILE_MAX + 1];
	ssize_t n = read(fd, text, FILE_MAX);
	int err;

	if (n < 0)
		return say(said, -errno, "key file %s: %s", path,
			   strerror(errno));
	text[n] = '\0';
	err = text_take(k, text, path, said);
	sodium_memzero(text, sizeof(text));
	return err;
}

static int file_take(struct keyfile *k, const char *path, bool shared,
		     char said[KEYFILE_SAID_MAX])
{
	struct keyfile got = { .machine = "" };
	int fd = -1, err;

	said[0] = '\0';
	err = open_check(&fd, path, shared, said);
	if (err < 0)
		return err;
	err = fd_take(&got, fd, path, said);
	close(fd);
	if (err == 0)
		*k = got;
	return err;
}

int keyfile_read(struct keyfile *k, const char *path,
		 char said[KEYFILE_SAID_MAX])
{
	return file_take(k, path, false, said);
}

/* -- Writing -------------------------------------------------------------- */

static int text_write(const struct keyfile *k, int fd)
{
	char machine_key[KEYFILE_HEX], public[KEYFILE_HEX], secret[KEYFILE_HEX];
	uint8_t seed[crypto_sign_SEEDBYTES];
	int n;

	crypto_sign_ed25519_sk_to_seed(seed, k->secret);
	keyfile_hex(machine_key, k->machine_key);
	keyfile_hex(public, k->public);
	keyfile_hex(secret, seed);
	n = dprintf(fd, "# Who can read this file can command machine %s.\n"
		    "edmd-key 1\nmachine %s\nname %s\nrole %s\n"
		    "machine-key %s\npublic %s\nsecret %s\n", k->machine,
		    k->machine, k->name, k->role, machine_key, public, secret);
	sodium_memzero(seed, sizeof(seed));
	sodium_memzero(secret, sizeof(secret));
	return n < 0 || fsync(fd) < 0 ? -errno : 0;
}

int keyfile_write(const struct keyfile *k, const char *path,
		  unsigned int mode)
{
	char temporary[KEYFILE_PATH_MAX + 8];
	int fd, err;

	snprintf(temporary, sizeof(temporary), "%s.XXXXXX", path);
	fd = mkostemp(temporary, O_CLOEXEC);
	if (fd < 0)
		return -errno;
	err = text_write(k, fd);
	if (err == 0 && fchmod(fd, mode) < 0)
		err = -errno;
	if (err == 0 && rename(temporary, path) < 0)
		err = -errno;
	if (err < 0)
		unlink(temporary);
	close(fd);
	return err;
}

/* -- Finding -------------------------------------------------------------- */

int keyfile_find(struct keyfile *k, const char *machine,
		 char said[KEYFILE_SAID_MAX])
{
	char stored[KEYFILE_PATH_MAX], shared[KEYFILE_PATH_MAX];
	int err;

	snprintf(stored, sizeof(stored), STORE "/%.31s.key", machine);
	keyfile_shared_path(shared, machine);
	err = keyfile_read(k, stored, said);
	if ((err == -ENOENT || err == -EACCES) && access(shared, F_OK) == 0)
		return file_take(k, shared, true, said);
	if (err == -ENOENT)
		say(said, err, "there is no key of machine %s: neither %s nor "
		    "%s; edmd-jobs makes it when it starts: systemctl start "
		    "edmd-jobs; another key: --key FILE", machine, stored,
		    shared);
	return err;
}
