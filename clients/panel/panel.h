/* SPDX-License-Identifier: Apache-2.0 */
/*
 * panel.h - edm-panel as a whole: what its parts share
 *
 * There is one event loop. A browser that is slow, gone or hostile takes a
 * limited part of it. Nothing here can hold up edmd or edmd-jobs.
 *
 * Threads: one.
 */
#ifndef PANEL_PANEL_H
#define PANEL_PANEL_H

#include "service.h"
#include "assets.h"
#include "child.h"
#include "config.h"
#include "live.h"
#include "session.h"
#include "share.h"
#include "visitor.h"

#include <jansson.h>
#include <libwebsockets.h>

#define PANEL_BODY_MAX		(64u << 20)	/* of a job's text */
#define PANEL_NOTES		200
#define PANEL_CHECKED_ROOM	16	/* more than SHARE_PATH are kept */

/* A line of the panel's own log: who did what. */
struct panel_note {
	int64_t utime_ms;
	char text[320];
};

/* The path of a text that was checked. */
struct checked {
	struct share share;
	char id[33];			/* "": none */
	int fd;
};

struct browser;

struct panel {
	struct machine_config config;
	const char *config_path;
	const char *self;		/* the program, to be run as --work */
	bool tls, local;		/* local: only 127.0.0.1 or ::1 */
	enum role local_role;
	struct lws_context *lws;
	struct lws_vhost *vhost;
	lws_sorted_usec_list_t timer;
	struct live *live;
	struct service *service;
	struct assets *assets;
	struct sessions *sessions;
	struct children *children;
	/* What is sent to all browsers. */
	json_t *told;			/* as last told */
	char *delta;			/* changes since the message before
					 * it */
	uint64_t tellings;
	struct browser *browsers;
	struct shares *shares;
	struct panel_note note[PANEL_NOTES];
	uint64_t notes;
	double past_owed_s, past_at_s;	/* time spent on answers about the
					 * past */
	struct checked checked[PANEL_CHECKED_ROOM];
};

/**
 * panel_note() - write to the journal and to the log that the page Machine
 * shows.
 */
void panel_note(struct panel *p, const char *text, ...)
	__attribute__((format(printf, 2, 3)));

/** panel_notes() - the lines of the log, the newest first. */
json_t *panel_notes(const struct panel *p);

/* -- http.c: what is asked for by HTTP ------------------------------------ */

int http_callback(struct lws *wsi, enum lws_callback_reasons reason,
		  void *user, void *in, size_t len);

/**
 * http_is_ours() - does the header Host name this panel, and the header Origin,
 * if there is one? It does not for a page of another site, nor for a foreign
 * name that was made to point to this address.
 */
bool http_is_ours(struct panel *p, struct lws *wsi, bool want_origin);

/**
 * http_session() - the session of the request's cookie; NULL if there is none.
 */
struct session *http_session(struct panel *p, struct lws *wsi);

/* -- socket.c: the web socket --------------------------------------------- */

int socket_callback(struct lws *wsi, enum lws_callback_reasons reason,
		    void *user, void *in, size_t len);
size_t socket_browser_size(void);

/** socket_tell_all() - send the state of the machine, if something is new. */
void socket_tell_all(struct panel *p);

/** socket_drop_ended() - close the connections whose session has ended. */
void socket_drop_ended(struct panel *p);

/** socket_tell_event() - tell all browsers that something happened. */
void socket_tell_event(struct panel *p, const char *kind, const char *text);

/**
 * socket_answer() - answer request @n of a browser; @body then belongs to this
 * function.
 */
void socket_answer(struct browser *b, int64_t n, int code, const char *reason,
		   json_t *body);

/** socket_press() - the key that is pressed on the page of a browser. */
struct press *socket_press(struct browser *b);

struct session *socket_session(struct browser *b);
/** socket_who() - for whom counts what the browser asks for. */
void socket_who(struct browser *b, struct share_who *ret);
struct panel *socket_panel(struct browser *b);

/* -- verbs.c: what a browser may ask for ---------------------------------- */

/** verbs_do() - carry out one request. */
void verbs_do(struct browser *b, const json_t *request);

/** verbs_forget() - say that this browser is gone. */
void verbs_forget(struct browser *b);

enum verbs_urge { VERBS_ASK, VERBS_ACT, VERBS_END };

/**
 * verbs_who() - for whom a question counts, and how it goes before others: what
 * ends a motion before all, acts before what is only asked.
 */
void verbs_who(struct browser *b, enum verbs_urge urge, struct share_who *ret);

/** verbs_hello() - what a page has to know, once. */
json_t *verbs_hello(struct panel *p, const struct session *s);

#endif /* PANEL_PANEL_H */
