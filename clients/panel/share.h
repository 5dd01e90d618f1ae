/* SPDX-License-Identifier: Apache-2.0 */
/*
 * share.h - who holds how much of what is scarce, and who makes room
 *
 * One table has everything of which the panel has only so much: connections,
 * browsers, sessions, uploads, and so on.  Whoever wants one more when all are
 * held gets it from somebody with a lower rank, or from the peer who holds the
 * most, if that is more than the one who asks holds.  So a crowd of one peer
 * may fill the panel as long as nobody else is there, and keeps nobody out.
 *
 * A peer is a user of this host, a user who logged in, or an address.
 *
 * Threads: one, that of the event loop.
 */
#ifndef PANEL_SHARE_H
#define PANEL_SHARE_H

#include <stdbool.h>
#include <stdint.h>

enum share_kind {
	SHARE_CONNECTION,
	SHARE_BROWSER,			/* a web socket */
	SHARE_SESSION,
	SHARE_UPLOAD,			/* a text, until it is answered */
	SHARE_CHECK,			/* a program that may use all it may */
	SHARE_LOGIN,			/* a password that is compared */
	SHARE_PATH,			/* of a text that was checked */
	SHARE_QUESTION,			/* of edmd-jobs */
	SHARE_NKINDS
};

#define SHARE_PEER_MAX	56

struct share_who {
	char peer[SHARE_PEER_MAX];
	int rank;			/* who has a higher one goes first */
};

struct shares;
struct share_peer;

/* Part of what holds it.  All zero: it holds nothing. */
struct share {
	enum share_kind kind;
	/**
	 * It has been taken away already.  @why is a text for who held it.
	 */
	void (*end)(void *arg, const char *why);
	void *arg;
	bool idle;			/* its holder loses little with it */
	/* Private. */
	struct shares *of;		/* NULL: it holds nothing */
	struct share_peer *peer;
	struct share *next, **at;
	int rank;
	int64_t used_ms, until_ms;
};

/** shares_create() - Return: NULL if there is no memory. */
struct shares *shares_create(void);
/** shares_destroy() - nothing may be held any more. */
void shares_destroy(struct shares *a);

/**
 * share_take() - take one for @who, perhaps from somebody else.
 *
 * @s: kind, end, arg and idle are set.
 *
 * Return: 0; -EBUSY; -ENOMEM.
 */
int share_take(struct shares *a, struct share *s, const struct share_who *who);

/** share_give() - give it back; allowed if nothing is held. */
void share_give(struct share *s);

/** share_use() - it was used now: of the idle ones the oldest goes first. */
void share_use(struct share *s);

/** share_pass() - from now on it counts for @who. */
void share_pass(struct share *s, const struct share_who *who);

/** share_limit() - it ends in @s seconds; 0: it may last. */
void share_limit(struct share *s, int seconds);

/** shares_look() - end what has lasted too long; to be called each second. */
void shares_look(struct shares *a);

/** share_held() - how many are held. */
int share_held(const struct shares *a, enum share_kind kind);

#endif /* PANEL_SHARE_H */
