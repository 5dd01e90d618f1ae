/* SPDX-License-Identifier: Apache-2.0 */
/*
 * spread.h - the same question about many things, on all processors
 *
 * Proofs of blocks do not depend on each other.  The answer is that of a plain
 * loop, on any number of processors.
 */
#ifndef PLAN_SPREAD_H
#define PLAN_SPREAD_H

#include <stdbool.h>
#include <stdint.h>

/* Called from several threads at once, each with another @i. */
typedef bool spread_ask(void *arg, uint32_t i);

/**
 * spread_first() - the least i under @n with the answer true; @n: none.
 *
 * All below it are asked; of those above it, some are.
 */
uint32_t spread_first(uint32_t n, spread_ask *ask, void *arg);

#endif /* PLAN_SPREAD_H */
