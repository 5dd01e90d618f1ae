/* SPDX-License-Identifier: Apache-2.0 */
/*
 * socket.c - the web socket: the state goes out, requests come in
 *
 * All browsers are told the same. A browser that has heard message k gets what
 * has changed since; one that has missed a message gets everything. So a slow
 * browser needs no queue, and is never more than one message behind.
 */
#include "panel.h"
#include "clocks.h"
#include "frames.h"
#include "press.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MESSAGE_MAX	65536		/* of a request */
#define ANSWERS_MAX	(2u << 20)	/* most bytes that wait for a browser */
#define LOOK_EVERY	10		/* messages between two looks at the
					 * sessions */
#define RATE_PER_S	60.0		/* most requests of a browser at a
					 * time */
#define RATE_BURST	120.0

struct answer {
	struct answer *next;
	size_t bytes;
	unsigned char text[];		/* after LWS_PRE */
};

struct browser {
	struct browser *next;
	struct share share;
	struct panel *panel;
	struct lws *wsi;
	char session[SESSION_ID_BYTES];
	uint64_t heard;			/* number of the message; 0: none */
	bool closing;			/* it said so: it is told, and may say,
					 * nothing more */
	struct answer *first, **last;
	size_t waiting;
	char *in;			/* a request that comes in pieces */
	size_t in_bytes;
	int64_t number;			/* number of the last request */
	double tokens, tokens_s;
	struct press press;
};

size_t socket_browser_size(void)
{
	return sizeof(struct browser);
}

struct panel *socket_panel(struct browser *b)
{
	return b->panel;
}

struct press *socket_press(struct browser *b)
{
	return &b->press;
}

struct session *socket_session(struct browser *b)
{
	return session_by_id(b->panel->sessions, b->session);
}

void socket_who(struct browser *b, struct share_who *ret)
{
	visitor_who(visitor_of(b->wsi), socket_session(b), ret);
}

/* -- Out ------------------------------------------------------------------ */

static void drop(struct browser *b)
{
	lws_set_timeout(b->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT,
			LWS_TO_KILL_ASYNC);
}

void socket_drop_ended(struct panel *p)
{
	for (struct browser *b = p->browsers; b; b = b->next)
		if (!socket_session(b))
			drop(b);
}

static void queue_text(struct browser *b, const char *text)
{
	const size_t bytes = strlen(text);
	struct answer *a;

	if (b->waiting + bytes > ANSWERS_MAX) {
		/* The browser asks and does not read the answers. */
		drop(b);
		return;
	}
	a = malloc(sizeof(*a) + LWS_PRE + bytes);
	if (!a)
		return;
	a->next = NULL;
	a->bytes = bytes;
	memcpy(a->text + LWS_PRE, text, bytes);
	*b->last = a;
	b->last = &a->next;
	b->waiting += bytes;
	lws_callback_on_writable(b->wsi);
}

static void queue_json(struct browser *b, json_t *o)
{
	char *text = o ? json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(9)) :
			 NULL;

	if (text)
		queue_text(b, text);
	free(text);
	json_decref(o);
}

void socket_answer(struct browser *b, int64_t n, int code, const char *reason,
		   json_t *body)
{
	queue_json(b, json_pack("{s:I,s:i,s:s,s:o}", "n", (json_int_t)n, "code",
				code, "reason", reason ? reason : "", "body",
				body ? body : json_null()));
}

void socket_tell_event(struct panel *p, const char *kind, const char *text)
{
	for (struct browser *b = p->browsers; b; b = b->next)
		queue_json(b, json_pack("{s:{s:s,s:s}}", "event", "kind", kind,
					"text", text));
}

static int write_text(struct browser *b, const char *text)
{
	const size_t bytes = strlen(text);
	unsigned char *out = malloc(LWS_PRE + bytes);
	int n = -1;

	if (out) {
		memcpy(out + LWS_PRE, text, bytes);
		n = lws_write(b->wsi, out + LWS_PRE, bytes, LWS_WRITE_TEXT);
	}
	free(out);
	return n < (int)bytes ? -1 : 0;
}

static int write_state(struct browser *b)
{
	struct panel *p = b->panel;
	char *whole;
	json_t *o;
	int err;

	if (b->heard == p->tellings || !p->told)
		return 0;
	if (b->heard && b->heard + 1 == p->tellings) {
		b->heard = p->tellings;
		return write_text(b, p->delta);
	}
	b->heard = p->tellings;
	o = json_pack("{s:O,s:o}", "whole", p->told, "point",
		      live_last_point(p->live));
	whole = json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(9));
	err = whole ? write_text(b, whole) : -1;
	free(whole);
	json_decref(o);
	return err;
}

static int on_writable(struct browser *b)
{
	struct answer *a = b->first;
	int n;

	if (!a)
		return write_state(b);
	n = lws_write(b->wsi, a->text + LWS_PRE, a->bytes, LWS_WRITE_TEXT);
	if (n < (int)a->bytes)
		return -1;
	b->waiting -= a->bytes;
	b->first = a->next;
	if (!b->first)
		b->last = &b->first;
	free(a);
	lws_callback_on_writable(b->wsi);
	return 0;
}

