/* SPDX-License-Identifier: Apache-2.0 */
/*
 * log.c - one line at a time
 */
#include "log.h"

#include "logger.h"

#include <stdarg.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>

static const char *prefix(enum log_level level)
{
	static const char *const journal[] = {
		[LOG_ERROR]	= SD_ERR,
		[LOG_WARNING]	= SD_WARNING,
		[LOG_INFO]	= SD_INFO,
	};
	static const char *const plain[] = {
		[LOG_ERROR]	= "error: ",
		[LOG_WARNING]	= "warning: ",
		[LOG_INFO]	= "",
	};

	return getenv("JOURNAL_STREAM") ? journal[level] : plain[level];
}

void log_line(enum log_level level, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	logger_say(prefix(level), format, args);
	va_end(args);
}
