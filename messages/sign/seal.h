/* SPDX-License-Identifier: Apache-2.0 */
/*
 * seal.h - the signed envelope of every LCM packet of edmd
 *
 * README.md in this folder's parent describes it byte by byte, with test
 * vectors. The envelope has a fixed shape. So it is read without allocation,
 * and before anything inside it is looked at.
 *
 * Units: count is microseconds of the service's clock.
 *
 * Threads: any. Call sodium_init() first.
 */
#ifndef EDM_SEAL_H
#define EDM_SEAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SEAL_KEY_BYTES		32	/* a public key */
#define SEAL_SECRET_BYTES	64	/* as libsodium keeps it */
#define SEAL_SIGNATURE_BYTES	64
#define SEAL_BYTES		124	/* of the envelope, without its data */

/* What LCM derives from `struct signed_t` in edm.lcm. */
#define SEAL_FINGERPRINT	UINT64_C(0x49657b54b950317d)

/* A message in its envelope; @data and the other pointers are lent. */
struct seal {
	const uint8_t *key;		/* public key of who signs */
	int64_t boot;			/* of the service it is for, or from */
	int64_t count;
	const uint8_t *signature;
	const void *data;
	size_t size;
};

/**
 * seal_make() - sign @s->data for @channel and lay the envelope out.
 *
 * @to: SEAL_BYTES + @s->size bytes.
 * @secret: of SEAL_SECRET_BYTES; fits @s->key.  @s->signature is not read.
 * Return: bytes written; 0 out of memory.
 */
size_t seal_make(uint8_t *to, const struct seal *s, const char *channel,
		 const uint8_t *secret);

/**
 * seal_read() - find the parts of a packet; only its shape is checked.
 *
 * Return: false if it is no envelope; then @ret is not changed.
 */
bool seal_read(struct seal *ret, const void *packet, size_t bytes);

/** seal_holds() - is it a valid signature by @s->key, for @channel? */
bool seal_holds(const struct seal *s, const char *channel);

/**
 * seal_act_id() - the number by which a command is done once, whichever way it
 * comes: of who signs, of the client's name and of its seq.  From 1 to
 * INT64_MAX.
 */
uint64_t seal_act_id(const uint8_t key[SEAL_KEY_BYTES], const char *client,
		     int64_t seq);

#endif /* EDM_SEAL_H */
