/* SPDX-License-Identifier: Apache-2.0 */
/* dispatch.c - gives a job to one machine of the hall */
#include "dispatch.h"

#include "names.h"
#include "plain.h"
#include "post.h"
#include "standard.h"
#include "submission.h"
#include "submission_file.h"
#include "talk.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define NAME		"edm-fleet"
#define LONGEST		10		/* a machine that is named is waited for
					 * so many times wait_s */
#define HELLO_S		5.0
#define AGAIN_S		2.0		/* a machine that could not take it just
					 * now is asked again */
#define LOOK_MS		100

/* A machine that did not take it. */
struct tried {
	char machine[KEYFILE_NAME_MAX];
	char why[320];
	int code;
	double again_s;			/* when to ask again; INFINITY: never */
};

struct dispatch {
	const struct dispatch_options *o;
	dds_entity_t participant;
	struct hall *hall;
	struct submission_file text;
	char id[SUBMISSION_ID_MAX];
	struct tried *tried;		/* HALL_MAX */
	size_t ntried;
	double begun_s;
	double news_s;			/* a machine was new the last time */
	uint64_t news;
	bool tty;
	char said[512];			/* of the last line */
};

/* One machine, while it is offered the job. */
struct offer {
	struct dispatch *d;
	const char *machine;
	struct post post;
	struct talk_carrier carrier;
	struct talk *talk;
	struct submission *job;
	bool out;			/* it may have the job */
	bool said;			/* ... and is away */
};

/* -- Saying ---------------------------------------------------------------- */

static void wipe(const struct dispatch *d)
{
	if (d->tty)
		standard_control(stderr, "\r\033[K");
}

/* Where it stands: on a terminal one line; else a line when it is another. */
static void progress(struct dispatch *d, const char *text)
{
	if (strcmp(text, d->said) == 0)
		return;
	snprintf(d->said, sizeof(d->said), "%s", text);
	wipe(d);
	fprintf(stderr, d->tty ? "%.76s" : "%s\n", d->said);
}

__attribute__((format(printf, 2, 3)))
static void say(struct dispatch *d, const char *format, ...)
{
	va_list args;

	wipe(d);
	d->said[0] = '\0';
	fputs(NAME ": ", stderr);
	va_start(args, format);
	vfprintf(stderr, format, args);
	va_end(args);
	fputc('\n', stderr);
}

/* -- The machines ---------------------------------------------------------- */

static int look(struct dispatch *d)
{
	const int err = hall_look(d->hall);

	if (d->hall->news != d->news)
		d->news_s = talk_now_s();
	d->news = d->hall->news;
	return err;
}

static const struct hall_machine *find(const struct dispatch *d,
				       const char *machine)
{
	for (size_t i = 0; i < d->hall->n; i++)
		if (strcmp(d->hall->row[i].m.machine, machine) == 0)
			return &d->hall->row[i];
	return NULL;
}

static struct tried *tried_of(const struct dispatch *d, const char *machine)
{
	for (size_t i = 0; i < d->ntried; i++)
		if (strcmp(d->tried[i].machine, machine) == 0)
			return &d->tried[i];
	return NULL;
}

static void put_off(struct dispatch *d, const char *machine, int code,
		    const char *why)
{
	struct tried *t = tried_of(d, machine);
	const bool later = code == EX_TEMPFAIL || code == EX_UNAVAILABLE;

	if (!t)
		t = &d->tried[d->ntried++];
	*t = (struct tried) {
		.code = code,
		.again_s = later ? talk_now_s() + AGAIN_S : INFINITY,
	};
	snprintf(t->machine, sizeof(t->machine), "%s", machine);
	plain_copy(t->why, sizeof(t->why), why);
}

/* Nothing runs there, and no job waits there for somebody. */
static bool is_idle(const struct hall_machine *r)
{
	return !r->gone && !r->disputed && !*r->m.stand &&
	       strcmp(r->m.state, "idle") == 0 &&
	       names_machine_ok(r->m.machine);
}

/* Another dispatcher looks at the same machines, so each begins with another
 * one.  Return: NULL: there is none now. */
