/* SPDX-License-Identifier: Apache-2.0 */
/* tool.c - what the programs on DDS have in common */
#include "tool.h"
#include "cmdline.h"
#include "topic.h"

#include <stdio.h>
#include <sysexits.h>
#include <time.h>

#define NS	1000000000LL

int tool_fail(const char *name, dds_domainid_t domain, dds_return_t code)
{
	fprintf(stderr, "%s: error: DDS, domain %u: %s; a free domain and a "
		"network interface are wanted (CYCLONEDDS_URI)\n", name,
		domain, dds_strretcode(code));
	return EX_UNAVAILABLE;
}

int tool_domain(const char *program, const char *text, dds_domainid_t *ret)
{
	if (topic_domain_parse(text, ret) == 0)
		return -1;
	return cmdline_refuse(program, "--domain", text,
			      "a whole number from 0 to 230");
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
