/* SPDX-License-Identifier: Apache-2.0 */
/*
 * key.h - has something changed since before a restart? Numbers to compare
 *
 * Threads: any.
 */
#ifndef EDMD_KEY_H
#define EDMD_KEY_H

#include "config.h"

#include <stddef.h>
#include <stdint.h>

/** key_of() - a number for the @bytes at @block; never 0. */
uint64_t key_of(const void *block, size_t bytes);

/**
 * key_axes() - for everything that turns pulses into motion: backend and
 * drives.
 */
uint64_t key_axes(const struct machine_config *c);

/**
 * key_home() - for everything that decides how homing works and what places it
 * gives.
 */
uint64_t key_home(const struct machine_config *c);

#endif /* EDMD_KEY_H */