/* The new values of all keys that have changed. */
static json_t *changes(const json_t *was, json_t *now)
{
	json_t *o = json_object(), *v;
	const char *key;

	json_object_foreach(now, key, v)
		if (!was || !json_equal(json_object_get(was, key), v))
			json_object_set(o, key, v);
	return o;
}

/* Rounded: what has not changed is not sent. */
static void add_time(json_t *o, const struct service_status *s)
{
	json_object_set_new(o, "eta", json_real(round(s->eta_s)));
	json_object_set_new(o, "etaMin", json_real(round(s->eta_min_s)));
	json_object_set_new(o, "etaMax", json_real(round(s->eta_max_s)));
	json_object_set_new(o, "etaBy", json_string(s->eta_by));
	json_object_set_new(o, "etaCondition", json_string(s->eta_condition));
	json_object_set_new(o, "etaFactor",
			    json_real(round(s->eta_factor * 100) / 100));
	json_object_set_new(o, "end", json_real(round(s->end_s / 10) * 10));
	json_object_set_new(o, "queueS", json_real(round(s->queue_s)));
	json_object_set_new(o, "queueUntold", json_integer(s->queue_untold));
	json_object_set_new(o, "queueEnd",
			    json_real(round(s->queue_end_s / 60) * 60));
	json_object_set_new(o, "progress",
			    json_real(round(s->progress * 1000) / 1000));
}

static void add_work(json_t *o, const struct service_status *s)
{
	json_t *mm = json_array();

	for (int i = 0; i < INTERP_NAXES; i++)
		json_array_append_new(mm, json_real(round(s->work_mm[i] * 1e6) /
						    1e6));
	json_object_set_new(o, "work", json_string(s->work));
	json_object_set_new(o, "workTurn",
			    json_real(round(s->work_turn_deg * 1e4) / 1e4));
	json_object_set_new(o, "workMm", mm);
	json_object_set_new(o, "pass", json_integer(s->pass));
	json_object_set_new(o, "passes", json_integer(s->passes));
	json_object_set_new(o, "wireOffset",
			    json_real(round(s->wire_offset_mm * 1e5) / 1e5));
}

static json_t *state_of(struct panel *p)
{
	const struct service_status *s = service_status(p->service);
	json_t *o = json_object();

	live_fill(p->live, o);
	json_object_set_new(o, "jobs", json_boolean(s->heard));
	json_object_set_new(o, "job", json_string(s->job));
	json_object_set_new(o, "jobName", json_string(s->job_name));
	json_object_set_new(o, "jobState", json_string(s->job_state));
	json_object_set_new(o, "store", json_string(s->store));
	json_object_set_new(o, "interrupted", json_string(s->interrupted));
	json_object_set_new(o, "lost", json_string(s->lost));
	json_object_set_new(o, "asksFor", json_string(s->asks));
	json_object_set_new(o, "faults", json_string(s->faults));
	json_object_set_new(o, "hunts", json_integer(s->hunts));
	json_object_set_new(o, "lines", json_integer(s->lines));
	json_object_set_new(o, "electrode", json_integer(s->electrode));
	add_work(o, s);
	json_object_set_new(o, "lean",
			    json_real(round(s->lean_deg * 100) / 100));
	json_object_set_new(o, "queue", json_integer(s->queue_len));
	add_time(o, s);
	return o;
}

void socket_tell_all(struct panel *p)
{
	json_t *now = state_of(p);
	json_t *o = json_pack("{s:o,s:o}", "new", changes(p->told, now),
			      "point", live_last_point(p->live));
	char *text = json_dumps(o, JSON_COMPACT | JSON_REAL_PRECISION(9));

	json_decref(o);
	json_decref(p->told);
	p->told = now;
	if (!text)
		return;
	free(p->delta);
	p->delta = text;
	p->tellings++;
	if (p->tellings % LOOK_EVERY == 0) {
		sessions_look(p->sessions, p->config.panel.users);
		socket_drop_ended(p);
	}
	for (struct browser *b = p->browsers; b; b = b->next)
		lws_callback_on_writable(b->wsi);
}

/* -- In ------------------------------------------------------------------- */

static bool has_token(struct browser *b)
{
	const double at_s = clock_s(CLOCK_MONOTONIC);

	b->tokens += (at_s - b->tokens_s) * RATE_PER_S;
	if (b->tokens > RATE_BURST)
		b->tokens = RATE_BURST;
	b->tokens_s = at_s;
	if (b->tokens < 1)
		return false;
	b->tokens -= 1;
	return true;
}

/* A request has the token of the session, and a number above that of the last
 * one. */
