/* SPDX-License-Identifier: Apache-2.0 */
/* lcm.c - converts generated LCM messages to our structs and back */
#include "lcm.h"

#include "clocks.h"
#include "jobs_log.h"
#include "local.h"
#include "places.h"

#include "edm_ack_t.h"
#include "edm_command_t.h"
#include "edm_event_t.h"
#include "edm_job_chunk_t.h"
#include "edm_status_t.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define CHANNEL_MAX	64
#define AGAIN_US	1000000		/* between two tries to join */

struct jobs_lcm {
	struct udpm_url url;
	struct udpm *net;		/* NULL: there is no multicast now */
	struct local *local;		/* NULL: there is no socket */
	int epoll;			/* of both */
	int wrong;			/* -errno of the last try of net */
	int64_t tried_us;
	char machine[32];
	char command[CHANNEL_MAX], job[CHANNEL_MAX];
	struct jobs_lcm_handlers handlers;
	struct trust *trust;
	uint64_t strange;		/* number of malformed packets that were
					 * reported */
};

/* What comes before every message: who sent it. */
struct origin {
	enum trust_cause cause;
	const struct trust_packet *packet;
	bool here;		/* it came by the socket of this host */
};

/* LCM declares strings as char *, but only reads them. */
static char *lent(const char *s)
{
	return (char *)(uintptr_t)(s ? s : "");
}

/*
 * The generated decoder trusts every length that it reads: it copies a negative
 * one as a huge one, and a string need not have an end.  So the shape of its
 * type is checked for each packet first:
 *
 *	q 8 bytes, i 4 bytes, b 1 byte, H 32 bytes, s a string,
 *	a as many bytes as the i before it says
 */
static bool shape_step(char what, const uint8_t **at, size_t *left,
		       uint32_t *count)
{
	size_t n;

	switch (what) {
	case 'q':
		n = 8;
		break;
	case 'b':
		n = 1;
		break;
	case 'H':
		n = 32;
		break;
	case 'a':
		n = *count;
		break;
	default:			/* i, s: four bytes, big-endian */
		if (*left < 4)
			return false;
		*count = (uint32_t)(*at)[0] << 24 | (uint32_t)(*at)[1] << 16 |
			 (uint32_t)(*at)[2] << 8 | (*at)[3];
		n = what == 's' ? 4 + (size_t)*count : 4;
		break;
	}
	if (n > *left)
		return false;
	if (what == 's' && (*count == 0 || memchr(*at + 4, '\0', *count) !=
			    *at + n - 1))
		return false;
	*at += n;
	*left -= n;
	return true;
}

/* @ret_count: the value of the last i or s. */
static bool shape_fits(const struct seal *m, const char *shape,
		       uint32_t *ret_count)
{
	const uint8_t *at = m->data;
	size_t left = m->size;

	for (; *shape; shape++)
		if (!shape_step(*shape, &at, &left, ret_count))
			return false;
	return left == 0;
}

/* The first q of a shape is the fingerprint of the type. */
#define SHAPE_COMMAND	"qqsqssqs"
#define SHAPE_CHUNK	"qqsqssqHiiqbiqisia"

/* Tell the sender why its packet is not accepted. */
static void tell_refused(struct jobs_lcm *w, const struct jobs_lcm_ack *to,
			 enum trust_cause cause)
{
	const bool again = cause == TRUST_BOOT || cause == TRUST_TIME;
	char reason[192];

	snprintf(reason, sizeof(reason), "%s%s", trust_cause_text(cause),
		 again ? "; sign it again, with boot and count of this answer" :
		 cause == TRUST_KEY ? "; edmctl keys add makes one" :
		 "; try again in 30 s");
	jobs_lcm_ack(w, &(struct jobs_lcm_ack) {
		.key = to->key, .client = to->client, .seq = to->seq,
		.reason = reason,
		.code = again ? JOBS_LCM_AGAIN :
			cause == TRUST_KEY ? EX_NOPERM : EX_TEMPFAIL,
	});
}

/* Is the packet signed with a known key, for the present time, and new?  If
 * not, say so. */
