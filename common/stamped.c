/* SPDX-License-Identifier: Apache-2.0 */
/* stamped.c - records from one writer to any number of readers */
#include "stamped.h"

typedef uint64_t __attribute__((may_alias)) word_t;

/*
 * In C11 a record that is written while it is read is a data race unless every
 * word is atomic.  Release and acquire on the words also keep the order against
 * the stamps, on any processor and without a fence.  On x86 they are plain
 * moves.
 */
static void words_put(word_t *to, const void *from, size_t bytes)
{
	const word_t *w = from;

	for (size_t i = 0; i < bytes / sizeof(*w); i++)
		__atomic_store_n(&to[i], w[i], __ATOMIC_RELEASE);
}

static void words_get(void *to, const word_t *from, size_t bytes)
{
	word_t *w = to;

	for (size_t i = 0; i < bytes / sizeof(*w); i++)
		w[i] = __atomic_load_n(&from[i], __ATOMIC_ACQUIRE);
}

static word_t *stamp_of(const struct stamped *r, uint64_t n)
{
	return (word_t *)(void *)((char *)r->slots +
				  (n & (r->count - 1)) * r->slot_bytes);
}

void stamped_put(const struct stamped *r, const void *record)
{
	const uint64_t n = __atomic_load_n(r->next, __ATOMIC_RELAXED);
	word_t *stamp = stamp_of(r, n);

	__atomic_store_n(stamp, 2 * n + 1, __ATOMIC_RELAXED);
	words_put(stamp + 1, record, r->slot_bytes - sizeof(*stamp));
	__atomic_store_n(stamp, 2 * n + 2, __ATOMIC_RELEASE);
	__atomic_store_n(r->next, n + 1, __ATOMIC_RELEASE);
}

bool stamped_get(const struct stamped *r, uint64_t n, void *ret)
{
	const word_t *stamp = stamp_of(r, n);

	if (__atomic_load_n(stamp, __ATOMIC_ACQUIRE) != 2 * n + 2)
		return false;
	words_get(ret, stamp + 1, r->slot_bytes - sizeof(*stamp));
	return __atomic_load_n(stamp, __ATOMIC_RELAXED) == 2 * n + 2;
}

bool stamped_last(const struct stamped *r, int tries, void *ret)
{
	for (int i = 0; i < tries; i++) {
		const uint64_t n = __atomic_load_n(r->next, __ATOMIC_ACQUIRE);

		if (n == 0)
			return false;
		if (stamped_get(r, n - 1, ret))
			return true;
	}
	return false;
}
