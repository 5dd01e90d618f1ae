/* SPDX-License-Identifier: Apache-2.0 */
/* calls.c - conditions that a job has called, on their way into the history */
#include "calls.h"

#include "jobs.h"
#include "store_tally.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

static json_t *row_of(const struct call *c)
{
	return json_pack("[I,s,o]", (json_int_t)c->time_ns, c->condition,
			 isfinite(c->place_mm) ? json_real(c->place_mm) :
						 json_null());
}

void calls_add(struct jobs *j, uint32_t n, const struct call *c)
{
	struct calls *l = &j->calls;

	if (l->n == CALLS_MAX || (l->n && l->job != n))
		calls_write(j);
	l->job = n;
	l->call[l->n++] = *c;
}

void calls_write(struct jobs *j)
{
	struct calls *l = &j->calls;
	json_t *rows;
	char *text;

	if (!l->n)
		return;
	rows = json_array();
	for (uint32_t i = 0; i < l->n; i++)
		json_array_append_new(rows, row_of(&l->call[i]));
	text = json_dumps(rows, JSON_COMPACT | JSON_REAL_PRECISION(12));
	if (text)
		store_calls(j->store, l->job, text);
	free(text);
	json_decref(rows);
	l->n = 0;
}
