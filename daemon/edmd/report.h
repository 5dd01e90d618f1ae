/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report.h - what the cycle did, in words: log lines and systemd's status
 *
 * Follows the event ring, as any other reader would.
 * Threads: main thread only.
 */
#ifndef EDMD_REPORT_H
#define EDMD_REPORT_H

#include "io.h"
#include "rt.h"
#include "shm.h"

#include <stdint.h>

struct report {
	struct shm_follow follow;
	uint64_t watchdog_us;		/* of systemd; 0: none wanted */
	int64_t watchdog_due_ns;
	uint64_t beats;			/* of the cycle, when last asked */
	int64_t window_ns;		/* begin of the second counted in */
	uint32_t in_window;		/* gap states logged in it */
	uint32_t unsaid;		/* and not logged */
};

/** report_init() - begin at the newest event. */
void report_init(struct report *r, const struct shm_status *s);

/**
 * report_setup() - one line of the log for each thing that the host did not
 * give.
 */
void report_setup(const struct setup_report *r);

/** report_ready() - tell systemd that the cycle runs. */
void report_ready(void);

/** report_stopping() - tell systemd that it is being ended. */
void report_stopping(void);

/** report_notes() - a line for each note of the machine since the last call. */
void report_notes(const struct io_machine *m);

/** report_events() - a line for each event since the last call. */
void report_events(struct report *r, const struct shm_status *s);

/**
 * report_watchdog() - tell systemd's watchdog that edmd is alive, when it is
 * time.
 *
 * Only if @beats, the number of periods that the cycle has run, has grown.
 */
void report_watchdog(struct report *r, uint64_t beats);

#endif /* EDMD_REPORT_H */
