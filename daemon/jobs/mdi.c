/* SPDX-License-Identifier: Apache-2.0 */
/* mdi.c - lines that are carried out at once */
#include "mdi.h"

#include "act.h"
#include "compiler.h"
#include "interrupt.h"
#include "offset.h"

#include "plain.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Who types lines does not wait longer than some seconds for their check. */
#define SEGS_MAX	20000u
#define EXECUTED_MAX	20000u
#define WALKED_MAX	5000000u
#define REASON_MAX	1100

/* Lines that are being checked, and who asked for them. */
struct mdi_check {
	struct jobs *jobs;
	struct compiler *compile;
	struct mdi m;			/* what it points at is below */
	char id[64], name[64], text[MDI_TEXT_MAX + 1];
	char by[KEYFILE_NAME_MAX];
	struct asker asker;
	int64_t signed_us;		/* when that one asked last */
	int32_t pos[SHM_NAXES];		/* where they begin */
	bool given_up;
};

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
	if (j->unseen)
		return interrupt_unseen(j);
	if (j->link.snap.state != SHM_IDLE || j->link.snap.unplaced)
		return "the machine is not idle; wait until it stands";
	return NULL;
}

/* Return: an exit code. */
static int judge(struct jobs *j, const struct mdi *m,
		 const struct compiler_result *r, char reason[REASON_MAX])
{
	const char *why = NULL;

	if (r->tech_refusal[0]) {
		snprintf(reason, REASON_MAX, "%s", r->tech_refusal);
		return EX_CONFIG;
	}
	if (r->err == -EINVAL) {
		snprintf(reason, REASON_MAX, "%u:%u: %s; %s", r->diag.line,
			 r->diag.column, r->diag.found, r->diag.wanted);
		return EX_DATAERR;
	}
	if (r->err < 0)
		why = strerror(-r->err);
	else if (!m->measures)
		why = electrode_check(j, r);
	snprintf(reason, REASON_MAX, "%s", why ? why : "");
	return why ? REFUSED : 0;
}

/* Something may have happened while they were checked.  NULL: nothing. */
static const char *changed(struct jobs *j, const struct mdi_check *k)
{
	const char *why = mdi_why_not(j);

	if (why)
		return why;
	if (k->given_up)
		return "a stop or a hold came while it was checked; send it "
		       "again";
	if (memcmp(k->pos, j->link.snap.pos, sizeof(k->pos)) != 0)
		return "the axes moved while it was checked; send it again";
	return jobs_lcm_is_late(k->signed_us) ?
	       "who asked for it did not wait for its check; send it again" :
	       NULL;
}

static int add(struct jobs *j, const struct mdi *m, uint32_t lines)
{
	unsigned char hash[crypto_hash_sha256_BYTES];
	char hex[65], told[128];

	crypto_hash_sha256(hash, (const unsigned char *)m->text,
			   strlen(m->text));
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	/* The job has a transaction of its own. */
	if (act_commit(j))
		return -EIO;
	snprintf(told, sizeof(told), "%s begins at once, says %s", m->name,
		 m->by);
	return jobs_add(j, &(struct store_new) {
		.id = m->id, .name = m->name, .sha256 = hex, .tech_sha256 = "",
		.text = m->text, .bytes = strlen(m->text), .lines = lines,
		.now_us = jobs_utime(), .measures = m->measures, .told = told,
	});
}

