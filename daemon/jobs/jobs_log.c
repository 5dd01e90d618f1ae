/* SPDX-License-Identifier: Apache-2.0 */
/*
 * jobs_log.c - lines on stderr
 */
#include "jobs_log.h"

#include "logger.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void jobs_log(const char *level, const char *format, ...)
{
	char prefix[32];
	va_list args;

	snprintf(prefix, sizeof(prefix), "%sedmd-jobs: ",
		 getenv("JOURNAL_STREAM") ? level : "");
	va_start(args, format);
	logger_say(prefix, format, args);
	va_end(args);
}
