/* SPDX-License-Identifier: Apache-2.0 */
/* session.c - cookies, tokens, and attempts to log in */
#include "session.h"
#include "clocks.h"
#include "visitor.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define IDLE_S		3600		/* without a browser that holds the
					 * session */
#define LONGEST_S	(12 * 3600)
#define TRIES_MAX	5		/* attempts of one address in TRY_S */
#define TRIES_ALL	30		/* attempts of all addresses in TRY_S */
#define TRY_S		60
#define PLACES		64
#define SESSIONS_ROOM	512		/* more than there may be */

struct place {
	char address[SESSION_ADDRESS_MAX];
	int tries;
	bool known;			/* somebody has logged in from here */
	int64_t since_s;
};

struct sessions {
	struct shares *shares;
	struct session session[SESSIONS_ROOM];
	struct place place[PLACES];
	struct place all;
	struct stat users;		/* the time of the file at the last
					 * look */
};

static const char *const names[] = {
	[ROLE_NONE] = "none",
	[ROLE_VIEWER] = "viewer",
	[ROLE_OPERATOR] = "operator",
	[ROLE_SERVICE] = "service",
};

const char *role_name(enum role r)
{
	return names[r];
}

enum role role_parse(const char *name)
{
	for (int i = ROLE_VIEWER; i <= ROLE_SERVICE; i++)
		if (strcmp(names[i], name) == 0)
			return (enum role)i;
	return ROLE_NONE;
}

struct sessions *sessions_create(struct shares *shares)
{
	struct sessions *s = calloc(1, sizeof(*s));

	if (s)
		s->shares = shares;
	return s;
}

void sessions_destroy(struct sessions *s)
{
	if (!s)
		return;
	for (int i = 0; i < SESSIONS_ROOM; i++)
		session_end(&s->session[i]);
	free(s);
}

void session_end(struct session *session)
{
	share_give(&session->share);
	sodium_memzero(session, sizeof(*session));
}

static bool is_over(const struct session *s, int64_t at_s)
{
	if (at_s - s->begun_s > LONGEST_S)
		return true;
	return s->sockets == 0 && at_s - s->used_s > IDLE_S;
}

static bool is_same_file(const struct stat *a, const struct stat *b)
{
	return a->st_ino == b->st_ino && a->st_size == b->st_size &&
	       a->st_mtim.tv_sec == b->st_mtim.tv_sec &&
	       a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

void sessions_look(struct sessions *s, const char *path)
{
	struct stat now = { .st_ino = 0 };
	struct session_user u;

	if (stat(path, &now) < 0)
		memset(&now, 0, sizeof(now));
	if (is_same_file(&now, &s->users))
		return;
	s->users = now;
	for (int i = 0; i < SESSIONS_ROOM; i++) {
		struct session *t = &s->session[i];

		if (t->hash[0] && (session_user_find(path, t->user, &u) < 0 ||
				   u.role != t->role ||
				   strcmp(u.hash, t->hash) != 0))
			session_end(t);
	}
}

static struct session *free_one(struct sessions *s)
{
	int i = 0;

	while (s->session[i].id[0])
		i++;
	return &s->session[i];
}

static void on_taken(void *arg, const char *why)
{
	(void)why;
	session_end(arg);
}

static void draw_hex(char *to, size_t bytes)
{
	uint8_t drawn[32];

	randombytes_buf(drawn, bytes);
	sodium_bin2hex(to, 2 * bytes + 1, drawn, bytes);
	sodium_memzero(drawn, sizeof(drawn));
}

struct session *session_begin(struct sessions *s, const struct visitor *v,
			      const char *user, enum role role)
{
	struct session *n = free_one(s);
	struct share_who who;

	snprintf(n->user, sizeof(n->user), "%s", user);
	snprintf(n->address, sizeof(n->address), "%s", v->address);
	n->role = role;
	n->uid = v->uid;
	n->begun_s = n->used_s = clock_ms(CLOCK_MONOTONIC) / 1000;
	n->share = (struct share) { .kind = SHARE_SESSION, .end = on_taken,
				    .arg = n, .idle = true };
	visitor_who(v, n, &who);
	if (share_take(s->shares, &n->share, &who))
		return NULL;
	draw_hex(n->id, 32);
	draw_hex(n->token, 16);
	return n;
}

void session_hold(struct session *session, int more)
{
	session->sockets += more;
	session->share.idle = session->sockets == 0;
}

struct session *session_by_id(struct sessions *s, const char *id)
{
	const int64_t at_s = clock_ms(CLOCK_MONOTONIC) / 1000;

	if (strlen(id) != SESSION_ID_BYTES - 1)
		return NULL;
	for (int i = 0; i < SESSIONS_ROOM; i++) {
		struct session *t = &s->session[i];

		if (!t->id[0] || sodium_memcmp(t->id, id,
					       SESSION_ID_BYTES - 1) != 0)
			continue;
		if (is_over(t, at_s)) {
			session_end(t);
			return NULL;
		}
		t->used_s = at_s;
		share_use(&t->share);
		return t;
	}
	return NULL;
}

struct session *session_find(struct sessions *s, const char *cookie)
{
	static const char name[] = "edm_session=";
	char id[SESSION_ID_BYTES];

	for (const char *at = cookie; at && *at;) {
		at += strspn(at, " ;");
		if (strncmp(at, name, sizeof(name) - 1) == 0) {
			snprintf(id, sizeof(id), "%s", at + sizeof(name) - 1);
			id[strcspn(id, "; ")] = '\0';
			return session_by_id(s, id);
		}
		at = strchr(at, ';');
	}
	return NULL;
}

bool session_token_ok(const struct session *session, const char *token)
{
	return token && strlen(token) == sizeof(session->token) - 1 &&
	       sodium_memcmp(token, session->token,
			     sizeof(session->token) - 1) == 0;
}

static struct place *place_of(struct sessions *s, const char *address)
{
	struct place *oldest = &s->place[0];

	for (int i = 0; i < PLACES; i++) {
		if (strcmp(s->place[i].address, address) == 0)
			return &s->place[i];
		if (oldest->known != s->place[i].known ? oldest->known :
		    s->place[i].since_s < oldest->since_s)
			oldest = &s->place[i];
	}
	*oldest = (struct place) {
		.since_s = clock_ms(CLOCK_MONOTONIC) / 1000,
	};
	snprintf(oldest->address, sizeof(oldest->address), "%s", address);
	return oldest;
}

static int count_try(struct place *p, int most)
{
	const int64_t at_s = clock_ms(CLOCK_MONOTONIC) / 1000;

	if (at_s - p->since_s >= TRY_S) {
		p->tries = 0;
		p->since_s = at_s;
	}
	if (p->tries >= most)
		return (int)(p->since_s + TRY_S - at_s) + 1;
	p->tries++;
	return 0;
}

/* Many strangers together do not keep those out who have logged in before. */
int session_may_try(struct sessions *s, const char *address)
{
	struct place *p = place_of(s, address);
	const int wait_s = count_try(p, TRIES_MAX);

	return wait_s || p->known ? wait_s : count_try(&s->all, TRIES_ALL);
}

void session_try_ok(struct sessions *s, const char *address)
{
	struct place *p = place_of(s, address);

	p->tries -= p->tries > 0;
	s->all.tries -= !p->known && s->all.tries > 0;
	p->known = true;
}