static void begin(struct jobs *j, const struct jobs_lcm_command *c,
		  const struct mdi *m, uint32_t lines)
{
	if (add(j, m, lines) < 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	queue_go(j);
	queue_recount(j);
	verbs_answer(j, c, 0, m->id);
}

static void refuse(struct jobs *j, const struct jobs_lcm_command *c,
		   const char *why)
{
	char reason[REASON_MAX];

	snprintf(reason, sizeof(reason), "not now: %s", why);
	verbs_answer(j, c, REFUSED, reason);
}

static void on_checked(void *arg, struct compiler_result *r)
{
	struct mdi_check *k = arg;
	struct jobs *j = k->jobs;
	const struct jobs_lcm_command c = reply_asker_command(&k->asker);
	char reason[REASON_MAX];
	const int code = judge(j, &k->m, r, reason);

	j->mdi = NULL;
	if (code)
		verbs_answer(j, &c, code, reason);
	else if (changed(j, k))
		refuse(j, &c, changed(j, k));
	else
		begin(j, &c, &k->m, r->lines);
	free(k);
}

/* The texts of @m may be gone when the check is over. */
static struct mdi_check *check_new(struct jobs *j,
				   const struct jobs_lcm_command *c,
				   const struct mdi *m)
{
	struct mdi_check *k = calloc(1, sizeof(*k));

	if (!k)
		return NULL;
	k->jobs = j;
	k->m = *m;
	snprintf(k->id, sizeof(k->id), "%s", m->id);
	snprintf(k->name, sizeof(k->name), "%s", m->name);
	snprintf(k->text, sizeof(k->text), "%s", m->text);
	k->m.id = k->id;
	k->m.name = k->name;
	k->m.text = k->text;
	snprintf(k->by, sizeof(k->by), "%s", c->by ? c->by->name : "");
	k->m.by = k->by;
	reply_asker_keep(&k->asker, c);
	k->signed_us = c->signed_us;
	memcpy(k->pos, j->link.snap.pos, sizeof(k->pos));
	return k;
}

/* A few lines can ask for a second of work, so the loop does not do it. */
static int check(struct jobs *j, struct mdi_check *k)
{
	static struct compiler_request request;
	int err;

	request = (struct compiler_request) {
		.config = j->config, .name = "mdi", .dialect = k->m.dialect,
		.text = k->text, .bytes = strlen(k->text),
		.segs_max = SEGS_MAX, .executed_max = EXECUTED_MAX,
		.walked_max = WALKED_MAX,
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		request.start_mm[i] = k->pos[i] * j->link.snap.pulse_mm[i];
	electrode_request(j, NULL, 0, &request);
	err = offset_request(j, NULL, &request);
	return err < 0 ? err : compiler_start(&k->compile, j->event, &request,
					      on_checked, k);
}

void mdi_run(struct jobs *j, const struct jobs_lcm_command *c,
	     const struct mdi *m)
{
	const char *why = mdi_why_not(j);
	struct mdi_check *k;
	struct store_job job;

	/* Its answer did not reach the sender. */
	if (store_find(j->store, m->id, &job) == 0) {
		verbs_answer(j, c, 0, m->id);
		return;
	}
	if (j->mdi && j->mdi->asker.act == c->act)
		return;
	if (why || j->mdi) {
		refuse(j, c, why ? why : "other lines are being checked; send "
					 "it again when they are done");
		return;
	}
	k = check_new(j, c, m);
	if (!k || check(j, k) < 0) {
		free(k);
		verbs_answer(j, c, EX_IOERR, "it cannot be checked: no memory, "
			     "or the store failed");
		return;
	}
	j->mdi = k;
}

void mdi_heard(struct jobs *j, const struct jobs_lcm_command *c)
{
	if (j->mdi && reply_asker_is(&j->mdi->asker, c))
		j->mdi->signed_us = c->signed_us;
}

void mdi_give_up(struct jobs *j)
{
	if (j->mdi)
		j->mdi->given_up = true;
}

void mdi_fini(struct jobs *j)
{
	if (j->mdi)
		free(compiler_destroy(j->mdi->compile));
	j->mdi = NULL;
}

void mdi_take(struct jobs *j, const struct verb *v,
	      const struct jobs_lcm_command *c)
{
	struct mdi m = { .text = c->text };
	char id[64], name[64];

	(void)v;
	if (strlen(c->text) > MDI_TEXT_MAX) {
		verbs_answer(j, c, EX_DATAERR, "the text is too long; 4000 "
			     "bytes at most; submit takes a longer one");
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
