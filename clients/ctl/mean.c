/* SPDX-License-Identifier: Apache-2.0 */
/* mean.c - the mean of a value over the last second */
#include "mean.h"

#include <math.h>

#define OVER_S	1.0

void mean_add(struct mean *m, double now_s, double value)
{
	m->at_s[m->n % MEAN_ROOM] = now_s;
	m->value[m->n % MEAN_ROOM] = value;
	m->n++;
}

double mean_now(const struct mean *m, double now_s)
{
	double until_s = now_s, sum = 0, over_s = 0;
	int i;

	for (i = m->n - 1; i >= 0 && i >= m->n - MEAN_ROOM; i--) {
		const double at_s = fmax(m->at_s[i % MEAN_ROOM],
					 now_s - OVER_S);
		const double held_s = fmax(until_s - at_s, 0);

		sum += held_s * m->value[i % MEAN_ROOM];
		over_s += held_s;
		until_s = at_s;
		if (at_s <= now_s - OVER_S)
			break;
	}
	/* Two that came at once have held for no time. */
	return over_s > 0 ? sum / over_s :
	       m->n ? m->value[(m->n - 1) % MEAN_ROOM] : 0;
}
