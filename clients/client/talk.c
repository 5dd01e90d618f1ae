/* SPDX-License-Identifier: Apache-2.0 */
/*
 * talk.c - speaks with edmd-jobs by LCM's messages
 *
 * The client learns the service's boot number and clock from an ack that has
 * the client's own name.  The name was drawn a moment ago, so nobody can have
 * recorded such an ack before.  A status or an event counts if it has that boot
 * number and is later than that ack and than the previous one.  Until the boot
 * number is known, and whenever a status has another one, the client asks
 * "hello", signed for the boot number and the time of that status.  If these
 * are the true ones, the service always answers, however many recorded packets
 * of other times it has to answer.
 */
#include "talk.h"

#include "clocks.h"
#include "packet.h"
#include "seal.h"
#include "standard.h"
#include "talk_stop.h"
#include "talk_way.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define CHANNEL_MAX	64
#define QUEUE_MESSAGES	256
#define REPEAT_S	0.3
#define HELLO_S		0.2
#define LISTENERS	8
#define ALONE_S		0.5		/* then what edmd itself has done is
					 * told */
#define CODE_AGAIN	100		/* sign it again; messages/README.md */

/* A question that waits for its answer. */
struct question {
	int64_t seq;			/* 0: free */
	char *verb, *job, *text;
	double arg, until_s, sent_s, begun_s;
	talk_answer_fn fn;
	void *arg_fn;
	struct talk_stop stop;
	bool ended;			/* edmd itself has done it */
};

struct listener {
	int64_t first;			/* 0: free */
	int n;
	void (*fn)(void *arg, const struct talk_ack *a);
	void *arg;
};

struct talk {
	struct talk_way *way;
	bool is_here;			/* the machine is on this host */
	struct keyfile key;
	char machine[32];
	char client[TALK_WORD_MAX];
	char why[TALK_SAID_MAX];
	bool turned_away;		/* the service itself said why */
	int64_t seq;
	/* Of the service: whether its start and its clock are known. */
	bool known;
	int64_t boot, ahead_us;		/* its clock minus ours */
	int64_t count;			/* the last we signed with */
	int64_t heard;			/* count of its last status or event */
	int64_t guess, guess_ahead_us;	/* boot and clock of a status that may
					 * be a recording; 0: none */
	int64_t hello;			/* seq of the hello; 0: none is under
					 * way */
	double hello_s;
	struct question question[TALK_QUESTIONS];
	struct listener listener[LISTENERS];
	struct talk_status status;
	uint64_t nstatus, nevents;
	void (*on_event)(void *arg, const struct talk_event *e);
	void *on_event_arg;
};

/* What talk_ask() waits for. */
struct asking {
	struct talk_answer *ret;
	bool over;
	int err;
};

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
	(void)number;
	interrupted = 1;
	standard_interrupt();
}

void talk_catch_signals(void)
{
	struct sigaction sa = { .sa_handler = on_signal };

	sigaction(SIGINT, &sa, NULL);
	sigaction(SIGTERM, &sa, NULL);
}

bool talk_interrupted(void)
{
	return interrupted;
}

double talk_now_s(void)
{
	return (double)clock_us(CLOCK_MONOTONIC) * 1e-6;
}

/* -- Sending -------------------------------------------------------------- */

static void channel_name(const struct talk *t, const char *name,
			 char ret[CHANNEL_MAX])
{
	snprintf(ret, CHANNEL_MAX, "EDM.%s.%s", t->machine, name);
}

/* Our count is the service's clock, as far as we know it, and it must grow. */
static int64_t next_count(struct talk *t)
{
	const int64_t now =
		t->known ? clock_us(CLOCK_MONOTONIC) + t->ahead_us : 0;

	t->count = now > t->count ? now : t->count + 1;
	return t->count;
}

/* @data is freed. */
static void sign_and_send(struct talk *t, const char *name, struct seal s,
			  uint8_t *data)
{
	uint8_t *packet = data ? malloc(SEAL_BYTES + s.size) : NULL;
	char channel[CHANNEL_MAX];
	size_t n = 0;

	s.key = t->key.public;
	s.data = data;
	channel_name(t, name, channel);
	if (packet)
		n = seal_make(packet, &s, channel, t->key.secret);
	if (n)
		talk_way_send(t->way, channel, packet, n);
	free(packet);
	free(data);
}

