/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scope.h - each cycle of a machine over DDS, while somebody reads it
 *
 * edm-dds writes nothing of it as long as nobody has a reader of EDM_Scope.
 * Then it begins with the present cycle.  A cycle costs 96 bytes.
 *
 * Threads: one.
 */
#ifndef DDS_SCOPE_H
#define DDS_SCOPE_H

#include "topic.h"
#include "watch.h"

#define SCOPE_ROWS	512		/* of a sample, as edm.idl has it */

/* Placed by the caller, filled by scope_open(); fields are private. */
struct scope {
	dds_entity_t writer;
	bool is_read;
	uint32_t instance;		/* of the edmd that is followed */
	struct shm_follow trace;
	edm_ScopeRow row[SCOPE_ROWS];
};

/** scope_open() - @part: a publisher in the machine's partition.
 *  Return: 0 or a negative DDS code. */
int scope_open(struct scope *s, dds_entity_t part);

/** scope_step() - write the cycles since the last call; every 50 ms. */
void scope_step(struct scope *s, const struct watch *w);

/**
 * scope_record() - write the cycles of @machine to a CSV until a signal to
 * stop.
 *
 * @epoll: of tool_block_stops().  Return: EX_OK; 1: nothing was heard;
 * EX_CANTCREAT, EX_IOERR, or a negative DDS code.
 */
int scope_record(dds_entity_t participant, int epoll, const char *machine,
		 const char *path);

#endif /* DDS_SCOPE_H */
