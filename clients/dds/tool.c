/* SPDX-License-Identifier: Apache-2.0 */
/* tool.c - what the programs on DDS have in common */
#include "tool.h"
#include "cmdline.h"
#include "clocks.h"
#include "topic.h"

#include "dds/ddsrt/log.h"

#include <stdatomic.h>
#include <stdio.h>
#include <sysexits.h>
#include <time.h>

#define NS	1000000000LL

int tool_fail(const char *name, dds_domainid_t domain, dds_return_t code)
{
	fprintf(stderr, "%s: error: DDS, domain %u: %s; a free domain and a "
		"network interface are wanted, and for more than 10 programs "
		"on a host without multicast a MaxAutoParticipantIndex of as "
		"many (CYCLONEDDS_URI; docs/fleet.md)\n", name, domain,
		dds_strretcode(code));
	return EX_UNAVAILABLE;
}

int tool_domain(const char *program, const char *text, dds_domainid_t *ret)
{
	if (topic_domain_parse(text, ret) == 0)
		return -1;
	return cmdline_refuse(program, "--domain", text,
			      "a whole number from 0 to 230");
}

static struct {
	const char *program;
	_Atomic int64_t said_ns;	/* 0: not yet */
	_Atomic uint64_t n;
} lines;

/* Any thread of the library. */
static void count_line(void *arg, const dds_log_data_t *line)
{
	const int64_t now = clock_ns(CLOCK_MONOTONIC);
	int64_t said = lines.said_ns;
	uint64_t n;

	(void)arg;
	lines.n++;
	if ((said && now - said < TOOL_QUIET_S * NS) ||
	    !atomic_compare_exchange_strong(&lines.said_ns, &said, now))
		return;
	n = atomic_exchange(&lines.n, 0);
	fprintf(stderr, "%s: DDS, %llu such since the last line: %.*s\n",
		lines.program, (unsigned long long)n,
		(int)(line->size < 200 ? line->size : 200), line->message);
}

dds_entity_t tool_participant(const char *program, dds_domainid_t domain,
			      const char *name)
{
	dds_qos_t *qos = dds_create_qos();
	dds_entity_t participant;

	lines.program = program;
	dds_set_log_sink(count_line, NULL);
	if (name)
		dds_qset_entity_name(qos, name);
	participant = dds_create_participant(domain, qos, NULL);
	dds_delete_qos(qos);
	return participant;
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
