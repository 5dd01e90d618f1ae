/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_block.c - a finished program as one flat block
 *
 * Most of a program are its segments.  So the memory of their table becomes
 * the block, and only the other tables are copied.
 */

#include "path/builder.h"
#include "interp/limits.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool ends(const struct interp_build *b)
{
	const struct interp_seg *s = b->segs.at;

	return s[b->segs.n - 1].kind == INTERP_END;
}

static struct interp_program_head layout(const struct interp_build *b)
{
	const size_t nsegs = b->segs.n + !ends(b);
	struct interp_program_head h = {
		.magic = INTERP_PROGRAM_MAGIC,
		.version = INTERP_PROGRAM_VERSION,
		.head_bytes = sizeof(h),
		.nsegs = (uint32_t)nsegs,
		.narcs = (uint32_t)b->arcs.n,
		.nconds = (uint32_t)b->conds.n,
		.nescapes = b->escapes.n,
		.ncouples = b->couples.n,
		.nbits = b->bits.n,
		.ncurves = b->curves.n,
		.npieces = b->pieces.n,
		.nstops = b->stops.n,
		.nnumbers = b->numbers.n,
		.norigins = b->origins.n,
		.naxes = b->naxes,
		.strategy = b->o.strategy,
		.tolerance_milli = b->o.tolerance_milli,
		.perpendicular = b->o.perpendicular,
		.coupling = b->o.coupling,
		.nruns = (uint32_t)b->runs.n,
		.length_mm = b->length_mm,
	};

	h.segs_at = BUILD_SEGS_AT;
	h.nodes_at = h.segs_at + nsegs * b->segs.size;
	h.arcs_at = h.nodes_at + (nsegs + 1) * b->naxes * b->nodes.size;
	h.conds_at = h.arcs_at + b->arcs.n * b->arcs.size;
	h.escapes_at = h.conds_at + b->conds.n * b->conds.size;
	h.couples_at = h.escapes_at + b->escapes.n * b->escapes.size;
	h.bits_at = h.couples_at + b->couples.n * b->couples.size;
	h.curves_at = h.bits_at + b->bits.n * b->bits.size;
	h.pieces_at = h.curves_at + b->curves.n * b->curves.size;
	h.stops_at = h.pieces_at + b->pieces.n * b->pieces.size;
	h.numbers_at = h.stops_at + b->stops.n * b->stops.size;
	h.origins_at = h.numbers_at + b->numbers.n * b->numbers.size;
	h.runs_at = h.origins_at + b->origins.n * b->origins.size;
	h.bytes = h.runs_at + b->runs.n * b->runs.size;
	return h;
}

size_t interp_build_bytes(const struct interp_build *b)
{
	return layout(b).bytes;
}

/* -- Tables ---------------------------------------------------------------- */

/* The table's memory is freed at once, so a large program is in memory only
 * once. */
static void move_table(char *to, struct table *t)
{
	if (t->n > 0)
		memcpy(to, t->at, t->n * t->size);
	build_table_free(t);
}

static void write_head(const struct interp_build *b,
		       struct interp_program_head *h,
		       const struct interp_build_about *about)
{
	memcpy(h->column, b->column, sizeof(h->column));
	for (int i = 0; i < INTERP_NAXES; i++) {
		h->pulse_mm[i] = b->o.machine->axis[i].pulse_mm;
		h->start_pulses[i] = interp_round_sub(b->first[i]);
	}
	h->probed = b->probed;
	h->depth = b->depth;
	h->lines = about->lines;
	memcpy(h->hash, about->hash, sizeof(h->hash));
	snprintf(h->name, sizeof(h->name), "%s",
		 about->name ? about->name : "");
}

/* Node 0 comes with the first column.  The END has a node of its own. */
static void write_nodes(struct interp_build *b, size_t rows,
			const struct interp_program_head *h, int64_t *nodes)
{
	move_table((char *)nodes, &b->nodes);
	for (size_t i = rows; i <= h->nsegs; i++) {
		for (uint32_t j = 0; j < b->naxes; j++)
			nodes[i * b->naxes + j] = b->here[b->column[j]];
	}
}

/* All but the segments, which are there. */
static void write_tables(struct interp_build *b,
			 const struct interp_program_head *h, char *base)
{
	move_table(base + h->arcs_at, &b->arcs);
	move_table(base + h->conds_at, &b->conds);
	move_table(base + h->escapes_at, &b->escapes);
	move_table(base + h->couples_at, &b->couples);
	move_table(base + h->bits_at, &b->bits);
	move_table(base + h->curves_at, &b->curves);
	move_table(base + h->pieces_at, &b->pieces);
	move_table(base + h->stops_at, &b->stops);
	move_table(base + h->numbers_at, &b->numbers);
	move_table(base + h->origins_at, &b->origins);
	move_table(base + h->runs_at, &b->runs);
}

static struct interp_limits limits_of(const struct interp_build *b)
{
	const struct interp_build_options *o = &b->o;

	return (struct interp_limits) {
		.machine = o->machine,
		.corner_mm = o->corner_mm > 0 ? o->corner_mm :
						INTERP_CORNER_MM,
		.tolerance_mm = o->tolerance_mm > 0 ? o->tolerance_mm :
						      INTERP_TOLERANCE_MM,
		.rotary_radius_mm = o->rotary_radius_mm > 0 ?
				    o->rotary_radius_mm : INTERP_ROTARY_MM,
		.points_per_s = o->points_per_s > 0 ? o->points_per_s :
						      INFINITY,
	};
}

void *interp_build_take(struct interp_build *b,
			const struct interp_build_about *about,
			size_t *ret_bytes)
{
	struct interp_program_head h = layout(b);
	const size_t n = b->segs.n;
	const bool ended = ends(b);
	const struct interp_limits l = limits_of(b);
	struct interp_program p;
	struct interp_seg *segs;
	char *base;

	write_head(b, &h, about);
	if (build_table_size(&b->segs, h.bytes) < 0)
		return NULL;
	segs = b->segs.at;
	base = (char *)segs - h.segs_at;
	b->segs.at = NULL;
	memcpy(base, &h, sizeof(h));
	write_nodes(b, n + 1, &h, (void *)(base + h.nodes_at));
	if (!ended) {
		segs[n] = (struct interp_seg) {
			.kind = INTERP_END, .s_mm = b->length_mm,
			.line = segs[n - 1].line, .cond = b->cond,
		};
	}
	write_tables(b, &h, base);
	if (interp_program_map(&p, base, h.bytes) == 0 &&
	    interp_limits_write(&l, &p, segs) < 0) {
		if (!b->o.memory)
			free(base);
		return NULL;
	}
	*ret_bytes = h.bytes;
	return base;
}
