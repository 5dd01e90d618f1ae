/* SPDX-License-Identifier: Apache-2.0 */
/*
 * session.h - who is at a browser, and what that person may do
 *
 * Over the network a user logs in with a name and a password. The file of users
 * has a line `NAME ROLE HASH` for each of them, with a hash by argon2id. On the
 * loopback address of the host, the kernel says to which user of the host a
 * connection belongs. Root, members of group edm, and the user who runs the
 * panel have the role of [panel] local_role; everybody else may only look.
 *
 * A session is a random cookie. Each request that does something also bears the
 * token of the session, which no other site can read.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_SESSION_H
#define PANEL_SESSION_H

#include "share.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum role { ROLE_NONE, ROLE_VIEWER, ROLE_OPERATOR, ROLE_SERVICE };

#define SESSION_USER_MAX	32
#define SESSION_ID_BYTES	65	/* hex, with its NUL */
#define SESSION_HASH_MAX	160
#define SESSION_ADDRESS_MAX	48
#define SESSION_NOBODY		(~0u)

struct session {
	struct share share;
	char id[SESSION_ID_BYTES];	/* of the cookie; "": the slot is
					 * free */
	char token[33];
	char user[SESSION_USER_MAX];
	char address[SESSION_ADDRESS_MAX];
	enum role role;
	unsigned int uid;		/* user of this host, or
					 * SESSION_NOBODY */
	char hash[SESSION_HASH_MAX];	/* the hash at the login; "": none */
	int sockets;			/* browsers that hold the session
					 * open: session_hold() */
	int64_t begun_s, used_s;
};

struct session_user {
	char name[SESSION_USER_MAX];
	enum role role;
	char hash[SESSION_HASH_MAX];
};

struct sessions;
struct visitor;

/** sessions_create() - Return: NULL if there is no memory. */
struct sessions *sessions_create(struct shares *shares);
void sessions_destroy(struct sessions *s);

/**
 * session_begin() - begin a session of who came by @v.
 *
 * Return: NULL if there are too many, and none has to make room.
 */
struct session *session_begin(struct sessions *s, const struct visitor *v,
			      const char *user, enum role role);

/** session_hold() - one browser more, or less (-1), holds it open. */
void session_hold(struct session *session, int more);

/**
 * session_find() - find a session by the value of a Cookie header; NULL if
 * there is none, or if it is too old.
 */
struct session *session_find(struct sessions *s, const char *cookie);

/** session_by_id() - find a session by its id; NULL if it has ended. */
struct session *session_by_id(struct sessions *s, const char *id);

/** session_end() - end and forget a session. */
void session_end(struct session *session);

/**
 * sessions_look() - if the file of users @path has changed, end the sessions of
 * those whose line, role or password has changed.
 */
void sessions_look(struct sessions *s, const char *path);

/**
 * session_token_ok() - compare the token; the time that this takes tells
 * nothing.
 */
bool session_token_ok(const struct session *session, const char *token);

/**
 * session_user_find() - find a user in the file @path. Return: 0; -ESRCH: no
 * such user; -EBADMSG: a line cannot be understood; -errno: it cannot be read.
 */
int session_user_find(const char *path, const char *name,
		      struct session_user *ret);

/**
 * session_user_put() - add or change a user: @path is written anew.  If root
 * does it, the file stays with its owner, or goes to that of its folder, and
 * the group of the service may read it.
 */
int session_user_put(const char *path, const struct session_user *user);

/**
 * session_may_try() - count an attempt to log in from @address. Return: 0, or
 * the seconds to wait before the next one.
 */
int session_may_try(struct sessions *s, const char *address);
/**
 * session_try_ok() - the password was right: this attempt does not count.  What
 * failed from the same address counts on, since it may have been for another
 * user.
 */
void session_try_ok(struct sessions *s, const char *address);

/**
 * session_local_role() - the role of the host's user @uid by [panel]
 * local_role. @ret_name gets the name of the user.
 */
enum role session_local_role(unsigned int uid, enum role most,
			     char ret_name[SESSION_USER_MAX]);

/**
 * role_name() - "viewer" and so on. role_parse() - the reverse; ROLE_NONE if
 * there is no such role.
 */
const char *role_name(enum role r);
enum role role_parse(const char *name);

#endif /* PANEL_SESSION_H */
