/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_store.c - verbs for who looks after the machine: the database, the last
 * checkpoint
 */
#include "jobs.h"
#include "values.h"
#include "verb.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

/* The name of a folder may be anything. */
static json_t *path_put(const char *path)
{
	json_t *o = json_string(path);

	return o ? o : json_string("?");
}

void verbs_store(struct jobs *j, const struct verb *v,
		 const struct jobs_lcm_command *c)
{
	struct checkpoint_stats place = { .err = -ENOENT };
	struct store_size size;

	(void)v;
	if (j->checkpoint)
		checkpoint_stats(j->checkpoint, &place);
	store_measure(j->store, &size);
	verbs_answer_json(j, c, json_pack(
		"{s:o,s:I,s:I,s:I,s:I,s:s,s:I,s:I,s:I,s:s,s:o,s:i,s:s}",
		"path", path_put(size.path), "bytes", (json_int_t)size.bytes,
		"jobs", (json_int_t)size.jobs, "kept", (json_int_t)size.kept,
		"dropped", (json_int_t)size.dropped,
		"why", store_why(j->store),
		"place_writes", (json_int_t)place.writes,
		"place_bytes", (json_int_t)place.bytes,
		"place_slowest_us", (json_int_t)place.slowest_us,
		"place_why", place.err ? strerror(-place.err) : "",
		"machine_file", path_put(j->config_path),
		"pid", (int)getpid(), "version", EDM_VERSION));
}

/* -- The values in force --------------------------------------------------- */

#define VALUES_BYTES_MAX	(64 << 20)

/* A larger program would hold up the service while it is copied. */
static bool is_large(const struct jobs *j)
{
	char path[SHM_PATH_MAX], name[32];
	struct stat st;

	snprintf(name, sizeof(name), "program.%u", j->link.snap.program);
	shm_path(path, j->machine, name);
	return j->link.snap.loaded && stat(path, &st) == 0 &&
	       st.st_size > VALUES_BYTES_MAX;
}

void verbs_values(struct jobs *j, const struct verb *v,
		  const struct jobs_lcm_command *c)
{
	static const struct shm_snapshot none;
	const bool there = j->link.state == LINK_OK;
	json_t *o;

	(void)v;
	if (there && is_large(j)) {
		verbs_answer(j, c, EX_UNAVAILABLE, "the program is larger than "
			     "64 MiB; its values are not read");
		return;
	}
	o = json_object();
	if (!j->values)
		j->values = values_create(j->config);
	if (o && j->values)
		values_fill(j->values, there ? j->link.status : NULL,
			    there ? &j->link.snap : &none, o);
	verbs_answer_json(j, c, o);
}

/* -- The last checkpoint --------------------------------------------------- */

static json_t *real(double x)
{
	return isfinite(x) ? json_real(x) : json_null();
}

static json_t *axes(const int32_t *x)
{
	json_t *row = json_array();

	for (int i = 0; i < SHM_NAXES; i++)
		json_array_append_new(row, json_integer(x[i]));
	return row;
}

static json_t *job_put(const struct checkpoint_job *job)
{
	return json_pack("{s:I,s:s,s:b}", "n", (json_int_t)job->n,
			 "job", job->n ? job->id : "", "begun", job->begun);
}

static json_t *place_put(const struct shm_snapshot *s)
{
	return json_pack(
		"{s:s,s:I,s:I,s:I,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:i,s:i,s:i}",
		"state", shm_state_name(s->state),
		"line", (json_int_t)s->line, "segment", (json_int_t)s->seg,
		"tick", (json_int_t)s->tick, "place_mm", real(s->place_mm),
		"far_mm", real(s->far_mm), "length_mm", real(s->length_mm),
		"pos", axes(s->pos), "drive", axes(s->drive),
		"shift", axes(s->shift), "override", real(s->override),
		"homed", s->homed, "unhomed", s->unhomed, "m_code", s->mcode);
}

static json_t *sums_put(const struct shm_snapshot *s)
{
	const double period_s = (double)s->period_ns / 1e9;

	return json_pack("{s:o,s:o,s:o,s:I,s:I,s:I,s:I}",
			 "job_s", real((double)s->job_cycles * period_s),
			 "erode_s", real((double)s->erode_cycles * period_s),
			 "energy_j", real(s->energy_j),
			 "jumps", (json_int_t)s->jumps,
			 "retracts", (json_int_t)s->retracts,
			 "shorts", (json_int_t)s->shorts,
			 "arcs", (json_int_t)s->arcs);
}

void verbs_checkpoint(struct jobs *j, const struct verb *v,
		      const struct jobs_lcm_command *c)
{
	const struct checkpoint *last = &j->last;

	(void)v;
	if (!last->there)
		verbs_answer_json(j, c, json_object());
	else
		verbs_answer_json(j, c, json_pack("{s:I,s:o,s:o,s:o,s:I}",
				       "utime", (json_int_t)last->utime,
				       "job", job_put(&last->base.job),
				       "place", place_put(&last->base.snap),
				       "sums", sums_put(&last->base.snap),
				       "sets", (json_int_t)last->base.sets.n));
}
