/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keyring.c - the service's own keys, and the verbs that manage those of others
 */
#include "keyring.h"

#include "jobs_log.h"
#include "store_trust.h"
#include "verb.h"

#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

#define STORE		"/var/lib/edmd"
#define HOST		"host"		/* the name of the host's key */

/* -- At the start --------------------------------------------------------- */

static int key_check(const struct jobs *j, const struct keyfile *k,
		     const char *path)
{
	struct stat st;

	if (strcmp(k->machine, j->machine) != 0) {
		log_error("keys: %s is a key of machine %s, and this is %s; "
			  "move it away, a new one is made", path, k->machine,
			  j->machine);
		return -EINVAL;
	}
	if (stat(path, &st) == 0 && st.st_uid != geteuid()) {
		log_error("keys: %s belongs to user %u, and this service is "
			  "user %u; chown %u %s, or move it away: a new one "
			  "is made", path, (unsigned int)st.st_uid,
			  (unsigned int)geteuid(), (unsigned int)geteuid(),
			  path);
		return -EPERM;
	}
	return 0;
}

/* 0: read; 1: there was none, a new one is drawn, not yet written. */
static int key_read(const struct jobs *j, struct keyfile *k, const char *path)
{
	char said[KEYFILE_SAID_MAX];
	int err = keyfile_read(k, path, said);

	if (err == 0)
		return key_check(j, k, path);
	if (err != -ENOENT) {
		log_error("keys: %s; or move it away, and a new one is made",
			  said);
		return err;
	}
	snprintf(k->machine, sizeof(k->machine), "%s", j->machine);
	keyfile_draw(k);
	return 1;
}

static int key_write(const struct keyfile *k, const char *path,
		     unsigned int mode)
{
	int err = keyfile_write(k, path, mode);

	if (err < 0)
		log_error("keys: cannot write %s: %s", path, strerror(-err));
	else
		log_notice("keys: made %s, a new key", path);
	return err;
}

/* The group commands by the host's key; it does not speak for the machine. */
static int alone_check(const char *path)
{
	struct stat st;

	if (stat(path, &st) < 0 || (st.st_mode & 0077) == 0)
		return 0;
	log_error("keys: %s has mode %04o: others may sign as the machine; "
		  "move it away, and a new one is made", path,
		  st.st_mode & 07777u);
	return -EPERM;
}

static int machine_key(struct jobs *j, const char *dir)
{
	struct keyfile *k = &j->trust.machine;
	char path[KEYFILE_PATH_MAX];
	int err;

	snprintf(path, sizeof(path), "%.250s/%s.machine-key", dir, j->machine);
	err = key_read(j, k, path);
	if (err == 0)
		err = alone_check(path);
	if (err <= 0)
		return err;
	memcpy(k->machine_key, k->public, sizeof(k->public));
	snprintf(k->name, sizeof(k->name), "machine");
	snprintf(k->role, sizeof(k->role), "machine");
	return key_write(k, path, 0600);
}

static bool fits_machine(const struct jobs *j, const struct keyfile *k)
{
	return memcmp(k->machine_key, j->trust.machine.public,
		      sizeof(k->machine_key)) == 0;
}

static int host_key(struct jobs *j, const char *dir)
{
	struct keyfile *k = &j->host_key;
	struct trust_key row = { .name = HOST, .role = ROLE_SERVICE };
	char path[KEYFILE_PATH_MAX];
	int err;

	snprintf(path, sizeof(path), "%.250s/%s.key", dir, j->machine);
	err = key_read(j, k, path);
	if (err < 0)
		return err;
	if (err == 0 && !fits_machine(j, k))
		log_warning("keys: the machine's own key is a new one; key "
			    "files that were given out before do not fit it: "
			    "make them anew with edmctl keys add");
	if (err == 1 || !fits_machine(j, k)) {
		memcpy(k->machine_key, j->trust.machine.public,
		       sizeof(k->machine_key));
		snprintf(k->name, sizeof(k->name), HOST);
		snprintf(k->role, sizeof(k->role), "service");
		err = key_write(k, path, 0640);
	}
	memcpy(row.key, k->public, sizeof(row.key));
	return err < 0 ? err : trust_add(&j->trust, &row);
}

static void leave_copy(struct jobs *j, const char *dir)
{
	char path[KEYFILE_PATH_MAX];
	int err;

	if (strcmp(dir, STORE) == 0)
		return;
	keyfile_shared_path(path, j->machine);
	err = keyfile_write(&j->host_key, path, 0640);
	j->key_shared = err == 0;
	if (err < 0)
		log_warning("keys: cannot leave a copy in %s: %s; clients "
			    "need --key %s/%s.key", path, strerror(-err), dir,
			    j->machine);
}

