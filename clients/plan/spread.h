/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spread.h - ask the same question about many things, on all processors
 *
 * Proofs of blocks do not depend on each other.  The answer is always that of a
 * plain loop, whatever the number of processors.
 */
#ifndef PLAN_SPREAD_H
#define PLAN_SPREAD_H

#include <stdbool.h>
#include <stdint.h>

/* Called by several threads at once, each with a different @i. */
typedef bool spread_ask(void *arg, uint32_t i);

/**
 * spread_first() - the least i below @n for which the answer is true; @n: there
 * is none.
 *
 * It asks about all i up to that one, and about some of those above it.
 */
uint32_t spread_first(uint32_t n, spread_ask *ask, void *arg);

#endif /* PLAN_SPREAD_H */
