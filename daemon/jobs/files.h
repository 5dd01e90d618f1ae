/* SPDX-License-Identifier: Apache-2.0 */
/*
 * files.h - the files that a job depends on beside its text and its technology
 *
 * A job that was interrupted goes on only with the machine file, the maps of
 * geometric errors and the dialect with which it began.
 *
 * Threads: one, that of the event loop.
 */
#ifndef JOBS_FILES_H
#define JOBS_FILES_H

#include "jobs.h"

/**
 * files_read() - take the hash of the machine file @path and of the maps that
 * it names.
 *
 * Call it once, at the start: edmd and this service read these files only then.
 */
void files_read(struct jobs *j, const char *path);

/**
 * files_hash() - the hash of what files_read() has read, and of the dialect's
 * file, which is read now, as it is for each job.
 *
 * If a file cannot be read, its name counts in its place.
 */
void files_hash(const struct jobs *j, uint8_t ret[32]);

#endif /* JOBS_FILES_H */