static bool is_taken(struct jobs_lcm *w, const struct origin *o,
		     const struct trust_client *from, int64_t seq)
{
	const char *client = from->name;
	struct jobs_lcm_ack to = {
		.key = o->packet->seal.key, .client = client, .seq = seq,
		.code = EX_PROTOCOL,
		.reason = "the client's name is empty or too long; "
			  "1 to 63 bytes",
	};
	const int64_t now = clock_us(CLOCK_MONOTONIC);
	enum trust_cause cause = o->cause;
	const size_t n = strlen(client);
	char who[KEYFILE_NAME_MAX];
	bool is_guest;

	if (cause == TRUST_FINE && (n == 0 || n >= TRUST_CLIENT_MAX)) {
		jobs_lcm_ack(w, &to);
		return false;
	}
	if (cause == TRUST_FINE)
		cause = trust_fresh(w->trust, o->packet, from, now);
	/* Who repeats a packet of another is not the other. */
	if (o->here && n < LOCAL_CLIENT_MAX && cause != TRUST_REPLAY)
		local_is(w->local, &(struct local_who) { to.key, client });
	if (cause == TRUST_FINE)
		return true;
	trust_who(o->packet, who);
	/* A client that asks for the first time cannot know the boot number. */
	is_guest = cause == TRUST_BOOT && o->packet->seal.boot == 0;
	if (!is_guest)
		trust_refuse(w->trust, cause, who, o->packet->from, now);
	if (cause != TRUST_REPLAY)
		tell_refused(w, &to, cause);
	if (is_guest)
		w->handlers.guest(w->handlers.arg);
	return false;
}

/* Return: false if the packet does not have the shape of the type. */
static bool on_command(struct jobs_lcm *w, const struct origin *o)
{
	const struct seal *s = &o->packet->seal;
	struct jobs_lcm_command c;
	uint32_t count = 0;
	edm_command_t m;

	if (!shape_fits(s, SHAPE_COMMAND, &count) ||
	    edm_command_t_decode(s->data, 0, (int)s->size, &m) < 0)
		return false;
	c = (struct jobs_lcm_command) {
		.key = s->key, .client = m.client, .seq = m.seq, .verb = m.verb,
		.job = m.job, .text = m.text, .arg = m.arg,
		.by = o->packet->key, .from = o->packet->from,
		.signed_us = trust_signed_us(w->trust, s),
	};
	if (is_taken(w, o, &(struct trust_client) {
			.name = m.client, .want = w->handlers.want(m.verb) },
		     m.seq))
		w->handlers.command(w->handlers.arg, &c);
	edm_command_t_decode_cleanup(&m);
	return true;
}

/*
 * For a chunk without data, as from an empty file, the generated decoder copies
 * 0 bytes to NULL, which C does not allow.  So such a chunk is decoded as one
 * with a single byte.
 */
static int chunk_decode(const struct seal *s, uint32_t size,
			edm_job_chunk_t *ret)
{
	const size_t n = s->size;
	uint8_t *padded;
	int got;

	if (size > 0)
		return edm_job_chunk_t_decode(s->data, 0, (int)n, ret);
	padded = calloc(n + 1, 1);
	if (!padded)
		return -1;
	/* The size is the last field of the packet, big-endian. */
	memcpy(padded, s->data, n);
	padded[n - 1] = 1;
	got = edm_job_chunk_t_decode(padded, 0, (int)n + 1, ret);
	free(padded);
	if (got >= 0)
		ret->size = 0;
	return got;
}

static bool on_chunk(struct jobs_lcm *w, const struct origin *o)
{
	const struct seal *s = &o->packet->seal;
	struct jobs_lcm_chunk c;
	uint32_t size = 0;
	edm_job_chunk_t m;

	if (!shape_fits(s, SHAPE_CHUNK, &size) || chunk_decode(s, size, &m) < 0)
		return false;
	c = (struct jobs_lcm_chunk) {
		.key = s->key, .client = m.client, .seq = m.seq, .job = m.job,
		.name = m.name,
		.bytes = m.bytes, .sha256 = m.sha256, .chunk = m.chunk,
		.chunks = m.chunks, .offset = m.offset, .hold = m.hold != 0,
		.from_line = m.from_line, .from_mm = m.from_mm,
		.electrode = m.electrode, .setting = m.setting,
		.size = (uint32_t)m.size, .data = m.data,
		.signed_us = trust_signed_us(w->trust, s),
		.by = o->packet->key, .from = o->packet->from,
	};
	if (is_taken(w, o, &(struct trust_client) {
			.name = m.client, .want = TRUST_ACTS }, m.seq))
		w->handlers.chunk(w->handlers.arg, &c);
	edm_job_chunk_t_decode_cleanup(&m);
	return true;
}

