/* SPDX-License-Identifier: Apache-2.0 */
/* swarm.c - particle swarm in a box, with Clerc and Kennedy's constriction */
#include "interp/minimise.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define N	INTERP_MINIMISE_NMAX
#define PARTICLES	12
#define INERTIA	0.7298
#define PULL	1.49618			/* toward its own best, and the swarm's */

struct particle {
	double x[N], v[N], best[N], best_cost;
};

/* xorshift64*: 0 up to 1. */
static double draw(uint64_t *s)
{
	*s ^= *s >> 12;
	*s ^= *s << 25;
	*s ^= *s >> 27;
	return (double)((*s * 2685821657736338717u) >> 11) * 0x1p-53;
}

static void place(const struct interp_minimise *m, uint64_t *seed,
		  struct particle *p, const double *x)
{
	for (int i = 0; i < m->n; i++) {
		const double width = m->high[i] - m->low[i];

		p->x[i] = x ? fmin(fmax(x[i], m->low[i]), m->high[i]) :
			      m->low[i] + width * draw(seed);
		p->v[i] = width * (draw(seed) - 0.5) / 2;
	}
	p->best_cost = INFINITY;
}

/* A wall stops the particle. */
static void fly(const struct interp_minimise *m, uint64_t *seed,
		struct particle *p, const double *best)
{
	for (int i = 0; i < m->n; i++) {
		p->v[i] = INERTIA * p->v[i] +
			  PULL * draw(seed) * (p->best[i] - p->x[i]) +
			  PULL * draw(seed) * (best[i] - p->x[i]);
		p->x[i] += p->v[i];
		if (p->x[i] >= m->low[i] && p->x[i] <= m->high[i])
			continue;
		p->x[i] = fmin(fmax(p->x[i], m->low[i]), m->high[i]);
		p->v[i] = 0;
	}
}

double interp_minimise_swarm(const struct interp_minimise *m, double *x)
{
	struct particle all[PARTICLES];
	uint64_t seed = m->seed * 2 + 1;
	double best[N], least = INFINITY;

	for (int i = 0; i < PARTICLES; i++)
		place(m, &seed, &all[i], i ? NULL : x);
	memcpy(best, all[0].x, sizeof(best));
	for (unsigned int k = 0; k < m->budget; k++) {
		struct particle *p = &all[k % PARTICLES];
		double cost;

		if (k >= PARTICLES)
			fly(m, &seed, p, best);
		cost = m->cost(m->arg, p->x);
		if (cost < p->best_cost) {
			p->best_cost = cost;
			memcpy(p->best, p->x, sizeof(best));
		}
		if (cost < least) {
			least = cost;
			memcpy(best, p->x, sizeof(best));
		}
	}
	memcpy(x, best, (size_t)m->n * sizeof(*x));
	return least;
}
