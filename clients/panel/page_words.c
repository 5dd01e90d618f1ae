/* SPDX-License-Identifier: Apache-2.0 */
/*
 * page_words.c - the machine's own words, for the page's catalogue
 */
#include "page_words.h"

#include "faults.h"
#include "hunting.h"
#include "interp/tech.h"
#include "shm.h"

#include <jansson.h>
#include <stdio.h>

static json_t *faults(void)
{
	json_t *all = json_object();

	for (int i = 0; i < CYCLE_NFAULTS; i++)
		json_object_set_new(all, fault_table[i].name,
			json_pack("{s:s,s:s,s:s}", "what", fault_table[i].what,
				  "why", fault_table[i].why, "clear",
				  fault_table[i].clear));
	return all;
}

/* A number without a name is called "?": the names end there. */
static json_t *names(const char *(*name)(uint32_t), uint32_t first)
{
	json_t *all = json_object();

	for (uint32_t i = first; name(i)[0] != '?'; i++)
		json_object_set_new(all, name(i), json_integer(i));
	return all;
}

static json_t *fields(void)
{
	json_t *all = json_object();

	for (int i = 0; i < INTERP_NTECH; i++)
		json_object_set_new(all, interp_tech_field[i].name,
				    json_string(interp_tech_field[i].help));
	return all;
}

int page_words_print(void)
{
	json_t *o = json_pack("{s:o,s:o,s:o,s:o,s:s}", "faults", faults(),
			      "states", names(shm_state_name, SHM_IDLE),
			      "outcomes", names(shm_outcome_name, 0),
			      "fields", fields(), "hunting",
			      HUNTING_ADVICE);
	const int err = json_dumpf(o, stdout, JSON_INDENT(1));

	putchar('\n');
	json_decref(o);
	return err || fflush(stdout) ? 74 : 0;
}
