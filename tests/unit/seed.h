/* SPDX-License-Identifier: Apache-2.0 */
/*
 * seed.h - the seed of a random test, printed so that the test can be repeated
 */
#ifndef SEED_H
#define SEED_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdlib.h>
#include <time.h>

/*
 * SEED_ROUNDS() - of so many random rounds, those that are made.  Sanitizers
 * make a round some ten times slower and look at each access and sum of it, so
 * they are shown a tenth.  `make check` has the same seed each time, so more of
 * the same rounds find less and less: it makes one in $EDM_SHARE.
 */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SEED_ROUNDS(n)	seed_share(((n) + 9) / 10)
#else
#define SEED_ROUNDS(n)	seed_share(n)
#endif

static inline int seed_share(int n)
{
	const char *given = getenv("EDM_SHARE");
	const int share = given ? atoi(given) : 1;

	return share > 1 ? (n + share - 1) / share : n;
}

/** seed_take() - the seed is $EDM_SEED, or else the time. */
static inline uint64_t seed_take(void)
{
	const char *given = getenv("EDM_SEED");
	const uint64_t seed = given ? strtoull(given, NULL, 0) :
				      (uint64_t)time(NULL);

	print_message("EDM_SEED=%llu\n", (unsigned long long)seed);
	return seed;
}

#endif /* SEED_H */
