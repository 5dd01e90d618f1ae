/* SPDX-License-Identifier: Apache-2.0 */
/* trust.c - who signed a packet, and whether it is new */
#include "trust.h"

#include "jobs_log.h"

#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#define TELL_US		10000000	/* between two lines of the log for one
					 * cause */
#define STRANGERS_A_S	200		/* of their packets looked at */

static const char *const roles[] = {
	[ROLE_NONE]	= "none",
	[ROLE_VIEWER]	= "viewer",
	[ROLE_OPERATOR]	= "operator",
	[ROLE_SERVICE]	= "service",
};

static const char *const causes[TRUST_NCAUSES] = {
	[TRUST_FINE]	= "nothing is wrong",
	[TRUST_SHAPE]	= "not the shape of a signed message",
	[TRUST_KEY]	= "signed by a key that is not known here",
	[TRUST_SIGNATURE] = "its signature is not for this machine and channel",
	[TRUST_BOOT]	= "signed for another start of the service",
	[TRUST_TIME]	= "signed too long ago, or ahead of time",
	[TRUST_REPLAY]	= "sent before, or overtaken by a later one",
	[TRUST_CROWD]	= "too many clients at once",
	[TRUST_ROLE]	= "the role of its key does not allow it",
	[TRUST_STRANGE]	= "from another host, or in LCM's pieces",
	[TRUST_OFTEN]	= "more than is taken of a viewer in a second",
};

const char *trust_cause_text(enum trust_cause c)
{
	return causes[c];
}

const char *trust_role_name(enum trust_role role)
{
	return roles[role];
}

enum trust_role trust_role_of(const char *name)
{
	for (int i = ROLE_VIEWER; i <= ROLE_SERVICE; i++)
		if (strcmp(name, roles[i]) == 0)
			return (enum trust_role)i;
	return ROLE_NONE;
}

void trust_init(struct trust *t, int64_t now_us)
{
	uint64_t drawn;

	randombytes_buf(&drawn, sizeof(drawn));
	t->boot = (int64_t)(drawn >> 1) | 1;
	t->begun_us = now_us;
	t->sent = 0;
}

static int64_t clock_of(const struct trust *t, int64_t now_us)
{
	return now_us - t->begun_us;
}

int64_t trust_signed_us(const struct trust *t, const struct seal *s)
{
	return t->begun_us + s->count;
}

int64_t trust_count(struct trust *t, int64_t now_us)
{
	int64_t now = clock_of(t, now_us);

	t->sent = now > t->sent ? now : t->sent + 1;
	return t->sent;
}

/* -- Keys ----------------------------------------------------------------- */

const struct trust_key *trust_find(const struct trust *t,
				   const uint8_t key[SEAL_KEY_BYTES])
{
	for (int i = 0; i < TRUST_KEYS; i++)
		if (t->key[i].role != ROLE_NONE &&
		    memcmp(t->key[i].key, key, SEAL_KEY_BYTES) == 0)
			return &t->key[i];
	return NULL;
}

int trust_add(struct trust *t, const struct trust_key *k)
{
	struct trust_key *room = NULL;

	for (int i = TRUST_KEYS - 1; i >= 0; i--) {
		struct trust_key *one = &t->key[i];

		if (one->role == ROLE_NONE)
			room = one;
		else if (strcmp(one->name, k->name) == 0 ||
			 memcmp(one->key, k->key, SEAL_KEY_BYTES) == 0)
			return -EEXIST;
	}
	if (!room)
		return -ENOSPC;
	*room = *k;
	t->nkeys++;
	return 0;
}

int trust_remove(struct trust *t, const char *name)
{
	for (int i = 0; i < TRUST_KEYS; i++) {
		struct trust_key *one = &t->key[i];

		if (one->role == ROLE_NONE || strcmp(one->name, name) != 0)
			continue;
		memset(t->session[i], 0, sizeof(t->session[i]));
		one->role = ROLE_NONE;
		t->nkeys--;
		return 0;
	}
	return -ENOENT;
}

/* -- Refusals ------------------------------------------------------------- */

void trust_refuse(struct trust *t, enum trust_cause cause, const char *who,
		  const char *from, int64_t now_us)
{
	struct trust_refusals *r = &t->refused[cause];

	r->count++;
	if (r->told_us && now_us - r->told_us < TELL_US)
		return;
	log_warning("trust: refused %" PRIu64 " packets: %s; the last of %s "
		    "from %s", r->count - r->told, causes[cause], who, from);
	r->told = r->count;
	r->told_us = now_us;
}