static struct seal next_seal(struct talk *t)
{
	return (struct seal) {
		.boot = t->known ? t->boot : 0, .count = next_count(t),
	};
}

static void send_question(struct talk *t, struct question *q)
{
	const struct packet_from f = { .client = t->client, .seq = q->seq };
	const struct talk_question what = {
		.verb = q->verb, .job = q->job, .text = q->text, .arg = q->arg,
	};
	struct seal s = next_seal(t);
	uint8_t *data = packet_command(&f, &what, &s.size);

	q->sent_s = talk_now_s();
	sign_and_send(t, "COMMAND", s, data);
}

static void send_hello(struct talk *t)
{
	const struct talk_question what = { .verb = "hello" };
	struct packet_from f;
	struct seal s;
	uint8_t *data;

	if (talk_now_s() - t->hello_s < HELLO_S)
		return;
	t->hello_s = talk_now_s();
	if (!t->hello)
		t->hello = ++t->seq;
	f = (struct packet_from) { .client = t->client, .seq = t->hello };
	if (t->guess && (!t->known || t->guess != t->boot))
		s = (struct seal) {
			.boot = t->guess,
			.count = clock_us(CLOCK_MONOTONIC) +
				 t->guess_ahead_us,
		};
	else
		s = next_seal(t);
	data = packet_command(&f, &what, &s.size);
	sign_and_send(t, "COMMAND", s, data);
}

bool talk_send_chunk(struct talk *t, const struct talk_chunk *c)
{
	const struct packet_from f = { .client = t->client, .seq = c->seq };
	struct seal s;
	uint8_t *data;

	if (!t->known)
		return false;
	s = next_seal(t);
	data = packet_chunk(&f, c, &s.size);
	sign_and_send(t, "JOB", s, data);
	return true;
}

/* -- Hearing -------------------------------------------------------------- */

static void question_end(struct question *q, int err,
			 const struct talk_ack *a)
{
	const struct question was = *q;

	free(q->verb);
	free(q->job);
	free(q->text);
	talk_stop_end(&q->stop);
	*q = (struct question) { .seq = 0 };
	if (was.fn)
		was.fn(was.arg_fn, err, a);
}

static struct question *question_find(struct talk *t, int64_t seq)
{
	for (int i = 0; i < TALK_QUESTIONS; i++)
		if (t->question[i].seq == seq)
			return &t->question[i];
	return NULL;
}

/* Learn the present state of the service from an ack that was made in this
 * minute. */
static void learn(struct talk *t, const struct seal *s)
{
	if (!t->known || t->boot != s->boot) {
		t->boot = s->boot;
		t->heard = s->count;
		t->count = 0;
	}
	t->ahead_us = s->count - clock_us(CLOCK_MONOTONIC);
	t->known = true;
	t->hello = 0;
	t->why[0] = '\0';
	t->turned_away = false;
}

static void send_waiting(struct talk *t)
{
	for (int i = 0; i < TALK_QUESTIONS; i++)
		if (t->question[i].seq)
			send_question(t, &t->question[i]);
}

static void hear_listeners(struct talk *t, const struct talk_ack *a)
{
	for (int i = 0; i < LISTENERS; i++) {
		struct listener *l = &t->listener[i];

		if (l->first && a->seq >= l->first &&
		    a->seq - l->first < l->n) {
			l->fn(l->arg, a);
			return;
		}
	}
}

static void hear_ack(void *arg, const struct seal *s, const uint8_t *key,
		     const char *client, const struct talk_ack *a)
{
	struct talk *t = arg;
	struct question *q;

	if (strcmp(client, t->client) != 0 ||
	    memcmp(key, t->key.public, SEAL_KEY_BYTES) != 0)
		return;
	q = a->seq > 0 ? question_find(t, a->seq) : NULL;
	if (a->code == CODE_AGAIN) {
		/* The count of an ack that was made long ago would be
		 * misleading. */
		if (!q && a->seq != t->hello)
			return;
		learn(t, s);
		send_waiting(t);
	} else if (a->seq == t->hello && a->seq) {
		t->turned_away = a->code != 0;
		if (a->code == 0)
			learn(t, s);
		else
			snprintf(t->why, sizeof(t->why), "%s", a->reason);
	} else if (q) {
		/* Its clock and ours drift apart, a little every hour. */
		if (s->boot == t->boot)
			t->ahead_us = s->count - clock_us(CLOCK_MONOTONIC);
		question_end(q, 0, a);
	} else if (s->boot == t->boot) {
		hear_listeners(t, a);
	}
}

