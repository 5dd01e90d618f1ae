/* SPDX-License-Identifier: Apache-2.0 */
/*
 * band.h - symmetric systems of equations of which only the diagonal and five
 * beside it are not 0, for several right sides
 *
 * Private to libinterp/compile/speed.
 */
#ifndef SPEED_BAND_H
#define SPEED_BAND_H

#include <stddef.h>
#include <stdint.h>

#define BAND_WIDTH	6

struct band {
	size_t n;			/* unknowns */
	uint32_t sides;
	double *a;			/* of row i, columns i to i + 5 */
	double *b;			/* of row i, each right side */
};

/** band_make() - a system of zeros.  Return: 0, -ENOMEM. */
int band_make(struct band *s, size_t n, uint32_t sides);

/** band_solve() - @s->b becomes the unknowns; @s->a is used up.  The matrix
 *  must be positive definite. */
void band_solve(struct band *s);

void band_free(struct band *s);

#endif /* SPEED_BAND_H */
