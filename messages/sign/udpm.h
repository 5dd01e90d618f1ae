/* SPDX-License-Identifier: Apache-2.0 */
/*
 * udpm.h - LCM's packets by sockets of our own
 *
 * LCM's library takes what any host sends to the port, on any interface, and
 * does not say who sent it. This socket receives only its own multicast group.
 * If the URL has ttl=0, it receives only what this host has sent: a packet with
 * another source address is dropped before a byte of it is read. (The kernel
 * drops packets that come from outside with an address of this host.)
 *
 * Only LCM's short packets are read. Everything that clients and the service
 * send fits into one, and an attacker cannot leave one half sent. The library's
 * reader of long packets crashes on some that nobody signed.
 *
 * Threads: one.
 */
#ifndef EDM_UDPM_H
#define EDM_UDPM_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define UDPM_FROM_MAX	32		/* "address:port" */
#define UDPM_PACKET_MAX	65507
#define UDPM_PARTS	3

struct iovec;
struct udpm;

struct udpm_packet {
	const char *channel;
	const uint8_t *data;
	size_t size;
	char from[UDPM_FROM_MAX];
};

/* Where an URL leads. */
struct udpm_url {
	struct sockaddr_in group;
	unsigned int ttl;
};

/**
 * udpm_url_read() - "udpm://GROUP:PORT?ttl=N".
 * Return: NULL, or what is wrong with it, in words.
 */
const char *udpm_url_read(struct udpm_url *ret, const char *url);

/** udpm_open() - join the group, to hear and to send.  Return: 0 or -errno. */
int udpm_open(struct udpm **ret, const struct udpm_url *url);

#define UDPM_WHY_MAX	256

/** udpm_why() - what @err of udpm_open() means, and what helps, in words. */
void udpm_why(const struct udpm_url *url, int err, char *to, size_t size);

/**
 * udpm_choose() - take only these channels: what comes for another one is left
 * in the kernel and wakes nobody.  Every service of a host has the same group,
 * so each packet comes to all of them.
 *
 * Without it, and where the kernel does not allow it, all of them come.
 */
void udpm_choose(struct udpm *u, const char *const channel[], int n);

/** udpm_close() - @u may be NULL. */
void udpm_close(struct udpm *u);

/** udpm_fd() - readable when udpm_take() has something. */
int udpm_fd(const struct udpm *u);

/**
 * udpm_take() - take one packet, if there is one for us.
 *
 * Return: true with @ret filled; it is valid until the next call.
 */
bool udpm_take(struct udpm *u, struct udpm_packet *ret);

/** udpm_send() - one packet; nothing says whether it arrives. */
void udpm_send(const struct udpm *u, const char *channel, const void *data,
	       size_t size);

/**
 * udpm_split() - the parts of one of LCM's short packets, which are lent.
 * Return: false: it is none.
 */
bool udpm_split(struct udpm_packet *ret, const uint8_t *packet, size_t bytes);

/** udpm_parts() - the other way: what a packet is made of. */
void udpm_parts(struct iovec to[UDPM_PARTS], const char *channel,
		const void *data, size_t size);

/**
 * udpm_strange() - packets dropped so far, because they came from other hosts
 * or were not short. @ret_from: the sender of the last one; "" if there was
 * none.
 */
uint64_t udpm_strange(const struct udpm *u, const char **ret_from);

#endif /* EDM_UDPM_H */
