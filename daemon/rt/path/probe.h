/* SPDX-License-Identifier: Apache-2.0 */
/*
 * probe.h - segments that end where the machine says
 *
 * A probing motion looks for the work with the power off: fast to the first
 * contact, a little back, then slowly to the contact that counts.  A half ends
 * in the middle between the last two contacts along its axis.  A limit ends
 * just before the end of the travel.
 *
 * The rest of such a segment is not walked.  The cursor goes to the segment's
 * end, the axes stay where they are, and `shift` is the difference from then
 * on:
 *
 *	out.target = cursor.pos + shift
 *
 * So places in the program count from the contact, whatever the machine knew
 * before.  No way back leads over it.  In a dry run there is nothing to feel,
 * and these segments end where they begin.
 *
 * Units: pulses where the name has no unit.
 * Threads: RT-safe.
 */
#ifndef RT_PROBE_H
#define RT_PROBE_H

#include "interp/cursor.h"

#include "settings.h"

#include <stdbool.h>
#include <stdint.h>

enum probe_phase {
	PROBE_SETTLE,
	PROBE_FAST,
	PROBE_STOP,			/* in contact, not standing yet */
	PROBE_BACK,
	PROBE_FINE,
	PROBE_GO,			/* to a place known beforehand */
	PROBE_LOOK,			/* it is known where the rest lies */
	PROBE_DONE,
	PROBE_NPHASES
};

struct probe {
	enum probe_phase phase;
	bool contact;			/* in this cycle */
	bool open_seen;			/* no contact, since it began to go */
	uint64_t settled;		/* cycles */
	double met_mm, to_mm;		/* places on the path */
	uint32_t rest;			/* the next segment to look at */
	uint32_t beyond;		/* the one that leaves the travel; 0:
					 * none */
	/* Of the whole job: */
	int32_t shift[INTERP_NAXES];
	int32_t found[2][INTERP_NAXES];	/* contacts along each axis, where the
					 * axis stood; the last one first */
	uint32_t once, twice;		/* bit per axis: so many are filled */
};

struct cycle;
struct io_inputs;

/** probe_is_start() - are the axes where a program begins that is loaded with
 *  its cursor @at? */
bool probe_is_start(const struct cycle *c, const struct interp_cursor *at);

/**
 * probe_load() - the program that is loaded begins, with what was probed before
 * it (struct interp_probed): its axes are taken to be there.
 */
void probe_load(struct cycle *c);

/** probe_sense() - is there contact? */
void probe_sense(struct cycle *c, const struct io_inputs *in);

/** probe_begin() - begin the segment in front, or what is left of it. */
void probe_begin(struct cycle *c);

/** probe_distance() - how far to go in this cycle; it ends the segment, too. */
double probe_distance(struct cycle *c);

#endif /* RT_PROBE_H */
