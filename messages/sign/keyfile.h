/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keyfile.h - the file that holds somebody's key pair
 *
 * Text, a line for each word, `#` begins a comment:
 *
 *	edmd-key 1
 *	machine edm
 *	name host
 *	role service
 *	machine-key <64 hex digits>	public key the machine signs with
 *	public <64 hex digits>
 *	secret <64 hex digits>		the seed of the key pair
 *
 * The machine's own key is in such a file too, with the role `machine`.
 * Who can read the file can sign as its owner, so a file that everyone can
 * read, or that others can write, is refused.
 *
 * Threads: any.  sodium_init() comes first.
 */
#ifndef EDM_KEYFILE_H
#define EDM_KEYFILE_H

#include "seal.h"

#include <stdbool.h>
#include <stdint.h>

#define KEYFILE_NAME_MAX	32	/* with its NUL */
#define KEYFILE_PATH_MAX	320
#define KEYFILE_SAID_MAX	640
#define KEYFILE_HEX		(2 * SEAL_KEY_BYTES + 1)

struct keyfile {
	char machine[KEYFILE_NAME_MAX];
	char name[KEYFILE_NAME_MAX];
	char role[KEYFILE_NAME_MAX];
	uint8_t machine_key[SEAL_KEY_BYTES];
	uint8_t public[SEAL_KEY_BYTES];
	uint8_t secret[SEAL_SECRET_BYTES];	/* as libsodium keeps it */
};

/** keyfile_draw() - draw a new key pair; the caller fills the other fields. */
void keyfile_draw(struct keyfile *k);

/**
 * keyfile_read() - read and check a key file.
 *
 * @said: what is wrong with it and how to mend it, in words.
 *
 * Return: 0; -ENOENT; -EACCES: it may not be read; -EPERM: others may read or
 * write it; -EINVAL: it is not a key file; else -errno.
 */
int keyfile_read(struct keyfile *k, const char *path,
		 char said[KEYFILE_SAID_MAX]);

/**
 * keyfile_write() - write it as a whole or not at all; replaces a file that is
 * there.
 *
 * @mode: 0600, or 0640 for a file that its group may use.
 *
 * Return: 0 or -errno.
 */
int keyfile_write(const struct keyfile *k, const char *path,
		  unsigned int mode);

/**
 * keyfile_find() - the key that this user has for @machine on this host.
 *
 * It is the one that edmd-jobs keeps in its usual folder; else the one in
 * /dev/shm of a service that was started by hand. The latter must belong to
 * root, to the user edm-jobs or to this user, because anybody may make a file
 * there.
 *
 * Return: as keyfile_read(); -ENOENT if there is none.
 */
int keyfile_find(struct keyfile *k, const char *machine,
		 char said[KEYFILE_SAID_MAX]);

/** keyfile_shared_path() - where a service leaves the host's key. */
void keyfile_shared_path(char path[KEYFILE_PATH_MAX], const char *machine);

/** keyfile_name_fits() - 1 to 31 of A-Z a-z 0-9 . _ - */
bool keyfile_name_fits(const char *name);

/** keyfile_hex() - a public key as text. */
void keyfile_hex(char to[KEYFILE_HEX], const uint8_t key[SEAL_KEY_BYTES]);

/** keyfile_unhex() - Return: false unless @text is 64 hex digits. */
bool keyfile_unhex(uint8_t key[SEAL_KEY_BYTES], const char *text);

#endif /* EDM_KEYFILE_H */
