/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fewest.c - the fewest blocks over given nodes
 */
#include "fewest.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDEST_MM	0.005

int fewest_init(struct fewest *f, const struct job *j,
		double (*q)[INTERP_NAXES], uint32_t n)
{
	const size_t edges = (size_t)n * n;

	*f = (struct fewest) { .j = j, .n = n };
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
		f->refuted[i] = FLT_MAX;
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

bool fewest_keeps(struct fewest *f, uint32_t i, uint32_t k, double mm)
{
	float *proved = &f->proved[(size_t)i * f->n + k];
	float *refuted = &f->refuted[(size_t)i * f->n + k];
	struct clearance c = *f->c;
	struct proof p = { .pair = f->nearest };
	struct block b;
	double more;
	bool ok;

	if ((double)*proved >= mm)
		return true;
	if ((double)*refuted <= mm)
		return false;
	block_init(&b, &f->j->motion, f->q[i], f->q[k]);
	more = motion_strays_mm(&b, f->lattice) + f->j->chord_mm;
	c.end_mm += more + (c.zone_mm > 0 ? 0 : mm - c.mm);
	c.mm = mm + more;
	c.end_mm = fmin(c.end_mm, c.mm);
	ok = !prove_refuted(&f->j->bodies, &b, &c, &p) &&
	     prove_block(&f->j->bodies, &b, &c, &p);
	f->queries += p.queries;
	f->blocks++;
	f->nearest = p.pair;
	if (ok)
		*proved = (float)mm;
	else
		*refuted = (float)mm;
	return ok;
}

static void show(const struct fewest *f, const char *what, double share)
{
	char text[100];

	snprintf(text, sizeof(text), "%s: %llu blocks tried", what,
		 (unsigned long long)f->blocks);
	bar_show(f->j, share, text);
}

uint32_t fewest_greedy(struct fewest *f, double mm, uint32_t *ret)
{
	uint32_t n = 0, at = 0;

	ret[0] = 0;
	while (at + 1 < f->n) {
		uint32_t k = f->n - 1;

		while (k > at && !fewest_keeps(f, at, k, mm)) {
			show(f, "greedy", (double)at / f->n);
			k--;
			if (bar_interrupted())
				return UINT32_MAX;
		}
		if (k == at)
			return 0;
		ret[++n] = at = k;
	}
	return n;
}

/* -- Breadth first -------------------------------------------------------- */

struct search {
	uint32_t *before;		/* UINT32_MAX: not reached */
	uint32_t *reached;		/* in the order of their blocks */
	uint32_t nreached;
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

/* All that one more block reaches, from @from on in the order of reaching; at
 * the last level only the end counts. */
static bool level(struct fewest *f, struct search *s, double mm, uint32_t from,
		  bool last)
{
	const uint32_t end = f->n - 1, to = s->nreached;

	for (uint32_t i = from; i < to; i++) {
		if (fewest_keeps(f, s->reached[i], end, mm)) {
			reach(s, end, s->reached[i]);
			return true;
		}
	}
	for (uint32_t i = from; i < to && !last; i++) {
		for (uint32_t k = end - 1; k > s->reached[i]; k--) {
			if (bar_interrupted())
				return false;
			show(f, "fewest", (double)i / to);
			if (s->before[k] == UINT32_MAX &&
			    fewest_keeps(f, s->reached[i], k, mm))
				reach(s, k, s->reached[i]);
		}
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

	if (s.before && s.reached) {
		memset(s.before, 0xff, f->n * sizeof(*s.before));
		reach(&s, 0, 0);
		for (uint32_t i = 0; i < most && !n; i++) {
			const uint32_t to = s.nreached;

			if (bar_interrupted())
				break;

			if (level(f, &s, mm, from, i + 1 == most))
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
	uint32_t *way = malloc((f->n + 1) * sizeof(*way));

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