static int take_request(struct browser *b, const json_t *o)
{
	struct session *s = socket_session(b);
	const json_int_t n = json_integer_value(json_object_get(o, "n"));
	const char *token = json_string_value(json_object_get(o, "token"));

	if (!s) {
		lws_close_reason(b->wsi, 4401, (unsigned char *)"session", 7);
		return -1;
	}
	if (!session_token_ok(s, token)) {
		panel_note(b->panel, "a request of %s (%s) without the token "
			   "of its session was refused", s->user, s->address);
		lws_close_reason(b->wsi, 4403, (unsigned char *)"token", 5);
		return -1;
	}
	if (n <= b->number) {
		socket_answer(b, n, 76, "this number was used before; count "
			      "up", NULL);
		return 0;
	}
	b->number = n;
	if (!has_token(b)) {
		socket_answer(b, n, 75, "too many requests; 60 a second",
			      NULL);
		return 0;
	}
	verbs_do(b, o);
	return 0;
}

static int take_message(struct browser *b, const char *text, size_t bytes)
{
	json_t *o = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, NULL);
	int err;

	if (!json_is_object(o) ||
	    !json_is_integer(json_object_get(o, "n")) ||
	    !json_is_string(json_object_get(o, "do"))) {
		json_decref(o);
		lws_close_reason(b->wsi, LWS_CLOSE_STATUS_INVALID_PAYLOAD,
				 (unsigned char *)"request", 7);
		return -1;
	}
	err = take_request(b, o);
	json_decref(o);
	return err;
}

static int on_receive(struct browser *b, const char *in, size_t len)
{
	char *more;
	int err;

	if (lws_frame_is_binary(b->wsi) || b->in_bytes + len > MESSAGE_MAX) {
		lws_close_reason(b->wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE,
				 (unsigned char *)"size", 4);
		return -1;
	}
	more = realloc(b->in, b->in_bytes + len + 1);
	if (!more)
		return -1;
	b->in = more;
	memcpy(b->in + b->in_bytes, in, len);
	b->in_bytes += len;
	if (!lws_is_final_fragment(b->wsi) ||
	    lws_remaining_packet_payload(b->wsi) > 0)
		return 0;
	err = take_message(b, b->in, b->in_bytes);
	free(b->in);
	b->in = NULL;
	b->in_bytes = 0;
	return err;
}

/* This refuses before the web socket begins: so nothing of a stranger is
 * kept. */
static int filter(struct panel *p, struct lws *wsi)
{
	if (!http_is_ours(p, wsi, true)) {
		panel_note(p, "a connection of another site was refused");
		return -1;
	}
	return http_session(p, wsi) &&
	       frames_begin(lws_get_socket_fd(wsi)) ? 0 : -1;
}

static void on_taken(void *arg, const char *why)
{
	(void)why;
	drop(arg);
}

static int take_share(struct browser *b)
{
	struct share_who who;

	b->share = (struct share) { .kind = SHARE_BROWSER, .end = on_taken,
				    .arg = b };
	socket_who(b, &who);
	if (share_take(b->panel->shares, &b->share, &who) == 0) {
		visitor_of(b->wsi)->share.idle = false;
		return 0;
	}
	lws_close_reason(b->wsi, 4429, (unsigned char *)"crowd", 5);
	b->panel = NULL;
	return -1;
}

static int begin(struct browser *b, struct panel *p, struct lws *wsi)
{
	struct session *s = http_session(p, wsi);

	if (!s)
		return -1;
	*b = (struct browser) { .panel = p, .wsi = wsi, .next = p->browsers,
				.tokens = RATE_BURST,
				   .tokens_s = clock_s(CLOCK_MONOTONIC) };
	b->last = &b->first;
	memcpy(b->session, s->id, sizeof(b->session));
	if (take_share(b))
		return -1;
	session_hold(s, 1);
	p->browsers = b;
	queue_json(b, json_pack("{s:o}", "hello", verbs_hello(p, s)));
	return 0;
}

static void end(struct browser *b)
{
	struct session *s = socket_session(b);
	struct browser **at = &b->panel->browsers;

	press_end(b);
	verbs_forget(b);
	share_give(&b->share);
	if (s)
		session_hold(s, -1);
	while (*at && *at != b)
		at = &(*at)->next;
	if (*at)
		*at = b->next;
	while (b->first) {
		struct answer *next = b->first->next;

		free(b->first);
		b->first = next;
	}
	free(b->in);
	b->panel = NULL;
}

int socket_callback(struct lws *wsi, enum lws_callback_reasons reason,
		    void *user, void *in, size_t len)
{
	struct browser *b = user;

	switch (reason) {
	case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
		return filter(lws_context_user(lws_get_context(wsi)), wsi);
	case LWS_CALLBACK_ESTABLISHED:
		return begin(b, lws_context_user(lws_get_context(wsi)), wsi);
	case LWS_CALLBACK_CLOSED:
		if (b && b->panel)
			end(b);
		return 0;
	case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
		b->closing = true;
		return 0;
	case LWS_CALLBACK_SERVER_WRITEABLE:
		if (b->closing)
			return 0;
		return b->panel ? on_writable(b) : -1;
	case LWS_CALLBACK_RECEIVE:
		return b->panel && !b->closing ? on_receive(b, in, len) : -1;
	default:
		return 0;
	}
}
