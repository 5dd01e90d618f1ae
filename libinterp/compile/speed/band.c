/* SPDX-License-Identifier: Apache-2.0 */
/* band.c - symmetric systems with a narrow band */
#include "speed/band.h"

#include <errno.h>
#include <stdlib.h>

int band_make(struct band *s, size_t n, uint32_t sides)
{
	*s = (struct band) { .n = n, .sides = sides };
	s->a = calloc(n, BAND_WIDTH * sizeof(*s->a));
	s->b = calloc(n, sides * sizeof(*s->b));
	if (s->a && s->b)
		return 0;
	band_free(s);
	return -ENOMEM;
}

void band_free(struct band *s)
{
	free(s->a);
	free(s->b);
	s->a = s->b = NULL;
}

/* Row @i is taken off the rows below it. */
static void eliminate(struct band *s, size_t i)
{
	const double *row = s->a + i * BAND_WIDTH;
	const double *b = s->b + i * s->sides;

	for (size_t d = 1; d < BAND_WIDTH && i + d < s->n; d++) {
		const double by = row[d] / row[0];
		double *below = s->a + (i + d) * BAND_WIDTH;

		for (size_t e = d; e < BAND_WIDTH; e++)
			below[e - d] -= by * row[e];
		for (uint32_t k = 0; k < s->sides; k++)
			s->b[(i + d) * s->sides + k] -= by * b[k];
	}
}

static void put_back(struct band *s, size_t i)
{
	const double *row = s->a + i * BAND_WIDTH;
	double *b = s->b + i * s->sides;

	for (size_t d = 1; d < BAND_WIDTH && i + d < s->n; d++)
		for (uint32_t k = 0; k < s->sides; k++)
			b[k] -= row[d] * b[d * s->sides + k];
	for (uint32_t k = 0; k < s->sides; k++)
		b[k] /= row[0];
}

void band_solve(struct band *s)
{
	for (size_t i = 0; i < s->n; i++)
		eliminate(s, i);
	for (size_t i = s->n; i-- > 0;)
		put_back(s, i);
}