static const struct hall_machine *pick(const struct dispatch *d)
{
	const size_t n = d->hall->n;
	const size_t from = n ? randombytes_uniform((uint32_t)n) : 0;

	for (size_t i = 0; i < n; i++) {
		const struct hall_machine *r = &d->hall->row[(from + i) % n];
		const struct tried *t = tried_of(d, r->m.machine);

		if (is_idle(r) && (!t || talk_now_s() >= t->again_s))
			return r;
	}
	return NULL;
}

/* Have all that are there refused it? */
static bool all_refused(const struct dispatch *d)
{
	const size_t known = hall_known(d->hall);

	if (talk_now_s() - d->news_s < d->o->wait_s || d->hall->n < known ||
	    d->hall->n < d->o->expect || !d->hall->n)
		return false;
	for (size_t i = 0; i < d->hall->n; i++) {
		const struct tried *t = tried_of(d, d->hall->row[i].m.machine);

		if (!t || isfinite(t->again_s))
			return false;
	}
	return true;
}

static int refuse_all(struct dispatch *d)
{
	say(d, "no machine fits %s:", d->o->path);
	for (size_t i = 0; i < d->ntried; i++)
		fprintf(stderr, "  %s: %s\n", d->tried[i].machine,
			d->tried[i].why);
	return EX_DATAERR;
}

/* Whom it waits for. */
static void tell_wait(struct dispatch *d)
{
	char text[sizeof(d->said)] = "waits for an idle machine";
	size_t at = strlen(text);

	for (size_t i = 0; i < d->hall->n && at < sizeof(text); i++) {
		const struct hall_machine *r = &d->hall->row[i];
		const struct tried *t = tried_of(d, r->m.machine);

		at += (size_t)snprintf(text + at, sizeof(text) - at,
				       "%s %s: %s", i ? "," : ";",
				       r->m.machine, r->gone ? "gone" :
				       r->disputed ? "disputed" :
				       t ? t->why : *r->m.stand ? r->m.stand :
				       r->m.state);
		if (d->tty && at < sizeof(text) && r->m.progress > 0)
			at += (size_t)snprintf(text + at, sizeof(text) - at,
					       " %.0f %%",
					       100 * r->m.progress);
	}
	progress(d, d->hall->n ? text : "no machine is heard yet");
}

/* -- An offer -------------------------------------------------------------- */

static void carry(void *arg, const char *channel, const void *data,
		  size_t size)
{
	post_send(arg, channel, data, size);
}

static bool fetch(void *arg, struct udpm_packet *ret)
{
	return post_take(arg, ret, NULL);
}

/* The key of this machine; where there is none, that of this host.  Return: as
 * talk_open(). */
static int offer_open(struct offer *f, char said[TALK_SAID_MAX])
{
	char key[KEYFILE_PATH_MAX];
	struct talk_options o = {
		.machine = f->machine, .program = NAME, .carrier = &f->carrier,
	};
	int err = post_open(&f->post, f->d->participant, f->machine,
			    TOPIC_OFFER);

	if (err < 0) {
		snprintf(said, TALK_SAID_MAX, "DDS: %s", dds_strretcode(err));
		return err;
	}
	f->carrier = (struct talk_carrier) {
		.fd = f->post.fd, .send = carry, .take = fetch,
		.arg = &f->post,
	};
	snprintf(key, sizeof(key), "%s/%s.key", f->d->o->keys, f->machine);
	if (access(key, F_OK) == 0)
		o.key = key;
	return talk_open(&f->talk, &o, said);
}

static void offer_close(struct offer *f)
{
	submission_end(f->job);
	talk_close(f->talk);
	post_close(&f->post);
}

static int begin(struct offer *f)
{
	const struct dispatch_options *o = f->d->o;
	const struct submission_text x = {
		.id = f->d->id, .name = submission_file_name(o->path),
		.text = f->d->text.bytes, .bytes = f->d->text.size,
		.hold = !o->start,
	};

	submission_end(f->job);
	f->job = NULL;
	return submission_begin(&f->job, f->talk, &x);
}

