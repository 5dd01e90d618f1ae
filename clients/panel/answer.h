/* SPDX-License-Identifier: Apache-2.0 */
/*
 * answer.h - one request of HTTP, and the answer to it
 *
 * Every answer bears the headers that keep a page from running what is not
 * ours.  An answer is a text, an asset in memory, or a file in memory.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_ANSWER_H
#define PANEL_ANSWER_H

#include "panel.h"

struct route;

struct request {
	struct panel *panel;		/* NULL: none is under way */
	struct lws *wsi;
	const struct route *route;
	char who[SESSION_USER_MAX];
	enum role role;
	struct session_user user;	/* who logs in */
	char id[33], name[64];
	bool hold;
	int from_line;			/* 0: at the beginning */
	bool has_body, whole;		/* a text; all of it is there */
	int body_fd;
	size_t body_bytes;
	/* The answer. */
	bool answered, headed;
	int status;
	const char *type;
	const struct asset *asset;
	char *text;
	int fd;
	size_t bytes, sent;
	char cookie[160];
};

/* Each returns what the callback of lws has to. */

/** answer_json() - @o is taken over. */
int answer_json(struct request *r, int status, json_t *o);

/** answer_refusal() - what was found, and what would be accepted. */
int answer_refusal(struct request *r, int status, const char *found,
		  const char *wanted);
int answer_asset(struct request *r, const struct asset *a);
/** answer_file() - of bytes; @fd is taken over. */
int answer_file(struct request *r, int fd);

/** answer_wait() - an answer will come, within @s. */
int answer_wait(struct request *r, int s);

/** answer_write() - as much as the connection takes now. */
int answer_write(struct request *r);

/** answer_forget() - give back what it holds; nothing calls it any more. */
void answer_forget(struct request *r);

/** answer_draw_id() - a random id. */
void answer_draw_id(struct request *r);

#endif /* PANEL_ANSWER_H */
