/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tool.h - what the programs on DDS have in common
 *
 * Threads: startup only; tool_wait() in the main loop too.
 */
#ifndef DDS_TOOL_H
#define DDS_TOOL_H

#include "dds/dds.h"

#include <stdbool.h>
#include <stdint.h>

/**
 * tool_domain() - @text as a DDS domain.  Return: -1, or an exit code after a
 * message.
 */
int tool_domain(const char *program, const char *text, dds_domainid_t *ret);

/** tool_fail() - say why DDS cannot be used.  Return: EX_UNAVAILABLE. */
int tool_fail(const char *name, dds_domainid_t domain, dds_return_t code);

/**
 * tool_participant() - in @domain, with a name that others see, NULL for none.
 *
 * Anybody can send what is no DDS, and for each packet the library has a line.
 * From here on these are counted: one of them is printed in TOOL_QUIET_S, with
 * their number.
 *
 * Return: the participant, or a negative DDS code.
 */
dds_entity_t tool_participant(const char *program, dds_domainid_t domain,
			      const char *name);

#define TOOL_QUIET_S	60

/**
 * tool_block_stops() - block SIGINT and SIGTERM in every thread from now on, so
 * that tool_wait() takes them.  Return: an epoll for it, or -1.
 */
int tool_block_stops(void);

/** tool_watch() - @fd ends tool_wait() when it is readable. */
void tool_watch(int epoll, int fd);

/**
 * tool_wait() - for @ns (not less than 0), or until a watched descriptor is
 * readable.  Return: true if it was told to stop.
 */
bool tool_wait(int epoll, int64_t ns);

#endif /* DDS_TOOL_H */
