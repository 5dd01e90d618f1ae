/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lifts.c - lifts that leave the path, from all of its places at once
 *
 * A lift goes along up to three legs, which are straight in the axes.  Lifts
 * from two places of the path that are near each other are near each other all
 * along: at the same share of the same leg no axis is farther off than at the
 * beginning.  So the legs from the middle of a piece are proved, with a
 * clearance that is larger by as much as the piece needs.  Where that fails,
 * both halves of the piece are looked at, down to pieces of SMALL_MM.
 */
#include "lifts.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#define SMALL_MM	0.002
#define LEGS		3

struct lifting {
	const struct job *j;
	const struct route *w;
	const struct clearance *c;
	const struct route_lift *lift;
	struct check_result *ret;
	struct near_pair pair;
};

/* Some of the path, up to node @node.  In each axis it is no farther from @q
 * than @wide, and a lift from it no farther than @wide + @strays. */
struct piece {
	double q[INTERP_NAXES], wide[INTERP_NAXES], strays[INTERP_NAXES];
	uint32_t node;
};

static const uint32_t linear = 1u << INTERP_X | 1u << INTERP_Y |
			       1u << INTERP_Z | 1u << INTERP_U | 1u << INTERP_V;

/* -- Legs ----------------------------------------------------------------- */

static bool rises_along(const struct interp_escape *x, int axis)
{
	return (x->out & linear) == 1u << axis;
}

/*
 * The share of the way to out_mm that the rise takes, from the middle of a
 * piece.  The cycle measures the way by the linear axes, and there is but one
 * among them.  @spread: by how much it differs over the piece.
 */
static double rise_share(const struct interp_escape *x, const double q[],
			 const double off[], double *spread)
{
	double least, most;

	*spread = 0;
	if (!(x->rise_mm > 0))
		return 0;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double way = fabs(x->out_mm[i] - q[i]);

		if (!rises_along(x, i))
			continue;
		least = fmin(x->rise_mm / (way + off[i]), 1);
		most = way > off[i] ? fmin(x->rise_mm / (way - off[i]), 1) : 1;
		*spread = most - least;
		return least;
	}
	*spread = 1;
	return 0;
}

/* Move the axes in @axes toward @mm. */
static void leg_to(const double from[INTERP_NAXES], uint32_t axes,
		   const double mm[INTERP_NAXES], double share,
		   double to[INTERP_NAXES])
{
	memcpy(to, from, INTERP_NAXES * sizeof(*to));
	for (int i = 0; i < INTERP_NAXES; i++)
		if (axes & 1u << i)
			to[i] += share * (mm[i] - from[i]);
}

/*
 * The ends of the legs from the middle of a piece; @at[0] is where the first
 * begins.  @off: how far lifts from elsewhere on the piece begin from it; on
 * return how far they may be from these legs anywhere.  The axis that the rise
 * is along rises by rise_mm, or to its end, so it gets no farther off.
 */
static void legs(const struct interp_escape *x, const double q[],
		 double at[LEGS + 1][INTERP_NAXES], double off[INTERP_NAXES])
{
	double spread;
	const double share = rise_share(x, q, off, &spread);

	memcpy(at[0], q, sizeof(at[0]));
	leg_to(at[0], x->out, x->out_mm, share, at[1]);
	leg_to(at[1], x->home, x->home_mm, 1, at[2]);
	leg_to(at[2], x->out, x->out_mm, 1, at[3]);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (x->out & 1u << i && !rises_along(x, i))
			off[i] += spread * (fabs(x->out_mm[i] - q[i]) + off[i]);
}

/* -- One piece ------------------------------------------------------------ */

/* How far any point may be from the leg @from @to, if the axes are off by @off;
 * and what the clearance may rise by on that way. */
static double strays_mm(const struct lifting *l,
			const double from[INTERP_NAXES],
			const double to[INTERP_NAXES],
			const double off[INTERP_NAXES])
{
	const struct machine_motion *m = &l->j->motion;
	const double corner = fmax(m->corner_mm - m->ball_r_mm, 0);
	double low[INTERP_NAXES], high[INTERP_NAXES], mm, turn = 0;
	struct block wide;

	for (int i = 0; i < INTERP_NAXES; i++) {
		low[i] = fmin(from[i], to[i]) - off[i];
		high[i] = fmax(from[i], to[i]) + off[i];
		if (interp_axis_is_rotary((enum interp_axis)i))
			turn += off[i] * PLAN_RADIAN;
	}
	block_init(&wide, m, low, high);
	mm = motion_strays_mm(&wide, off);
	if (!(l->c->zone_mm > 0))
		return mm;
	return mm + (mm + turn * corner) *
		    fmax(l->c->mm - l->c->end_mm, 0) / l->c->zone_mm;
}

static void contact(struct lifting *l, const struct piece *p,
		    const struct block *b, const struct proof *proof,
		    const struct clearance *c)
{
	struct check_result *r = l->ret;
	struct pose pose;

	r->ok = false;
	r->lift = true;
	r->given_up = proof->given_up;
	r->block = p->node > 0 ? p->node - 1 : 0;
	r->t = proof->t;
	r->pair = proof->pair;
	block_at(b, proof->t, r->q);
	block_pose(b, proof->t, &pose, NULL);
	r->wanted_mm = clearance_at(c, &pose);
}

