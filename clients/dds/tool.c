/* SPDX-License-Identifier: Apache-2.0 */
/* tool.c - what the programs on DDS have in common */
#include "tool.h"
#include "cmdline.h"
#include "clocks.h"
#include "topic.h"

#include "dds/ddsrt/log.h"

#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

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

static int stop_fd;

int tool_block_stops(void)
{
	const int epoll = epoll_create1(EPOLL_CLOEXEC);
	sigset_t stops;

	sigemptyset(&stops);
	sigaddset(&stops, SIGINT);
	sigaddset(&stops, SIGTERM);
	sigprocmask(SIG_BLOCK, &stops, NULL);
	stop_fd = signalfd(-1, &stops, SFD_CLOEXEC | SFD_NONBLOCK);
	tool_watch(epoll, stop_fd);
	return epoll;
}

void tool_watch(int epoll, int fd)
{
	struct epoll_event e = { .events = EPOLLIN };

	epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &e);
}

bool tool_wait(int epoll, int64_t ns)
{
	const struct timespec t = { ns / NS, ns % NS };
	struct pollfd p = { .fd = epoll, .events = POLLIN };
	struct signalfd_siginfo stop;

	ppoll(&p, 1, &t, NULL);
	return read(stop_fd, &stop, sizeof(stop)) == sizeof(stop);
}
