/* SPDX-License-Identifier: Apache-2.0 */
/*
 * command.c - commands come through a socket into a ring that belongs to edmd
 *
 * The two sides do not trust each other equally, so they share no memory here.
 * Nothing can be changed after it was checked, cut short while it is read, or
 * set back to be read again.  The kernel keeps packets whole and in order, says
 * who connects, and ends the connection with the process.  A thread reads the
 * socket, so the cycle makes no system call and waits for nobody.
 */
#include "object.h"

#include "places.h"
#include "thread.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#define FULL_MS		1		/* time until a full ring is tried
					 * again */

CK_RING_PROTOTYPE(command, shm_command)

struct shm_commands {
	ck_ring_t ring;
	struct shm_command slot[SHM_COMMAND_SLOTS];
	struct shm_head head;		/* sent to everybody who connects */
	char path[OBJECT_PATH_MAX];
	int listening, connected, end;	/* end: an eventfd */
	uid_t service;			/* may connect, besides our own user */
	pthread_t thread;
};

/* -- edmd: the thread ----------------------------------------------------- */

static bool peer_is_service(const struct shm_commands *c, int fd)
{
	struct ucred peer;
	socklen_t size = sizeof(peer);

	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) < 0)
		return false;
	return peer.uid == 0 || peer.uid == geteuid() ||
	       peer.uid == c->service;
}

/* A new connection takes the place of the old one, which is closed. */
static void commands_accept(struct shm_commands *c)
{
	int fd = accept4(c->listening, NULL, NULL,
			 SOCK_CLOEXEC | SOCK_NONBLOCK);

	if (fd < 0)
		return;
	if (!peer_is_service(c, fd) ||
	    send(fd, &c->head, sizeof(c->head), MSG_NOSIGNAL) < 0) {
		close(fd);
		return;
	}
	if (c->connected >= 0)
		close(c->connected);
	c->connected = fd;
}

static void commands_receive(struct shm_commands *c)
{
	struct shm_command m;
	ssize_t n = recv(c->connected, &m, sizeof(m), MSG_TRUNC);

	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	if (n != sizeof(m)) {
		close(c->connected);
		c->connected = -1;
		return;
	}
	/* There was room, and only this thread fills the ring. */
	ck_ring_enqueue_spsc_command(&c->ring, c->slot, &m);
}

static bool ring_is_full(const struct shm_commands *c)
{
	return ck_ring_size(&c->ring) >= SHM_COMMAND_SLOTS - 1;
}

static void *commands_run(void *arg)
{
	struct shm_commands *c = arg;

	for (;;) {
		const bool full = ring_is_full(c);
		struct pollfd p[] = {
			{ .fd = c->end, .events = POLLIN },
			{ .fd = c->listening, .events = POLLIN },
			{ .fd = full ? -1 : c->connected, .events = POLLIN },
		};

		if (poll(p, 3, full ? FULL_MS : -1) < 0 && errno != EINTR)
			break;
		if (p[0].revents)
			break;
		if (p[2].revents)
			commands_receive(c);
		if (p[1].revents)
			commands_accept(c);
	}
	return NULL;
}

/* -- edmd: beginning and end ---------------------------------------------- */

static int listen_at(struct shm_commands *c, const struct sockaddr_un *at)
{
	snprintf(c->path, sizeof(c->path), "%.95s", at->sun_path);
	c->listening = places_listen(at, SOCK_SEQPACKET);
	if (c->listening < 0)
		return c->listening;
	c->end = eventfd(0, EFD_CLOEXEC);
	return c->end < 0 ? -errno :
	       thread_start(&c->thread, &(struct thread) {
			.name = "edmd-commands", .run = commands_run,
			.arg = c });
}

static void commands_free(struct shm_commands *c)
{
	if (c->listening >= 0)
		close(c->listening);
	if (c->connected >= 0)
		close(c->connected);
	if (c->end >= 0)
		close(c->end);
	free(c);
}

int shm_command_create(struct shm_commands **ret, const char *machine,
		       uint32_t instance)
{
	const struct passwd *service = getpwnam(PLACES_JOBS);
	struct sockaddr_un at;
	int err = places_address(&at, machine, "command");
	struct shm_commands *c;

	if (err < 0)
		return err;
	c = calloc(1, sizeof(*c));
	if (!c)
		return -ENOMEM;
	c->listening = c->connected = c->end = -1;
	c->service = service ? service->pw_uid : geteuid();
	ck_ring_init(&c->ring, SHM_COMMAND_SLOTS);
	object_head_fill(&c->head, machine, sizeof(struct shm_command),
			 instance);
	err = listen_at(c, &at);
	if (err < 0) {
		commands_free(c);
		return err;
	}
	*ret = c;
	return 0;
}

void shm_command_destroy(struct shm_commands *c)
{
	if (!c)
		return;
	object_thread_end(c->thread, c->end);
	unlink(c->path);
	commands_free(c);
}

bool shm_command_take(struct shm_commands *c, struct shm_command *ret)
{
	return ck_ring_dequeue_spsc_command(&c->ring, c->slot, ret);
}

/* -- edmd-jobs ------------------------------------------------------------ */

static int head_take(int fd, uint32_t *ret_instance)
{
	struct pollfd p = { .fd = fd, .events = POLLIN };
	struct shm_head h;
	int err;

	/* edmd's thread answers at once, unless edmd was stopped. */
	if (poll(&p, 1, 20) <= 0)
		return -EAGAIN;
	if (recv(fd, &h, sizeof(h), MSG_TRUNC) != sizeof(h))
		return -EACCES;
	err = object_head_check(&h, sizeof(struct shm_command));
	*ret_instance = h.instance;
	return err == -ENOENT ? -EPROTO : err;
}

int shm_command_open(int *ret, const char *machine, uint32_t *ret_instance)
{
	struct sockaddr_un at;
	int err = places_address(&at, machine, "command"), fd;

	if (err < 0)
		return err;
	fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return -errno;
	if (connect(fd, (const struct sockaddr *)&at, sizeof(at)) < 0)
		err = errno == ECONNREFUSED ? -ENOENT : -errno;
	if (err == 0)
		err = head_take(fd, ret_instance);
	if (err < 0) {
		close(fd);
		return err;
	}
	*ret = fd;
	return 0;
}

int shm_command_put(int fd, const struct shm_command *c)
{
	if (send(fd, c, sizeof(*c), MSG_NOSIGNAL) == sizeof(*c))
		return 0;
	return errno == EAGAIN ? -EAGAIN : -ENOTCONN;
}
