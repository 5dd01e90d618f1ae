/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rng.h - random numbers that a seed repeats on every machine
 *
 * xoshiro256++ (Blackman and Vigna, 2019), seeded by splitmix64.
 * Threads: RT-safe; one object belongs to one thread.
 */
#ifndef IO_RNG_H
#define IO_RNG_H

#include <stdint.h>

struct rng {
	uint64_t s[4];
};

static inline void rng_seed(struct rng *r, uint64_t seed)
{
	for (int i = 0; i < 4; i++) {
		uint64_t z = seed += 0x9e3779b97f4a7c15u;

		z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
		z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
		r->s[i] = z ^ (z >> 31);
	}
}

static inline uint64_t rng_rotl(uint64_t x, int k)
{
	return x << k | x >> (64 - k);
}

static inline uint64_t rng_next(struct rng *r)
{
	const uint64_t result = rng_rotl(r->s[0] + r->s[3], 23) + r->s[0];
	const uint64_t t = r->s[1] << 17;

	r->s[2] ^= r->s[0];
	r->s[3] ^= r->s[1];
	r->s[1] ^= r->s[2];
	r->s[0] ^= r->s[3];
	r->s[2] ^= t;
	r->s[3] = rng_rotl(r->s[3], 45);
	return result;
}

/** rng_uniform() - in [0, 1). */
static inline double rng_uniform(struct rng *r)
{
	return (double)(rng_next(r) >> 11) * 0x1p-53;
}

/**
 * rng_normal() - near enough to a normal deviate for sensor noise: the sum of
 * the four 16-bit quarters of one draw, scaled to sigma 1, cut at 3.46.
 */
static inline double rng_normal(struct rng *r)
{
	const uint64_t x = rng_next(r);
	const int64_t sum = (int64_t)((x & 0xffff) + (x >> 16 & 0xffff) +
				      (x >> 32 & 0xffff) + (x >> 48));

	return (double)(sum - 2 * 65535) * (1.7320508075688772 / 65535);
}

#endif /* IO_RNG_H */
