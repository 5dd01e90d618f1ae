/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fewest.c - the fewest blocks over given nodes
 */
#include "fewest.h"

#include "spread.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDEST_MM	0.005

/* Put to a distance, so that a pair at it is nearer for certain. */
#define ROUNDING_MM	1e-9

int fewest_init(struct fewest *f, const struct job *j,
		double (*q)[INTERP_NAXES], uint32_t n)
{
	const size_t edges = (size_t)n * n;

	*f = (struct fewest) { .j = j, .n = n,
			       .lock = PTHREAD_MUTEX_INITIALIZER };
	route_lattice(&j->config, f->lattice);
	f->q = malloc(n * sizeof(*f->q));
	f->proved = malloc(edges * sizeof(*f->proved));
	f->refuted = malloc(edges * sizeof(*f->refuted));
	if (!f->q || !f->proved || !f->refuted) {
		fewest_free(f);
		return -ENOMEM;
	}
	memcpy(f->q, q, n * sizeof(*f->q));
	for (size_t i = 0; i < edges; i++) {
		f->proved[i] = -1;
		f->refuted[i] = DBL_MAX;
	}
	return 0;
}

void fewest_free(struct fewest *f)
{
	free(f->q);
	free(f->proved);
	free(f->refuted);
	*f = (struct fewest) { 0 };
}

static void show(const struct fewest *f)
{
	char text[100];

	snprintf(text, sizeof(text), "%s: %llu blocks tried", f->what,
		 (unsigned long long)f->blocks);
	bar_show(f->j, f->share, text);
}

/* @refuted: if it does not keep @mm, it does not keep that either. */
static bool prove(const struct fewest *f, const struct block *b, double mm,
		  struct proof *p, double *refuted)
{
	struct clearance c = *f->c;
	const double more = motion_strays_mm(b, f->lattice) + f->j->chord_mm;

	c.end_mm += more + (c.zone_mm > 0 ? 0 : mm - c.mm);
	c.mm = mm + more;
	c.end_mm = fmin(c.end_mm, c.mm);
	if (!prove_refuted(&f->j->bodies, b, &c, p) &&
	    prove_block(&f->j->bodies, b, &c, p))
		return true;
	*refuted = mm;
	if (!p->given_up && !(c.zone_mm > 0))
		*refuted = fmin(mm, p->least_mm - more + ROUNDING_MM);
	return false;
}

/* Does the block from node @i to node @k keep @mm?  Several threads may ask at
 * once, about different blocks. */
static bool fewest_keeps(struct fewest *f, uint32_t i, uint32_t k, double mm)
{
	double *proved = &f->proved[(size_t)i * f->n + k];
	double *refuted = &f->refuted[(size_t)i * f->n + k];
	struct proof p = { 0 };
	struct block b;
	bool ok;

	if (*proved >= mm)
		return true;
	if (*refuted <= mm)
		return false;
	block_init(&b, &f->j->motion, f->q[i], f->q[k]);
	pthread_mutex_lock(&f->lock);
	p.pair = f->nearest;
	pthread_mutex_unlock(&f->lock);
	ok = prove(f, &b, mm, &p, refuted);
	pthread_mutex_lock(&f->lock);
	f->queries += p.queries;
	f->blocks++;
	f->nearest = p.pair;
	show(f);
	pthread_mutex_unlock(&f->lock);
	if (ok)
		*proved = mm;
	return ok;
}

/* Blocks that are asked of together; none of them twice. */
struct ask {
	struct fewest *f;
	double mm;
	uint32_t from;			/* a node */
	const uint32_t *at;		/* nodes */
};

/* From ask->from as far as node f->n - 1 - @i. */
static bool reaches(void *arg, uint32_t i)
{
	const struct ask *a = arg;

	return bar_interrupted() ||
	       fewest_keeps(a->f, a->from, a->f->n - 1 - i, a->mm);
}

uint32_t fewest_greedy(struct fewest *f, double mm, uint32_t *ret)
{
	const uint32_t end = f->n - 1;
	uint32_t n = 0, at = 0;

	ret[0] = 0;
	f->what = "greedy";
	while (at < end) {
		struct ask a = { f, mm, at, NULL };
		const uint32_t back = spread_first(end - at, reaches, &a);

		f->share = (double)at / f->n;
		if (bar_interrupted())
			return UINT32_MAX;
		if (back == end - at)
			return 0;
		ret[++n] = at = end - back;
	}
	return n;
}

/* -- Breadth first -------------------------------------------------------- */

struct search {
	uint32_t *before;		/* UINT32_MAX: not reached */
	uint32_t *reached;		/* in the order of their blocks */
	uint32_t nreached;
	uint32_t left;			/* blocks, after the next one */
};

