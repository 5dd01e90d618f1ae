/* SPDX-License-Identifier: Apache-2.0 */
/* mdi.c - lines that are carried out at once */
#include "mdi.h"

#include "act.h"
#include "compiler.h"
#include "offset.h"

#include "plain.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

/* The event loop waits for the check. */
#define SEGS_MAX	20000u
#define EXECUTED_MAX	20000u
#define WALKED_MAX	5000000u

const char *mdi_why_not(const struct jobs *j)
{
	const char *why = queue_unready(j);

	if (why)
		return why;
	if (*store_why(j->store))
		return "the store cannot write; edmctl doctor says why";
	if (j->queue.job.n && !queue_is_leaving(&j->queue))
		return "a job is loaded; edmctl stop or edmctl remove takes it "
		       "away";
	if (j->queue.behind > 0 || j->queue.compile)
		return "jobs wait in the queue; edmctl remove takes them out";
	if (j->link.snap.state != SHM_IDLE || j->link.snap.unplaced)
		return "the machine is not idle; wait until it stands";
	return NULL;
}

/* It is small, so it is checked at once.  Return: an exit code. */
static int check(struct jobs *j, const struct mdi *m, char *reason, size_t size,
		 uint32_t *ret_lines)
{
	static struct compiler_request request;
	struct compiler_result r;
	const char *why;
	int code = 0;

	request = (struct compiler_request) {
		.config = j->config, .name = "mdi", .dialect = m->dialect,
		.text = m->text, .bytes = strlen(m->text),
		.segs_max = SEGS_MAX, .executed_max = EXECUTED_MAX,
		.walked_max = WALKED_MAX,
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		request.start_mm[i] = j->link.snap.pos[i] *
				      j->link.snap.pulse_mm[i];
	electrode_request(j, NULL, 0, &request);
	if (offset_request(j, NULL, &request) < 0) {
		snprintf(reason, size, "the store failed");
		return EX_IOERR;
	}
	compiler_now(&request, &r);
	*ret_lines = r.lines;
	if (r.tech_refusal[0])
		code = EX_CONFIG;
	if (r.tech_refusal[0])
		snprintf(reason, size, "%.600s", r.tech_refusal);
	else if (r.err == -EINVAL)
		snprintf(reason, size, "%u:%u: %s; %s", r.diag.line,
			 r.diag.column, r.diag.found, r.diag.wanted);
	else if (r.err < 0)
		snprintf(reason, size, "%s", strerror(-r.err));
	else if ((why = m->measures ? NULL : electrode_check(j, &r)))
		snprintf(reason, size, "%s", why);
	else
		*reason = '\0';
	if (!code && *reason)
		code = r.err == -EINVAL ? EX_DATAERR : REFUSED;
	compiler_forget(&r);
	return code;
}

static int add(struct jobs *j, const struct mdi *m, uint32_t lines)
{
	unsigned char hash[crypto_hash_sha256_BYTES];
	char hex[65];
	uint32_t n;

	crypto_hash_sha256(hash, (const unsigned char *)m->text,
			   strlen(m->text));
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	/* The job has a transaction of its own. */
	if (act_commit(j))
		return -EIO;
	return store_add(j->store, &(struct store_new) {
		.id = m->id, .name = m->name, .sha256 = hex, .tech_sha256 = "",
		.text = m->text, .bytes = strlen(m->text), .lines = lines,
		.now_us = jobs_utime(), .measures = m->measures,
	}, &n);
}

void mdi_run(struct jobs *j, const struct jobs_lcm_command *c,
	     const struct mdi *m)
{
	const char *why = mdi_why_not(j);
	struct store_job job;
	char reason[1000];
	uint32_t lines = 0;
	int code;

	/* Its answer did not reach the sender. */
	if (store_find(j->store, m->id, &job) == 0) {
		verbs_answer(j, c, 0, m->id);
		return;
	}
	if (why) {
		snprintf(reason, sizeof(reason), "not now: %s", why);
		verbs_answer(j, c, REFUSED, reason);
		return;
	}
	code = check(j, m, reason, sizeof(reason), &lines);
	if (code) {
		verbs_answer(j, c, code, reason);
		return;
	}
	if (add(j, m, lines) < 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	queue_go(j);
	queue_recount(j);
	jobs_note(j, &(struct jobs_note) { .kind = "queued", .job = m->id },
		  "%s begins at once", m->name);
	verbs_answer(j, c, 0, m->id);
}

void mdi_take(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c)
{
	struct mdi m = { .text = c->text };
	char id[64], name[64];

	(void)v;
	if (strlen(c->text) > MDI_TEXT_MAX) {
		verbs_answer(j, c, EX_DATAERR, "too long a text; 4000 bytes at "
			     "most; submit takes a longer one");
		return;
	}
	snprintf(id, sizeof(id), "mdi-%llx", (unsigned long long)c->act);
	snprintf(name, sizeof(name), "mdi: %.56s", c->text);
	name[5 + strcspn(name + 5, "\r\n")] = '\0';
	plain_copy(name, sizeof(name), name);
	m.id = id;
	m.name = name;
	mdi_run(j, c, &m);
}
