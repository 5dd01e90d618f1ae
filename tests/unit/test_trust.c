/* SPDX-License-Identifier: Apache-2.0 */
/* test_trust.c - whose packets are accepted, and that none is accepted twice */
#include "trust.h"

#include <errno.h>
#include <setjmp.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define CHANNEL	"EDM.edm.COMMAND"
#define S	INT64_C(1000000)

struct world {
	struct trust t;
	struct keyfile host, other;
	int64_t now_us;
};

static int setup(void **state)
{
	struct world *w = calloc(1, sizeof(*w));
	struct trust_key row = { .name = "host", .role = ROLE_SERVICE };

	if (!w)
		return -1;
	keyfile_draw(&w->host);
	keyfile_draw(&w->other);
	memcpy(row.key, w->host.public, sizeof(row.key));
	w->now_us = 100 * S;
	if (trust_add(&w->t, &row) < 0)
		return -1;
	trust_init(&w->t, w->now_us);
	*state = w;
	return 0;
}

static int teardown(void **state)
{
	free(*state);
	return 0;
}

struct sent {
	const struct keyfile *by;
	const char *channel, *client;
	int64_t boot, count;
	enum trust_want want;
};

/* What becomes of a packet that is @s. */
static enum trust_cause send(struct world *w, const struct sent *s)
{
	const struct seal seal = { .key = s->by->public, .boot = s->boot,
				   .count = s->count, .data = "x", .size = 1 };
	struct trust_packet p = { .channel = CHANNEL, .from = "test" };
	uint8_t packet[SEAL_BYTES + 1];
	enum trust_cause cause;

	seal_make(packet, &seal, s->channel, s->by->secret);
	cause = trust_look(&w->t, &p, packet, sizeof(packet), w->now_us);
	if (cause == TRUST_FINE)
		cause = trust_fresh(&w->t, &p, &(struct trust_client) {
			.name = s->client, .want = s->want }, w->now_us);
	return cause;
}

/* Is what is not taken answered? */
static bool is_answered(struct world *w, const struct sent *s, bool forged)
{
	const struct seal seal = { .key = s->by->public, .boot = s->boot,
				   .count = s->count, .data = "x", .size = 1 };
	struct trust_packet p = { .channel = CHANNEL, .from = "test" };
	uint8_t packet[SEAL_BYTES + 1];

	seal_make(packet, &seal, s->channel, s->by->secret);
	packet[sizeof(packet) - 1] ^= forged;
	trust_look(&w->t, &p, packet, sizeof(packet), w->now_us);
	return p.answers;
}

static struct sent good(const struct world *w, int64_t count)
{
	return (struct sent) {
		.by = &w->host, .channel = CHANNEL, .client = "a",
		.boot = w->t.boot, .count = count,
	};
}

static void a_packet_is_taken_once(void **state)
{
	struct world *w = *state;
	struct sent s = good(w, 5);

	assert_int_equal(send(w, &s), TRUST_FINE);
	assert_int_equal(send(w, &s), TRUST_REPLAY);
	s.count = 4;
	assert_int_equal(send(w, &s), TRUST_REPLAY);
	s.client = "b";
	assert_int_equal(send(w, &s), TRUST_FINE);
	s.client = "a";
	s.count = 6;
	assert_int_equal(send(w, &s), TRUST_FINE);
}

static void what_is_not_ours_is_not_taken(void **state)
{
	struct world *w = *state;
	struct sent s = good(w, 5);

	s.by = &w->other;
	assert_int_equal(send(w, &s), TRUST_KEY);
	s = good(w, 5);
	s.channel = "EDM.other.COMMAND";
	assert_int_equal(send(w, &s), TRUST_SIGNATURE);
	s = good(w, 5);
	s.boot++;
	assert_int_equal(send(w, &s), TRUST_BOOT);
	s = good(w, 11 * S);
	assert_int_equal(send(w, &s), TRUST_TIME);
	s = good(w, INT64_MAX);
	assert_int_equal(send(w, &s), TRUST_TIME);
	s = good(w, INT64_MIN);
	assert_int_equal(send(w, &s), TRUST_TIME);
	assert_int_equal(send(w, &(struct sent) {
		.by = &w->host, .channel = CHANNEL, .client = "a",
		.boot = w->t.boot, .count = 0 }), TRUST_FINE);
}

/* Each asks by a name of its own, as a loop of edmctl does. */
static void who_asks_takes_no_room_from_who_acts(void **state)
{
	struct world *w = *state;
	struct sent s = good(w, 1);
	char name[32];

	s.want = TRUST_ACTS;
	s.client = "acts";
	assert_int_equal(send(w, &s), TRUST_FINE);
	for (int i = 0; i < 3 * TRUST_SESSIONS; i++) {
		s = good(w, 2 + i);
		snprintf(name, sizeof(name), "c%d", i);
		s.client = name;
		assert_int_equal(send(w, &s), TRUST_FINE);
	}
	/* An act that was recorded is still known. */
	s = good(w, 1);
	s.want = TRUST_ACTS;
	s.client = "acts";
	assert_int_equal(send(w, &s), TRUST_REPLAY);
	s.client = "new";
	assert_int_equal(send(w, &s), TRUST_FINE);
}