static void on_packet(struct jobs_lcm *w, const struct udpm_packet *u,
		      bool here)
{
	const bool command = strcmp(u->channel, w->command) == 0;
	const int64_t now = clock_us(CLOCK_MONOTONIC);
	struct trust_packet packet = { .channel = u->channel, .from = u->from };
	struct origin o = { .packet = &packet, .here = here };
	char who[KEYFILE_NAME_MAX] = "no key";

	/* It is for another machine, or it is something that only services
	 * send. */
	if (!command && strcmp(u->channel, w->job) != 0)
		return;
	o.cause = trust_look(w->trust, &packet, u->data, u->size, now);
	if (o.cause == TRUST_FINE || packet.answers) {
		if (command ? on_command(w, &o) : on_chunk(w, &o))
			return;
		o.cause = TRUST_SHAPE;
	}
	if (packet.seal.key)
		trust_who(&packet, who);
	trust_refuse(w->trust, o.cause, who, u->from, now);
}

static void channel_name(const struct jobs_lcm *w, const char *name,
			 char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM.%s.%s", w->machine, name);
}

static int watch(struct jobs_lcm *w, int fd)
{
	struct epoll_event e = { .events = EPOLLIN };

	return epoll_ctl(w->epoll, EPOLL_CTL_ADD, fd, &e) < 0 ? -errno : 0;
}

/* What is wrong is said once, and once more when it is mended. */
static void tell_net(struct jobs_lcm *w, int err)
{
	char why[UDPM_WHY_MAX];

	if (err < 0 && err != w->wrong) {
		udpm_why(&w->url, err, why, sizeof(why));
		log_warning("lcm: no multicast, so only clients of this host "
			    "are served: %s", why);
	} else if (err == 0 && w->wrong) {
		log_notice("lcm: there is multicast now");
	}
	w->wrong = err;
}

void jobs_lcm_look(struct jobs_lcm *w, int64_t now_us)
{
	int err;

	if (w->net || (w->tried_us && now_us - w->tried_us < AGAIN_US))
		return;
	w->tried_us = now_us;
	err = udpm_open(&w->net, &w->url);
	if (err == 0) {
		udpm_choose(w->net, (const char *[]){ w->command, w->job }, 2);
		err = watch(w, udpm_fd(w->net));
	}
	tell_net(w, err);
}

static void open_local(struct jobs_lcm *w)
{
	struct sockaddr_un at;
	int err = places_address(&at, w->machine, "jobs");

	if (err == 0)
		err = local_open(&w->local, &at);
	if (err == 0)
		err = watch(w, local_fd(w->local));
	if (err < 0)
		log_error("lcm: no socket %s, so clients of this host need "
			  "multicast: %s", at.sun_path, strerror(-err));
}

int jobs_lcm_open(struct jobs_lcm **ret, const struct udpm_url *url,
	      const char *machine, const struct jobs_lcm_handlers *h)
{
	const int epoll = epoll_create1(EPOLL_CLOEXEC);
	struct jobs_lcm *w = epoll < 0 ? NULL : calloc(1, sizeof(*w));

	if (!w)
		return -ENOMEM;
	w->epoll = epoll;
	w->url = *url;
	snprintf(w->machine, sizeof(w->machine), "%s", machine);
	w->handlers = *h;
	w->trust = h->trust;
	channel_name(w, "COMMAND", w->command);
	channel_name(w, "JOB", w->job);
	open_local(w);
	jobs_lcm_look(w, clock_us(CLOCK_MONOTONIC));
	if (!w->local && !w->net) {
		jobs_lcm_close(w);
		return -ENETUNREACH;
	}
	*ret = w;
	return 0;
}

void jobs_lcm_close(struct jobs_lcm *w)
{
	if (!w)
		return;
	udpm_close(w->net);
	local_close(w->local);
	close(w->epoll);
	free(w);
}

bool jobs_lcm_is_late(int64_t signed_us)
{
	return clock_us(CLOCK_MONOTONIC) - signed_us > JOBS_LCM_LATE_US;
}

int jobs_lcm_fd(const struct jobs_lcm *w)
{
	return w->epoll;
}

