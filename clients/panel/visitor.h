/* SPDX-License-Identifier: Apache-2.0 */
/*
 * visitor.h - one connection: where it comes from, and for whom it counts
 *
 * On the loopback address the kernel says which user of the host holds the
 * other end.  It is asked once, when the connection begins: later the user may
 * have given it away.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_VISITOR_H
#define PANEL_VISITOR_H

#include "session.h"
#include "share.h"

#include <libwebsockets.h>

struct panel;

struct visitor {
	struct share share;
	struct lws *wsi;
	int fd;
	char address[SESSION_ADDRESS_MAX];
	char net[SESSION_ADDRESS_MAX];	/* all that one who has this address
					 * may have */
	/* Only on loopback. */
	unsigned int uid;		/* SESSION_NOBODY: not known */
	enum role role;			/* of this user of the host */
	char user[SESSION_USER_MAX];
};

/**
 * visitor_begin() - a connection was accepted.  Return: 0; -errno: it has to be
 * closed.
 */
int visitor_begin(struct panel *p, struct lws *wsi);

/** visitor_end() - the connection is gone. */
void visitor_end(struct lws *wsi);

/** visitor_of() - never NULL for a connection that was taken. */
struct visitor *visitor_of(struct lws *wsi);

/**
 * visitor_who() - for whom something counts.  @s: the session; NULL: none.
 */
void visitor_who(const struct visitor *v, const struct session *s,
		 struct share_who *ret);

#endif /* PANEL_VISITOR_H */
