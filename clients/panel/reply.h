/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reply.h - one request of HTTP, and the answer to it
 *
 * Every answer bears the headers that keep a page from running what is not
 * ours.  An answer is a text, an asset in memory, or a file in memory.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_REPLY_H
#define PANEL_REPLY_H

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

/** reply_json() - @o is taken over. */
int reply_json(struct request *r, int status, json_t *o);

/** reply_refusal() - what was found, and what would be accepted. */
int reply_refusal(struct request *r, int status, const char *found,
		  const char *wanted);
int reply_asset(struct request *r, const struct asset *a);
/** reply_file() - of bytes; @fd is taken over. */
int reply_file(struct request *r, int fd);

/** reply_wait() - an answer will come, within @s. */
int reply_wait(struct request *r, int s);

/** reply_write() - as much as the connection takes now. */
int reply_write(struct request *r);

/** reply_forget() - give back what it holds; nothing calls it any more. */
void reply_forget(struct request *r);

/** reply_draw_id() - a random id. */
void reply_draw_id(struct request *r);

#endif /* PANEL_REPLY_H */
