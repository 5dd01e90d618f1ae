/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watch.h - one machine, seen through its shared memory
 *
 * It opens edmd's status when that appears, and again when another edmd has
 * taken its place.  It gives the machine's own state, "lost" or "absent".
 *
 * Threads: one object belongs to one thread; ordinary code, not for the cycle.
 */
#ifndef DDS_WATCH_H
#define DDS_WATCH_H

#include "edm.h"
#include "shm.h"

/* Placed by the caller, filled by watch_init(); fields are private. */
struct watch {
	char machine[SHM_NAME_MAX];
	const char *fault_words;	/* of [generator], lent */
	const struct shm_status *status;	/* NULL: not open */
	uint32_t instance;			/* of the edmd in `last` */
	struct shm_snapshot last;
	bool heard;			/* `last` holds something */
	int open_error;			/* of the last attempt */
	int64_t moved_ns;		/* when the cycle last moved */
};

/** watch_init() - look for @machine; nothing is opened yet. */
void watch_init(struct watch *w, const char *machine);

/** watch_fini() - unmap. */
void watch_fini(struct watch *w);

/**
 * watch_look() - read the machine and write it into a sample.
 *
 * @now_ns: CLOCK_MONOTONIC.  @ret is filled except for the host.
 */
void watch_look(struct watch *w, int64_t now_ns, edm_MachineState *ret);

#endif /* DDS_WATCH_H */
