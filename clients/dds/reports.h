/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reports.h - the jobs that have ended, and the alarms, of the last day
 *
 * edmd-jobs keeps them; it is asked for what is new when it tells of an end or
 * an alarm, and every ten seconds.  Each is written once, and stays with the
 * writer for a day, for who comes late.  A program that is started anew writes
 * the last day again; machine and number say what is the same.
 *
 * Threads: one.  No call waits for edmd-jobs.
 */
#ifndef DDS_REPORTS_H
#define DDS_REPORTS_H

#include "dds/dds.h"
#include "talk.h"

#define REPORTS_LISTS	2		/* of jobs, of alarms */

/* One that was written. */
struct reports_told {
	uint32_t number;
	int64_t utime;
};

/* Placed by the caller, filled by reports_open(); fields are private. */
struct reports {
	const char *machine, *key;
	struct talk *talk;		/* NULL: not yet */
	dds_entity_t writer[REPORTS_LISTS];
	struct reports_told *told[REPORTS_LISTS];
	size_t ntold[REPORTS_LISTS];
	bool asking;
	bool all;			/* ask for the whole day */
	bool failed;			/* DDS did not take one */
	double due_s;			/* when to ask next */
	char said[TALK_SAID_MAX];
};

/**
 * reports_open() - of @machine, whose publisher @part is; @key: key file, or
 * NULL as in talk.h; both lent.  Return: 0 or a negative DDS code.
 */
int reports_open(struct reports *r, dds_entity_t part,
		 const char *machine, const char *key);
void reports_close(struct reports *r);

/** reports_step() - to be called every 50 ms. */
void reports_step(struct reports *r);

#endif /* DDS_REPORTS_H */
