/* SPDX-License-Identifier: Apache-2.0 */
/*
 * session.h - who is at a browser, and what they may do
 *
 * Over the network a user logs in by a name and a password; the file of users
 * has a line `NAME ROLE HASH` for each, the hash by argon2id.  On the host's
 * own loopback address the kernel says which user of the host a connection
 * belongs to: who is root, or in group edm, or runs the panel, has the role of
 * [panel] local_role; everybody else looks on.
 *
 * A session is a random cookie.  Each act bears the session's token too, which
 * no other site can read.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_SESSION_H
#define PANEL_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum role { ROLE_NONE, ROLE_VIEWER, ROLE_OPERATOR, ROLE_SERVICE };

#define SESSIONS_MAX		256
#define SESSION_USER_MAX	32
#define SESSION_ID_BYTES	65	/* hex, with its NUL */
#define SESSION_HASH_MAX	160
#define SESSION_ADDRESS_MAX	48
#define SESSION_NOBODY		(~0u)

struct session {
	char id[SESSION_ID_BYTES];	/* of the cookie; "": free */
	char token[33];
	char user[SESSION_USER_MAX];
	char address[SESSION_ADDRESS_MAX];
	enum role role;
	unsigned int uid;		/* of this host, or SESSION_NOBODY */
	char hash[SESSION_HASH_MAX];	/* as it was at the login; "": none */
	int sockets;			/* browsers that hold it open */
	int64_t begun_s, used_s;
};

struct session_user {
	char name[SESSION_USER_MAX];
	enum role role;
	char hash[SESSION_HASH_MAX];
};

struct sessions;

/** sessions_create() - NULL: no memory. */
struct sessions *sessions_create(void);
void sessions_destroy(struct sessions *s);

/** session_begin() - a new one; the one that was used longest ago makes room,
 *  unless a browser holds it.  NULL: all are held. */
struct session *session_begin(struct sessions *s, const char *user,
			      enum role role, const char *address);

/** session_find() - by the value of a Cookie header; NULL: none, or too old. */
struct session *session_find(struct sessions *s, const char *cookie);

/** session_by_id() - NULL if it has ended. */
struct session *session_by_id(struct sessions *s, const char *id);

/** session_end() - forget it. */
void session_end(struct session *session);

/** sessions_look() - if the file of users @path was changed, end the sessions of
 *  those whose role or password it no longer has. */
void sessions_look(struct sessions *s, const char *path);

/** session_token_ok() - compares in a time that tells nothing. */
bool session_token_ok(const struct session *session, const char *token);

/** session_user_find() - a line of the file @path.
 *  Return: 0, -ENOENT: no such user or no such file; -EBADMSG; -errno. */
int session_user_find(const char *path, const char *name,
		      struct session_user *ret);

/** session_user_put() - add or change one: @path is written anew, mode 600. */
int session_user_put(const char *path, const struct session_user *user);

/** session_may_try() - count a try to log in from @address.
 *  Return: 0, or the seconds after which it may be tried again. */
int session_may_try(struct sessions *s, const char *address);
/** session_try_ok() - it was the right password. */
void session_try_ok(struct sessions *s, const char *address);

/** session_local_role() - of the host's user @uid, in [panel] local_role.
 *  @ret_name: what they are called. */
enum role session_local_role(unsigned int uid, enum role most,
			     char ret_name[SESSION_USER_MAX]);

/** session_peer_uid() - who of this host owns the other end of the loopback
 *  connection @fd.  Return: 0, or -ENOENT. */
int session_peer_uid(int fd, unsigned int *ret);

/** role_name() - "viewer", ...; role_parse() - ROLE_NONE if there is none. */
const char *role_name(enum role r);
enum role role_parse(const char *name);

#endif /* PANEL_SESSION_H */
