/* SPDX-License-Identifier: Apache-2.0 */
/* talk_stop.c - acts that end motion go to edmd itself, too */
#include "talk_stop.h"

#include "places.h"
#include "stop_act.h"

#include <errno.h>
#include <poll.h>
#include <sodium.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

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

int talk_stop_send(const char *machine, const char *verb, uint64_t id)
{
	const int v = verb_of(verb), fd = v < 0 ? -EINVAL : connect_to(machine);
	const struct stop_act a = {
		.magic = STOP_ACT_MAGIC, .verb = (uint32_t)v, .id = id,
	};
	int err;

	if (fd < 0 || send(fd, &a, sizeof(a), MSG_NOSIGNAL) == sizeof(a))
		return fd;
	err = -errno;
	close(fd);
	return err;
}

int talk_stop_take(int fd, int *ret_code)
{
	struct stop_answer a;
	const ssize_t n = recv(fd, &a, sizeof(a), MSG_TRUNC);

	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return 0;
	close(fd);
	if (n != sizeof(a) || a.magic != STOP_ACT_MAGIC)
		return -ENOTCONN;
	*ret_code = a.code;
	return 1;
}

int talk_stop_ask(const char *machine, const char *verb, double timeout_s,
		  struct talk_answer *ret)
{
	uint64_t id;
	struct pollfd p = { .events = POLLIN };
	int code, got;

	randombytes_buf(&id, sizeof(id));
	p.fd = talk_stop_send(machine, verb, id >> 1 | 1);
	if (p.fd < 0)
		return p.fd;
	poll(&p, 1, (int)(timeout_s * 1e3));
	got = talk_stop_take(p.fd, &code);
	if (got == 0)
		close(p.fd);
	if (got <= 0)
		return got < 0 ? got : -ETIMEDOUT;
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
