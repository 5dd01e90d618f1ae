/* SPDX-License-Identifier: Apache-2.0 */
/* sim_map.c - what a step of an electrode meets: it counts cells */
#include "sim_map.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define NM_PER_MM	1e6
#define DEEPEST_NM	1e9		/* a difference is within int32_t */
#define FRESH		INT32_MAX	/* depth of a cell without electrode */
#define PROBES		4		/* blocks that one may be kept in */
#define STEPS_PER_CELL	4
#define WINDOW_CELLS	2		/* of the mean */
#define FRESH_MORE	1.1		/* so that a cut into fresh ground is
					 * never counted as less than that */

void sim_map_init(struct sim_map *m, double area_mm2, unsigned int across)
{
	m->radius_mm = sqrt(area_mm2 / M_PI);
	m->cell_mm = 2 * m->radius_mm / across;
	sim_map_clear(m);
}

void sim_map_clear(struct sim_map *m)
{
	/* A key keeps 16 bits of it: an old ground must not come back. */
	if (++m->ground >= SIM_MAP_GROUNDS) {
		memset(m->block, 0, sizeof(m->block));
		m->ground = 1;
	}
	sim_map_lift(m);
}

void sim_map_lift(struct sim_map *m)
{
	m->placed = false;
	m->known = false;
	m->share = 1;
}

double sim_map_step_mm(const struct sim_map *m)
{
	return m->cell_mm / STEPS_PER_CELL;
}

static uint64_t key_of(const struct sim_map *m, int64_t column, int64_t row)
{
	const uint64_t x = (uint64_t)(column / SIM_MAP_SIDE) & 0xffffff;
	const uint64_t y = (uint64_t)(row / SIM_MAP_SIDE) & 0xffffff;

	return (uint64_t)m->ground << 48 | x << 24 | y;
}

/* The block of a cell; the first of its probes is given up if all are taken. */
static struct sim_map_block *block_of(struct sim_map *m, int64_t column,
				      int64_t row)
{
	const uint64_t key = key_of(m, column, row);
	const uint32_t at = (uint32_t)(key * 0x9e3779b97f4a7c15u >> 40);
	struct sim_map_block *b, *free = NULL;

	for (uint32_t i = 0; i < PROBES; i++) {
		b = &m->block[(at + i) & (SIM_MAP_BLOCKS - 1)];
		if (b->key == key)
			return b;
		if (!free && b->key >> 48 != m->ground)
			free = b;
	}
	b = free ? free : &m->block[at & (SIM_MAP_BLOCKS - 1)];
	b->key = key;
	for (int i = 0; i < SIM_MAP_SIDE * SIM_MAP_SIDE; i++)
		b->depth_nm[i / SIM_MAP_SIDE][i % SIM_MAP_SIDE] = FRESH;
	return b;
}

/* Return: how much lay above the electrode's end, mm. */
static double lower(const struct sim_map *m, int32_t *depth_nm, int32_t end_nm)
{
	const int32_t was_nm = *depth_nm;

	if (was_nm <= end_nm)
		return 0;
	*depth_nm = end_nm;
	return was_nm == FRESH ? FRESH_MORE * M_PI_2 * m->radius_mm :
				 (was_nm - end_nm) / NM_PER_MM;
}

/* The cells @first ... @last of a row.  Return: the sum of their heights. */
static double lower_row(struct sim_map *m, int64_t row, int64_t first,
			int64_t last, int32_t end_nm)
{
	const int64_t y = row & (SIM_MAP_SIDE - 1);
	struct sim_map_block *b = NULL;
	double height = 0;

	for (int64_t i = first; i <= last; i++) {
		const int64_t x = i & (SIM_MAP_SIDE - 1);

		if (!b || x == 0)
			b = block_of(m, i, row);
		height += lower(m, &b->depth_nm[y][x], end_nm);
	}
	return height;
}

/* Return: the mean height of what lay above the electrode's end, mm. */
static double cover(struct sim_map *m, const double at_mm[3])
{
	/* Far from 0, so that rounding down is rounding toward 0. */
	const double x = at_mm[0] / m->cell_mm + (1 << 30);
	const double y = at_mm[1] / m->cell_mm + (1 << 30);
	const double r = m->radius_mm / m->cell_mm;
	const int32_t end_nm = (int32_t)lrint(fmin(DEEPEST_NM,
				fmax(-DEEPEST_NM, at_mm[2] * NM_PER_MM)));
	double height = 0;
	int64_t n = 0;

	for (int64_t row = (int64_t)ceil(y - r); (double)row <= y + r; row++) {
		const double dy = (double)row - y;
		const double half = sqrt(fmax(0, r * r - dy * dy));
		const int64_t first = (int64_t)ceil(x - half);
		const int64_t last = (int64_t)floor(x + half);

		height += lower_row(m, row, first, last, end_nm);
		n += last - first + 1;
	}
	return n ? height / (double)n : 0;
}

static double across_mm(const struct sim_map *m, const double at_mm[3])
{
	return hypot(at_mm[0] - m->at_mm[0], at_mm[1] - m->at_mm[1]);
}

/* Across the grid, cells are met now and then: a mean over some of them counts.
 * Down it, each step meets all cells below, and counts as it is. */
static void count(struct sim_map *m, double across, double way, double height)
{
	const double now = height / way;
	const double keep = m->known ?
		exp(-way / (WINDOW_CELLS * m->cell_mm)) : 0;

	m->mean = keep * m->mean + (1 - keep) * now;
	m->known = true;
	m->share = fmin(1, now + (m->mean - now) * across / way);
}

double sim_map_cut(struct sim_map *m, const double at_mm[3])
{
	const double across = m->placed ? across_mm(m, at_mm) : 0;
	const double way = m->placed ?
			   hypot(across, at_mm[2] - m->at_mm[2]) : 0;
	const double height = cover(m, at_mm);

	for (int i = 0; i < 3; i++)
		m->at_mm[i] = at_mm[i];
	if (way > 0)
		count(m, across, way, height);
	m->placed = true;
	return m->share;
}
