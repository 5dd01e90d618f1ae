/* SPDX-License-Identifier: Apache-2.0 */
/*
 * serve.h - the main thread beside a running loop
 */
#ifndef EDMD_SERVE_H
#define EDMD_SERVE_H

#include "loop.h"
#include "report.h"

#include "config.h"

#include <signal.h>

struct server {
	struct loop *loop;
	const struct machine_config *config;
	struct report report;
	struct program *ahead;		/* copied before it is loaded */
	int64_t end_by_ns;		/* 0: not being ended */
};

/**
 * serve() - map programs, write the log and keep systemd's watchdog content,
 * until a signal comes; then wait until the machine stands.
 */
void serve(struct server *s);

/**
 * serve_signals() - those that end edmd.  serve() waits for them, so all
 * threads block them.
 */
void serve_signals(sigset_t *ret);

#endif /* EDMD_SERVE_H */
