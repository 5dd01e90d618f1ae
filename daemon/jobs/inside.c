/* SPDX-License-Identifier: Apache-2.0 */
/* inside.c - an interrupted job goes on */
#include "inside.h"
#include "entry.h"
#include "files.h"
#include "interrupt.h"
#include "jobs_log.h"

#include "interp/axis.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define HASH_HEX	32		/* digits */

/* -- In the store ---------------------------------------------------------- */

/* What is kept is HASH;HEX;NUMBERS.  HEX is a struct, or nothing.  So the hash
 * is of the version too: a struct of another layout would be another place. */
static void hash_of(const char *body, char ret[HASH_HEX + 1])
{
	const uint32_t version = CHECKPOINT_VERSION;
	crypto_generichash_state state;
	uint8_t hash[HASH_HEX / 2];

	crypto_generichash_init(&state, NULL, 0, sizeof(hash));
	crypto_generichash_update(&state, (const uint8_t *)&version,
				  sizeof(version));
	crypto_generichash_update(&state, (const uint8_t *)body, strlen(body));
	crypto_generichash_final(&state, hash, sizeof(hash));
	sodium_bin2hex(ret, HASH_HEX + 1, hash, sizeof(hash));
}

/* @at: HASH_HEX + 1 bytes of room, then the body. */
static void seal(char *at)
{
	char hash[HASH_HEX + 1];

	hash_of(at + HASH_HEX + 1, hash);
	memcpy(at, hash, HASH_HEX);
	at[HASH_HEX] = ';';
}

static bool is_whole(const char *at)
{
	char hash[HASH_HEX + 1];

	if (strlen(at) <= HASH_HEX || at[HASH_HEX] != ';')
		return false;
	hash_of(at + HASH_HEX + 1, hash);
	return memcmp(at, hash, HASH_HEX) == 0;
}

static int take(const char *body, struct inside *ret)
{
	const char *rest = NULL;
	size_t bytes = 0;

	if (sodium_hex2bin((uint8_t *)&ret->base, sizeof(ret->base), body,
			   strlen(body), NULL, &bytes, &rest) < 0 ||
	    sscanf(rest, ";%lf;%lf;%u;%u;%u;%lf", &ret->from_mm, &ret->way_mm,
		   &ret->instance, &ret->run, &ret->line, &ret->place_mm) != 6)
		return -EBADMSG;
	return bytes == sizeof(ret->base) || inside_is_named(ret) ?
	       0 : -EBADMSG;
}

int inside_read(struct jobs *j, uint32_t n, struct inside *ret)
{
	char *at = store_resume_at(j->store, n);
	int err = -EBADMSG;

	memset(ret, 0, sizeof(*ret));
	if (!at)
		return -ENOENT;
	if (is_whole(at))
		err = take(at + HASH_HEX + 1, ret);
	if (err < 0)
		memset(ret, 0, sizeof(*ret));
	free(at);
	return err;
}

bool inside_is_named(const struct inside *a)
{
	return a->line > 0 || a->place_mm > 0;
}

const char *inside_named(uint32_t line, double place_mm)
{
	static char at[HASH_HEX + 80];

	if (line == 0 && place_mm == 0)
		return NULL;
	snprintf(at + HASH_HEX + 1, sizeof(at) - HASH_HEX - 1,
		 ";0;0;0;0;%u;%.17g", line, place_mm);
	seal(at);
	return at;
}

int inside_write(struct jobs *j, uint32_t n, const struct inside *a)
{
	const size_t hex = 2 * sizeof(a->base) + 1, room = hex + 140;
	char *at = malloc(HASH_HEX + 1 + room), *body = at + HASH_HEX + 1;
	int err;

	if (!at)
		return -ENOMEM;
	sodium_bin2hex(body, hex, (const uint8_t *)&a->base, sizeof(a->base));
	snprintf(body + hex - 1, room - hex + 1, ";%.17g;%.17g;%u;%u;%u;%.17g",
		 a->from_mm, a->way_mm, a->instance, a->run, a->line,
		 a->place_mm);
	seal(at);
	err = store_interrupt(j->store, n, at);
	free(at);
	return err;
}

void inside_whole(const struct inside *a, struct shm_snapshot *s)
{
	const struct shm_snapshot *before = &a->base.snap;

	/* On the way in nothing is cut. */
	s->far_mm = fmax(before->far_mm, s->far_mm - a->way_mm + a->from_mm);
	s->place_mm = fmax(a->from_mm, s->place_mm - a->way_mm + a->from_mm);
	s->length_mm = before->length_mm;
	s->job_cycles += before->job_cycles;
	s->erode_cycles += before->erode_cycles;
	s->jump_cycles += before->jump_cycles;
	s->jumps += before->jumps;
	s->retracts += before->retracts;
	s->shorts += before->shorts;
	s->arcs += before->arcs;
	s->energy_j += before->energy_j;
}

