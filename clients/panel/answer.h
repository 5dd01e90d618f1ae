/* SPDX-License-Identifier: Apache-2.0 */
/*
 * answer.h - one request of HTTP, and the answer to it
 *
 * Every answer has the headers that keep a page from running foreign code. An
 * answer is a text, an asset in memory, or a file in memory.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_ANSWER_H
#define PANEL_ANSWER_H

#include "panel.h"

struct route;

struct request {
	struct panel *panel;		/* NULL: no request is under way */
	struct lws *wsi;
	const struct route *route;
	char who[SESSION_USER_MAX];
	enum role role;
	struct session_user user;	/* who logs in */
	char id[33], name[64];
	bool hold;
	int from_line;			/* 0: at the beginning */
	char setting[INTERP_SETTING_MAX];
	bool has_body, whole;		/* the request has a text; the whole
					 * text has come */
	int body_fd;
	size_t body_bytes;
	struct share upload, work;	/* the text; the program that runs */
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

/* Each function returns what the callback of lws has to return. */

/** answer_json() - answer with @o, which then belongs to this function. */
int answer_json(struct request *r, int status, json_t *o);

/** answer_refusal() - refuse; say what was found and what would be accepted. */
int answer_refusal(struct request *r, int status, const char *found,
		  const char *wanted);
int answer_asset(struct request *r, const struct asset *a);
/**
 * answer_file() - answer with the bytes of @fd, which then belongs to this
 * function.
 */
int answer_file(struct request *r, int fd);

/** answer_wait() - an answer will come within @s seconds. */
int answer_wait(struct request *r, int s);

/** answer_write() - write as much as the connection takes now. */
int answer_write(struct request *r);

/**
 * answer_forget() - free what the request holds; nothing will call back for it.
 */
void answer_forget(struct request *r);

/** answer_draw_id() - give the request a random id. */
void answer_draw_id(struct request *r);

#endif /* PANEL_ANSWER_H */