/*
 * Is it signed by the machine of our key file, for this channel?  Anybody may
 * sign with a key of their own: that explains why nothing was heard, and
 * decides nothing.
 */
static bool is_machine(struct talk *t, struct seal *ret,
		       const struct udpm_packet *u)
{
	if (!seal_read(ret, u->data, u->size))
		return false;
	if (memcmp(ret->key, t->key.machine_key, SEAL_KEY_BYTES) != 0) {
		if (!t->known && !t->why[0] && seal_holds(ret, u->channel))
			snprintf(t->why, sizeof(t->why), "somebody signs as "
				 "machine %s with another key than that of our "
				 "key file; if the machine's keys were made "
				 "anew, get a new key file: edmctl keys add",
				 t->machine);
		return false;
	}
	return seal_holds(ret, u->channel);
}

/* What waited for us, while a long text was hashed, shows its clock as it was.
 * Signed by that, a chunk would come too late. */
static void hear_clock(struct talk *t, const struct seal *s)
{
	const int64_t ahead_us = s->count - clock_us(CLOCK_MONOTONIC);

	if (ahead_us > t->ahead_us)
		t->ahead_us = ahead_us;
}

/* Is it from this start of the service, and later than the previous one? */
static bool is_news(struct talk *t, const struct seal *s)
{
	if (!t->known || s->boot != t->boot) {
		t->guess = s->boot;
		t->guess_ahead_us = s->count - clock_us(CLOCK_MONOTONIC);
		send_hello(t);
		return false;
	}
	if (s->count <= t->heard)
		return false;
	t->heard = s->count;
	hear_clock(t, s);
	return true;
}

static void on_ack(struct talk *t, const struct seal *s)
{
	packet_ack(s, hear_ack, t);
}

static void on_status(struct talk *t, const struct seal *s)
{
	if (is_news(t, s) && packet_status(s, &t->status))
		t->nstatus++;
}

static void on_event(struct talk *t, const struct seal *s)
{
	if (is_news(t, s) && packet_event(s, t->on_event, t->on_event_arg))
		t->nevents++;
}

static void take(struct talk *t, const struct udpm_packet *u)
{
	static const struct {
		const char *name;
		void (*fn)(struct talk *t, const struct seal *s);
	} heard[] = {
		{ "ACK", on_ack }, { "STATUS", on_status },
		{ "EVENT", on_event },
	};
	char channel[CHANNEL_MAX];
	struct seal s;

	for (size_t i = 0; i < sizeof(heard) / sizeof(heard[0]); i++) {
		channel_name(t, heard[i].name, channel);
		if (strcmp(u->channel, channel) == 0 && is_machine(t, &s, u))
			heard[i].fn(t, &s);
	}
}

/* -- Opening -------------------------------------------------------------- */

static int key_take(struct talk *t, const char *path, char *said)
{
	int err;

	if (!path)
		path = getenv("EDM_KEY");
	err = path && *path ? keyfile_read(&t->key, path, said) :
			      keyfile_find(&t->key, t->machine, said);
	if (err < 0)
		return err;
	if (strcmp(t->key.machine, t->machine) == 0)
		return 0;
	snprintf(said, TALK_SAID_MAX, "the key is of machine %s, and machine "
		 "%s is asked for; --key FILE names another, --machine %s the "
		 "other", t->key.machine, t->machine, t->key.machine);
	return -EINVAL;
}

const char *talk_machine(const struct talk_options *o)
{
	return o->machine ? o->machine : "edm";
}

