/* SPDX-License-Identifier: Apache-2.0 */
/*
 * prove.c - conservative advancement along a block
 */
#include "prove.h"

#include "vec.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* Steps after which a proof is given up; a block takes some dozens. */
#define STEPS_MAX	1000000

/* prove_least(): under the least distance that was seen. */
#define LEAST_KEEP_MM	0.0016
#define LEAST_EPS_MM	0.0008

/* A step of the proof asks for so much more than its own pose does, at most,
 * where the clearance falls. */
#define FALL_MM		0.001

/* -- What is to be kept --------------------------------------------------- */

void clearance_init(struct clearance *c, double mm)
{
	*c = (struct clearance) { .mm = mm, .end_mm = mm };
}

static void place(const struct pose *pose, const double p[3], double ret[3])
{
	rot_apply(&pose->r, p, ret);
	v_add(ret, pose->t, ret);
}

void clearance_end(struct clearance *c, const struct mesh *tool,
		   const struct pose *end, double zone_mm, double end_mm)
{
	c->zone_mm = zone_mm;
	c->end_mm = end_mm;
	for (int i = 0; i < 8; i++) {
		for (int k = 0; k < 3; k++)
			c->corner[i][k] = i >> k & 1 ? tool->max[k] :
						       tool->min[k];
		place(end, c->corner[i], c->end[i]);
	}
}

/* No point of the electrode is farther from its end place than a corner of a box
 * round it. */
static double from_end(const struct clearance *c, const struct pose *pose)
{
	double most = 0;

	for (int i = 0; i < 8; i++) {
		double at[3];

		place(pose, c->corner[i], at);
		most = fmax(most, v_distance(at, c->end[i]));
	}
	return most;
}

double clearance_at(const struct clearance *c, const struct pose *pose,
		    double way_mm)
{
	double far;

	if (!(c->zone_mm > 0))
		return c->mm;
	far = from_end(c, pose) + way_mm;
	if (far >= c->zone_mm)
		return c->mm;
	return c->end_mm + (c->mm - c->end_mm) * far / c->zone_mm;
}

/* The clearance a step from here has to keep, and how long the step may be. */
static double keep_from(const struct clearance *c, const struct block *b,
			const struct pose *pose, double *until)
{
	double far, fall;

	*until = 2;
	if (!(c->zone_mm > 0) || !(b->way_mm > 0))
		return c->mm;
	far = from_end(c, pose);
	if (far - c->zone_mm > b->way_mm)
		return c->mm;
	fall = (c->mm - c->end_mm) / c->zone_mm;
	*until = fmax(far / 8, fall > 0 ? FALL_MM / fall : far) / b->way_mm;
	return clearance_at(c, pose, *until * b->way_mm);
}

/* -- Proofs --------------------------------------------------------------- */

struct march {
	const struct bodies *bodies;
	const struct block *b;
	struct near_step s;
	const struct clearance *clear;	/* NULL: s holds it */
	struct near_pair pair;
	struct proof *p;
	double t;
};

/* As far as goes. Return: true at the end, false where it is too near. */
static bool advance(struct march *m)
{
	for (int i = 0; i < STEPS_MAX && m->t < 1; i++) {
		struct pose_rate rate;
		struct pose pose;
		double x;

		block_pose(m->b, m->t, &pose, &rate);
		m->s.until = 2;
		if (m->clear) {
			m->s.keep_mm = keep_from(m->clear, m->b, &pose,
						 &m->s.until);
			m->s.refuse_mm = m->s.keep_mm + PROVE_EPS_MM;
		}
		m->p->queries++;
		x = near_step(m->bodies, &pose, &rate, &m->s, &m->pair);
		if (!(x > 0))
			return false;
		m->t = m->t + x < 1 ? m->t + x : 1;
	}
	return m->t >= 1;
}

bool prove_block(const struct bodies *bodies, const struct block *b,
		 const struct clearance *c, struct proof *p)
{
	struct march m = { .bodies = bodies, .b = b, .clear = c,
			   .pair = p->pair, .p = p };
	const bool ok = advance(&m);

	p->pair = m.pair;
	if (!ok) {
		p->t = m.t;
		p->least_mm = m.pair.mm;
	}
	return ok;
}

bool prove_refuted(const struct bodies *bodies, const struct block *b,
		   const struct clearance *c, struct proof *p)
{
	/* The middle first: there a block is farthest from the path. */
	static const int order[] = { 8, 4, 12, 16, 6, 10, 2, 14, 7, 9, 5, 11,
				     3, 13, 1, 15 };

	for (unsigned int i = 0; i < sizeof(order) / sizeof(order[0]); i++) {
		const double t = order[i] / 16.0;
		struct pose pose;

		block_pose(b, t, &pose, NULL);
		p->queries++;
		if (!near_below(bodies, &pose, clearance_at(c, &pose, 0),
				&p->pair))
			continue;
		p->t = t;
		p->least_mm = p->pair.mm;
		return true;
	}
	return false;
}

static double see(struct march *m, double t)
{
	struct pose pose;
	double d;

	block_pose(m->b, t, &pose, NULL);
	m->p->queries++;
	d = near_distance(m->bodies, &pose, &m->pair);
	if (d < m->p->least_mm) {
		m->p->least_mm = d;
		m->p->t = t;
		m->p->pair = m->pair;
	}
	return d;
}

/* Down to the bottom of the valley round @t, so that the proof does not meet
 * every point of the slope. */
static void descend(struct march *m, double t)
{
	double h = 1.0 / 32;

	while (h > 1e-7 && m->p->least_mm > 0) {
		const double at = t;

		for (int side = -1; side <= 1; side += 2) {
			const double to = fmin(fmax(at + side * h, 0), 1);
			const double was = m->p->least_mm;

			if (to != at && see(m, to) < was)
				t = to;
		}
		if (t == at)
			h /= 2;
	}
}

double prove_least(const struct bodies *bodies, const struct block *b,
		   struct proof *p)
{
	struct march m = { .bodies = bodies, .b = b, .pair = p->pair, .p = p };

	p->least_mm = DBL_MAX;
	for (int i = 0; i <= 8; i++)
		see(&m, i / 8.0);
	descend(&m, p->t);
	while (m.t < 1) {
		if (p->least_mm <= LEAST_KEEP_MM)
			return -1;
		m.s.keep_mm = p->least_mm - LEAST_KEEP_MM;
		m.s.refuse_mm = m.s.keep_mm + LEAST_EPS_MM;
		if (advance(&m))
			break;
		if (!(m.pair.mm < m.s.refuse_mm))
			return -1;	/* given up */
		see(&m, m.t);
		descend(&m, m.t);
	}
	return m.s.keep_mm;
}
