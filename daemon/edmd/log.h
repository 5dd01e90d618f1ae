/* SPDX-License-Identifier: Apache-2.0 */
/*
 * log.h - lines on stderr: "module: what, with numbers and units"
 *
 * Under the journal each line begins with its level, as sd-daemon(3) says.
 * A reader that does not read delays nothing (logger.h).
 * Threads: main thread only.  The cycle never prints.
 */
#ifndef EDMD_LOG_H
#define EDMD_LOG_H

enum log_level { LOG_ERROR, LOG_WARNING, LOG_INFO };

void log_line(enum log_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

#endif /* EDMD_LOG_H */
