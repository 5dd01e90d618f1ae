/* SPDX-License-Identifier: Apache-2.0 */
/* early.c - compiles an interrupted job before it is resumed */
#include "early.h"

#include "jobs.h"
#include "jobs_log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define LOOK_US		500000		/* as long the axes stand before */

static void forget(struct jobs *j)
{
	struct early *a = &j->early;

	if (a->tried)
		shm_program_remove(j->machine, SHM_PROGRAM_AHEAD);
	if (a->made)
		compiler_forget(a->made);
	free(a->made);
	a->made = NULL;
	a->tried = false;
	a->job = (struct store_job) { .n = 0 };
}

/* All of its bytes were set, so they can be compared.  The names are at
 * different places. */
static bool is_same(const struct early *a, const struct store_job *job,
		    const struct compiler_request *request)
{
	struct compiler_request r;

	memcpy(&r, request, sizeof(r));
	r.name = a->request.name;
	return a->job.n == job->n && strcmp(a->job.name, job->name) == 0 &&
	       memcmp(&a->request, &r, sizeof(r)) == 0;
}

/* edmd copies it now, and not when it is loaded.  If it does not, it copies it
 * then, as any other. */
static void copy_ahead(struct jobs *j, int block)
{
	const struct link_command c = {
		.verb = SHM_AHEAD, .arg = SHM_PROGRAM_AHEAD,
	};

	if (shm_program_name(block, j->machine, SHM_PROGRAM_AHEAD) == 0)
		link_send(&j->link, &c, jobs_now_us());
}

static void on_made(void *arg, struct compiler_result *r)
{
	struct jobs *j = arg;
	struct early *a = &j->early;

	a->compile = NULL;
	/* Why it cannot be compiled is told when it is resumed. */
	if (r->err == 0)
		a->made = malloc(sizeof(*a->made));
	log_info("early: job %s is %scompiled before it is resumed", a->job.id,
		 a->made ? "" : "not ");
	if (!a->made)
		return;
	*a->made = *r;
	compiler_take_out(r);
	copy_ahead(j, a->made->block);
}

/* It is compiled at the first look, and after that when two looks have seen the
 * same: who jogs to a place in steps is not followed. */
static void look(struct jobs *j)
{
	struct early *a = &j->early;
	struct compiler_request r;
	struct store_job job;
	bool stands = true;

	if (store_interrupted(j->store, &job) < 0 ||
	    load_request(j, &job, &r) < 0 || !*r.text_file) {
		forget(j);
		return;
	}
	if (!is_same(a, &job, &r)) {
		forget(j);
		a->job = job;
		memcpy(&a->request, &r, sizeof(r));
		a->request.name = a->job.name;
		stands = a->looked != job.n;
		a->looked = job.n;
	}
	if (stands && !a->tried) {
		a->tried = true;
		compiler_start(&a->compile, j->event, &a->request, on_made, j);
	}
}

/* What is made before an axis is homed no resume would take. */
static bool is_worth_it(const struct jobs *j)
{
	return j->link.snap.state == SHM_IDLE &&
	       !(j->link.snap.unhomed & j->config->axes.present);
}

void early_step(struct jobs *j, int64_t now_us)
{
	struct early *a = &j->early;

	if (a->compile || now_us < a->look_us)
		return;
	if (*j->interrupted && is_worth_it(j)) {
		a->look_us = now_us + LOOK_US;
		look(j);
	} else if (!*j->interrupted && (j->queue.job.n || !j->queue.behind)) {
		forget(j);
	}
}

int early_take(struct jobs *j, const struct store_job *job,
	       struct compiler_request *request)
{
	struct early *a = &j->early;
	const bool same = is_same(a, job, request);

	if (a->compile)
		return same ? -EAGAIN : 0;
	if (same) {
		request->made = a->made;
		a->made = NULL;
		/* A file that has lost its last name gets no other. */
		a->tried = false;
	}
	forget(j);
	return 0;
}

void early_fini(struct jobs *j)
{
	compiler_destroy(j->early.compile);
	j->early.compile = NULL;
	forget(j);
}
