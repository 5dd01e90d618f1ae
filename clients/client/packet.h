/* SPDX-License-Identifier: Apache-2.0 */
/*
 * packet.h - our structs to LCM's generated messages and back
 *
 * Private to this folder.  Threads: that of the struct talk.
 */
#ifndef CLIENT_PACKET_H
#define CLIENT_PACKET_H

#include "talk.h"

#include "seal.h"

/* Whose message it is. */
struct packet_from {
	const char *client;
	int64_t seq;
};

/* @s: its signature holds.  Lent pointers are good until @fn returns. */
typedef void (*packet_ack_fn)(void *arg, const struct seal *s,
			      const uint8_t *key, const char *client,
			      const struct talk_ack *a);

/** packet_command(), packet_chunk() - encode as LCM does; free the result. */
uint8_t *packet_command(const struct packet_from *f,
			const struct talk_question *q, size_t *ret_bytes);
uint8_t *packet_chunk(const struct packet_from *f, const struct talk_chunk *c,
		      size_t *ret_bytes);

/**
 * packet_ack() - decode, clean, and call @fn. Return: false if it is not an
 * ack.
 */
bool packet_ack(const struct seal *s, packet_ack_fn fn, void *arg);

/** packet_status() - decode and clean. Return: false if it is not a status. */
bool packet_status(const struct seal *s, struct talk_status *ret);

/** packet_event() - decode, clean, and call @fn if there is one. */
bool packet_event(const struct seal *s,
		  void (*fn)(void *arg, const struct talk_event *e), void *arg);

#endif /* CLIENT_PACKET_H */
