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
