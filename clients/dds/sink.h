/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sink.h - what comes over DDS goes into a ledger
 *
 * Reports and alarms stay in DDS's hands until they are on the disk.  If the
 * disk takes nothing, they are put in again later, and what comes meanwhile
 * waits in the reader.
 *
 * Threads: one.
 */
#ifndef DDS_SINK_H
#define DDS_SINK_H

#include "hall.h"
#include "ledger.h"

#define SINK_LISTS	2		/* of reports, of alarms */
#define SINK_BATCH	256

/* Placed by the caller, filled by sink_open(); fields are private, but news. */
struct sink {
	struct ledger *ledger;
	dds_entity_t reader[SINK_LISTS];
	void *at[SINK_LISTS][SINK_BATCH];	/* taken, and not stored yet */
	dds_sample_info_t info[SINK_LISTS][SINK_BATCH];
	int n[SINK_LISTS];
	int64_t spent_ns, stored_ns;	/* CLOCK_MONOTONIC */
	uint64_t news;			/* that were taken so far */
};

/** sink_open() - @l is lent.  Return: 0 or a negative DDS code. */
int sink_open(struct sink *s, dds_entity_t participant, struct ledger *l);

/**
 * sink_step() - take what has come, and how long each machine was what it is.
 * @all: store what was spent now, and not only each ten seconds.
 *
 * Return: 0, or -errno: ledger_why() says what; nothing is lost.
 */
int sink_step(struct sink *s, const struct hall *h, bool all);

#endif /* DDS_SINK_H */
