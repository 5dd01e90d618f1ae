/* SPDX-License-Identifier: Apache-2.0 */
/* wear.c - what a program takes off its electrodes, by estimate */
#include "interp/wear.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define SAME_SLOPE	1e-12		/* mm per mm */
#define PARTS_MAX	(1u << 20)	/* 24 MiB; then every second one is
					 * left out */

static int part_add(struct interp_wear *w, const struct interp_wear_part *p)
{
	if (w->nparts == w->room &&
	    grow_array(&w->part, &w->room, sizeof(*w->part)))
		return -ENOMEM;
	w->part[w->nparts++] = *p;
	return 0;
}

static bool is_straight(const struct interp_wear_part *a,
			const struct interp_wear_part *b,
			const struct interp_wear_part *c)
{
	const double ab = b->s_mm - a->s_mm, bc = c->s_mm - b->s_mm;

	return ab > 0 && bc > 0 &&
	       fabs((b->wear_mm - a->wear_mm) / ab -
		    (c->wear_mm - b->wear_mm) / bc) < SAME_SLOPE &&
	       fabs((b->unknown_mm - a->unknown_mm) / ab -
		    (c->unknown_mm - b->unknown_mm) / bc) < SAME_SLOPE;
}

/* Between those that stay, the wear is then even. */
static void thin(struct interp_wear *w)
{
	size_t n = 0;

	for (size_t i = 0; i < w->nparts; i += 2)
		w->part[n++] = w->part[i];
	w->nparts = n;
}

/* A part that goes on as the last one did replaces its end. */
static int part_join(struct interp_wear *w, const struct interp_wear_part *p)
{
	const size_t n = w->nparts;

	if (n == PARTS_MAX) {
		thin(w);
		return part_add(w, p);
	}
	if (n < 2 || !is_straight(&w->part[n - 2], &w->part[n - 1], p))
		return part_add(w, p);
	w->part[n - 1] = *p;
	return 0;
}

static int z_column(const struct interp_program *p)
{
	for (uint32_t j = 0; j < p->head->naxes; j++)
		if (p->head->column[j] == INTERP_Z)
			return (int)j;
	return -1;
}

static double down_mm(const struct interp_program *p, uint32_t i, int z)
{
	const int64_t *node = p->nodes + (size_t)i * p->head->naxes;
	const int64_t sub = z < 0 ? 0 :
			    node[z] - (node + p->head->naxes)[z];

	return sub > 0 ? (double)sub / INTERP_SUB *
			 p->head->pulse_mm[INTERP_Z] : 0;
}

static bool is_eroded(const struct interp_seg *s)
{
	return s->length_mm > 0 && !(s->flags & INTERP_SEG_UNCUT);
}

static void count(const struct interp_program *p, uint32_t i, int z,
		  struct interp_wear_part *at)
{
	const struct interp_seg *s = &p->segs[i];
	const double ratio = s->cond < p->head->nconds ?
		p->conds[s->cond].tech.v[INTERP_TECH_WEAR] : (double)NAN;
	const double mm = down_mm(p, i, z);

	if (isfinite(ratio))
		at->wear_mm += ratio * mm;
	else
		at->unknown_mm += mm;
}

static void change(struct interp_wear *w, const struct interp_seg *s,
		   uint32_t i)
{
	if (w->nchanges < INTERP_ELECTRODES_MAX)
		w->change[w->nchanges++] = (struct interp_wear_change) {
			.s_mm = s->s_mm, .seg = i,
			.number = s->arg & ~INTERP_ELECTRODE_STOP,
			.stops = s->arg & INTERP_ELECTRODE_STOP,
		};
}

int interp_wear_measure(struct interp_wear *w, const struct interp_program *p)
{
	struct interp_wear_part at = { .s_mm = 0 };
	const int z = z_column(p);
	int err;

	*w = (struct interp_wear) { .nparts = 0 };
	err = part_add(w, &at);
	for (uint32_t i = 0; i < p->head->nsegs && err == 0; i++) {
		const struct interp_seg *s = &p->segs[i];

		if (s->kind == INTERP_ELECTRODE)
			change(w, s, i);
		if (is_eroded(s))
			count(p, i, z, &at);
		if (!(s->length_mm > 0))
			continue;
		at.s_mm = s->s_mm + s->length_mm;
		err = part_join(w, &at);
	}
	return err;
}

void interp_wear_free(struct interp_wear *w)
{
	free(w->part);
	*w = (struct interp_wear) { .nparts = 0 };
}

struct interp_wear_part interp_wear_at(const struct interp_wear *w, double s_mm)
{
	size_t low = 0, high = w->nparts;
	struct interp_wear_part ret = { .s_mm = s_mm };
	const struct interp_wear_part *a, *b;
	double share;

	if (w->nparts == 0)
		return ret;
	while (high - low > 1) {
		const size_t mid = low + (high - low) / 2;

		if (w->part[mid].s_mm <= s_mm)
			low = mid;
		else
			high = mid;
	}
	a = &w->part[low];
	b = low + 1 < w->nparts ? a + 1 : a;
	share = b->s_mm > a->s_mm ?
		fmin(fmax((s_mm - a->s_mm) / (b->s_mm - a->s_mm), 0), 1) : 0;
	ret.wear_mm = a->wear_mm + share * (b->wear_mm - a->wear_mm);
	ret.unknown_mm = a->unknown_mm +
			 share * (b->unknown_mm - a->unknown_mm);
	return ret;
}
