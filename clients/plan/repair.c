/* SPDX-License-Identifier: Apache-2.0 */
/*
 * repair.c - a way that is too near in places, led round them
 */
#include "repair.h"

#include "check.h"
#include "corridor.h"

#include <errno.h>
#include <string.h>

#define ROUNDS		30		/* of linear programs */
#define SPARE_MM	0.02		/* more than is to be kept: poses are
					 * tried, blocks are proved */
#define WIDE_MM		2.0		/* of the corridor */
#define TRIES		20000		/* poses drawn in it */
#define BESIDE		2		/* free nodes taken with a stretch, on
					 * each side */

struct stretch {
	uint32_t first, last;		/* nodes; both are free and stay */
};

struct repair {
	struct plan *p;
	double (*q)[INTERP_NAXES];
	uint32_t n;
	struct near_pair pair;
	struct job_axes axes;
};

static bool keeps(struct repair *r, const double from[INTERP_NAXES],
		  const double to[INTERP_NAXES])
{
	return check_block(r->p->j, from, to, &r->p->c, &r->pair);
}

/* The next stretch from node @at on: the blocks that are too near, with some
 * free nodes on both sides. */
static bool find_stretch(struct repair *r, uint32_t at, struct stretch *ret)
{
	while (at + 1 < r->n && keeps(r, r->q[at], r->q[at + 1]))
		at++;
	if (at + 1 >= r->n)
		return false;
	ret->first = at > BESIDE ? at - BESIDE : 0;
	/* It ends where so many blocks in a row are free. */
	for (uint32_t good = 0; at + 1 < r->n && good < BESIDE; at++)
		good = keeps(r, r->q[at], r->q[at + 1]) ? good + 1 : 0;
	ret->last = at;
	return true;
}

/* Nodes @at of the stretch instead of its own. */
static bool replace(struct repair *r, const struct stretch *s,
		    double (*at)[INTERP_NAXES], uint32_t n)
{
	const uint32_t was = s->last - s->first + 1;

	if (r->n - was + n > FEWEST_NODES_MAX)
		return false;
	for (uint32_t i = 0; i + 1 < n; i++)
		if (!keeps(r, at[i], at[i + 1]))
			return false;
	memmove(r->q + s->first + n, r->q + s->last + 1,
		(r->n - s->last - 1) * sizeof(*r->q));
	memcpy(r->q + s->first, at, n * sizeof(*r->q));
	r->n = r->n - was + n;
	r->p->repaired += n - 2;
	return true;
}

static bool by_programs(struct repair *r, struct stretch *s)
{
	const uint32_t all = s->last - s->first + 1;
	const uint32_t n = all < FREE_NODES_MAX ? all : FREE_NODES_MAX;
	double q[FREE_NODES_MAX][INTERP_NAXES];
	struct free_way w;

	for (uint32_t i = 0; i < n; i++)
		memcpy(q[i], r->q[s->first + i * (all - 1) / (n - 1)],
		       sizeof(q[i]));
	if (n < 3 || free_init(&w, r->p->j, &r->p->c, q, n))
		return false;
	w.enough_mm = r->p->c.mm + r->p->j->chord_mm + SPARE_MM;
	free_widen(&w, ROUNDS);
	r->p->queries += w.queries;
	for (uint32_t i = 1; i + 1 < n; i++)
		free_round(&r->p->j->config, w.q[i]);
	if (!replace(r, s, w.q, n))
		return false;
	s->last = s->first + n - 1;
	return true;
}

static bool corridor_keeps(void *arg, const double from[INTERP_NAXES],
			   const double to[INTERP_NAXES])
{
	struct repair *r = arg;
	double a[INTERP_NAXES], b[INTERP_NAXES];

	memcpy(a, from, sizeof(a));
	memcpy(b, to, sizeof(b));
	free_round(&r->p->j->config, a);
	free_round(&r->p->j->config, b);
	return keeps(r, a, b);
}

static bool corridor_stop(void *arg)
{
	struct repair *r = arg;

	bar_show(r->p->j, 0.5, "another way in a corridor");
	return bar_interrupted();
}

static int by_corridor(struct repair *r, struct stretch *s)
{
	double q[FEWEST_NODES_MAX][INTERP_NAXES];
	struct corridor c = {
		.naxes = r->axes.n,
		.guess = (const double (*)[INTERP_NAXES])(r->q + s->first),
		.nguess = s->last - s->first + 1,
		.wide_mm = WIDE_MM, .tries = TRIES,
		.keeps = corridor_keeps, .stop = corridor_stop, .arg = r,
	};
	int n;

	memcpy(c.axis, r->axes.axis, sizeof(c.axis));
	memcpy(c.reach_mm, r->axes.reach_mm, sizeof(c.reach_mm));
	for (int k = 0; k < INTERP_NAXES; k++) {
		c.low[k] = r->p->j->config.axes.axis[k].travel_min_mm;
		c.high[k] = r->p->j->config.axes.axis[k].travel_max_mm;
	}
	n = corridor_find(&c, q, FEWEST_NODES_MAX);
	if (n < 2)
		return n < 0 ? n : 1;
	for (int i = 1; i + 1 < n; i++)
		free_round(&r->p->j->config, q[i]);
	if (!replace(r, s, q, (uint32_t)n))
		return 1;
	s->last = s->first + (uint32_t)n - 1;
	return 0;
}

int repair_nodes(struct plan *p, double (*q)[INTERP_NAXES], uint32_t *n)
{
	struct repair r = { .p = p, .q = q, .n = *n };
	struct stretch s = { 0 };
	int rc = 0;

	job_axes_find(p->j, q[0], q[*n - 1], &r.axes);
	while (rc == 0 && !bar_interrupted() && find_stretch(&r, s.last, &s))
		rc = by_programs(&r, &s) ? 0 : by_corridor(&r, &s);
	*n = r.n;
	p->nearest = r.pair;
	return bar_interrupted() ? 1 : rc;
}
