/* SPDX-License-Identifier: Apache-2.0 */
/*
 * post.h - signed packets between who offers a job and a machine's edmd-jobs
 *
 * What goes to or from one machine is in a DDS partition with the machine's
 * name: a job of 64 MiB comes to its machine, and not to a hundred others.
 *
 * The quality of service, and why:
 *
 * - Reliable: a packet of 32 KiB is some 25 datagrams, and one in ten that is
 *   lost would lose nearly every packet.
 * - Volatile: a packet is good for a second and a half, because its signature
 *   has the time.  Who comes later could only be refused.
 * - Keep last: nobody waits for a reader that hangs, neither the machine's
 *   state nor another dispatcher.  A packet that was pushed out is sent again
 *   by who made it, as over LCM.
 *
 * Threads: one; the descriptor is written by DDS's.
 */
#ifndef DDS_POST_H
#define DDS_POST_H

#include "topic.h"

#include "udpm.h"

#include <stdbool.h>

/* Placed by the caller, filled by post_open(); fields are private, but fd. */
struct post {
	dds_entity_t publisher, subscriber, writer, reader;
	int fd;				/* readable when something has come */
	edm_SignedPacket *in;
};

/**
 * post_open() - of @machine; @out: TOPIC_OFFER of who offers, TOPIC_ANSWER of
 * the machine.  Return: 0 or a negative DDS code; post_close() in any case.
 */
int post_open(struct post *p, dds_entity_t participant, const char *machine,
	      enum topic out);
void post_close(struct post *p);

/** post_send() - nothing says whether it arrives. */
void post_send(struct post *p, const char *channel, const void *data,
	       size_t size);

/**
 * post_take() - take one packet, if there is one.
 *
 * @ret_from: who wrote it; may be NULL.
 * Return: true with @ret filled; it is valid until the next call.
 */
bool post_take(struct post *p, struct udpm_packet *ret,
	       dds_instance_handle_t *ret_from);

#endif /* DDS_POST_H */