/* More clients than there is room for: none that counts is forgotten. */
static void a_crowd_lets_no_replay_through(void **state)
{
	struct world *w = *state;
	struct sent s;
	char name[32];

	for (int i = 0; i < TRUST_SESSIONS; i++) {
		s = good(w, 1);
		s.want = TRUST_ACTS;
		snprintf(name, sizeof(name), "c%d", i);
		s.client = name;
		assert_int_equal(send(w, &s), TRUST_FINE);
	}
	s.client = "late";
	assert_int_equal(send(w, &s), TRUST_CROWD);
	/* A stop and a question are not kept away. */
	s.client = "stop";
	s.want = TRUST_ENDS;
	assert_int_equal(send(w, &s), TRUST_FINE);
	s.client = "asks";
	s.want = TRUST_ASKS;
	assert_int_equal(send(w, &s), TRUST_FINE);
	s.client = "c7";
	s.want = TRUST_ACTS;
	assert_int_equal(send(w, &s), TRUST_REPLAY);
	w->now_us += TRUST_OLD_US + 2;
	s.client = "c7";
	assert_int_equal(send(w, &s), TRUST_TIME);
	s = good(w, TRUST_OLD_US);
	s.client = "late";
	assert_int_equal(send(w, &s), TRUST_FINE);
}

static void add_other(struct world *w, enum trust_role role)
{
	struct trust_key row = { .name = "guest", .role = role };

	memcpy(row.key, w->other.public, sizeof(row.key));
	assert_int_equal(trust_add(&w->t, &row), 0);
}

/* Its owner draws a thousand names; the others come in. */
static void a_crowd_of_one_key_locks_no_other_out(void **state)
{
	struct world *w = *state;
	struct sent s;
	char name[32];

	add_other(w, ROLE_OPERATOR);
	for (int i = 0; i <= TRUST_SESSIONS; i++) {
		s = good(w, 1);
		s.by = &w->other;
		s.want = TRUST_ACTS;
		snprintf(name, sizeof(name), "c%d", i);
		s.client = name;
		assert_int_equal(send(w, &s), i < TRUST_SESSIONS ?
				 TRUST_FINE : TRUST_CROWD);
	}
	s.by = &w->host;
	assert_int_equal(send(w, &s), TRUST_FINE);
	s.client = "c0";
	assert_int_equal(send(w, &s), TRUST_FINE);
	assert_int_equal(send(w, &s), TRUST_REPLAY);
}

static void so_much_is_taken_of_a_viewer_and_all_of_an_operator(void **state)
{
	struct world *w = *state;
	struct sent mine = good(w, 1), guest = mine;
	enum trust_cause cause;

	add_other(w, ROLE_VIEWER);
	guest.by = &w->other;
	for (int second = 0; second < 3; second++) {
		for (int i = 0; i < 3 * TRUST_VIEWER_A_S; i++) {
			guest.count++;
			mine.count++;
			cause = send(w, &guest);
			assert_int_equal(cause, i < TRUST_VIEWER_A_S ?
					 TRUST_FINE : TRUST_OFTEN);
			assert_int_equal(send(w, &mine), TRUST_FINE);
		}
		w->now_us += S + 1;
		guest.count = mine.count += S + 1;
	}
	/* What somebody else sends in a viewer's name is not the viewer's. */
	guest.channel = "EDM.other.COMMAND";
	for (int i = 0; i < 3 * TRUST_VIEWER_A_S; i++)
		assert_int_equal(send(w, &guest), TRUST_SIGNATURE);
	guest.channel = CHANNEL;
	guest.count++;
	assert_int_equal(send(w, &guest), TRUST_FINE);
}

/* What is answered to strangers, and to what was recorded of one key, is not
 * taken from the answers to another key's first packet. */
static void no_flood_uses_up_what_another_key_is_answered(void **state)
{
	struct world *w = *state;
	struct sent mine = good(w, 1), guest = mine, stranger = mine;
	struct keyfile nobody;
	int n = 0;

	keyfile_draw(&nobody);
	add_other(w, ROLE_OPERATOR);
	stranger.by = &nobody;
	guest.by = &w->other;
	mine.boot = guest.boot = 0;
	for (int i = 0; i < 500; i++)
		n += is_answered(w, &stranger, false);
	assert_in_range(n, 1, 499);
	assert_true(is_answered(w, &mine, false));
	n = 0;
	for (int i = 0; i < 2 * TRUST_AGAIN_A_S; i++)
		n += is_answered(w, &guest, false);
	assert_int_equal(n, TRUST_AGAIN_A_S);
	assert_true(is_answered(w, &mine, false));
	/* Nor is a signature that does not hold an answer of the key's. */
	for (int i = 0; i < TRUST_AGAIN_A_S; i++)
		assert_false(is_answered(w, &mine, true));
	assert_true(is_answered(w, &mine, false));
}

