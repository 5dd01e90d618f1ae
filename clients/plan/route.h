/* SPDX-License-Identifier: Apache-2.0 */
/*
 * route.h - a program as a row of poses with straight blocks between them
 *
 * The poses are those of the compiled program, rounded as on the machine.
 * Arcs and curves become short blocks.  Each block has a bound, not a sample,
 * of how far the axes stray from it.
 *
 * Units: mm, and degrees of a rotary axis; machine coordinates.
 * Threads: one at a time.
 */
#ifndef PLAN_ROUTE_H
#define PLAN_ROUTE_H

#include "config.h"

#include "interp/program.h"

struct route_node {
	double q[INTERP_NAXES];
	uint32_t line;			/* of the block that leads here */
	float feed_mm_s;		/* F, by the length of the path */
	float strays;			/* how far any axis strays from that
					 * block, mm or degrees */
	bool rapid;			/* it is positioned, not eroded */
	uint32_t cond;			/* number of its conditions; 0: none */
	uint32_t act_line;		/* line of the last M word or dwell
					 * between the block before and this
					 * one; 0: none */
};

/* Lifts from all places between two nodes leave the path the same way. */
struct route_lift {
	uint32_t first, last;		/* nodes; equal: from that place */
	struct interp_escape way;
};

struct route {
	struct route_node *node;		/* block i leads from node[i] to
					 * node[i + 1] */
	uint32_t n;
	double lattice[INTERP_NAXES];	/* how far the pulses stray from it */
	uint32_t lines;			/* of the text */
	char *text;			/* as it was read; NULL: it was given */
	uint32_t act_line;		/* as a node's, since the last node */
	struct route_lift *lift;	/* lifts that leave the path */
	uint32_t nlifts;
	size_t room, lifts_room;
};

/** route_free() - a zeroed one is fine. */
void route_free(struct route *w);

/** route_add() - Return: 0 or -ENOMEM. */
int route_add(struct route *w, const struct route_node *node);

/** route_lattice() - how far pulses may stray from a straight block. */
void route_lattice(const struct machine_config *c, double ret[INTERP_NAXES]);

struct route_text {
	const char *path;		/* as messages name it; - is stdin */
	const char *text;		/* NULL: read it from there */
	const char *dialect;		/* NULL: by the end of path, or else the
					 * machine file's */
	bool quiet;			/* print nothing about a refusal */
	const double *start;		/* of all axes; NULL: the machine
					 * file's start_mm */
};

/**
 * route_read() - compile a program and follow it.
 *
 * Refused: words that the readers do not know, motion that is not that of one
 * rigid electrode (guides of a wire), and moves that end at a contact.
 * Return: 0; else a sysexits code, and the reason is on stderr.
 */
int route_read(struct route *w, const struct machine_config *c,
	     const struct route_text *from);

#endif /* PLAN_ROUTE_H */