int talk_open(struct talk **ret, const struct talk_options *o,
	      char said[TALK_SAID_MAX])
{
	struct talk *t = calloc(1, sizeof(*t));
	int err = t && sodium_init() >= 0 ? 0 : -ENOMEM;

	snprintf(said, TALK_SAID_MAX, "out of memory");
	if (err == 0) {
		t->is_here = !o->url && !o->carrier;
		snprintf(t->machine, sizeof(t->machine), "%s",
			 talk_machine(o));
		snprintf(t->client, sizeof(t->client), "%.20s-%d-%08x%08x",
			 o->program ? o->program : "client", (int)getpid(),
			 randombytes_random(), randombytes_random());
		err = talk_way_open(&t->way, o, said);
	}
	/* Where there is no network, no service has made a key yet. */
	if (err == 0)
		err = key_take(t, o->key, said);
	if (err < 0) {
		talk_close(t);
		return err;
	}
	t->hello_s = -1;
	send_hello(t);
	*ret = t;
	return 0;
}

void talk_close(struct talk *t)
{
	if (!t)
		return;
	for (int i = 0; i < TALK_QUESTIONS; i++) {
		t->question[i].fn = NULL;
		question_end(&t->question[i], -ECANCELED, NULL);
	}
	talk_way_close(t->way);
	sodium_memzero(&t->key, sizeof(t->key));
	free(t);
}

const struct keyfile *talk_key(const struct talk *t)
{
	return &t->key;
}

const char *talk_why(const struct talk *t)
{
	return t->why;
}

/* -- Questions ------------------------------------------------------------ */

/* edmd itself has carried the act out.  Its refusal is no answer: edmd-jobs
 * knows of jobs that edmd does not. */
static void stop_turn(struct question *q, double now_s)
{
	int code;

	if (talk_stop_turn(&q->stop, &code))
		q->ended = code == 0;
	if (!q->ended || now_s < q->begun_s + ALONE_S)
		return;
	question_end(q, 0, &(struct talk_ack) {
		.seq = q->seq, .reason = TALK_STOP_DONE, .body = "",
	});
}

/* Send again what is due, and give up what has waited long enough. */
static void questions_turn(struct talk *t)
{
	const double now_s = talk_now_s();

	if (!t->known)
		send_hello(t);
	for (int i = 0; i < TALK_QUESTIONS; i++) {
		struct question *q = &t->question[i];

		if (q->seq)
			stop_turn(q, now_s);
		if (!q->seq)
			continue;
		if (now_s > q->until_s)
			question_end(q, -ETIMEDOUT, NULL);
		else if (t->known && now_s - q->sent_s > REPEAT_S)
			send_question(t, q);
	}
}

int talk_fd(const struct talk *t)
{
	return talk_way_fd(t->way);
}

void talk_step(struct talk *t)
{
	struct pollfd p = { .fd = talk_fd(t), .events = POLLIN };
	struct udpm_packet u;

	for (int i = 0; i < QUEUE_MESSAGES && poll(&p, 1, 0) > 0; i++)
		if (talk_way_take(t->way, &u))
			take(t, &u);
	talk_way_look(t->way);
	questions_turn(t);
}

void talk_wait(struct talk *t, int ms)
{
	struct pollfd p = { .fd = talk_fd(t), .events = POLLIN };

	if (!interrupted && poll(&p, 1, ms) >= 0)
		talk_step(t);
}

/* An act that ends motion takes the place of what was asked first. */
static struct question *room_for(struct talk *t, const char *verb)
{
	struct question *room = question_find(t, 0);

	if (room || !talk_stop_is(verb))
		return room;
	for (int i = 0; i < TALK_QUESTIONS; i++) {
		struct question *q = &t->question[i];

		if (!talk_stop_is(q->verb) && (!room || q->seq < room->seq))
			room = q;
	}
	if (room)
		question_end(room, -ETIMEDOUT, NULL);
	return room;
}

