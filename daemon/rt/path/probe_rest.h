/* SPDX-License-Identifier: Apache-2.0 */
/*
 * probe_rest.h - the rest of a program, looked through after a contact
 *
 * The compiler cannot check the travel of an axis that counts from a contact.
 * So this is done when the contact is known, before anything goes on, a part of
 * the program in each cycle.  It ends at the next motion along this axis that
 * ends where the machine says.
 *
 * Nodes and arcs are looked at.  What a curve does between its nodes the cycle
 * sees when it comes there.
 *
 * Threads: RT-safe.
 */
#ifndef RT_PROBE_REST_H
#define RT_PROBE_REST_H

#include <stdbool.h>
#include <stdint.h>

struct cycle;
struct interp_seg;

/**
 * probe_rest_look() - if segment @sensed along @axis ends where the axis is,
 * does the program from segment @c->probe.rest on stay in its travel?
 *
 * Return: true if all was looked at.  @c->probe.beyond is then the segment that
 * leaves the travel, or 0.
 */
bool probe_rest_look(struct cycle *c, int axis, uint32_t sensed);

/** probe_rest_beyond() - the segment that a fault soft-limit is about, or NULL:
 *  the one where it stands. */
const struct interp_seg *probe_rest_beyond(const struct cycle *c);

#endif /* RT_PROBE_REST_H */
