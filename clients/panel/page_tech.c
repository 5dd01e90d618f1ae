/* SPDX-License-Identifier: Apache-2.0 */
/*
 * page_tech.c - the machine's technology table as JSON
 */
#include "page_tech.h"

#include "compiling.h"
#include "values.h"
#include "interp/tech_table.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

static json_t *row(const struct interp_tech_row *r)
{
	char name[16];

	interp_tech_name(r->letter, r->number, name, sizeof(name));
	return json_pack("{s:s,s:i,s:o}", "name", name, "line", (int)r->line,
			 "values", values_json(&r->tech));
}

static json_t *sequence(const struct interp_tech_sequence *q)
{
	json_t *steps = json_array();
	char name[16];

	for (uint32_t i = 0; i < q->nsteps; i++) {
		interp_tech_name(q->step[i].letter, q->step[i].number, name,
				 sizeof(name));
		json_array_append_new(steps, json_string(name));
	}
	return json_pack("{s:i,s:o}", "number", (int)q->number, "steps", steps);
}

static json_t *table(const struct interp_tech_table *t)
{
	json_t *rows = json_array(), *sequences = json_array();
	json_t *notes = json_array();

	for (uint32_t i = 0; i < t->nrows; i++)
		json_array_append_new(rows, row(&t->row[i]));
	for (uint32_t i = 0; i < t->nsequences; i++)
		json_array_append_new(sequences, sequence(&t->sequence[i]));
	for (uint32_t i = 0; i < t->nnotes; i++)
		json_array_append_new(notes, json_string(t->note[i]));
	return json_pack("{s:s,s:s,s:o,s:o,s:o}", "electrode", t->electrode,
			 "workpiece", t->workpiece, "notes", notes, "rows",
			 rows, "sequences", sequences);
}

int page_tech_put(const struct machine_config *c)
{
	struct config_tech t;
	struct interp_tech base;
	const int err = config_tech_load(&t, c, NULL);
	json_t *o = json_object();

	config_tech_base(c, &base);
	json_object_set_new(o, "base", values_json(&base));
	json_object_set_new(o, "file", json_string(t.path));
	if (err == -EINVAL)
		json_object_set_new(o, "refused", json_pack("{s:i,s:i,s:s,s:s}",
			"line", (int)t.diag.line, "column", (int)t.diag.column,
			"found", t.diag.found, "wanted", t.diag.wanted));
	else if (err < 0)
		json_object_set_new(o, "refused", json_pack("{s:i,s:i,s:s,s:s}",
			"line", 0, "column", 0, "found", strerror(-err),
			"wanted", "a file that [tech] table names"));
	else if (t.table)
		json_object_set_new(o, "table", table(t.table));
	json_dumpf(o, stdout, JSON_COMPACT);
	json_decref(o);
	config_tech_free(&t);
	return 0;
}
