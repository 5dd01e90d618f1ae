/* SPDX-License-Identifier: Apache-2.0 */
/*
 * edges.h - a thread that puts out the edges of one period during the next one
 *
 * The cycle says where the axes are to be. The thread goes there in `slots`
 * writes, evenly spread over a period, so pulses can be faster than the cycle.
 * It takes what the cycle said half a period before. So neither of the two has
 * to be in time to better than that; a target is reached one and a half periods
 * after the cycle said it.
 *
 * Edges that do not fit into their period are put out in the next one. While
 * more than a quarter of what a period holds is left over, the thread says that
 * it is busy. No edge is lost, and none comes too soon after another. `stop`
 * ends with the pulse that is under way; the pulses that are left come with the
 * next target.
 *
 * If slots are less than EDGES_SPIN_NS apart, the thread does not sleep between
 * them. Then it needs a processor core of its own.
 *
 * Units: pulses; slots are the periods of pulser.h.
 *
 * Threads: edges_start() and edges_end() are startup only. edges_tell() and
 * edges_ask() are RT-safe and belong to the cycle; edges_note() belongs to the
 * thread that logs. @write is called by the edge
 * thread.
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
	uint32_t pad;
};

/* What the thread says, once a slot. */
struct edges_shown {
	int32_t put[IO_NAXES];		/* pulses put out */
	uint32_t busy;			/* too many pulses are left over */
	uint32_t lost;			/* the lines are gone */
	uint32_t periods;		/* played; stands still: it is dead */
	uint32_t late;			/* slots later than one slot, in all */
};

struct edges;

/**
 * edges_next_ns() - the first multiple of the period behind @now_ns.
 *
 * The thread begins its periods there.  The cycle wakes in the middle between
 * two of them (setup_clock_start()), so each has half a period in which the
 * other may be late.
 */
int64_t edges_next_ns(int64_t now_ns, int64_t period_ns);

/** edges_start() - Return: 0 or -errno. */
int edges_start(struct edges **ret, const struct edges_config *c);

/** edges_end() - finish the pulse under way and leave the lines alone. */
void edges_end(struct edges *e);

/** edges_note() - once: the rights that the host did not give to the thread, as
 *  a line for the log.  false: it has all of them.  @e may be NULL. */
bool edges_note(struct edges *e, char *buf, size_t size);

void edges_tell(struct edges *e, const struct edges_told *t);
void edges_ask(struct edges *e, struct edges_shown *ret);

#endif /* IO_EDGES_H */
