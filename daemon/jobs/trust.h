/* SPDX-License-Identifier: Apache-2.0 */
/*
 * trust.h - who sent a packet, and is it a new one?
 *
 * A packet is taken if its signature is valid for a key in the table, if it was
 * signed for this start of the service (`boot`), if its count is near the
 * service's clock, and if its count is greater than that of the last packet of
 * the same client. So no packet is taken twice, whoever sends it again. What
 * has to be remembered is bounded: a client that was silent for TRUST_OLD_US
 * can be forgotten, because its old packets are too old by then.
 *
 * A client that only asked is forgotten when its room is wanted: a question
 * that is heard twice is answered twice, and that is all.  An act that ends
 * motion is taken without a session, if there is no room: edmd and the store
 * know its id.
 *
 * Who may only look must not keep the service from those who may stop the
 * machine. So each key has room of its own for its clients, and of a viewer's
 * packets only so many a second are looked at.
 *
 * What is refused is counted by cause and told in the log, at most once in ten
 * seconds for each cause.
 *
 * Units: in every name. Threads: one, that of the event loop.
 */
#ifndef JOBS_TRUST_H
#define JOBS_TRUST_H

#include "keyfile.h"
#include "seal.h"

#define TRUST_KEYS		64
#define TRUST_SESSIONS		1024	/* of each key */
#define TRUST_VIEWER_A_S	50	/* packets that are taken of a viewer */
#define TRUST_AGAIN_A_S		1000	/* for another time, answered to a
					 * key */
#define TRUST_CLIENT_MAX	64	/* with its NUL */
#define TRUST_OLD_US		30000000
#define TRUST_AHEAD_US		10000000

/* What a key's owner may do; each may do what those before it may. */
enum trust_role { ROLE_NONE, ROLE_VIEWER, ROLE_OPERATOR, ROLE_SERVICE };

struct trust_key {
	uint8_t key[SEAL_KEY_BYTES];
	char name[KEYFILE_NAME_MAX];
	enum trust_role role;
};

/* Why a packet is not taken. */
enum trust_cause {
	TRUST_FINE, TRUST_SHAPE, TRUST_KEY, TRUST_SIGNATURE, TRUST_BOOT,
	TRUST_TIME, TRUST_REPLAY, TRUST_CROWD, TRUST_ROLE, TRUST_STRANGE,
	TRUST_OFTEN,
	TRUST_NCAUSES
};

/* What a packet wants, as far as its session is concerned. */
enum trust_want { TRUST_ASKS, TRUST_ACTS, TRUST_ENDS };

struct trust_session {
	char client[TRUST_CLIENT_MAX];	/* "": free */
	int64_t count;			/* of its last packet */
	bool acted;			/* it did more than ask */
};

struct trust_refusals {
	uint64_t count, told;
	int64_t told_us;
};

/* How often in this second. */
struct trust_rate {
	int64_t since_us;
	int n;
};

/* Placed by the caller. */
struct trust {
	struct keyfile machine;		/* its own pair; signs what it sends */
	struct trust_key key[TRUST_KEYS];
	int nkeys;
	int64_t boot;
	/* Private. */
	int64_t begun_us, sent;
	struct trust_session session[TRUST_KEYS][TRUST_SESSIONS];
	struct trust_rate asked[TRUST_KEYS], again[TRUST_KEYS], strangers;
	struct trust_refusals refused[TRUST_NCAUSES];
};

/* One packet. */
struct trust_packet {
	const char *channel, *from;
	struct seal seal;
	const struct trust_key *key;	/* NULL: not in the table */
	bool answers;			/* one that is not taken is told why */
};

struct trust_client {
	const char *name;
	enum trust_want want;
};

/**
 * trust_init() - draw a new boot number; @machine and the keys are set already.
 */
void trust_init(struct trust *t, int64_t now_us);

/**
 * trust_count() - the count for a packet to be sent: the clock of the service;
 * it always grows.
 */
int64_t trust_count(struct trust *t, int64_t now_us);

/**
 * trust_look() - is the packet signed by a key of the table, for us, now?
 *
 * The caller has set @p->channel and @p->from; the rest is filled.
 *
 * Return: TRUST_FINE; TRUST_KEY, TRUST_BOOT or TRUST_TIME if the signature is
 * valid and the reason may be answered; any other value: drop it silently.
 */
enum trust_cause trust_look(struct trust *t, struct trust_packet *p,
			    const void *packet, size_t bytes, int64_t now_us);

/**
 * trust_fresh() - is it the next packet of @client? TRUST_FINE, else why not.
 *
 * TRUST_CROWD is said only to acts that do not end motion, and only if so many
 * clients have acted.
 */
enum trust_cause trust_fresh(struct trust *t, const struct trust_packet *p,
			     const struct trust_client *client, int64_t now_us);

/**
 * trust_signed_us() - when the client signed it, by our clock, as far as the
 * client knows that.
 */
int64_t trust_signed_us(const struct trust *t, const struct seal *s);

/** trust_refuse() - count it, and write it to the log if that is due. */
void trust_refuse(struct trust *t, enum trust_cause cause, const char *who,
		  const char *from, int64_t now_us);

/** trust_who() - the name of a packet's key, or the key's first digits. */
void trust_who(const struct trust_packet *p, char to[KEYFILE_NAME_MAX]);

/** trust_cause_text() - "its signature is not for ...", ... */
const char *trust_cause_text(enum trust_cause c);

/** trust_role_name() and back; ROLE_NONE for no such name. */
const char *trust_role_name(enum trust_role role);
enum trust_role trust_role_of(const char *name);

/** trust_find() - the key in the table; NULL if it is not there. */
const struct trust_key *trust_find(const struct trust *t,
				   const uint8_t key[SEAL_KEY_BYTES]);

/**
 * trust_add() - Return: 0; -EEXIST: the key or its name is there already;
 * -ENOSPC.
 */
int trust_add(struct trust *t, const struct trust_key *k);

/**
 * trust_remove() - remove the key of this name, and end its sessions. Return: 0
 * or -ENOENT.
 */
int trust_remove(struct trust *t, const char *name);

#endif /* JOBS_TRUST_H */