/* What was set before the first interruption, unless it was set again. */
static void keep_sets(const struct shm_sets *before, struct shm_sets *s)
{
	for (uint64_t i = 0; i < before->n && s->n < SHM_SETS_MAX; i++) {
		const struct shm_set *b = &before->set[i];
		bool again = false;

		for (uint64_t k = 0; k < s->n; k++)
			again = again || (s->set[k].cond == b->cond &&
					  s->set[k].field == b->field);
		if (!again)
			s->set[s->n++] = *b;
	}
}

void inside_interrupted(struct jobs *j, uint32_t n,
			const struct checkpoint_base *last, struct inside *ret)
{
	static struct inside before;

	*ret = (struct inside) { .base = *last };
	if (inside_read(j, n, &before) < 0)
		return;
	/* It would have been told again at the end of the positioning. */
	if (!last->snap.mcode && last->snap.far_mm <= before.way_mm)
		ret->base.snap.mcode = before.base.snap.mcode;
	inside_whole(&before, &ret->base.snap);
	keep_sets(&before.base.sets, &ret->base.sets);
	if (!inside_is_named(&before))
		memcpy(ret->base.job.start, before.base.job.start,
		       sizeof(ret->base.job.start));
}

#define UNREADABLE	"its checkpoint is damaged or of another version of " \
			"edmd-jobs; remove it, and submit it again with " \
			"--from-place; edmctl show JOB says where it was"

/* -- The verb -------------------------------------------------------------- */

/* The axes that @text names.  Axes that the machine does not have do not
 * count. */
static uint32_t axes_named(const char *text)
{
	uint32_t axes = 0;

	for (; *text; text++) {
		const char *at = strchr(INTERP_AXIS_LETTERS, *text);

		if (at)
			axes |= 1u << (at - INTERP_AXIS_LETTERS);
	}
	return axes;
}

/* Why the axes are not good enough; "": they are.  An axis that can be homed
 * has to be. */
static void say_axes(struct jobs *j, const char *vouched, char reason[320])
{
	const uint32_t now = axes_named(vouched);
	const char *told = interrupt_told(j, now);
	char home[INTERP_NAXES + 1] = "", say[INTERP_NAXES + 1] = "";
	size_t nhome = 0, nsay = 0;

	for (const char *at = interrupt_lost(j); *at; at++) {
		const uint32_t axis = (uint32_t)(strchr(INTERP_AXIS_LETTERS,
							*at) -
						 INTERP_AXIS_LETTERS);

		if (j->link.snap.unhomed >> axis & 1)
			home[nhome++] = *at;
		else if (!(now >> axis & 1))
			say[nsay++] = *at;
	}
	reason[0] = '\0';
	if (nhome)
		snprintf(reason, 320, "the places of %s are not known; home "
			 "them, then resume", home);
	else if (nsay)
		snprintf(reason, 320, "the places of %s are not certain since "
			 "the power failed; see that the machine stands where "
			 "it shows, then name these axes: resume JOB %s", say,
			 say);
	else if (told)
		snprintf(reason, 320, "%s", told);
}

static bool are_same_files(const struct jobs *j, const struct inside *a)
{
	uint8_t now[32];

	files_hash(j, now);
	return memcmp(a->base.job.config, now, sizeof(now)) == 0;
}

/* It may have come here from another store. */
static bool is_of_job(const struct inside *a, const struct store_job *job)
{
	char hex[65];

	sodium_bin2hex(hex, sizeof(hex), a->base.job.sha256,
		       sizeof(a->base.job.sha256));
	return a->base.job.n == job->n && strcmp(hex, job->sha256) == 0;
}

static void why_not(struct jobs *j, const struct jobs_lcm_command *c,
		    const struct store_job *job, const struct inside *a,
		    char reason[320])
{
	const char *now = NULL;

	if (job->state != JOB_INTERRUPTED)
		now = "this job was not interrupted; without a job, resume "
		      "goes on after a hold";
	else if (j->link.state != LINK_OK)
		now = "edmd is not there";
	else if (queue_is_faulted(j))
		now = "a fault is latched; reset first";
	else if (j->link.snap.state != SHM_IDLE)
		now = "the machine is not idle; wait, or stop what it does";
	else if (*store_why(j->store))
		now = store_why(j->store);
	else if (!is_of_job(a, job))
		now = UNREADABLE;
	else if (!are_same_files(j, a))
		now = "the machine file, or a map or a dialect that it names, "
		      "is another than when the job began; put that one "
		      "back, and restart the services";
	if (now)
		snprintf(reason, 320, "%s", now);
	else
		say_axes(j, c->text, reason);
}

