/* SPDX-License-Identifier: Apache-2.0 */
/* tool.c - what the programs on DDS have in common */
#include "tool.h"
#include "topic.h"

#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <time.h>

#define NS	1000000000LL

int tool_refuse(const char *name, const char *option, const char *found,
		const char *wanted)
{
	fprintf(stderr, "%s: error: %s %s; %s\n", name, option, found, wanted);
	return EX_USAGE;
}

int tool_fail(const char *name, dds_domainid_t domain, dds_return_t code)
{
	fprintf(stderr, "%s: error: DDS, domain %u: %s; a free domain and a "
		"network interface are wanted (CYCLONEDDS_URI)\n", name,
		domain, dds_strretcode(code));
	return EX_UNAVAILABLE;
}

static int set_option(const struct tool *t, int c)
{
	switch (c) {
	case 'd':
		if (topic_domain_parse(optarg, t->domain) < 0)
			return tool_refuse(t->name, "--domain", optarg,
					   "a whole number from 0 to 230");
		return 0;
	case 'h':
		fputs(t->usage, stdout);
		exit(EX_OK);
	case 'V':
		puts(t->version);
		exit(EX_OK);
	case '?':
		return EX_USAGE;
	default:
		return t->set(t->arg, c);
	}
}

int tool_parse(const struct tool *t, int argc, char **argv)
{
	int c, r;

	while ((c = getopt_long(argc, argv, "", t->options, NULL)) != -1) {
		r = set_option(t, c);
		if (r)
			return r;
	}
	if (optind < argc)
		return tool_refuse(t->name, "argument", argv[optind],
				   "options only");
	return 0;
}

void tool_block_stops(sigset_t *ret)
{
	sigemptyset(ret);
	sigaddset(ret, SIGINT);
	sigaddset(ret, SIGTERM);
	sigprocmask(SIG_BLOCK, ret, NULL);
}

bool tool_wait(const sigset_t *stops, int64_t ns)
{
	const struct timespec t = { ns / NS, ns % NS };

	return sigtimedwait(stops, NULL, &t) > 0;
}
