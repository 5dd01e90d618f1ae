/* SPDX-License-Identifier: Apache-2.0 */
/* relay.c - jobs that are offered over DDS go to edmd-jobs, its answers back */
#include "relay.h"

#include "seal.h"
#include "tool.h"

#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#define TAKE		64		/* packets of a step, of each side */

/*
 * Read by hand: who signed it nobody has checked, and LCM's decoder trusts the
 * lengths of strings.  A command_t is its fingerprint, utime, client, seq,
 * verb; a string is its length, with its NUL, and its bytes.
 */
static bool is_hello(const struct udpm_packet *u)
{
	static const char verb[] = "\0\0\0\6hello";
	const size_t client = 8 + 8, after = 4 + 8 + sizeof(verb);
	struct seal s;
	uint32_t n;

	if (!seal_read(&s, u->data, u->size) || s.size < client + after)
		return false;
	memcpy(&n, (const uint8_t *)s.data + client, sizeof(n));
	n = ntohl(n);
	return n <= s.size - client - after &&
	       memcmp((const uint8_t *)s.data + client + 4 + n + 8, verb,
		      sizeof(verb)) == 0;
}

static bool is_on(const struct relay *r, const struct udpm_packet *u,
		  const char *name)
{
	char channel[sizeof(r->post.in->channel)];

	snprintf(channel, sizeof(channel), "EDM.%s.%s", r->machine, name);
	return strcmp(u->channel, channel) == 0;
}

static bool may_pass(const struct relay *r, const struct udpm_packet *u)
{
	return is_on(r, u, "JOB") || (is_on(r, u, "COMMAND") && is_hello(u));
}

static void leave(struct relay_way *w)
{
	talk_way_close(w->way);
	*w = (struct relay_way) { .way = NULL };
}

static void come(struct relay *r, struct relay_way *w,
		 dds_instance_handle_t peer)
{
	const struct talk_options o = { .machine = r->machine };
	char said[TALK_SAID_MAX] = "out of memory";

	leave(w);
	if (talk_way_open(&w->way, &o, said) == 0) {
		w->peer = peer;
		tool_watch(r->epoll, talk_way_fd(w->way));
	} else if (!r->said) {
		fprintf(stderr, "edm-dds: a job is offered, and edmd-jobs "
			"cannot be asked: %s\n", said);
	}
	r->said = !w->way;
}

/* That of @peer, a new one, or that of the most silent.  Return: way may be
 * NULL: edmd-jobs cannot be reached. */
static struct relay_way *way_of(struct relay *r, dds_instance_handle_t peer)
{
	struct relay_way *w = &r->to[0];

	for (size_t i = 0; i < RELAY_WAYS && w->peer != peer; i++)
		if (r->to[i].peer == peer || r->to[i].heard_s < w->heard_s)
			w = &r->to[i];
	if (w->peer != peer || !w->way)
		come(r, w, peer);
	w->heard_s = talk_now_s();
	return w;
}

/* All hear the states and events; once is enough. */
static void answer(struct relay *r, struct relay_way *w, bool first)
{
	struct pollfd p = { .fd = talk_way_fd(w->way), .events = POLLIN };
	struct udpm_packet u;

	for (int i = 0; i < TAKE && poll(&p, 1, 0) > 0; i++)
		if (talk_way_take(w->way, &u) && (first || is_on(r, &u, "ACK")))
			post_send(&r->post, u.channel, u.data, u.size);
	talk_way_look(w->way);
}

int relay_open(struct relay *r, dds_entity_t participant, const char *machine,
	       int epoll)
{
	int err;

	*r = (struct relay) { .machine = machine, .epoll = epoll };
	err = post_open(&r->post, participant, machine, TOPIC_ANSWER);
	if (err == 0)
		tool_watch(epoll, r->post.fd);
	return err;
}

void relay_close(struct relay *r)
{
	for (size_t i = 0; i < RELAY_WAYS; i++)
		leave(&r->to[i]);
	post_close(&r->post);
}

void relay_step(struct relay *r)
{
	dds_instance_handle_t from;
	struct udpm_packet u;
	bool first = true;

	if (!r->machine)
		return;
	for (int i = 0; i < TAKE && post_take(&r->post, &u, &from); i++) {
		struct relay_way *w = may_pass(r, &u) ? way_of(r, from) : NULL;

		if (w && w->way)
			talk_way_send(w->way, u.channel, u.data, u.size);
	}
	for (size_t i = 0; i < RELAY_WAYS; i++) {
		if (!r->to[i].way)
			continue;
		if (!topic_has_writer(r->post.reader, r->to[i].peer)) {
			leave(&r->to[i]);
			continue;
		}
		answer(r, &r->to[i], first);
		first = false;
	}
}
