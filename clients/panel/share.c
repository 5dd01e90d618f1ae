/* SPDX-License-Identifier: Apache-2.0 */
/* share.c - who holds how much of what is scarce, and who makes room */
#include "share.h"
#include "clocks.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct share_peer {
	struct share_peer *next;
	char name[SHARE_PEER_MAX];
	int held[SHARE_NKINDS], all;
};

struct shares {
	struct share *first[SHARE_NKINDS];
	int held[SHARE_NKINDS];
	struct share_peer *peers;
};

static const int most[SHARE_NKINDS] = {
	[SHARE_CONNECTION]	= 384,
	[SHARE_BROWSER]		= 128,
	[SHARE_SESSION]		= 256,
	[SHARE_UPLOAD]		= 4,
	[SHARE_CHECK]		= 4,
	[SHARE_LOGIN]		= 4,
	[SHARE_PATH]		= 8,
	[SHARE_QUESTION]	= 16,
};

static const char MADE_ROOM[] = "it made room for somebody else; try again";
static const char TOO_LONG[] = "it took too long; try again";

struct shares *shares_create(void)
{
	return calloc(1, sizeof(struct shares));
}

void shares_destroy(struct shares *a)
{
	free(a);
}

/* -- Peers ---------------------------------------------------------------- */

static struct share_peer *peer_of(struct shares *a, const char *name)
{
	struct share_peer *p = a->peers;

	while (p && strcmp(p->name, name) != 0)
		p = p->next;
	if (p)
		return p;
	p = calloc(1, sizeof(*p));
	if (!p)
		return NULL;
	snprintf(p->name, sizeof(p->name), "%s", name);
	p->next = a->peers;
	a->peers = p;
	return p;
}

static void peer_count(struct shares *a, struct share_peer *p,
		       enum share_kind kind, int more)
{
	struct share_peer **at = &a->peers;

	p->held[kind] += more;
	p->all += more;
	if (p->all > 0)
		return;
	while (*at != p)
		at = &(*at)->next;
	*at = p->next;
	free(p);
}

/* -- Who makes room ------------------------------------------------------- */

/* What is under way goes only if that makes the two more equal: else they would
 * take it from each other for ever. */
static bool may_take(const struct share *from, const struct share_peer *by,
		     int rank)
{
	const int has = from->peer->held[from->kind];
	const int wants = by->held[from->kind] + 1;

	if (from->rank != rank)
		return from->rank < rank;
	if (from->peer == by)
		return from->idle;
	return from->idle ? has >= wants : has > wants;
}

/* Is it better to take it from @a than from @b? */
static bool is_less(const struct share *a, const struct share *b)
{
	const int more = a->peer->held[a->kind] - b->peer->held[b->kind];

	if (a->rank != b->rank)
		return a->rank < b->rank;
	if (more)
		return more > 0;
	if (a->idle != b->idle)
		return a->idle;
	return a->used_ms < b->used_ms;
}

static struct share *least(struct shares *a, enum share_kind kind,
			   const struct share_peer *by, int rank)
{
	struct share *found = NULL;

	for (struct share *s = a->first[kind]; s; s = s->next)
		if (may_take(s, by, rank) && (!found || is_less(s, found)))
			found = s;
	return found;
}

static void end(struct share *s, const char *why)
{
	share_give(s);
	s->end(s->arg, why);
}

/* -- Taking and giving ---------------------------------------------------- */

static int make_room(struct shares *a, enum share_kind kind,
		     const struct share_peer *by, int rank)
{
	struct share *s;

	if (a->held[kind] < most[kind])
		return 0;
	s = least(a, kind, by, rank);
	if (!s)
		return -EBUSY;
	end(s, MADE_ROOM);
	return 0;
}

int share_take(struct shares *a, struct share *s, const struct share_who *who)
{
	struct share_peer *p = peer_of(a, who->peer);
	struct share **first = &a->first[s->kind];
	int err;

	assert(!s->of);
	if (!p)
		return -ENOMEM;
	/* It counts from here on, so that it stays while room is made. */
	p->all++;
	err = make_room(a, s->kind, p, who->rank);
	p->all--;
	if (err) {
		peer_count(a, p, s->kind, 0);
		return err;
	}
	peer_count(a, p, s->kind, 1);
	s->of = a;
	s->peer = p;
	s->rank = who->rank;
	s->until_ms = 0;
	s->next = *first;
	s->at = first;
	if (s->next)
		s->next->at = &s->next;
	*first = s;
	a->held[s->kind]++;
	share_use(s);
	return 0;
}

void share_give(struct share *s)
{
	struct shares *a = s->of;

	if (!a)
		return;
	*s->at = s->next;
	if (s->next)
		s->next->at = s->at;
	a->held[s->kind]--;
	peer_count(a, s->peer, s->kind, -1);
	s->of = NULL;
	s->peer = NULL;
}

void share_use(struct share *s)
{
	s->used_ms = clock_ms(CLOCK_MONOTONIC);
}

void share_pass(struct share *s, const struct share_who *who)
{
	struct share_peer *p = s->of ? peer_of(s->of, who->peer) : NULL;

	if (!p)
		return;
	peer_count(s->of, p, s->kind, 1);
	peer_count(s->of, s->peer, s->kind, -1);
	s->peer = p;
	s->rank = who->rank;
}

void share_limit(struct share *s, int seconds)
{
	s->until_ms = seconds ? clock_ms(CLOCK_MONOTONIC) + seconds * 1000 : 0;
}

void shares_look(struct shares *a)
{
	const int64_t at_ms = clock_ms(CLOCK_MONOTONIC);

	for (int i = 0; i < SHARE_NKINDS; i++) {
		struct share *s = a->first[i];

		/* What ends one may give others back: begin anew. */
		while (s && !(s->until_ms && at_ms > s->until_ms))
			s = s->next;
		if (s) {
			end(s, TOO_LONG);
			i--;
		}
	}
}

int share_held(const struct shares *a, enum share_kind kind)
{
	return a->held[kind];
}
