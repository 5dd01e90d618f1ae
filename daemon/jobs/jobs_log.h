/* SPDX-License-Identifier: Apache-2.0 */
/*
 * log.h - lines on stderr; for the journal with sd-daemon's level prefixes
 *
 * "module: what, with numbers and units".  Threads: any.
 */
#ifndef JOBS_LOG_H
#define JOBS_LOG_H

#include <stdio.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>

#define log_at(level, ...) \
	do { \
		fputs(getenv("JOURNAL_STREAM") ? level "edmd-jobs: " : \
						 "edmd-jobs: ", stderr); \
		fprintf(stderr, __VA_ARGS__); \
		fputc('\n', stderr); \
	} while (0)

#define log_error(...)		log_at(SD_ERR, __VA_ARGS__)
#define log_warning(...)	log_at(SD_WARNING, __VA_ARGS__)
#define log_notice(...)		log_at(SD_NOTICE, __VA_ARGS__)
#define log_info(...)		log_at(SD_INFO, __VA_ARGS__)

#endif /* JOBS_LOG_H */