static void handle_net(struct jobs_lcm *w)
{
	struct udpm_packet packet;
	const char *from;
	uint64_t strange;

	if (udpm_take(w->net, &packet))
		on_packet(w, &packet, false);
	strange = udpm_strange(w->net, &from);
	for (; w->strange < strange; w->strange++)
		trust_refuse(w->trust, TRUST_STRANGE, "nobody", from,
			     clock_us(CLOCK_MONOTONIC));
}

void jobs_lcm_handle(struct jobs_lcm *w)
{
	struct udpm_packet packet;

	if (w->local && local_take(w->local, &packet))
		on_packet(w, &packet, true);
	if (w->net)
		handle_net(w);
}

/* Who asked by the socket is answered there; everybody hears the rest. */
static void spread(struct jobs_lcm *w, const struct local_who *to,
		   const char *channel, const void *packet, size_t size)
{
	const bool here = w->local &&
			  local_send(w->local, to, channel, packet, size);

	if (w->net && !(here && to))
		udpm_send(w->net, channel, packet, size);
}

/* Sign the message that LCM has encoded in @bytes, and send it to @to, or to
 * all. */
static void publish(struct jobs_lcm *w, const struct local_who *to,
		    const char *name, const void *data, int bytes)
{
	char channel[CHANNEL_MAX];
	const struct seal s = {
		.key = w->trust->machine.public, .boot = w->trust->boot,
		.count = trust_count(w->trust, clock_us(CLOCK_MONOTONIC)),
		.data = data,
		.size = bytes < 0 ? 0 : (size_t)bytes,
	};
	uint8_t *packet = bytes < 0 ? NULL : malloc(SEAL_BYTES + s.size);
	size_t n = 0;

	channel_name(w, name, channel);
	if (packet)
		n = seal_make(packet, &s, channel, w->trust->machine.secret);
	if (n)
		spread(w, to, channel, packet, n);
	else
		log_error("lcm: out of memory; a message is lost");
	free(packet);
}

/* Encode message @m of @type and send it on channel @name. */
#define PUBLISH(w, to, name, type, m) \
	do { \
		const int room = type ## _encoded_size(m); \
		uint8_t *data = malloc((size_t)room); \
		publish(w, to, name, data, data ? \
			type ## _encode(data, 0, room, m) : -1); \
		free(data); \
	} while (0)

void jobs_lcm_ack(struct jobs_lcm *w, const struct jobs_lcm_ack *a)
{
	const struct local_who to = { a->key, a->client };
	edm_ack_t m = {
		.utime = clock_us(CLOCK_REALTIME),
		.client = lent(a->client),
		.seq = a->seq,
		.code = a->code,
		.reason = lent(a->reason),
		.body = lent(a->body),
	};

	memcpy(m.key, a->key, sizeof(m.key));
	PUBLISH(w, &to, "ACK", edm_ack_t, &m);
}

void jobs_lcm_event(struct jobs_lcm *w, const struct jobs_lcm_event *e)
{
	edm_event_t m = {
		.utime = clock_us(CLOCK_REALTIME),
		.machine = w->machine,
		.kind = lent(e->kind),
		.job = lent(e->job),
		.outcome = lent(e->outcome),
		.place_mm = e->place_mm,
		.text = lent(e->text),
	};

	PUBLISH(w, NULL, "EVENT", edm_event_t, &m);
}

#define SEND_WORD(name)		.name = lent(s->name),
#define SEND_COUNT(name)	.name = (int32_t)s->name,
#define SEND_NUMBER(name)	.name = s->name,

void jobs_lcm_status(struct jobs_lcm *w, const struct jobs_lcm_status *s)
{
	edm_status_t m = {
		STATUS_FIELDS(SEND_WORD, SEND_WORD, SEND_COUNT, SEND_NUMBER)
		.utime = clock_us(CLOCK_REALTIME),
		.machine = w->machine,
		.faults = lent(s->faults),
		.contour_mm = s->contour_mm,
		.contour_predicted_mm = s->contour_predicted_mm,
	};

	memcpy(m.pos_mm, s->pos_mm, sizeof(m.pos_mm));
	memcpy(m.work_mm, s->work_mm, sizeof(m.work_mm));
	PUBLISH(w, NULL, "STATUS", edm_status_t, &m);
}
