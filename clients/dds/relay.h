/* SPDX-License-Identifier: Apache-2.0 */
/*
 * relay.h - jobs that are offered over DDS go to edmd-jobs, its answers back
 *
 * What was signed is handed on as it is: edmd-jobs judges it, as that of any
 * client.  Only the pieces of a job and `hello` are handed on, so who has a key
 * can give a job over DDS, but neither start nor stop anything.
 *
 * Each who offers has a connection of its own to edmd-jobs, as a person's
 * client has, as long as DDS sees it.  One beyond takes the place of the one
 * that was silent for the longest time.
 *
 * Threads: one.  No call waits for edmd-jobs.
 */
#ifndef DDS_RELAY_H
#define DDS_RELAY_H

#include "post.h"
#include "talk_way.h"

#define RELAY_WAYS	16		/* who offer at once */

struct relay_way {
	dds_instance_handle_t peer;
	double heard_s;
	struct talk_way *way;		/* NULL: free */
};

/* Placed by the caller, filled by relay_open(); fields are private. */
struct relay {
	const char *machine;
	struct post post;
	struct relay_way to[RELAY_WAYS];
	int epoll;			/* the caller's */
	bool said;			/* that edmd-jobs cannot be reached */
};

/**
 * relay_open() - @epoll gets what wakes relay_step(); both lent.
 * Return: 0 or a negative DDS code; relay_close() in any case.
 */
int relay_open(struct relay *r, dds_entity_t participant, const char *machine,
	       int epoll);
void relay_close(struct relay *r);

/**
 * relay_step() - hand on what has come; to be called every 50 ms.  Nothing
 * before relay_open().
 */
void relay_step(struct relay *r);

#endif /* DDS_RELAY_H */
