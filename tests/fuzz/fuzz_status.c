/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_status.c - read a status object with any bytes changed
 *
 * The input says what is written where: five bytes each, a place and a byte.
 */
#include "shm.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define RECORDS	2000

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct shm_status *s;
	struct shm_follow f = { .next = 0 };
	struct shm_snapshot snap;
	struct shm_trace trace;
	struct shm_event event;
	struct shm_sets sets;
	struct shm_done done;
	uint32_t at;

	if (!s)
		s = calloc(1, sizeof(*s));
	assert(s);
	for (size_t i = 0; i + 5 <= size; i += 5) {
		memcpy(&at, data + i, sizeof(at));
		/* Half of them where the counts and stamps are. */
		at %= (uint32_t)(sizeof(*s) - (i & 1 ? 0 : sizeof(s->trace) +
							   sizeof(s->event)));
		((uint8_t *)s)[at] = data[i + 4];
	}
	shm_snapshot(s, &snap);
	shm_sets(s, &sets);
	for (int i = 0; i < RECORDS && shm_trace_next(s, &f, &trace); i++)
		;
	f = (struct shm_follow) { .next = 0 };
	for (int i = 0; i < RECORDS && shm_event_next(s, &f, &event); i++)
		;
	shm_done(s, size, &done);
	shm_done_begin(s, size + 1);
	shm_done_end(s, size + 1, SHM_DONE);
	assert(shm_done(s, size + 1, &done) && done.code == SHM_DONE);
	return 0;
}
