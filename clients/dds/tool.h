/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tool.h - what the programs on DDS have in common: options, stops, refusals
 *
 * Threads: startup only, but tool_wait().
 */
#ifndef DDS_TOOL_H
#define DDS_TOOL_H

#include "dds/dds.h"

#include <getopt.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

struct tool {
	const char *name;
	const char *version;		/* the line that --version prints */
	const char *usage;		/* the text that --help prints */
	const struct option *options;	/* 'd', 'h' and 'V' are domain, help
					 * and version, set here */
	int (*set)(void *arg, int c);	/* any other; 0, or an exit code */
	void *arg;
	dds_domainid_t *domain;
};

/**
 * tool_parse() - the command line.  --help and --version print and exit.
 * Return: 0, or what to exit with, said why.
 */
int tool_parse(const struct tool *t, int argc, char **argv);

/** tool_refuse() - say it.  Return: EX_USAGE. */
int tool_refuse(const char *name, const char *option, const char *found,
		const char *wanted);

/** tool_fail() - say why DDS is not there.  Return: EX_UNAVAILABLE. */
int tool_fail(const char *name, dds_domainid_t domain, dds_return_t code);

/** tool_block_stops() - SIGINT and SIGTERM, in every thread from now on, so
 *  that tool_wait() takes them. */
void tool_block_stops(sigset_t *ret);

/** tool_wait() - Return: true if told to stop within @ns (not less than 0). */
bool tool_wait(const sigset_t *stops, int64_t ns);

#endif /* DDS_TOOL_H */