static void reach(struct search *s, uint32_t node, uint32_t from)
{
	s->before[node] = from;
	s->reached[s->nreached++] = node;
}

static uint32_t trace_back(const struct search *s, uint32_t end, uint32_t *ret)
{
	uint32_t n = 0;

	for (uint32_t i = end; i != 0; i = s->before[i])
		n++;
	for (uint32_t i = end, k = n; k > 0; i = s->before[i])
		ret[k--] = i;
	ret[0] = 0;
	return n;
}

/* From node ask->at[@i] to the end. */
static bool ends(void *arg, uint32_t i)
{
	const struct ask *a = arg;

	return bar_interrupted() ||
	       fewest_keeps(a->f, a->at[i], a->f->n - 1, a->mm);
}

/* From ask->from to ask->at[@i]; all are asked. */
static bool learns(void *arg, uint32_t i)
{
	const struct ask *a = arg;

	if (!bar_interrupted())
		fewest_keeps(a->f, a->from, a->at[i], a->mm);
	return false;
}

/* The fewest blocks from each node to the end, if all blocks keep @mm that are
 * not known to come nearer. */
static void hope(const struct fewest *f, double mm, uint32_t *ret)
{
	const uint32_t end = f->n - 1;

	ret[end] = 0;
	for (uint32_t i = end; i-- > 0;) {
		const double *refuted = &f->refuted[(size_t)i * f->n];

		ret[i] = f->n;
		for (uint32_t k = i + 1; k <= end; k++)
			if (refuted[k] > mm && ret[k] + 1 < ret[i])
				ret[i] = ret[k] + 1;
	}
}

/* All nodes that a block from node @from reaches, that were not reached before,
 * and from which the blocks that are left may be enough. */
static void reach_from(struct fewest *f, struct search *s, double mm,
		       uint32_t from)
{
	uint32_t at[FEWEST_NODES_MAX], togo[FEWEST_NODES_MAX], n = 0;
	struct ask a = { f, mm, from, at };

	hope(f, mm, togo);
	for (uint32_t k = f->n - 2; k > from; k--)
		if (s->before[k] == UINT32_MAX && togo[k] <= s->left)
			at[n++] = k;
	spread_first(n, learns, &a);
	for (uint32_t i = 0; i < n && !bar_interrupted(); i++)
		if (fewest_keeps(f, from, at[i], mm))
			reach(s, at[i], from);
}

/* All that one more block reaches, from the node reached @first on; if none is
 * left after it, only the end counts. */
static bool level(struct fewest *f, struct search *s, double mm, uint32_t first)
{
	const uint32_t to = s->nreached;
	struct ask a = { f, mm, 0, s->reached + first };
	uint32_t i = spread_first(to - first, ends, &a);

	if (bar_interrupted())
		return false;
	if (i < to - first) {
		reach(s, f->n - 1, s->reached[first + i]);
		return true;
	}
	for (i = first; i < to && s->left && !bar_interrupted(); i++) {
		f->share = (double)i / to;
		reach_from(f, s, mm, s->reached[i]);
	}
	return false;
}

uint32_t fewest_search(struct fewest *f, double mm, uint32_t most,
		       uint32_t *ret)
{
	struct search s = {
		.before = malloc(f->n * sizeof(*s.before)),
		.reached = malloc(f->n * sizeof(*s.reached)),
	};
	uint32_t from = 0, n = 0;

	f->what = "fewest";
	if (s.before && s.reached) {
		memset(s.before, 0xff, f->n * sizeof(*s.before));
		reach(&s, 0, 0);
		for (uint32_t i = 0; i < most && !n; i++) {
			const uint32_t to = s.nreached;

			if (bar_interrupted())
				break;
			s.left = most - i - 1;
			if (level(f, &s, mm, from))
				n = trace_back(&s, f->n - 1, ret);
			else if (s.nreached == to)
				break;
			from = to;
		}
	}
	free(s.before);
	free(s.reached);
	return n;
}

double fewest_widest(struct fewest *f, double mm, uint32_t blocks,
		     uint32_t *ret)
{
	double low = mm, high = mm + 0.32;
	uint32_t *way;

	/* From the first node to the last there is one block only. */
	if (blocks == 1)
		return mm;
	way = malloc((f->n + 1) * sizeof(*way));

	while (way && high - low > WIDEST_MM && !bar_interrupted()) {
		const double mid = (low + high) / 2;
		const uint32_t n = fewest_search(f, mid, blocks, way);

		if (n) {
			low = mid;
			memcpy(ret, way, (n + 1) * sizeof(*ret));
		} else {
			high = mid;
		}
	}
	free(way);
	return low;
}
