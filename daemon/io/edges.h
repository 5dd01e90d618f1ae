/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edges.h - a thread that plays the edges of a period within the next one
 *
 * The cycle says where the axes are to be; the thread goes there in `slots`
 * writes, evenly over a period, so that pulses are faster than the cycle.  It
 * takes what was said half a period before, so that neither need be on time to
 * less than that: a target is reached one and a half periods after it was said.
 *
 * What could not be put out in its period is put out in the next; if that is
 * more than a quarter of what a period holds, the thread is busy meanwhile.
 * Nothing is lost, or squeezed.  `stop`
 * ends the pulses with the one under way; those that are left come with the
 * next target.
 *
 * Between slots that are less than EDGES_SPIN_NS apart the thread does not
 * sleep: it wants a processor of its own.
 *
 * Units: pulses; slots are the periods of pulser.h.
 * Threads: edges_start() and edges_end() startup only; edges_tell() and
 * edges_ask() RT-safe, the cycle's; @write is the thread's own.
 */
#ifndef IO_EDGES_H
#define IO_EDGES_H

#include "pulser.h"

#define EDGES_SPIN_NS	50000

struct edges_config {
	struct pulser_config pulser;
	int64_t period_ns;
	uint32_t slots;			/* writes in a period, 2 or more */
	int cpu, priority;		/* -1: any; 0: no real time */
	/* Levels onto the lines; false: they are gone. */
	bool (*write)(void *arg, uint32_t step, uint32_t dir);
	void *arg;
};

/* What the cycle says, once a period. */
struct edges_told {
	int32_t target[IO_NAXES];	/* pulses since the start */
	uint32_t stop;			/* not 0: no pulses */
};

/* What the thread says, once a slot. */
struct edges_shown {
	int32_t put[IO_NAXES];		/* pulses put out */
	uint32_t busy;			/* too many of the last period's are left */
	uint32_t lost;			/* the lines are gone */
	uint32_t periods;		/* played; stands still: it is dead */
	uint32_t late;			/* slots later than one slot, in all */
};

struct edges;

/** edges_start() - Return: 0 or -errno; -EPERM: no right to its priority. */
int edges_start(struct edges **ret, const struct edges_config *c);

/** edges_end() - the pulse under way is finished, the lines are left. */
void edges_end(struct edges *e);

void edges_tell(struct edges *e, const struct edges_told *t);
void edges_ask(struct edges *e, struct edges_shown *ret);

#endif /* IO_EDGES_H */
