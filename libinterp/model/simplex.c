/* SPDX-License-Identifier: Apache-2.0 */
/* simplex.c - Nelder and Mead's downhill simplex in a box, begun anew */
#include "interp/minimise.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define N	INTERP_MINIMISE_NMAX
#define FIRST	0.15			/* of the box, the first simplex */
#define SHRUNK	1e-5			/* of the box: begin anew */

struct corner {
	double x[N], cost;
};

struct simplex {
	const struct interp_minimise *m;
	struct corner at[N + 1];	/* the best first */
	unsigned int left;		/* evaluations */
};

static struct corner look(struct simplex *s, const double *x)
{
	const struct interp_minimise *m = s->m;
	struct corner c = { .cost = INFINITY };

	for (int i = 0; i < m->n; i++)
		c.x[i] = fmin(fmax(x[i], m->low[i]), m->high[i]);
	if (s->left == 0)
		return c;
	s->left--;
	c.cost = m->cost(m->arg, c.x);
	if (isnan(c.cost))
		c.cost = INFINITY;
	return c;
}

static void sort(struct simplex *s)
{
	for (int i = 1; i <= s->m->n; i++) {
		const struct corner c = s->at[i];
		int j = i;

		for (; j > 0 && s->at[j - 1].cost > c.cost; j--)
			s->at[j] = s->at[j - 1];
		s->at[j] = c;
	}
}

static void spread(struct simplex *s, double part)
{
	const struct interp_minimise *m = s->m;

	for (int i = 0; i < m->n; i++) {
		double x[N];

		memcpy(x, s->at[0].x, sizeof(x));
		x[i] += part * (m->high[i] - m->low[i]);
		if (x[i] > m->high[i] || x[i] < m->low[i])
			x[i] -= 2 * part * (m->high[i] - m->low[i]);
		s->at[i + 1] = look(s, x);
	}
	sort(s);
}

/* From the worst corner through the middle of the others and @by further. */
static struct corner through(struct simplex *s, double by)
{
	const int n = s->m->n;
	double x[N];

	for (int i = 0; i < n; i++) {
		double middle = 0;

		for (int k = 0; k < n; k++)
			middle += s->at[k].x[i] / n;
		x[i] = middle + by * (middle - s->at[n].x[i]);
	}
	return look(s, x);
}

static void shrink(struct simplex *s)
{
	for (int k = 1; k <= s->m->n; k++) {
		double x[N];

		for (int i = 0; i < s->m->n; i++)
			x[i] = (s->at[0].x[i] + s->at[k].x[i]) / 2;
		s->at[k] = look(s, x);
	}
}

static void move(struct simplex *s)
{
	const int n = s->m->n;
	const struct corner over = through(s, 1);
	struct corner c;

	if (over.cost < s->at[0].cost) {
		c = through(s, 2);
		s->at[n] = c.cost < over.cost ? c : over;
	} else if (over.cost < s->at[n - 1].cost) {
		s->at[n] = over;
	} else {
		c = through(s, over.cost < s->at[n].cost ? 0.5 : -0.5);
		if (c.cost < fmin(over.cost, s->at[n].cost))
			s->at[n] = c;
		else
			shrink(s);
	}
	sort(s);
}

static bool shrunk(const struct simplex *s)
{
	const struct interp_minimise *m = s->m;

	for (int i = 0; i < m->n; i++)
		for (int k = 1; k <= m->n; k++)
			if (fabs(s->at[k].x[i] - s->at[0].x[i]) >
			    SHRUNK * (m->high[i] - m->low[i]))
				return false;
	return true;
}

double interp_minimise_simplex(const struct interp_minimise *m, double *x)
{
	struct simplex s = { .m = m, .left = m->budget };
	double part = FIRST;

	s.at[0] = look(&s, x);
	spread(&s, part);
	while (s.left > 0) {
		move(&s);
		if (!shrunk(&s))
			continue;
		part = -part;
		spread(&s, part);
	}
	memcpy(x, s.at[0].x, (size_t)m->n * sizeof(*x));
	return s.at[0].cost;
}
