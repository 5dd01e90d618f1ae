/* SPDX-License-Identifier: Apache-2.0 */
/*
 * stop.c - acts that end motion come by a socket of their own
 *
 * They need no edmd-jobs, no key and no session, so nothing that keeps these
 * busy keeps a stop away.  Who may connect is who is in the group; the kernel
 * sees to that.  The thread waits for nobody: a client sends one act and gets
 * one answer, and one beyond takes the place of the oldest.  It is before all
 * programs that have no real-time priority, so neither busy processes nor a
 * crowd that connects keep it waiting.
 *
 * The ids of acts go where those of commands go, and only so many of these are
 * remembered.  So not more than a few hundred acts are taken in a second; any
 * one of them ends all motion.
 */
#include "object.h"

#include "clocks.h"
#include "places.h"
#include "stop_act.h"
#include "thread.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#define ENDS		16		/* clients at once */
#define SLOTS		16		/* acts on their way; a power of two */
#define LOOK_MS		1		/* for an answer */
#define GIVE_UP_NS	2000000000LL
#define EACH_NS		10000000LL	/* an act; after the first ACTS */
#define ACTS		16
#define PRIORITY	1		/* SCHED_FIFO; below all that drives */

CK_RING_PROTOTYPE(stop, shm_command)

struct stop_end {
	int fd;				/* -1: free */
	int64_t since_ns;
	uint64_t id;			/* of its act; 0: none yet */
};

struct shm_stops {
	ck_ring_t ring;
	struct shm_command slot[SLOTS];
	const struct shm_status *status;
	struct sockaddr_un at;
	int listening, end;		/* end: an eventfd */
	struct stop_end client[ENDS];
	int64_t paid_ns;		/* acts are paid for up to here */
	pthread_t thread;
};

static void end_close(struct stop_end *e)
{
	if (e->fd >= 0)
		close(e->fd);
	*e = (struct stop_end) { .fd = -1 };
}

static bool is_paid(struct shm_stops *s, int64_t now_ns)
{
	const int64_t least = now_ns - ACTS * EACH_NS;

	if (s->paid_ns < least)
		s->paid_ns = least;
	return s->paid_ns + EACH_NS <= now_ns &&
	       shm_stop_waits(s) < SLOTS - 1;
}

static void act_take(struct shm_stops *s, struct stop_end *e)
{
#define SHM_OF(verb, name)	[STOP_ACT_##verb] = SHM_DO_##verb,
	static const uint32_t verb[] = { STOP_ACT_ROWS(SHM_OF) };
#undef SHM_OF
	struct shm_command c = { .until_ns = INT64_MAX };
	struct stop_act a;
	const ssize_t n = recv(e->fd, &a, sizeof(a), MSG_TRUNC);

	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return;
	if (n != sizeof(a) || a.magic != STOP_ACT_MAGIC || a.id == 0 ||
	    a.verb >= STOP_ACT_NVERBS) {
		end_close(e);
		return;
	}
	c.id = e->id = a.id;
	c.verb = verb[a.verb];
	c.instance = s->status->head.instance;
	s->paid_ns += EACH_NS;
	ck_ring_enqueue_spsc_stop(&s->ring, s->slot, &c);
}

/* One that has no act is nobody's last hope yet; then the oldest. */
static struct stop_end *end_room(struct shm_stops *s)
{
	struct stop_end *room = &s->client[0];

	for (int i = 0; i < ENDS; i++) {
		struct stop_end *e = &s->client[i];

		if (e->fd < 0)
			return e;
		if ((e->id == 0) > (room->id == 0) ||
		    ((e->id == 0) == (room->id == 0) &&
		     e->since_ns < room->since_ns))
			room = e;
	}
	end_close(room);
	return room;
}

static void end_greet(struct shm_stops *s, int64_t now_ns)
{
	const int fd = accept4(s->listening, NULL, NULL,
			       SOCK_CLOEXEC | SOCK_NONBLOCK);
	struct stop_end *e;

	if (fd < 0)
		return;
	e = end_room(s);
	*e = (struct stop_end) { .fd = fd, .since_ns = now_ns };
	/* Who connects has most often sent already. */
	act_take(s, e);
}

