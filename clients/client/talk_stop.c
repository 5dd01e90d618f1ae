/* SPDX-License-Identifier: Apache-2.0 */
/* talk_stop.c - acts that end motion go to edmd itself, too */
#include "talk_stop.h"

#include "places.h"
#include "stop_act.h"

#include <errno.h>
#include <poll.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define AGAIN_S		0.01		/* between two tries */

#define NAME(verb, name)	name,
static const char *const names[] = { STOP_ACT_ROWS(NAME) };
#undef NAME

/* Return: -1: none of them. */
static int verb_of(const char *name)
{
	for (int i = 0; i < STOP_ACT_NVERBS; i++)
		if (strcmp(names[i], name) == 0)
			return i;
	return -1;
}

bool talk_stop_is(const char *verb)
{
	return verb_of(verb) >= 0;
}

static int connect_to(const char *machine)
{
	struct sockaddr_un at;
	const int err = places_address(&at, machine, "stop");

	return err < 0 ? err : places_connect(&at, PLACES_EDMD);
}

/* Return: -1: it does not take it now. */
static int give(struct talk_stop *s)
{
	const int fd = connect_to(s->machine);
	const struct stop_act a = {
		.magic = STOP_ACT_MAGIC, .verb = s->verb, .id = s->id,
	};

	s->tried_s = talk_now_s();
	if (fd < 0 || send(fd, &a, sizeof(a), MSG_NOSIGNAL) == sizeof(a))
		return fd < 0 ? -1 : fd;
	close(fd);
	return -1;
}

void talk_stop_begin(struct talk_stop *s, const char *machine,
		     const char *verb, uint64_t id)
{
	*s = (struct talk_stop) { .verb = (uint32_t)verb_of(verb), .id = id };
	snprintf(s->machine, sizeof(s->machine), "%s", machine);
	s->fd = give(s);
}

void talk_stop_end(struct talk_stop *s)
{
	if (s->id && s->fd >= 0)
		close(s->fd);
	s->id = 0;
}

bool talk_stop_turn(struct talk_stop *s, int *ret_code)
{
	struct stop_answer a;
	ssize_t n;

	if (!s->id)
		return false;
	if (s->fd < 0) {
		if (talk_now_s() - s->tried_s >= AGAIN_S)
			s->fd = give(s);
		return false;
	}
	n = recv(s->fd, &a, sizeof(a), MSG_TRUNC);
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return false;
	if (n == sizeof(a) && a.magic == STOP_ACT_MAGIC) {
		*ret_code = a.code;
		talk_stop_end(s);
		return true;
	}
	close(s->fd);
	s->fd = -1;
	return false;
}

int talk_stop_ask(const char *machine, const char *verb, double timeout_s,
		  struct talk_answer *ret)
{
	const double until_s = talk_now_s() + timeout_s;
	struct talk_stop s;
	uint64_t id;
	int code = 0;
	bool got;

	randombytes_buf(&id, sizeof(id));
	talk_stop_begin(&s, machine, verb, id >> 1 | 1);
	while (!(got = talk_stop_turn(&s, &code)) && talk_now_s() < until_s &&
	       !talk_interrupted()) {
		struct pollfd p = { .fd = s.fd, .events = POLLIN };

		poll(&p, 1, TALK_TURN_MS);
	}
	talk_stop_end(&s);
	if (!got)
		return talk_interrupted() ? -EINTR : -ETIMEDOUT;
	if (code != 0)
		return -ECANCELED;
	return talk_answer_copy(ret, &(struct talk_ack) {
		.reason = TALK_STOP_DONE, .body = "",
	});
}

bool talk_stop_listens(const char *machine)
{
	const int fd = connect_to(machine);

	if (fd >= 0)
		close(fd);
	return fd >= 0;
}
