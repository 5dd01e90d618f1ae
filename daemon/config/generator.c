/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator.c - [generator]: what reaches it, and what may be asked
 */
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* -- The interface --------------------------------------------------------- */

int config_generator_interface(const struct machine_config *c)
{
	if (c->generator.interface != GENERATOR_AUTO)
		return c->generator.interface;
	return config_machine_is(c, MACHINE_MODEL) ? GENERATOR_SIM :
						     GENERATOR_NONE;
}

bool config_generator_beside(int interface)
{
	return interface >= GENERATOR_LINES;
}

bool config_generator_limits(const struct machine_config *c)
{
	return config_generator_interface(c) != GENERATOR_SIM &&
	       config_backend(c)->has_gap(c);
}

/* What every CAN generator was sent before a machine file could say more. */
static void usual_frame(const struct machine_config *c, int field,
			struct config_way *ret)
{
	static const char *const at[PROCESS_NFIELDS] = {
		[PROCESS_SPARK] = "byte 0 bit 0",
		[PROCESS_PUMP] = "byte 0 bit 1",
		[INTERP_TECH_POLARITY] = "byte 0 bit 2",
		[INTERP_TECH_PEAK_A] = "byte 2 scale 0.1",
		[INTERP_TECH_ON_US] = "byte 4 scale 0.1",
		[INTERP_TECH_OFF_US] = "byte 6 scale 0.1",
	};
	char text[CONFIG_WAY_MAX];

	if (!at[field] || c->generator.can_id == 0)
		return;
	snprintf(text, sizeof(text), "can %.0f %s", c->generator.can_id,
		 at[field]);
	config_way_read(text, field, ret);
}

bool config_generator_gpio(const struct machine_config *c, int field)
{
	const int line = field == PROCESS_SPARK ? LINE_SPARK :
			 field == PROCESS_PUMP ? LINE_PUMP : -1;
	struct config_line_at at;

	if (line < 0 || c->backend != BACKEND_GPIO)
		return false;
	config_line_read(c->gpio.line[line], &at);
	return at.wired;
}

static void by_itself(const struct machine_config *c, int field,
		      struct config_way *ret)
{
	const int interface = config_generator_interface(c);
	char odd[CONFIG_WAY_WORD];

	*ret = (struct config_way) { .kind = WAY_NONE };
	if (config_hand_read(c->generator.by_hand, odd) >> field & 1 ||
	    process_is_setting(field))
		return;
	if (interface == GENERATOR_CAN && !config_generator_gpio(c, field))
		usual_frame(c, field, ret);
	else if (interface == GENERATOR_PLC && config_plc_pulse(field) &&
		 !config_generator_gpio(c, field))
		config_way_read("plc", field, ret);
	else if (interface == GENERATOR_SIM || config_generator_gpio(c, field))
		ret->kind = WAY_OWN;
	if (ret->kind == WAY_OWN)
		config_way_all(field, false, &ret->gives);
}

/* A register that is written can be read, and a PLC tells what it sets. */
static void told_by_itself(const struct machine_config *c, int field,
			   struct config_way *ret)
{
	*ret = (struct config_way) { .kind = WAY_NONE };
	if (field < PROCESS_NFIELDS)
		config_way(c, field, false, ret);
	else if (config_generator_interface(c) == GENERATOR_PLC)
		config_way_read("plc", field, ret);
	if (ret->kind != WAY_REGISTER && ret->kind != WAY_PLC)
		*ret = (struct config_way) { .kind = WAY_NONE };
}

void config_way(const struct machine_config *c, int field, bool told,
		struct config_way *ret)
{
	const char *text = told ? c->generator.told[field] :
				  c->generator.field[field];

	if (strcmp(text, "auto") == 0 && told)
		told_by_itself(c, field, ret);
	else if (strcmp(text, "auto") == 0)
		by_itself(c, field, ret);
	else if (config_way_read(text, field, ret))
		*ret = (struct config_way) { .kind = WAY_NONE };
}

