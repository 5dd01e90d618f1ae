/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way.h - a program as a row of poses with straight blocks between them
 *
 * The poses are those of the compiled program, as rounded as the machine has
 * them.  Arcs and curves become short blocks; how far the axes stray from those
 * is bounded, not sampled, and kept with each.
 *
 * Units: mm, and degrees of a rotary axis; machine coordinates.
 * Threads: one at a time.
 */
#ifndef PLAN_WAY_H
#define PLAN_WAY_H

#include "config.h"

#include "interp/program.h"

struct way_node {
	double q[INTERP_NAXES];
	uint32_t line;			/* of the block that leads here */
	float feed_mm_s;		/* F on it, as the path's length counts */
	float strays;			/* mm, and degrees: of any axis on it */
	bool rapid;			/* it is positioned, not eroded */
};

struct way {
	struct way_node *node;		/* block i leads from node[i] to
					 * node[i + 1] */
	uint32_t n, room;
	double lattice[INTERP_NAXES];	/* how far the pulses stray from it */
	uint32_t lines;			/* of the text */
	uint32_t beside;		/* segments that leave beside the path */
	uint32_t beside_line;		/* the first of them */
};

/** way_free() - a zeroed one is fine. */
void way_free(struct way *w);

/** way_add() - Return: 0 or -ENOMEM. */
int way_add(struct way *w, const struct way_node *node);

/** way_lattice() - how far the machine's pulses stray from a straight block. */
void way_lattice(const struct machine_config *c, double ret[INTERP_NAXES]);

struct way_text {
	const char *path;		/* as messages name it; - is stdin */
	const char *text;		/* NULL: read it from there */
	const char *dialect;		/* NULL: by the file's name */
	const double *start;		/* of all axes; NULL: the machine
					 * file's start_mm */
};

/**
 * way_read() - compile a program and follow it.
 *
 * Refused: words that the readers do not know, motion that is not that of one
 * rigid electrode (guides of a wire), and moves that end at a contact.
 * Return: 0; else a sysexits code, and the reason is on stderr.
 */
int way_read(struct way *w, const struct machine_config *c,
	     const struct way_text *from);

#endif /* PLAN_WAY_H */
