/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.c - a command that does something is done once, whoever dies when
 */
#include "act.h"

#include "jobs_log.h"
#include "store_trust.h"
#include "verb.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>
#include <sysexits.h>

static uint64_t act_id(const struct jobs_lcm_command *c)
{
	crypto_generichash_state h;
	unsigned char out[crypto_generichash_BYTES_MIN];
	uint64_t id;

	crypto_generichash_init(&h, NULL, 0, sizeof(out));
	crypto_generichash_update(&h, c->key, SEAL_KEY_BYTES);
	crypto_generichash_update(&h, (const unsigned char *)&c->seq,
				  sizeof(c->seq));
	crypto_generichash_update(&h, (const unsigned char *)c->client,
				  strlen(c->client));
	crypto_generichash_final(&h, out, sizeof(out));
	memcpy(&id, out, sizeof(id));
	/* As SQLite keeps it; 0 is no id. */
	id &= INT64_MAX;
	return id ? id : 1;
}

void act_commit(struct jobs *j)
{
	if (j->act_open)
		store_commit(j->store);
	j->act_open = false;
}

void act_answered(struct jobs *j, uint64_t id, int code, const char *reason)
{
	store_act_end(j->store, id, code, reason);
	act_commit(j);
}

static void act_begin(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	const struct store_act a = {
		.id = c->act, .instance = j->link.instance,
		.born = j->link.status ? j->link.status->born : 0,
		.verb = v->name, .by = c->by->name, .now_us = jobs_utime(),
	};
	/* What edmd does is gone with the host's power; the rest is not. */
	int err = store_together(j->store, v->machine == VERB_OWN);

	j->act_open = err == 0;
	if (err == 0)
		err = store_act_begin(j->store, &a);
	if (err == 0 || v->kind == VERB_ENDS) {
		v->run(j, v, c);
	} else {
		verbs_answer(j, c, EX_IOERR, "the store failed, so it was not "
			     "done; see the journal of edmd-jobs; stop, hold "
			     "and estop work");
	}
	act_commit(j);
}

/* Handed over by a service before this one, and not answered then. */
static void act_settle(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c,
		       const struct store_act *a)
{
	const struct shm_status *s = j->link.status;
	struct shm_done d;

	if (j->link.state != LINK_OK || !s) {
		reply_forget(&j->replies, c);
		jobs_answer(j, &(struct jobs_lcm_ack) {
			.key = c->key, .client = c->client, .seq = c->seq,
			.code = EX_TEMPFAIL, .reason = "it was handed to edmd, "
			"which is not there now; what became of it is told "
			"when edmd is back" });
	} else if (shm_done(s, c->act, &d)) {
		if (d.code != SHM_TAKEN)
			verbs_settle(j, v, c, d.code);
		else if (d.instance == j->link.instance)
			verbs_await(j, v, c);
		else
			verbs_settle(j, v, c, SHM_CUT_SHORT);
	} else if (a->instance == j->link.instance) {
		/* Not taken: if it is on its way, edmd takes one of them. */
		v->run(j, v, c);
	} else if (a->born == s->born) {
		verbs_settle(j, v, c, -ENOTCONN);
	} else {
		verbs_answer(j, c, EX_UNAVAILABLE, "the edmd that had it ended "
			     "in order, and its record with it: whether it was "
			     "done is not known; look at the machine");
	}
}

void act_take(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c)
{
	struct jobs_lcm_command own = *c;
	struct store_act a;

	own.act = act_id(c);
	if (store_act_find(j->store, own.act, &a) < 0)
		act_begin(j, v, &own);
	else if (a.answered)
		jobs_answer(j, &(struct jobs_lcm_ack) {
			.key = c->key, .client = c->client, .seq = c->seq,
			.code = a.code, .reason = a.reason,
		});
	else
		act_settle(j, v, &own, &a);
}
