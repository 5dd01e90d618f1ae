/* SPDX-License-Identifier: Apache-2.0 */
/* begun.c - motions that clients asked for, and how they ended */
#include "begun.h"

#include "faults.h"
#include "verb.h"

#include <string.h>

bool begun_is(const struct verb *v)
{
	switch (v->machine) {
	case SHM_DO_START:
	case SHM_DO_RESUME:
	case SHM_DO_RETRACT:
	case SHM_DO_STEP:
	case SHM_DO_JOG:
	case SHM_DO_HOME:
		return true;
	default:
		return false;
	}
}

void begun_keep(struct jobs *j, const struct asker *by)
{
	j->begun = (struct begun) {
		.by = *by, .before = j->link.snap.moved_by,
	};
}

/* The snapshot may be older than the answer to the command. */
static const char *how(const struct jobs *j, const struct jobs_lcm_command *c)
{
	static const char *const words[] = {
		[SHM_MOVED_NOT] = "unknown", [SHM_MOVED_GOES_ON] = "goes on",
		[SHM_MOVED_THERE] = "there", [SHM_MOVED_SHORT] = "short",
		[SHM_MOVED_FAULT] = "fault",
	};
	const struct shm_snapshot *s = &j->link.snap;
	const struct begun *b = &j->begun;

	if (j->link.state != LINK_OK || strcmp(b->by.client, c->client) != 0 ||
	    memcmp(b->by.key, c->key, sizeof(b->by.key)) != 0)
		return "unknown";
	if (s->moved_by == b->by.act)
		return s->moved <= SHM_MOVED_FAULT ? words[s->moved] :
		       "unknown";
	return s->moved_by == b->before ? "goes on" : "unknown";
}

void begun_tell(struct jobs *j, const struct verb *v,
		const struct jobs_lcm_command *c)
{
	const uint32_t fault = j->link.snap.fault;

	(void)v;
	verbs_answer_json(j, c, json_pack("{s:s,s:s}", "moved", how(j, c),
		"fault", fault ? fault_name(fault) : ""));
}