void trust_who(const struct trust_packet *p, char to[KEYFILE_NAME_MAX])
{
	char hex[KEYFILE_HEX];

	if (p->key) {
		snprintf(to, KEYFILE_NAME_MAX, "%s", p->key->name);
		return;
	}
	keyfile_hex(hex, p->seal.key);
	snprintf(to, KEYFILE_NAME_MAX, "key %.8s...", hex);
}

/* Were there fewer than @most in this second? */
static bool rate_allows(struct trust_rate *r, int most, int64_t now_us)
{
	if (now_us - r->since_us > 1000000)
		*r = (struct trust_rate) { .since_us = now_us };
	return r->n < most;
}

/*
 * How many packets are looked at in a second.  All strangers share one limit.
 * Each key has one for packets that are signed for another time, as recorded
 * ones are.  A viewer has one for new packets.  So nobody uses up what belongs
 * to another.  NULL: no limit.
 */
static struct trust_rate *rate_of(struct trust *t, const struct trust_packet *p,
				  enum trust_cause cause, int *ret_most)
{
	const bool viewer = p->key && p->key->role == ROLE_VIEWER;

	*ret_most = !p->key ? STRANGERS_A_S :
		    viewer ? TRUST_VIEWER_A_S : TRUST_AGAIN_A_S;
	if (!p->key)
		return &t->strangers;
	if (cause != TRUST_FINE)
		return &t->again[p->key - t->key];
	return viewer ? &t->asked[p->key - t->key] : NULL;
}

/* What can be seen before a signature is computed. */
static enum trust_cause look_quickly(const struct trust *t,
				     const struct trust_packet *p,
				     int64_t now_us)
{
	int64_t now = clock_of(t, now_us), count = p->seal.count;

	if (!p->key)
		return TRUST_KEY;
	if (p->seal.boot != t->boot)
		return TRUST_BOOT;
	/* Do not subtract: a packet could make the difference overflow. */
	if (count < now - TRUST_OLD_US || count > now + TRUST_AHEAD_US)
		return TRUST_TIME;
	return TRUST_FINE;
}

enum trust_cause trust_look(struct trust *t, struct trust_packet *p,
			    const void *packet, size_t bytes, int64_t now_us)
{
	struct trust_rate *rate;
	enum trust_cause cause;
	int most;

	p->answers = false;
	if (!seal_read(&p->seal, packet, bytes))
		return TRUST_SHAPE;
	p->key = trust_find(t, p->seal.key);
	cause = look_quickly(t, p, now_us);
	rate = rate_of(t, p, cause, &most);
	if (rate && !rate_allows(rate, most, now_us))
		return cause == TRUST_FINE ? TRUST_OFTEN : cause;
	/* A stranger's signature costs as much as a good one. */
	if (!p->key)
		rate->n++;
	if (!seal_holds(&p->seal, p->channel))
		return TRUST_SIGNATURE;
	p->answers = cause != TRUST_FINE;
	if (p->key && p->answers)
		rate->n++;
	return cause;
}

/* -- Sessions ------------------------------------------------------------- */

static bool session_is_over(const struct trust_session *s, int64_t now)
{
	return !s->client[0] || s->count < now - TRUST_OLD_US;
}

/* Which of two is the better one to be given up; NULL: none yet. */
static struct trust_session *session_room(struct trust_session *a,
					  struct trust_session *b, int64_t now)
{
	if (session_is_over(b, now))
		return !a || !session_is_over(a, now) ? b : a;
	if (b->acted || (a && (session_is_over(a, now) || a->count < b->count)))
		return a;
	return b;
}

/* Return: NULL: it is not there, and @ret_room may be had; or NULL too. */
static struct trust_session *session_find(struct trust_session *of,
					  const char *client, int64_t now,
					  struct trust_session **ret_room)
{
	*ret_room = NULL;
	for (int i = 0; i < TRUST_SESSIONS; i++) {
		if (strcmp(of[i].client, client) == 0)
			return &of[i];
		*ret_room = session_room(*ret_room, &of[i], now);
	}
	return NULL;
}

enum trust_cause trust_fresh(struct trust *t, const struct trust_packet *p,
			     const struct trust_client *client, int64_t now_us)
{
	const int64_t now = clock_of(t, now_us);
	struct trust_session *room, *s;

	s = session_find(t->session[p->key - t->key], client->name, now, &room);
	if (s && p->seal.count <= s->count)
		return TRUST_REPLAY;
	if (!s && !room && client->want == TRUST_ACTS)
		return TRUST_CROWD;
	if (!s && room) {
		s = room;
		*s = (struct trust_session) { .acted = false };
		snprintf(s->client, sizeof(s->client), "%s", client->name);
	}
	if (s) {
		s->count = p->seal.count;
		s->acted = s->acted || client->want != TRUST_ASKS;
	}
	t->asked[p->key - t->key].n++;
	return TRUST_FINE;
}