static void tell_sent(struct offer *f)
{
	char text[160];
	int arrived;
	const int chunks = submission_progress(f->job, &arrived);

	if (f->d->tty && arrived < chunks)
		snprintf(text, sizeof(text), "sends to %s: %d of %d pieces",
			 f->machine, arrived, chunks);
	else
		snprintf(text, sizeof(text), arrived < chunks ?
			 "sends to %s" : "%s reads it", f->machine);
	if (!f->said)
		progress(f->d, text);
}

/* It may have the job, so nobody else gets it. */
static void tell_away(struct offer *f)
{
	if (f->said)
		return;
	f->said = true;
	say(f->d, "%s does not answer, and may have job %s; it is asked on, "
	    "and no other machine gets the job (Ctrl-C ends this)", f->machine,
	    f->d->id);
}

/* Return: 0: it has answered; -ECONNRESET: it is away and cannot have it;
 * -EINTR; -ENOMEM. */
static int offer_run(struct offer *f)
{
	int err = begin(f);

	while (err == 0 && !talk_interrupted()) {
		const struct hall_machine *r = find(f->d, f->machine);

		err = submission_step(f->job);
		f->out |= submission_is_out(f->job);
		if (err == 1)
			return 0;
		if (!f->out && (err == -ETIMEDOUT || !r || r->gone))
			return -ECONNRESET;
		if (err == -ETIMEDOUT || !r || r->gone)
			tell_away(f);
		tell_sent(f);
		if (err == -ETIMEDOUT)
			err = begin(f);
		talk_wait(f->talk, 20);
		look(f->d);
	}
	return err < 0 ? err : -EINTR;
}

static int given(struct offer *f, const struct talk_ack *a)
{
	wipe(f->d);
	submission_print_notes(a);
	if (f->d->o->json)
		printf("{\"machine\": \"%s\", \"job\": %s}\n", f->machine,
		       a->body);
	else
		printf("job %s is at %s: %s\n", f->d->id, f->machine,
		       a->reason);
	return EX_OK;
}

static int judge(struct offer *f, int err)
{
	const struct talk_ack *a = err ? NULL : submission_verdict(f->job);

	if (err == -EINTR && f->out)
		say(f->d, "%s may have job %s; the same command with --machine "
		    "%s --id %s asks, and gives it once", f->machine, f->d->id,
		    f->machine, f->d->id);
	else if (err == -EINTR)
		say(f->d, "ended before %s had the job; nothing was given",
		    f->machine);
	if (err == -EINTR)
		return EX_TEMPFAIL;
	if (err) {
		put_off(f->d, f->machine, EX_UNAVAILABLE, err == -ECONNRESET ?
			"it went away before it had the job" : strerror(-err));
		return EX_UNAVAILABLE;
	}
	if (a->code == 0)
		return given(f, a);
	put_off(f->d, f->machine, a->code, a->reason);
	if (f->d->o->machine)
		submission_print_refusal(NAME, f->d->o->path, a);
	return a->code;
}

/* Is somebody there who knows our key? */
static int greet(struct offer *f)
{
	const struct talk_question hello = { .verb = "hello" };
	struct talk_answer a = { .code = 0 };
	const int err = talk_ask(f->talk, &hello, HELLO_S, &a);
	const int code = err == -EINTR ? EX_TEMPFAIL :
			 err ? EX_UNAVAILABLE : a.code;

	if (code)
		put_off(f->d, f->machine, code, err == 0 ? a.reason :
			*talk_why(f->talk) ? talk_why(f->talk) :
			"it does not answer; edm-dds and edmd-jobs have to run "
			"there");
	talk_answer_free(&a);
	return code;
}

/* Return: the exit code; what is not EX_OK is in the list of tries too. */
static int offer(struct dispatch *d, const char *machine)
{
	struct offer f = { .d = d, .machine = machine };
	char said[TALK_SAID_MAX];
	int code = EX_OK;

	if (offer_open(&f, said) < 0) {
		char why[sizeof(said) + KEYFILE_PATH_MAX];

		snprintf(why, sizeof(why), "no %s/%s.key, and %s", d->o->keys,
			 machine, said);
		put_off(d, machine, EX_NOPERM, why);
		code = EX_NOPERM;
	}
	if (code == EX_OK)
		code = greet(&f);
	if (code == EX_OK) {
		say(d, "offers job %s to %s", d->id, machine);
		code = judge(&f, offer_run(&f));
	}
	offer_close(&f);
	return code;
}

