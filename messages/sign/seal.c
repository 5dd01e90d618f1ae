/* SPDX-License-Identifier: Apache-2.0 */
/*
 * seal.c - sign a message, and check a signature
 */
#include "seal.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONTEXT		"edmd 1"
#define HEAD_MAX	128		/* context, channel, boot, count */

/* Where the parts are in a packet. */
enum {
	AT_KEY = 8, AT_BOOT = 40, AT_COUNT = 48, AT_SIGNATURE = 56,
	AT_SIZE = 120
};

static void put_64(uint8_t *to, uint64_t value)
{
	for (int i = 0; i < 8; i++)
		to[i] = (uint8_t)(value >> (56 - 8 * i));
}

static uint64_t get_64(const uint8_t *from)
{
	uint64_t value = 0;

	for (int i = 0; i < 8; i++)
		value = value << 8 | from[i];
	return value;
}

/* Make the bytes that are signed before the data.  Return: their number; 0: the
 * channel is too long. */
static size_t head_make(uint8_t head[HEAD_MAX], const struct seal *s,
			const char *channel)
{
	int n = snprintf((char *)head, HEAD_MAX, CONTEXT "\n%s\n", channel);

	if (n < 0 || n > HEAD_MAX - 16)
		return 0;
	put_64(head + n, (uint64_t)s->boot);
	put_64(head + n + 8, (uint64_t)s->count);
	return (size_t)n + 16;
}

/* libsodium signs one piece of memory, so head and data are copied into one. */
static unsigned char *signed_bytes(const struct seal *s, const char *channel,
				   size_t *ret_bytes)
{
	uint8_t head[HEAD_MAX];
	const size_t n = head_make(head, s, channel);
	unsigned char *all = n ? malloc(n + s->size) : NULL;

	if (!all)
		return NULL;
	memcpy(all, head, n);
	if (s->size)
		memcpy(all + n, s->data, s->size);
	*ret_bytes = n + s->size;
	return all;
}

size_t seal_make(uint8_t *to, const struct seal *s, const char *channel,
		 const uint8_t *secret)
{
	size_t bytes;
	unsigned char *all = signed_bytes(s, channel, &bytes);

	if (!all)
		return 0;
	put_64(to, SEAL_FINGERPRINT);
	memcpy(to + AT_KEY, s->key, SEAL_KEY_BYTES);
	put_64(to + AT_BOOT, (uint64_t)s->boot);
	put_64(to + AT_COUNT, (uint64_t)s->count);
	crypto_sign_detached(to + AT_SIGNATURE, NULL, all, bytes, secret);
	free(all);
	for (int i = 0; i < 4; i++)
		to[AT_SIZE + i] = (uint8_t)(s->size >> (24 - 8 * i));
	if (s->size)
		memcpy(to + SEAL_BYTES, s->data, s->size);
	return SEAL_BYTES + s->size;
}

bool seal_read(struct seal *ret, const void *packet, size_t bytes)
{
	const uint8_t *at = packet;
	uint32_t size = 0;

	if (bytes < SEAL_BYTES || get_64(at) != SEAL_FINGERPRINT)
		return false;
	for (int i = 0; i < 4; i++)
		size = size << 8 | at[AT_SIZE + i];
	if (size != bytes - SEAL_BYTES)
		return false;
	*ret = (struct seal) {
		.key = at + AT_KEY, .boot = (int64_t)get_64(at + AT_BOOT),
		.count = (int64_t)get_64(at + AT_COUNT),
		.signature = at + AT_SIGNATURE,
		.data = at + SEAL_BYTES, .size = size,
	};
	return true;
}

bool seal_holds(const struct seal *s, const char *channel)
{
	size_t bytes;
	unsigned char *all = signed_bytes(s, channel, &bytes);
	bool good;

	if (!all)
		return false;
	good = crypto_sign_verify_detached(s->signature, all, bytes,
					   s->key) == 0;
	free(all);
	return good;
}

uint64_t seal_act_id(const uint8_t key[SEAL_KEY_BYTES], const char *client,
		     int64_t seq)
{
	crypto_generichash_state h;
	unsigned char out[crypto_generichash_BYTES_MIN];
	uint64_t id;

	crypto_generichash_init(&h, NULL, 0, sizeof(out));
	crypto_generichash_update(&h, key, SEAL_KEY_BYTES);
	crypto_generichash_update(&h, (const unsigned char *)&seq, sizeof(seq));
	crypto_generichash_update(&h, (const unsigned char *)client,
				  strlen(client));
	crypto_generichash_final(&h, out, sizeof(out));
	memcpy(&id, out, sizeof(id));
	/* SQLite stores signed 64-bit numbers; 0 means "no id". */
	id &= INT64_MAX;
	return id ? id : 1;
}