void inside_resume(struct jobs *j, const struct jobs_lcm_command *c,
		   const struct store_job *job)
{
	char reason[320];
	struct inside a;
	int err;

	inside_read(j, job->n, &a);
	why_not(j, c, job, &a, reason);
	if (reason[0]) {
		verbs_answer(j, c, REFUSED, reason);
		return;
	}
	a.instance = j->link.instance;
	a.from_mm = a.way_mm = 0;
	/* Places of the checkpoint before are not those of the new program. */
	a.run = randombytes_random() | 1;
	err = inside_write(j, job->n, &a);
	if (err == 0)
		err = store_again(j->store, job->n);
	if (err != 0) {
		verbs_answer(j, c, EX_IOERR, "the store failed");
		return;
	}
	store_set_number(j->store, "selected", job->n);
	interrupt_answered(j);
	interrupt_init(j);
	queue_recount(j);
	verbs_answer(j, c, 0, "it is read again; an event says which way it "
		     "will go in; then it waits for start");
}

/* -- Loading --------------------------------------------------------------- */

void inside_refuse(struct jobs *j, const struct store_job *job, const char *why)
{
	store_set_state(j->store, job->n, JOB_INTERRUPTED);
	interrupt_init(j);
	queue_recount(j);
	jobs_note(j, &(struct jobs_note) {
		.kind = "interrupted", .job = job->id,
	}, "job %s cannot go on: %s", job->name, why);
}

static struct interp_probed probed_by(const struct shm_snapshot *s)
{
	struct interp_probed p = {
		.once = s->found_once, .twice = s->found_twice,
	};

	memcpy(p.shift, s->shift, sizeof(p.shift));
	memcpy(p.found, s->found, sizeof(p.found));
	return p;
}

static struct interp_depth depth_by(const struct shm_snapshot *s)
{
	struct interp_depth d = {
		.far_mm = s->depth_far_mm, .counts = s->depth_counts,
	};

	memcpy(d.way, s->depth_way, sizeof(d.way));
	memcpy(d.from, s->depth_from, sizeof(d.from));
	return d;
}

int inside_check(struct jobs *j, const struct store_job *job)
{
	static struct inside a;
	const int err = inside_read(j, job->n, &a);

	if (err == -ENOENT)
		return 0;
	if (err == 0 && (inside_is_named(&a) || a.instance == j->link.instance))
		return 0;
	inside_refuse(j, job, err < 0 ? UNREADABLE :
		      "edmd was started anew since it was resumed, so its axes "
		      "have to be looked at again");
	return -ESTALE;
}

int inside_request(struct jobs *j, const struct store_job *job,
		   struct compiler_request *ret)
{
	const struct shm_snapshot *s = &j->link.snap;
	static struct inside a;
	const int err = inside_read(j, job->n, &a);

	if (err < 0)
		return err == -ENOENT ? 0 : err;
	inside_begin_at(j, a.line, a.place_mm, ret);
	if (inside_is_named(&a))
		return 0;
	ret->sets = a.base.sets;
	ret->from.far_mm = a.base.snap.far_mm;
	ret->from.probed = probed_by(&a.base.snap);
	ret->from.depth = depth_by(&a.base.snap);
	ret->from.probed_known = true;
	ret->from.unanswered = a.base.snap.mcode;
	for (int i = 0; i < INTERP_NAXES; i++)
		ret->start_mm[i] = a.base.job.start[i] * s->pulse_mm[i];
	return 0;
}

void inside_begin_at(const struct jobs *j, uint32_t line, double place_mm,
		     struct compiler_request *ret)
{
	ret->goes_on = true;
	ret->from.line = line;
	ret->from.far_mm = place_mm;
	ret->from.up = config_way_out(j->config);
	memcpy(ret->from.now_mm, ret->start_mm, sizeof(ret->from.now_mm));
}

static bool is_same_table(const struct inside *a, const char *sha256)
{
	uint8_t tech[sizeof(a->base.job.tech)] = { 0 };

	sodium_hex2bin(tech, sizeof(tech), sha256, strlen(sha256), NULL, NULL,
		       NULL);
	return memcmp(tech, a->base.job.tech, sizeof(tech)) == 0;
}

const char *inside_loaded(struct jobs *j, const struct compiler_result *r)
{
	const struct store_job *job = &j->queue.job;
	char way[480];
	static struct inside a;

	j->queue.run = 0;
	files_hash(j, j->config_hash);
	if (inside_read(j, job->n, &a) < 0)
		return NULL;
	j->queue.run = a.run;
	if (inside_is_named(&a)) {
		a.base.snap.far_mm = r->entry.far_mm;
		a.base.snap.length_mm = r->entry.length_mm;
	} else if (!is_same_table(&a, r->tech_sha256)) {
		return "the technology table is another than when the job "
		       "began; put that one back, and resume again";
	}
	a.from_mm = r->entry.from_mm;
	a.way_mm = r->entry.way_mm;
	if (inside_write(j, job->n, &a) != 0)
		return "where it goes on cannot be stored";
	config_entry_words(j->config, &r->entry, way, sizeof(way));
	jobs_note(j, &(struct jobs_note) {
		.kind = "waits", .job = job->id,
	}, "job %s: start %s", job->name, way);
	return NULL;
}
