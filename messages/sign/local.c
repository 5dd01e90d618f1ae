/* SPDX-License-Identifier: Apache-2.0 */
/* local.c - the same packets between the programs of one host */
#include "local.h"

#include "places.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#define BUFFER_BYTES	(4 << 20)	/* the kernel gives as much as it
					 * allows */

struct end {
	int fd;				/* -1: free */
	uid_t uid;
	uint64_t turn;			/* when it sent something last */
	char from[UDPM_FROM_MAX];
	uint8_t key[SEAL_KEY_BYTES];
	char client[LOCAL_CLIENT_MAX];	/* "": not known yet */
};

struct local {
	struct sockaddr_un at;
	int epoll, listening;
	uint64_t turns;
	struct end end[LOCAL_ENDS];
	struct end *last;		/* whose packet was taken last */
	uint8_t packet[UDPM_PACKET_MAX];
};

/* -- Packets -------------------------------------------------------------- */

static void buffer_grow(int fd)
{
	const int bytes = BUFFER_BYTES;

	setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
}

void local_put(int fd, const char *channel, const void *data, size_t size)
{
	struct iovec parts[UDPM_PARTS];
	const struct msghdr m = { .msg_iov = parts, .msg_iovlen = UDPM_PARTS };

	udpm_parts(parts, channel, data, size);
	sendmsg(fd, &m, MSG_NOSIGNAL | MSG_DONTWAIT);
}

int local_get(int fd, uint8_t room[UDPM_PACKET_MAX], struct udpm_packet *ret)
{
	const ssize_t n = recv(fd, room, UDPM_PACKET_MAX,
			       MSG_TRUNC | MSG_DONTWAIT);

	if (n < 0)
		return errno == EAGAIN || errno == EINTR ? 0 : -ENOTCONN;
	if (n == 0)
		return -ENOTCONN;
	return n <= UDPM_PACKET_MAX && udpm_split(ret, room, (size_t)n);
}

/* -- The service ---------------------------------------------------------- */

/* @end: NULL: of the socket that listens. */
static int watch(struct local *l, int fd, struct end *end)
{
	struct epoll_event e = { .events = EPOLLIN, .data.ptr = end };

	return epoll_ctl(l->epoll, EPOLL_CTL_ADD, fd, &e) < 0 ? -errno : 0;
}

int local_open(struct local **ret, const struct sockaddr_un *at)
{
	struct local *l = calloc(1, sizeof(*l));
	int err;

	if (!l)
		return -ENOMEM;
	for (int i = 0; i < LOCAL_ENDS; i++)
		l->end[i].fd = -1;
	l->at = *at;
	l->listening = -1;
	l->epoll = epoll_create1(EPOLL_CLOEXEC);
	err = l->epoll < 0 ? -errno : places_listen(at, SOCK_SEQPACKET);
	if (err >= 0) {
		l->listening = err;
		err = watch(l, l->listening, NULL);
	}
	if (err < 0) {
		local_close(l);
		return err;
	}
	*ret = l;
	return 0;
}

static void end_close(struct end *e)
{
	if (e->fd >= 0)
		close(e->fd);
	*e = (struct end) { .fd = -1 };
}

void local_close(struct local *l)
{
	if (!l)
		return;
	for (int i = 0; i < LOCAL_ENDS; i++)
		end_close(&l->end[i]);
	if (l->listening >= 0) {
		unlink(l->at.sun_path);
		close(l->listening);
	}
	if (l->epoll >= 0)
		close(l->epoll);
	free(l);
}

int local_fd(const struct local *l)
{
	return l->epoll;
}

/* Who sent nothing for the longest time: of user @uid, or of the others. */
static struct end *most_silent(struct local *l, uid_t uid, bool own)
{
	struct end *found = NULL;

	for (int i = 0; i < LOCAL_ENDS; i++) {
		struct end *e = &l->end[i];

		if (e->fd >= 0 && (e->uid == uid) == own &&
		    (!found || e->turn < found->turn))
			found = e;
	}
	return found;
}

/* A new client always finds room: who may have to stop the machine must not
 * wait for those who look.  One user's clients leave room for those of
 * others. */
static struct end *room_for(struct local *l, uid_t uid)
{
	struct end *room = NULL;
	int own = 0;

	for (int i = 0; i < LOCAL_ENDS; i++) {
		if (l->end[i].fd < 0)
			room = &l->end[i];
		else
			own += l->end[i].uid == uid;
	}
	if (room && own < LOCAL_OF_ONE)
		return room;
	room = most_silent(l, uid, own >= LOCAL_OF_ONE);
	end_close(room);
	return room;
}

static void greet(struct local *l)
{
	const int fd = accept4(l->listening, NULL, NULL,
			       SOCK_CLOEXEC | SOCK_NONBLOCK);
	struct ucred peer;
	socklen_t size = sizeof(peer);
	struct end *e;

	if (fd < 0)
		return;
	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) < 0) {
		close(fd);
		return;
	}
	e = room_for(l, peer.uid);
	*e = (struct end) { .fd = fd, .uid = peer.uid, .turn = ++l->turns };
	if (watch(l, fd, e) < 0) {
		end_close(e);
		return;
	}
	buffer_grow(fd);
	snprintf(e->from, sizeof(e->from), "uid %u, pid %d",
		 (unsigned int)peer.uid, (int)peer.pid);
}

bool local_take(struct local *l, struct udpm_packet *ret)
{
	struct epoll_event event;
	struct end *e;
	int got;

	l->last = NULL;
	if (epoll_wait(l->epoll, &event, 1, 0) < 1)
		return false;
	e = event.data.ptr;
	if (!e) {
		greet(l);
		return false;
	}
	got = local_get(e->fd, l->packet, ret);
	if (got < 0)
		end_close(e);
	if (got <= 0)
		return false;
	memcpy(ret->from, e->from, sizeof(ret->from));
	e->turn = ++l->turns;
	l->last = e;
	return true;
}

void local_is(struct local *l, const struct local_who *who)
{
	if (!l->last)
		return;
	memcpy(l->last->key, who->key, sizeof(l->last->key));
	snprintf(l->last->client, sizeof(l->last->client), "%s", who->client);
}

static bool end_is(const struct end *e, const struct local_who *who)
{
	return e->fd >= 0 && (!who || (e->client[0] &&
	       strcmp(e->client, who->client) == 0 &&
	       memcmp(e->key, who->key, sizeof(e->key)) == 0));
}

bool local_send(const struct local *l, const struct local_who *who,
		const char *channel, const void *data, size_t size)
{
	bool any = false;

	for (int i = 0; i < LOCAL_ENDS; i++) {
		if (!end_is(&l->end[i], who))
			continue;
		local_put(l->end[i].fd, channel, data, size);
		any = true;
	}
	return any;
}

/* -- A client ------------------------------------------------------------- */

int local_connect(const struct sockaddr_un *at)
{
	const int fd = places_connect(at, PLACES_JOBS);

	if (fd >= 0)
		buffer_grow(fd);
	return fd;
}