int keyring_open(struct jobs *j, const char *dir)
{
	if (machine_key(j, dir) < 0 || host_key(j, dir) < 0)
		return EX_CONFIG;
	if (store_keys_load(j->store, &j->trust) < 0)
		log_error("keys: the keys in the store cannot be read; only "
			  "the host's own is known");
	leave_copy(j, dir);
	trust_init(&j->trust, jobs_now_us());
	return 0;
}

void keyring_close(struct jobs *j)
{
	char path[KEYFILE_PATH_MAX];

	if (!j->key_shared)
		return;
	keyfile_shared_path(path, j->machine);
	unlink(path);
}

/* -- Verbs ---------------------------------------------------------------- */

static void answer_body(struct jobs *j, const struct jobs_lcm_command *c,
			const char *body)
{
	jobs_answer(j, &(struct jobs_lcm_ack) {
		.key = c->key, .client = c->client, .seq = c->seq, .body = body,
		.reason = "done",
	});
}

void keyring_hello(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	char body[256];

	(void)v;
	snprintf(body, sizeof(body), "{\"machine\":\"%s\",\"name\":\"%s\","
		 "\"role\":\"%s\"}", j->machine, c->by->name,
		 trust_role_name(c->by->role));
	answer_body(j, c, body);
}

void keyring_list(struct jobs *j, const struct verb *v,
	       const struct jobs_lcm_command *c)
{
	char body[TRUST_KEYS * 192], hex[KEYFILE_HEX];
	size_t n = 0;

	(void)v;
	for (int i = 0; i < TRUST_KEYS; i++) {
		const struct trust_key *k = &j->trust.key[i];

		if (k->role == ROLE_NONE)
			continue;
		keyfile_hex(hex, k->key);
		n += (size_t)snprintf(body + n, sizeof(body) - n,
			"%c{\"name\":\"%s\",\"role\":\"%s\",\"public\":"
			"\"%s\"}", n ? ',' : '[', k->name,
			trust_role_name(k->role), hex);
	}
	snprintf(body + n, sizeof(body) - n, "]");
	answer_body(j, c, body);
}

void keyring_add(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c)
{
	struct trust_key k = { .role = ROLE_NONE };
	char name[64], role[16], hex[80], rest;
	int err;

	(void)v;
	if (sscanf(c->text, "%63s %15s %79s %c", name, role, hex, &rest) != 3 ||
	    !keyfile_name_fits(name) || !keyfile_unhex(k.key, hex)) {
		verbs_answer(j, c, EX_DATAERR, "a name of 1 to 31 of A-Z a-z "
			    "0-9 . _ -, a role, and 64 hex digits");
		return;
	}
	k.role = trust_role_of(role);
	if (k.role == ROLE_NONE) {
		verbs_answer(j, c, EX_DATAERR, "no such role; viewer, operator "
			    "or service");
		return;
	}
	snprintf(k.name, sizeof(k.name), "%.31s", name);
	err = trust_add(&j->trust, &k);
	if (err == 0 && store_key_add(j->store, &k, jobs_utime()) < 0) {
		trust_remove(&j->trust, k.name);
		verbs_answer(j, c, EX_IOERR, "the store failed; see the "
			    "journal of edmd-jobs");
		return;
	}
	if (err == 0)
		log_notice("keys: %s added %s, a %s, from %s", c->by->name,
			   k.name, role, c->from);
	if (verbs_answer(j, c, err ? REFUSED : 0, err == -EEXIST ?
			 "this key, or one of this name, is there already; "
			 "edmctl keys list" :
			 err ? "64 keys are there; remove one" : "added") &&
	    err == 0)
		trust_remove(&j->trust, k.name);
}

void keyring_remove(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	/* The row of who asks may be the one that goes. */
	const struct trust_key by = *c->by;

	(void)v;
	if (strcmp(c->text, HOST) == 0) {
		verbs_answer(j, c, REFUSED, "the host's own key is renewed by "
			    "removing its file and starting edmd-jobs again");
		return;
	}
	if (trust_remove(&j->trust, c->text) < 0) {
		verbs_answer(j, c, EX_NOINPUT, "no key of this name; edmctl "
			    "keys list");
		return;
	}
	if (store_key_remove(j->store, c->text) < 0) {
		verbs_answer(j, c, EX_IOERR,
			     "it is not taken any more, but the store failed: "
			     "it comes back when edmd-jobs is started again; "
			     "see its journal");
		return;
	}
	log_notice("keys: %s removed %s, from %s", by.name, c->text, c->from);
	verbs_answer(j, c, 0, "removed");
}
