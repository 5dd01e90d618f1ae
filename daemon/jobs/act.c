/* SPDX-License-Identifier: Apache-2.0 */
/*
 * act.c - a command that changes something is carried out once, whichever
 * program dies
 */
#include "act.h"

#include "jobs_log.h"
#include "store_trust.h"
#include "verb.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

int act_commit(struct jobs *j)
{
	const int err = j->act_open ? store_commit(j->store) : 0;

	j->act_open = false;
	return err;
}

int act_answered(struct jobs *j, uint64_t id, int code, const char *reason)
{
	store_act_end(j->store, id, code, reason);
	return act_commit(j);
}

/* What edmd does is lost with the host's power, everything else is not.  The
 * promise that a job may begin is not lost either. */
static bool is_durable(const struct verb *v)
{
	return v->machine == VERB_OWN || v->machine == SHM_DO_START ||
	       v->machine == SHM_DO_RESUME;
}

/* edmd remembers the commands that it was given.  What this service does by
 * itself would be forgotten without a store, and what is done all the same
 * (VERB_ENDS) says so itself. */
static bool refuse_degraded(struct jobs *j, const struct verb *v,
			    const struct jobs_lcm_command *c)
{
	char reason[240];

	if (v->machine != VERB_OWN || v->kind == VERB_ENDS ||
	    !*store_why(j->store))
		return false;
	snprintf(reason, sizeof(reason), "the store is degraded: %s; make room "
		 "or mend it, then again; stop, hold and estop work",
		 store_why(j->store));
	verbs_answer(j, c, EX_IOERR, reason);
	return true;
}

static void act_begin(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	const struct store_act a = {
		.id = c->act, .instance = j->link.instance,
		.born = j->link.status ? j->link.status->born : 0,
		.verb = v->name, .by = c->by->name, .now_us = jobs_utime(),
	};
	j->act_open = store_together(j->store, is_durable(v)) == 0;
	store_act_begin(j->store, &a);
	if (!refuse_degraded(j, v, c))
		v->run(j, v, c);
	act_commit(j);
}

/* A service before this one handed the command over and did not live to answer
 * it. */
static void act_settle(struct jobs *j, const struct verb *v,
		       const struct jobs_lcm_command *c,
		       const struct store_act *a)
{
	const struct shm_status *s = j->link.status;
	struct shm_done d;

	if (v->machine == VERB_OWN) {
		/* It was not handed over, nor done. */
		v->run(j, v, c);
	} else if (j->link.state != LINK_OK || !s) {
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
		/* edmd has not taken it.  If it is still on its way, edmd takes
		 * only one of the two. */
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

	own.act = seal_act_id(c->key, c->client, c->seq);
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
