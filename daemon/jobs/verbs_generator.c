/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs_generator.c - what the generator is asked for and what it tells, and
 * values to try it with
 */
#include "verb.h"

#include "interp/tech_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

static json_t *real(double x)
{
	return isfinite(x) ? json_real(x) : json_null();
}

static json_t *values_of(const struct process_delivers *d)
{
	json_t *all = json_array();

	for (uint32_t i = 0; i < d->n; i++)
		json_array_append_new(all, json_real(d->value[i]));
	return all;
}

static json_t *field_put(const struct jobs *j, const struct shm_snapshot *s,
			 int field)
{
	const bool there = j->link.state == LINK_OK;
	const bool tells = there && s->tells >> field & 1;
	struct process_delivers d;
	struct config_way w;

	config_delivers(j->config, field, &d);
	config_way(j->config, field, false, &w);
	return json_pack("{s:s,s:s,s:s,s:b,s:o,s:o,s:b,s:f,s:f,s:f,s:o}",
			 "name", process_name(field),
			 "unit", interp_tech_field[field].unit,
			 "by", d.by_hand ? "hand" : config_way_word(w.kind),
			 "delivered", d.there && !d.by_hand,
			 "asked", there ? real(s->asked[field]) : json_null(),
			 "told", tells ? real(s->told[field]) : json_null(),
			 "tells", tells, "min", d.min, "max", d.max,
			 "step", d.step, "values", values_of(&d));
}

void verbs_generator(struct jobs *j, const struct verb *v,
		     const struct jobs_lcm_command *c)
{
	const struct shm_snapshot *s = &j->link.snap;
	const bool there = j->link.state == LINK_OK;
	json_t *fields = json_array();

	(void)v;
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		json_array_append_new(fields, field_put(j, s, i));
	verbs_answer_json(j, c, json_pack(
		"{s:s,s:b,s:b,s:b,s:f,s:o}",
		"interface", config_interface_word(
			config_generator_interface(j->config)),
		"there", there, "sparks", there && s->power,
		"in_force", there && s->has_asked,
		"confirm_s", j->config->generator.confirm_s,
		"fields", fields));
}

/* -- To try it ------------------------------------------------------------- */

static void refuse_field(struct jobs *j, const struct jobs_lcm_command *c)
{
	char reason[320];
	size_t n = (size_t)snprintf(reason, sizeof(reason), "'%.40s' is no "
				    "value of a generator; one of", c->text);

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		n += (size_t)snprintf(reason + n, sizeof(reason) - n, " %s",
				      process_name(i));
	verbs_answer(j, c, EX_DATAERR, reason);
}

static void refuse_value(struct jobs *j, const struct jobs_lcm_command *c,
			 int field, const struct process_delivers *d)
{
	char reason[400], range[120];

	process_range_text(d, field, range, sizeof(range));
	if (!d->there)
		snprintf(reason, sizeof(reason), "%s does not reach the "
			 "generator; [generator] %s = how it is reached",
			 c->text, c->text);
	else if (d->by_hand)
		snprintf(reason, sizeof(reason), "a person sets %s, as "
			 "[generator] by_hand says; a field that edmd sets",
			 c->text);
	else
		snprintf(reason, sizeof(reason), "%s %g does not reach the "
			 "generator; %s", c->text, c->arg, range);
	verbs_answer(j, c, EX_DATAERR, reason);
}

int verbs_generator_field(struct jobs *j, const struct jobs_lcm_command *c)
{
	const int field = *c->text ? interp_tech_find(c->text) :
				     INTERP_NGENERATOR;
	struct process_delivers d;

	if (*c->text && (field < 0 || field >= INTERP_NGENERATOR)) {
		refuse_field(j, c);
		return -1;
	}
	if (isnan(c->arg))
		return field;
	if (!*c->text) {
		refuse_field(j, c);
		return -1;
	}
	config_delivers(j->config, field, &d);
	if (!d.by_hand && !isnan(process_nearest(&d, field, c->arg)) &&
	    interp_tech_value_ok((enum interp_tech_id)field, c->arg))
		return field;
	refuse_value(j, c, field, &d);
	return -1;
}
