/* SPDX-License-Identifier: Apache-2.0 */
/*
 * grid.c - which curves of many are near a place
 */
#include "wire/grid.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* A cell's number: its row above its column, each moved to be positive. */
#define BIAS	((int64_t)1 << 31)

static uint64_t cell_of(int64_t col, int64_t row)
{
	return (uint64_t)(row + BIAS) << 32 | (uint64_t)(col + BIAS);
}

struct span {
	int64_t col[2], row[2];
};

static int64_t index_of(const struct grid *g, double mm)
{
	return (int64_t)floor(mm / g->cell_mm);
}

static struct span span_of(const struct grid *g, const struct curve *c,
			   double reach)
{
	const struct curve_box b = curve_bounds(c);

	return (struct span) {
		{ index_of(g, b.lo.x - g->origin.x - reach),
		  index_of(g, b.hi.x - g->origin.x + reach) },
		{ index_of(g, b.lo.y - g->origin.y - reach),
		  index_of(g, b.hi.y - g->origin.y + reach) },
	};
}

/* Long curves are cut, so that their boxes hold few cells beside them. */
static uint32_t parts_of(const struct grid *g, const struct curve *c)
{
	return (uint32_t)curve_min(floor(curve_length(c) / g->cell_mm), 1e6) +
	       1;
}

static struct curve part_of(const struct curve *c, uint32_t i, uint32_t n)
{
	return n == 1 ? *c : curve_part(c, (double)i / n, (i + 1.0) / n);
}

void grid_init(struct grid *g, double cell_mm, struct vec origin)
{
	*g = (struct grid) { .cell_mm = cell_mm, .origin = origin };
}

void grid_free(struct grid *g)
{
	free(g->entry);
	*g = (struct grid) { .cell_mm = 0 };
}

static int enter(struct grid *g, uint64_t cell, uint32_t id)
{
	if (g->n == g->room &&
	    grow_array(&g->entry, &g->room, sizeof(*g->entry)))
		return -ENOMEM;
	g->entry[g->n++] = (struct grid_entry) { cell, id };
	return 0;
}

int grid_add(struct grid *g, const struct curve *c, uint32_t id)
{
	const uint32_t n = parts_of(g, c);
	int err = 0;

	for (uint32_t i = 0; i < n; i++) {
		const struct curve part = part_of(c, i, n);
		const struct span s = span_of(g, &part, 0);

		for (int64_t y = s.row[0]; !err && y <= s.row[1]; y++) {
			for (int64_t x = s.col[0]; !err && x <= s.col[1]; x++)
				err = enter(g, cell_of(x, y), id);
		}
	}
	return err;
}

static int by_cell(const void *a, const void *b)
{
	const struct grid_entry *p = a, *q = b;

	if (p->cell != q->cell)
		return p->cell < q->cell ? -1 : 1;
	return p->id < q->id ? -1 : p->id > q->id;
}

void grid_sort(struct grid *g)
{
	size_t kept = 0;

	if (!g->n)
		return;
	qsort(g->entry, g->n, sizeof(*g->entry), by_cell);
	for (size_t i = 1; i < g->n; i++) {
		if (by_cell(&g->entry[kept], &g->entry[i]) != 0)
			g->entry[++kept] = g->entry[i];
	}
	g->n = kept + 1;
}

/* The first entry of @cell or of a later one. */
static size_t find(const struct grid *g, uint64_t cell)
{
	size_t lo = 0, hi = g->n;

	while (lo < hi) {
		const size_t mid = lo + (hi - lo) / 2;

		if (g->entry[mid].cell < cell)
			lo = mid + 1;
		else
			hi = mid;
	}
	return lo;
}

/* The cells of a row lie one behind the other. */
static bool visit_row(const struct grid *g, const struct span *s, int64_t row,
		      bool (*visit)(void *arg, uint32_t id), void *arg)
{
	const uint64_t last = cell_of(s->col[1], row);

	for (size_t i = find(g, cell_of(s->col[0], row));
	     i < g->n && g->entry[i].cell <= last; i++) {
		if (!visit(arg, g->entry[i].id))
			return false;
	}
	return true;
}

void grid_near(const struct grid *g, const struct curve *c, double reach,
	       bool (*visit)(void *arg, uint32_t id), void *arg)
{
	const uint32_t n = parts_of(g, c);

	for (uint32_t i = 0; i < n; i++) {
		const struct curve part = part_of(c, i, n);
		const struct span s = span_of(g, &part, reach);

		for (int64_t y = s.row[0]; y <= s.row[1]; y++) {
			if (!visit_row(g, &s, y, visit, arg))
				return;
		}
	}
}

int grid_pairs(const struct grid *g,
	       int (*visit)(void *arg, uint32_t a, uint32_t b), void *arg)
{
	for (size_t i = 0; i < g->n; i++) {
		const struct grid_entry *e = &g->entry[i];

		for (size_t j = i + 1; j < g->n &&
		     g->entry[j].cell == e->cell; j++) {
			const int err = visit(arg, e->id, g->entry[j].id);

			if (err)
				return err;
		}
	}
	return 0;
}
