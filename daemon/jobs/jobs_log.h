/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jobs_log.h - lines on stderr; for the journal with sd-daemon's level prefixes
 *
 * "module: what, with numbers and units".  A reader that does not read
 * delays nothing (logger.h).  Threads: any.
 */
#ifndef JOBS_LOG_H
#define JOBS_LOG_H

#include <systemd/sd-daemon.h>

/** jobs_log() - @level: SD_ERR, ... */
void jobs_log(const char *level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

#define log_error(...)		jobs_log(SD_ERR, __VA_ARGS__)
#define log_warning(...)	jobs_log(SD_WARNING, __VA_ARGS__)
#define log_notice(...)		jobs_log(SD_NOTICE, __VA_ARGS__)
#define log_info(...)		jobs_log(SD_INFO, __VA_ARGS__)

#endif /* JOBS_LOG_H */