/* What is added to the clearance on the leg @i for a piece.  Return: is most of
 * it there for the smallest piece too? */
static bool added(struct lifting *l, const struct piece *p, int i, double *mm)
{
	double at[LEGS + 1][INTERP_NAXES], off[INTERP_NAXES], least;

	memcpy(off, p->strays, sizeof(off));
	legs(&l->lift->way, p->q, at, off);
	least = strays_mm(l, at[i], at[i + 1], off);
	l->ret->most_added_mm = fmax(l->ret->most_added_mm, least);
	for (int k = 0; k < INTERP_NAXES; k++)
		off[k] = p->wide[k] + p->strays[k];
	legs(&l->lift->way, p->q, at, off);
	*mm = strays_mm(l, at[i], at[i + 1], off);
	return *mm < least + SMALL_MM;
}

/* Does leg @i from all of @p keep the clearance?  If not, and @p is small, the
 * first contact is noted. */
static bool leg_keeps(struct lifting *l, const struct piece *p, int i,
		      const double from[INTERP_NAXES],
		      const double to[INTERP_NAXES])
{
	struct proof proof = { .least_mm = DBL_MAX, .pair = l->pair };
	struct clearance c = *l->c;
	struct block b;
	double mm;
	bool small, ok;

	small = added(l, p, i, &mm);
	c.mm += mm + l->j->chord_mm;
	c.end_mm += mm + l->j->chord_mm;
	block_init(&b, &l->j->motion, from, to);
	ok = (small || !prove_refuted(&l->j->bodies, &b, &c, &proof)) &&
	     prove_block(&l->j->bodies, &b, &c, &proof);
	l->ret->queries += proof.queries;
	l->pair = proof.pair;
	if (!ok && small)
		contact(l, p, &b, &proof, &c);
	return ok;
}

static bool keeps(struct lifting *l, const struct piece *p)
{
	double at[LEGS + 1][INTERP_NAXES], off[INTERP_NAXES] = { 0 };

	legs(&l->lift->way, p->q, at, off);
	for (int i = 0; i < LEGS; i++)
		if (memcmp(at[i], at[i + 1], sizeof(at[i])) != 0 &&
		    !leg_keeps(l, p, i, at[i], at[i + 1]))
			return false;
	return true;
}

/* -- All of the path ------------------------------------------------------ */

/* A lift begins at a point of the lattice, and each leg is rounded to points of
 * it: that is a pulse more, at most twice the path's own. */
static void add_strays(const struct route *w, struct piece *p, double strays)
{
	for (int k = 0; k < INTERP_NAXES; k++)
		p->strays[k] = fmax(p->strays[k], strays + 3 * w->lattice[k]);
}

/* The path from node @a to @b, round its middle node. */
static void piece_of(const struct route *w, uint32_t a, uint32_t b,
		     struct piece *p)
{
	const double *mid = w->node[(a + b) / 2].q;

	*p = (struct piece) { .node = b };
	memcpy(p->q, mid, sizeof(p->q));
	for (uint32_t i = a; i <= b; i++) {
		add_strays(w, p, (double)w->node[i].strays);
		for (int k = 0; k < INTERP_NAXES; k++)
			p->wide[k] = fmax(p->wide[k],
					  fabs(w->node[i].q[k] - mid[k]));
	}
}

/* From share @from to share @to of the block to @node. */
static bool part_keeps(struct lifting *l, uint32_t node, double from, double to)
{
	const double *a = l->w->node[node - 1].q, *b = l->w->node[node].q;
	const double mid = (from + to) / 2;
	struct piece p = { .node = node };

	add_strays(l->w, &p, (double)l->w->node[node].strays);
	for (int k = 0; k < INTERP_NAXES; k++) {
		p.q[k] = a[k] + mid * (b[k] - a[k]);
		p.wide[k] = (to - from) / 2 * fabs(b[k] - a[k]);
	}
	if (keeps(l, &p))
		return true;
	return l->ret->ok && !bar_interrupted() &&
	       part_keeps(l, node, from, mid) && part_keeps(l, node, mid, to);
}

static void show(const struct lifting *l, uint32_t node)
{
	char text[100];

	snprintf(text, sizeof(text), "proof: lifts beside the path, block %u "
		 "of %u", node, l->w->n - 1);
	bar_show(l->j, (double)node / l->w->n, text);
}

/* From node @a to @b. */
static bool range_keeps(struct lifting *l, uint32_t a, uint32_t b)
{
	const uint32_t mid = (a + b) / 2;
	struct piece p;

	show(l, b);
	if (b == a + 1)
		return part_keeps(l, b, 0, 1);
	piece_of(l->w, a, b, &p);
	if (keeps(l, &p))
		return true;
	return b > a && l->ret->ok && !bar_interrupted() &&
	       range_keeps(l, a, mid) && range_keeps(l, mid, b);
}

int lifts_check(const struct job *j, const struct route *w,
		const struct clearance *c, struct check_result *ret)
{
	struct lifting l = { .j = j, .w = w, .c = c, .ret = ret };

	for (uint32_t i = 0; i < w->nlifts && ret->ok; i++) {
		l.lift = &w->lift[i];
		range_keeps(&l, l.lift->first, l.lift->last);
		if (bar_interrupted())
			return -EINTR;
	}
	return 0;
}
