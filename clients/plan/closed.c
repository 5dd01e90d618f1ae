/* SPDX-License-Identifier: Apache-2.0 */
/*
 * closed.c - a proof that no way leads out of a cavity
 *
 * A way may pass from a cube to any of the 26 beside it, through an edge or a
 * corner too.
 */
#include "closed.h"

#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HALF_DIAGONAL	(sqrt(3) / 2)	/* of a cube of side 1 */
#define SHARE		0.45		/* of the clearance, half a diagonal */

struct cell {
	int32_t at[3];
};

struct flood {
	const struct job *j;
	const struct clearance *c;
	const double *end;
	double side_mm;
	struct cell *cell;		/* all that are known, in the order in
					 * which they were reached */
	uint32_t n;
	size_t room;
	uint32_t *table;		/* numbers of cells + 1, by hash */
	size_t size;			/* a power of 2 */
	struct near_pair pair;
};

/* Only X, Y and Z move a body by as much as they move themselves, each square
 * to the others. */
static bool are_straight(const struct job *j)
{
	const uint32_t moves = motion_moves(&j->motion) &
			       j->config.axes.present;

	return !(moves & ~(1u << INTERP_X | 1u << INTERP_Y | 1u << INTERP_Z));
}

static size_t hash(const struct flood *f, const struct cell *c)
{
	uint64_t h = 0;

	for (int k = 0; k < 3; k++)
		h = (h ^ (uint32_t)c->at[k]) * 0x9e3779b97f4a7c15ull;
	return (size_t)(h >> 20) & (f->size - 1);
}

/* Where it stands in the table, or the free place for it. */
static size_t find(const struct flood *f, const struct cell *c)
{
	size_t i = hash(f, c);

	while (f->table[i] &&
	       memcmp(&f->cell[f->table[i] - 1], c, sizeof(*c)) != 0)
		i = (i + 1) & (f->size - 1);
	return i;
}

static int add(struct flood *f, const struct cell *c)
{
	const size_t i = find(f, c);

	if (f->table[i])
		return 0;
	if (f->n == f->room && grow_array(&f->cell, &f->room, sizeof(*c)))
		return -ENOMEM;
	f->cell[f->n++] = *c;
	f->table[i] = f->n;
	return 0;
}

static int add_beside(struct flood *f, struct cell c)
{
	for (int k = 0; k < 27; k++) {
		const struct cell next = { {
			c.at[0] + k % 3 - 1,
			c.at[1] + k / 3 % 3 - 1,
			c.at[2] + k / 9 - 1,
		} };

		if (add(f, &next))
			return -ENOMEM;
	}
	return 0;
}

static void middle(const struct flood *f, const struct cell *c,
		   double q[INTERP_NAXES])
{
	memcpy(q, f->end, INTERP_NAXES * sizeof(*q));
	for (int k = 0; k < 3; k++)
		q[INTERP_X + k] += f->side_mm * c->at[k];
}

static bool in_travel(const struct flood *f, const double q[INTERP_NAXES])
{
	const uint32_t moves = motion_moves(&f->j->motion) &
			       f->j->config.axes.present;

	for (int k = INTERP_X; k <= INTERP_Z; k++) {
		const struct interp_axis_limits *a = &f->j->config.axes.axis[k];
		const bool moved = moves & 1u << k;

		if (q[k] < (moved ? a->travel_min_mm : f->end[k]) -
			   f->side_mm / 2 ||
		    q[k] > (moved ? a->travel_max_mm : f->end[k]) +
			   f->side_mm / 2)
			return false;
	}
	return true;
}

/* May a pose in the cube keep the clearance? */
static bool may_pass(struct flood *f, const double q[INTERP_NAXES])
{
	const double half = f->side_mm * HALF_DIAGONAL;
	const struct clearance *c = f->c;
	double keep = half * (c->zone_mm > 0 ?
			      1 + (c->mm - c->end_mm) / c->zone_mm : 1);
	struct pose pose;

	if (!in_travel(f, q))
		return false;
	motion_pose(&f->j->motion, q, &pose);
	keep = clearance_at(c, &pose) + f->j->chord_mm - keep;
	return keep <= 0 || !near_below(&f->j->bodies, &pose, keep, &f->pair);
}

/* Does the machine stand in the cube, wherever that is? */
static bool is_start(const struct flood *f, const double q[INTERP_NAXES])
{
	for (int k = INTERP_X; k <= INTERP_Z; k++)
		if (fabs(q[k] - f->j->config.start_mm[k]) > f->side_mm / 2)
			return false;
	return true;
}

static void show(const struct flood *f, uint32_t looked, uint32_t most)
{
	char text[80];

	snprintf(text, sizeof(text), "is the cavity closed? %u places", looked);
	bar_show(f->j, (double)looked / most, text);
}

/* Return: 1: closed; 0: not decided; -ENOMEM. */
static int fill(struct flood *f, uint32_t most)
{
	for (uint32_t i = 0; i < f->n; i++) {
		double q[INTERP_NAXES];

		if (i == most || 2 * f->n > f->size || bar_interrupted())
			return 0;
		if (i % 256 == 0)
			show(f, i, most);
		middle(f, &f->cell[i], q);
		if (i > 0 && !may_pass(f, q))
			continue;
		if (outward_is_out(f->j, q) || is_start(f, q))
			return 0;
		if (add_beside(f, f->cell[i]))
			return -ENOMEM;
	}
	return 1;
}

int closed_prove(const struct job *j, const struct clearance *c,
		 const double end[INTERP_NAXES], uint32_t cells)
{
	struct flood f = { .j = j, .c = c, .end = end, .size = 1 };
	const struct cell first = { { 0, 0, 0 } };
	int rc;

	f.side_mm = (c->mm + j->chord_mm) * SHARE / HALF_DIAGONAL;
	if (!are_straight(j) || !(f.side_mm > 0))
		return 0;
	/* Of those that are known most are not looked at. */
	while (f.size < 16 * (size_t)cells)
		f.size *= 2;
	f.table = calloc(f.size, sizeof(*f.table));
	rc = f.table && add(&f, &first) == 0 ? fill(&f, cells) : -ENOMEM;
	free(f.table);
	free(f.cell);
	return rc;
}