int talk_send(struct talk *t, const struct talk_question *q, double timeout_s,
	      talk_answer_fn fn, void *arg)
{
	struct question *room = room_for(t, q->verb);

	if (!room)
		return -EAGAIN;
	*room = (struct question) {
		.seq = ++t->seq, .arg = q->arg, .fn = fn, .arg_fn = arg,
		.verb = strdup(q->verb), .job = strdup(q->job ? q->job : ""),
		.text = strdup(q->text ? q->text : ""),
		.begun_s = talk_now_s(),
		.until_s = talk_now_s() + timeout_s,
	};
	if (!room->verb || !room->job || !room->text) {
		room->fn = NULL;
		question_end(room, -ENOMEM, NULL);
		return -ENOMEM;
	}
	/* Whose key may only look does not ask edmd past it. */
	if (t->is_here && talk_stop_is(q->verb) &&
	    strcmp(t->key.role, "viewer") != 0)
		talk_stop_begin(&room->stop, t->machine, q->verb,
				seal_act_id(t->key.public, t->client,
					    room->seq));
	if (t->known)
		send_question(t, room);
	return 0;
}

void talk_forget(struct talk *t, const void *arg)
{
	for (int i = 0; i < TALK_QUESTIONS; i++) {
		struct question *q = &t->question[i];

		if (!q->seq || q->arg_fn != arg)
			continue;
		q->fn = NULL;
		question_end(q, 0, NULL);
	}
}

int talk_answer_copy(struct talk_answer *ret, const struct talk_ack *a)
{
	*ret = (struct talk_answer) {
		.code = a->code, .reason = strdup(a->reason),
		.body = strdup(a->body),
	};
	if (ret->reason && ret->body)
		return 0;
	talk_answer_free(ret);
	return -ENOMEM;
}

static void on_asked(void *arg, int err, const struct talk_ack *a)
{
	struct asking *asking = arg;

	asking->over = true;
	asking->err = err < 0 ? err : talk_answer_copy(asking->ret, a);
}

/* The service refuses us: that is an answer, too. */
static bool is_turned_away(const struct talk *t, struct asking *asking)
{
	if (t->known || !t->turned_away)
		return false;
	*asking->ret = (struct talk_answer) {
		.code = EX_NOPERM, .reason = strdup(t->why),
		.body = strdup(""),
	};
	asking->err = 0;
	return true;
}

int talk_ask(struct talk *t, const struct talk_question *q, double timeout_s,
	     struct talk_answer *ret)
{
	struct asking asking = { .ret = ret };
	int64_t seq = t->seq + 1;
	int err = talk_send(t, q, timeout_s, on_asked, &asking);

	while (err == 0 && !asking.over && !interrupted &&
	       !is_turned_away(t, &asking))
		talk_wait(t, TALK_TURN_MS);
	if (err == 0 && !asking.over) {
		struct question *left = question_find(t, seq);

		left->fn = NULL;
		question_end(left, -EINTR, NULL);
		if (interrupted)
			return -EINTR;
	}
	return err ? err : asking.err;
}

void talk_answer_free(struct talk_answer *a)
{
	free(a->reason);
	free(a->body);
	*a = (struct talk_answer) { .code = 0 };
}

void talk_on_event(struct talk *t,
		   void (*fn)(void *arg, const struct talk_event *e),
		   void *arg)
{
	t->on_event = fn;
	t->on_event_arg = arg;
}

const struct talk_status *talk_status(const struct talk *t,
				      uint64_t *ret_count)
{
	*ret_count = t->nstatus;
	return t->nstatus ? &t->status : NULL;
}

uint64_t talk_events(const struct talk *t)
{
	return t->nevents;
}

/* -- For job.c ------------------------------------------------------------ */

int64_t talk_numbers(struct talk *t, int n)
{
	int64_t first = t->seq + 1;

	t->seq += n;
	return first;
}

int64_t talk_boot(const struct talk *t)
{
	return t->known ? t->boot : 0;
}

int talk_on_acks(struct talk *t, int64_t first, int n,
		 void (*fn)(void *arg, const struct talk_ack *a), void *arg)
{
	for (int i = 0; i < LISTENERS; i++) {
		if (t->listener[i].first)
			continue;
		t->listener[i] = (struct listener) {
			.first = first, .n = n, .fn = fn, .arg = arg,
		};
		return 0;
	}
	return -EAGAIN;
}

void talk_off_acks(struct talk *t, int64_t first)
{
	for (int i = 0; i < LISTENERS; i++)
		if (t->listener[i].first == first)
			t->listener[i].first = 0;
}
