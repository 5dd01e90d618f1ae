/* SPDX-License-Identifier: Apache-2.0 */
/* key.c - numbers that show whether something is the same as before */
#include "key.h"

#include <string.h>

/* FNV-1a, by words. */
uint64_t key_of(const void *block, size_t bytes)
{
	uint64_t key = UINT64_C(0xcbf29ce484222325), word = 0;

	for (size_t i = 0; i < bytes; i += sizeof(word)) {
		const size_t left = bytes - i;

		memcpy(&word, (const char *)block + i,
		       left < sizeof(word) ? left : sizeof(word));
		key = (key ^ word) * UINT64_C(0x100000001b3);
	}
	return key ? key : 1;
}

uint64_t key_axes(const struct machine_config *c)
{
	double of[1 + 3 * INTERP_NAXES] = { c->backend };
	double *at = of + 1;

	if (!config_machine_is(c, MACHINE_DRIVES))
		return key_of(of, sizeof(of));
	for (int i = 0; i < INTERP_NAXES; i++) {
		*at++ = c->can402.node[i];
		*at++ = c->drive[i].increments;
		*at++ = c->drive[i].pulses;
	}
	return key_of(of, sizeof(of));
}

uint64_t key_home(const struct machine_config *c)
{
	double of[2 * INTERP_NAXES], *at = of;

	for (int i = 0; i < INTERP_NAXES; i++) {
		*at++ = c->manual[i].method;
		*at++ = c->manual[i].home_at_mm;
	}
	return key_of(of, sizeof(of));
}