static void end_answer(struct shm_stops *s, struct stop_end *e, int64_t now_ns)
{
	struct stop_answer a = { .magic = STOP_ACT_MAGIC, .id = e->id };
	struct shm_done d;

	if (e->fd < 0 || !e->id)
		return;
	if (!shm_done(s->status, e->id, &d) || d.code == SHM_TAKEN) {
		if (now_ns - e->since_ns > GIVE_UP_NS)
			end_close(e);
		return;
	}
	a.code = d.code;
	send(e->fd, &a, sizeof(a), MSG_NOSIGNAL | MSG_DONTWAIT);
	/* The client closes: a recv() that finds the queue empty, and then that
	 * this end is closed, would take what came in between for nothing. */
	e->id = 0;
}

/* What to wait for.  Return: for how long, ms. */
static int look_out(struct shm_stops *s, struct pollfd p[ENDS + 2],
		    bool paid)
{
	int ms = paid ? -1 : LOOK_MS;

	p[0] = (struct pollfd) { .fd = s->end, .events = POLLIN };
	p[1] = (struct pollfd) { .fd = paid ? s->listening : -1,
				 .events = POLLIN };
	for (int i = 0; i < ENDS; i++) {
		const struct stop_end *e = &s->client[i];

		p[i + 2] = (struct pollfd) {
			.fd = paid && !e->id ? e->fd : -1, .events = POLLIN,
		};
		if (e->fd >= 0 && e->id)
			ms = LOOK_MS;
	}
	return ms;
}

/* Without the right to it the thread waits as others do.  daemon/setup tells
 * that there is no such right. */
static void go_before_others(void)
{
	const struct sched_param p = { .sched_priority = PRIORITY };

	pthread_setschedparam(pthread_self(), SCHED_FIFO, &p);
}

static void *stops_run(void *arg)
{
	struct shm_stops *s = arg;
	struct pollfd p[ENDS + 2];

	go_before_others();
	for (;;) {
		bool paid = is_paid(s, clock_ns(CLOCK_MONOTONIC));
		int64_t now_ns;

		if (poll(p, ENDS + 2, look_out(s, p, paid)) < 0 &&
		    errno != EINTR)
			break;
		if (p[0].revents)
			break;
		now_ns = clock_ns(CLOCK_MONOTONIC);
		for (int i = 0; i < ENDS; i++) {
			end_answer(s, &s->client[i], now_ns);
			if (p[i + 2].revents && is_paid(s, now_ns))
				act_take(s, &s->client[i]);
		}
		if (p[1].revents && is_paid(s, now_ns))
			end_greet(s, now_ns);
	}
	return NULL;
}

static int stops_start(struct shm_stops *s)
{
	s->listening = places_listen(&s->at, SOCK_SEQPACKET);
	if (s->listening < 0)
		return s->listening;
	s->end = eventfd(0, EFD_CLOEXEC);
	return s->end < 0 ? -errno :
	       thread_start(&s->thread, &(struct thread) {
			.name = "edmd-stops", .run = stops_run, .arg = s });
}

static void stops_free(struct shm_stops *s)
{
	for (int i = 0; i < ENDS; i++)
		end_close(&s->client[i]);
	if (s->listening >= 0)
		close(s->listening);
	if (s->end >= 0)
		close(s->end);
	free(s);
}

int shm_stop_create(struct shm_stops **ret, const char *machine,
		    const struct shm_status *status)
{
	struct shm_stops *s = calloc(1, sizeof(*s));
	int err;

	if (!s)
		return -ENOMEM;
	for (int i = 0; i < ENDS; i++)
		s->client[i].fd = -1;
	s->listening = s->end = -1;
	s->status = status;
	ck_ring_init(&s->ring, SLOTS);
	err = places_address(&s->at, machine, "stop");
	if (err == 0)
		err = stops_start(s);
	if (err < 0) {
		stops_free(s);
		return err;
	}
	*ret = s;
	return 0;
}

void shm_stop_destroy(struct shm_stops *s)
{
	if (!s)
		return;
	object_thread_end(s->thread, s->end);
	unlink(s->at.sun_path);
	stops_free(s);
}

bool shm_stop_take(struct shm_stops *s, struct shm_command *ret)
{
	return s && ck_ring_dequeue_spsc_stop(&s->ring, s->slot, ret);
}

unsigned int shm_stop_waits(const struct shm_stops *s)
{
	return ck_ring_size(&s->ring);
}
