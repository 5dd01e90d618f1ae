/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk_way.h - how packets go between a client and edmd-jobs
 *
 * They go by the carrier that is given.  Without one: on the machine's own host
 * by the socket of edmd-jobs (local.h), which needs no network.  Multicast is
 * for other hosts: it is used if an URL is named, or as long as there is no
 * such socket.
 *
 * For talk.c, and for a program that hands on what others have signed.
 *
 * Threads: one.
 */
#ifndef CLIENT_TALK_WAY_H
#define CLIENT_TALK_WAY_H

#include "talk.h"
#include "udpm.h"

struct talk_way;

/** talk_machine() - of @o, or the usual one. */
const char *talk_machine(const struct talk_options *o);

/**
 * talk_way_open() - @o: machine, url and carrier.
 *
 * Return: 0; -EDESTADDRREQ: no such URL; -ENETUNREACH: there is no way, and
 * @said tells why; else -errno.
 */
int talk_way_open(struct talk_way **ret, const struct talk_options *o,
		  char said[TALK_SAID_MAX]);

/** talk_way_close() - @w may be NULL. */
void talk_way_close(struct talk_way *w);

/** talk_way_fd() - readable when talk_way_take() has something. */
int talk_way_fd(const struct talk_way *w);

/** talk_way_send() - one packet; nothing says whether it arrives. */
void talk_way_send(struct talk_way *w, const char *channel, const void *data,
	      size_t size);

/**
 * talk_way_take() - take one packet, if there is one.
 * Return: true with @ret filled; it is valid until the next call.
 */
bool talk_way_take(struct talk_way *w, struct udpm_packet *ret);

/** talk_way_look() - find the socket again, if the service was started anew. */
void talk_way_look(struct talk_way *w);

#endif /* CLIENT_TALK_WAY_H */