/* -- Whom ------------------------------------------------------------------ */

static int refuse_named(struct dispatch *d, const struct hall_machine *r)
{
	char text[sizeof(d->said)] = "none";
	size_t at = 0;

	if (r) {
		say(d, "machine %s is gone: nothing comes from its edm-dds",
		    d->o->machine);
		return EX_UNAVAILABLE;
	}
	for (size_t i = 0; i < d->hall->n && at < sizeof(text); i++)
		at += (size_t)snprintf(text + at, sizeof(text) - at, "%s%s",
				       i ? ", " : "",
				       d->hall->row[i].m.machine);
	say(d, "machine %s is not heard; heard are: %s", d->o->machine, text);
	return EX_UNAVAILABLE;
}

/* It is waited for until it is heard, then offered the job once. */
static int give_named(struct dispatch *d)
{
	const struct hall_machine *r = find(d, d->o->machine);
	const struct tried *t;
	int code;

	if (!r || r->gone)
		return talk_now_s() - d->begun_s > LONGEST * d->o->wait_s ?
		       refuse_named(d, r) : -1;
	code = offer(d, d->o->machine);
	t = tried_of(d, d->o->machine);
	if (t && (code == EX_NOPERM || code == EX_UNAVAILABLE))
		say(d, "%s: %s; nothing was given", t->machine, t->why);
	return code;
}

static int give_any(struct dispatch *d)
{
	const struct hall_machine *r = pick(d);
	char machine[KEYFILE_NAME_MAX];
	int code;

	if (!r) {
		tell_wait(d);
		return all_refused(d) ? refuse_all(d) : -1;
	}
	/* The hall goes on meanwhile. */
	snprintf(machine, sizeof(machine), "%s", r->m.machine);
	code = offer(d, machine);
	return code == EX_OK || talk_interrupted() ? code : -1;
}

static int run(struct dispatch *d)
{
	int code = -1;

	while (code < 0 && !talk_interrupted()) {
		if (look(d) < 0)
			return EX_UNAVAILABLE;
		code = d->o->machine ? give_named(d) : give_any(d);
		if (code < 0)
			usleep(LOOK_MS * 1000);
	}
	if (code < 0)
		say(d, "ended before a machine had the job; nothing was given");
	return code < 0 ? EX_TEMPFAIL : code;
}

static void take_signals(void)
{
	sigset_t stops;

	talk_catch_signals();
	sigemptyset(&stops);
	sigaddset(&stops, SIGINT);
	sigaddset(&stops, SIGTERM);
	sigprocmask(SIG_UNBLOCK, &stops, NULL);
}

static void draw_id(char id[SUBMISSION_ID_MAX])
{
	uint8_t drawn[6];

	randombytes_buf(drawn, sizeof(drawn));
	sodium_bin2hex(id, SUBMISSION_ID_MAX, drawn, sizeof(drawn));
}

int dispatch_run(dds_entity_t participant, struct hall *h,
		 const struct dispatch_options *o)
{
	struct dispatch d = {
		.o = o, .participant = participant, .hall = h,
		.begun_s = talk_now_s(), .tty = isatty(STDERR_FILENO),
	};
	int code = submission_read(NAME, o->path, &d.text);

	if (code)
		return code;
	d.news_s = d.begun_s;
	d.tried = calloc(HALL_MAX, sizeof(*d.tried));
	if (!d.tried || sodium_init() < 0) {
		free(d.text.bytes);
		return EX_SOFTWARE;
	}
	if (o->id)
		snprintf(d.id, sizeof(d.id), "%s", o->id);
	else
		draw_id(d.id);
	take_signals();
	code = run(&d);
	wipe(&d);
	free(d.tried);
	free(d.text.bytes);
	return code;
}
