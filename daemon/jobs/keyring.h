/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keyring.h - the service's own keys, and the verbs that manage the keys of
 * others
 *
 * Beside the store there are two files. <machine>.machine-key is the key that
 * the service signs with; only its own user may read it. <machine>.key is the
 * host's key; group edm may read it. Both are made at the first start. A
 * service whose store is not the usual one leaves a copy of the host's key in
 * /dev/shm, where clients look too.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_KEYRING_H
#define JOBS_KEYRING_H

struct jobs;
struct verb;
struct jobs_lcm_command;

/**
 * keyring_open() - read the keys, or make them.
 *
 * Return: 0, or an exit code; then the log says what is wrong and how to mend
 * it.
 */
int keyring_open(struct jobs *j, const char *dir);

/** keyring_close() - remove the copy. */
void keyring_close(struct jobs *j);

/* Verbs: "keys", "keys-add" with text NAME ROLE HEX, "keys-remove" NAME. */
void keyring_list(struct jobs *j, const struct verb *v,
	       const struct jobs_lcm_command *c);
void keyring_add(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c);
void keyring_remove(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c);

/** keyring_hello() - verb "hello": tell a client who it is to this service. */
void keyring_hello(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c);

#endif /* JOBS_KEYRING_H */
