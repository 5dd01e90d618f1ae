/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nodes.c - the way in of a dense program, and its nodes
 */
#include "plan.h"

#include <stdlib.h>
#include <sysexits.h>

int plan_find_way_in(struct plan *p)
{
	const struct route *w = &p->dense;

	p->first = p->last = 0;
	for (uint32_t i = 1; i < w->n; i++) {
		if (w->node[i].rapid)
			continue;
		if (p->last == 0)
			p->first = i - 1;
		else if (p->last != i - 1)
			break;
		p->last = i;
	}
	for (uint32_t i = p->last + 1; i < w->n && p->last; i++) {
		if (w->node[i].rapid)
			continue;
		fprintf(stderr, "%s:%u: error: a second cut, after it was "
			"positioned; a program of one way in\n",
			p->j->o->program, w->node[i].line);
		return EX_DATAERR;
	}
	if (p->last > 0)
		return 0;
	fprintf(stderr, "%s: error: no cut in it; a program of one way in, "
		"as G1 or G6.2\n", p->j->o->program);
	return EX_DATAERR;
}

/* How far the electrode has gone at each node of the way in.  Return: for
 * free(). */
static double *ways(const struct plan *p)
{
	const uint32_t all = p->last - p->first + 1;
	double *way = malloc(all * sizeof(*way));

	if (!way)
		return NULL;
	way[0] = 0;
	for (uint32_t i = 1; i < all; i++) {
		struct block b;

		job_block(p->j, &p->dense, p->first + i - 1, &b);
		way[i] = way[i - 1] + b.way_mm;
	}
	return way;
}

uint32_t plan_choose_nodes(const struct plan *p, uint32_t at[FEWEST_NODES_MAX])
{
	const uint32_t all = p->last - p->first + 1;
	double *way = ways(p);
	uint32_t n = 0, k = 0;

	for (uint32_t i = 0; i < FEWEST_NODES_MAX && way && k < all; i++) {
		const double share = (double)i / (FEWEST_NODES_MAX - 1);

		while (all > FEWEST_NODES_MAX && k + 1 < all &&
		       way[k] < share * way[all - 1])
			k++;
		at[n++] = p->first + k++;
	}
	if (n)
		at[n - 1] = p->last;
	free(way);
	return n;
}
