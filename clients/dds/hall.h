/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall.h - the machines that are heard, and who tells their states
 *
 * DDS lets any program write the state of any machine.  So of each machine it
 * is kept who wrote.  A program that is started anew takes the place of the
 * one before, and that one writes no more.  If it does write again, two
 * programs tell one machine: the name is disputed until one of them is gone.
 *
 * Threads: one.
 */
#ifndef DDS_HALL_H
#define DDS_HALL_H

#include "dds/dds.h"
#include "edm.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HALL_MAX	1024
#define HALL_PAST	4

struct hall_machine {
	edm_MachineState m;		/* the last, whoever wrote it */
	bool gone;			/* its writer left, died or hangs */
	bool disputed;
	char rival[sizeof(((edm_MachineState *)0)->host)];	/* host of the
					 * other one */
	int64_t heard_ns;		/* CLOCK_REALTIME of its last sample */
	dds_instance_handle_t writer;	/* of the last sample; 0: none */
	dds_instance_handle_t past[HALL_PAST];	/* the others before it */
};

/* Placed by the caller, filled by hall_open(). */
struct hall {
	dds_entity_t reader;
	struct hall_machine *row;	/* sorted by name */
	size_t n;
	uint64_t news;			/* machines that came, so far */
	uint64_t beyond;		/* samples of more than HALL_MAX */
	edm_MachineState *sample;
};

/** hall_open() - Return: 0 or a negative DDS code. */
int hall_open(struct hall *h, dds_entity_t participant);
void hall_close(struct hall *h);

/** hall_look() - take what has come.  Return: 0 or a negative DDS code. */
int hall_look(struct hall *h);

/**
 * hall_known() - of how many machines anybody knows: each edm-dds tells how
 * many it has found, and each machine that is heard counts.
 */
size_t hall_known(const struct hall *h);

#endif /* DDS_HALL_H */
