/* SPDX-License-Identifier: Apache-2.0 */
/*
 * smaller.h - the smaller and the larger of two numbers
 *
 * Compiled to one instruction, where fmin() and fmax() are calls, because they
 * also say what is to become of a NAN.  Here neither may be one.
 *
 * Threads: RT-safe.
 */
#ifndef INTERP_SMALLER_H
#define INTERP_SMALLER_H

#include <stdint.h>

static inline double smaller(double a, double b)
{
	return a < b ? a : b;
}

static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

/* The smaller of two whole numbers. */
static inline int64_t fewer(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

#endif /* INTERP_SMALLER_H */
