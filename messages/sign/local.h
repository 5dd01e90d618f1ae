/* SPDX-License-Identifier: Apache-2.0 */
/*
 * local.h - the same packets between the programs of one host
 *
 * Beside LCM's multicast a service listens on a socket in the file system
 * (places.h, "jobs").  What is sent there are LCM's short packets, byte for
 * byte.  It is a SOCK_SEQPACKET: the kernel keeps packets whole, says which
 * user sends, and tells both ends when the other is gone.  It needs no network.
 *
 * A reader that is too slow misses packets, as with LCM.  Nobody waits for it.
 *
 * Threads: one object belongs to one thread.
 */
#ifndef EDM_LOCAL_H
#define EDM_LOCAL_H

#include "seal.h"
#include "udpm.h"

#include <sys/un.h>

/* One beyond takes the place of the one that sent nothing for the longest
 * time. */
#define LOCAL_ENDS	128		/* clients at once */
#define LOCAL_OF_ONE	64		/* of these, of one user */
#define LOCAL_CLIENT_MAX 64		/* a client's name, with its NUL */

struct local;

/* To whom an answer goes. */
struct local_who {
	const uint8_t *key;		/* SEAL_KEY_BYTES */
	const char *client;
};

/* -- The service ---------------------------------------------------------- */

/** local_open() - listen at @at.  Return: 0 or -errno. */
int local_open(struct local **ret, const struct sockaddr_un *at);

/** local_close() - @l may be NULL. */
void local_close(struct local *l);

/** local_fd() - readable when local_take() has something to do. */
int local_fd(const struct local *l);

/**
 * local_take() - do one thing: greet a client, take a packet, or see one off.
 * Each client has its turn.
 *
 * Return: true with @ret filled; it is valid until the next call.
 */
bool local_take(struct local *l, struct udpm_packet *ret);

/** local_is() - the client whose packet was taken last is @who. */
void local_is(struct local *l, const struct local_who *who);

/**
 * local_send() - to the clients that are @who; NULL: to all.
 * Return: is anybody there to whom it goes?
 */
bool local_send(const struct local *l, const struct local_who *who,
		const char *channel, const void *data, size_t size);

/* -- A client ------------------------------------------------------------- */

/**
 * local_connect() - to the service at @at.
 *
 * Return: a descriptor; -EPERM: who listens is neither root, edm-jobs nor this
 * user; else -errno.
 */
int local_connect(const struct sockaddr_un *at);

/** local_put() - send one packet at @fd, if there is room for it. */
void local_put(int fd, const char *channel, const void *data, size_t size);

/**
 * local_get() - take one packet from @fd, if there is one.
 *
 * Return: 1 with @ret filled, which points into @room; 0: there is none, or it
 * is not one of LCM's; -ENOTCONN: the other end is gone.
 */
int local_get(int fd, uint8_t room[UDPM_PACKET_MAX], struct udpm_packet *ret);

#endif /* EDM_LOCAL_H */