static void only_in_list(struct process_delivers *d,
			 const struct process_delivers *told, double slack)
{
	const struct process_delivers all = *d;

	d->n = 0;
	for (uint32_t i = 0; i < told->n; i++) {
		const double v = told->value[i];
		bool has = all.n == 0 && v >= all.min - slack &&
			   v <= all.max + slack;

		for (uint32_t k = 0; k < all.n; k++)
			has = has || fabs(all.value[k] - v) <= slack;
		if (has)
			d->value[d->n++] = v;
	}
	d->there = d->n > 0;
}

static void only_up_to(struct process_delivers *d, double most)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < d->n; i++)
		if (d->value[i] <= most)
			d->value[n++] = d->value[i];
	d->there = d->n ? n > 0 : d->min <= most;
	d->n = n;
	d->max = fmin(d->max, most);
}

/* What it has no word for would never be in force. */
static void only_told(const struct machine_config *c, int field,
		      const struct config_way *asked,
		      struct process_delivers *d)
{
	struct config_way told;

	if (field < INTERP_NGENERATOR)
		config_way(c, field, true, &told);
	if (field >= INTERP_NGENERATOR || told.kind == WAY_NONE || !d->there)
		return;
	d->measured = told.within > 0;
	if (told.gives.n)
		only_in_list(d, &told.gives, asked->kind == WAY_DAC ? 0 :
					     asked->scale / 2);
	else
		only_up_to(d, told.gives.max);
}

void config_delivers(const struct machine_config *c, int field,
		     struct process_delivers *ret)
{
	char odd[CONFIG_WAY_WORD];
	struct config_way w;

	config_way(c, field, false, &w);
	*ret = w.gives;
	if (config_hand_read(c->generator.by_hand, odd) >> field & 1)
		config_way_all(field, true, ret);
	ret->stays = w.kind == WAY_REGISTER;
	only_told(c, field, &w, ret);
}

static void add_id(const struct config_way *w, uint16_t *id, uint32_t *n)
{
	uint32_t i = 0;

	while (i < *n && id[i] != w->id)
		i++;
	if (w->kind == WAY_CAN && i == *n)
		id[(*n)++] = w->id;
}

uint32_t config_generator_frames(const struct machine_config *c,
				 const char *name)
{
	uint16_t id[PROCESS_NFIELDS + PROCESS_NTOLD];
	struct config_way w;
	uint32_t n = 0;

	for (int i = 0; i < PROCESS_NTOLD; i++) {
		if (i < PROCESS_NFIELDS) {
			config_way(c, i, false, &w);
			add_id(&w, id, &n);
		}
		config_way(c, i, true, &w);
		add_id(&w, id, &n);
	}
	return strcmp(c->generator.can_interface, name) == 0 ? n : 0;
}

/* -- What may be asked ----------------------------------------------------- */

static int refuse_value(const struct process_delivers *d, int field,
			double value, const char *who,
			struct interp_diag *diag)
{
	const char *name = process_name(field);
	const char *unit = interp_tech_field[field].unit;
	char range[120];

	snprintf(diag->found, sizeof(diag->found), "%s: %s %g%s%s does not "
		 "reach the generator", who, name, value, *unit ? " " : "",
		 unit);
	process_range_text(d, field, range, sizeof(range));
	if (d->there)
		snprintf(diag->wanted, sizeof(diag->wanted), "%s; or another "
			 "[generator] %s", range, name);
	else
		snprintf(diag->wanted, sizeof(diag->wanted), "no %s in the "
			 "condition; or [generator] %s = how it is reached; "
			 "or [generator] by_hand = %s, and a person sets it",
			 name, name, name);
	return -EINVAL;
}

int config_generator_takes(const struct machine_config *c,
			   const struct interp_tech *t, const char *who,
			   struct interp_diag *diag)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		struct process_delivers d;

		if (isnan(t->v[i]) || !config_generator_limits(c))
			continue;
		config_delivers(c, i, &d);
		if (!process_takes(&d, i, t->v[i]))
			return refuse_value(&d, i, t->v[i], who, diag);
	}
	return 0;
}