/* A signature is as dear to look at if it is none. */
static void so_many_signatures_of_strangers_are_computed(void **state)
{
	struct world *w = *state;
	struct sent s = good(w, 1);
	int n = 0;

	s.by = &w->other;
	s.channel = "EDM.other.COMMAND";
	for (int i = 0; i < 500; i++)
		n += send(w, &s) == TRUST_SIGNATURE;
	assert_in_range(n, 1, 200);
	assert_int_equal(send(w, &s), TRUST_KEY);
}

static void what_is_recorded_of_a_viewer_is_not_counted_as_his(void **state)
{
	struct world *w = *state;
	struct sent s = good(w, 1);

	add_other(w, ROLE_VIEWER);
	s.by = &w->other;
	assert_int_equal(send(w, &s), TRUST_FINE);
	for (int i = 0; i < 3 * TRUST_VIEWER_A_S; i++)
		assert_int_equal(send(w, &s), TRUST_REPLAY);
	s.count++;
	assert_int_equal(send(w, &s), TRUST_FINE);
}

static void a_removed_key_is_out_at_once(void **state)
{
	struct world *w = *state;
	struct trust_key row = { .name = "guest", .role = ROLE_VIEWER };
	struct sent s = good(w, 5);

	add_other(w, ROLE_VIEWER);
	memcpy(row.key, w->other.public, sizeof(row.key));
	assert_int_equal(trust_add(&w->t, &row), -EEXIST);
	s.by = &w->other;
	assert_int_equal(send(w, &s), TRUST_FINE);
	assert_int_equal(trust_remove(&w->t, "guest"), 0);
	assert_int_equal(trust_remove(&w->t, "guest"), -ENOENT);
	s.count++;
	assert_int_equal(send(w, &s), TRUST_KEY);
}

/* What is written to stderr while @n packets are refused. */
static void refused_text(struct world *w, int n, char *to, size_t room)
{
	const int before = dup(STDERR_FILENO);
	FILE *f = tmpfile();
	size_t got;

	assert_non_null(f);
	dup2(fileno(f), STDERR_FILENO);
	for (int i = 0; i < n; i++)
		trust_refuse(&w->t, TRUST_REPLAY, "guest", "10.0.0.9:4711",
			     w->now_us);
	dup2(before, STDERR_FILENO);
	close(before);
	rewind(f);
	got = fread(to, 1, room - 1, f);
	to[got] = '\0';
	fclose(f);
}

static void what_is_refused_is_counted_and_told_now_and_then(void **state)
{
	struct world *w = *state;
	char text[512];

	refused_text(w, 1000, text, sizeof(text));
	assert_non_null(strstr(text, "refused 1 packets"));
	assert_non_null(strstr(text, "of guest from 10.0.0.9:4711\n"));
	assert_ptr_equal(strchr(text, '\n'), text + strlen(text) - 1);
	w->now_us += 9 * S;
	refused_text(w, 1, text, sizeof(text));
	assert_string_equal(text, "");
	w->now_us += 2 * S;
	refused_text(w, 1, text, sizeof(text));
	assert_non_null(strstr(text, "refused 1001 packets"));
}

static void no_two_starts_have_one_number(void **state)
{
	struct world *w = *state;
	const int64_t boot = w->t.boot;

	trust_init(&w->t, w->now_us);
	assert_true(w->t.boot > 0);
	assert_true(w->t.boot != boot);
	assert_true(trust_count(&w->t, w->now_us) > 0);
	assert_int_equal(trust_count(&w->t, w->now_us), 2);
}

int main(void)
{
#define T(f)	cmocka_unit_test_setup_teardown(f, setup, teardown)
	const struct CMUnitTest tests[] = {
		T(a_packet_is_taken_once),
		T(what_is_not_ours_is_not_taken),
		T(who_asks_takes_no_room_from_who_acts),
		T(a_crowd_lets_no_replay_through),
		T(a_crowd_of_one_key_locks_no_other_out),
		T(so_much_is_taken_of_a_viewer_and_all_of_an_operator),
		T(no_flood_uses_up_what_another_key_is_answered),
		T(so_many_signatures_of_strangers_are_computed),
		T(what_is_recorded_of_a_viewer_is_not_counted_as_his),
		T(a_removed_key_is_out_at_once),
		T(what_is_refused_is_counted_and_told_now_and_then),
		T(no_two_starts_have_one_number),
	};

	if (sodium_init() < 0)
		return 1;
	return cmocka_run_group_tests_name("trust", tests, NULL, NULL);
}
