/* SPDX-License-Identifier: Apache-2.0 */
/* asking.c - what the generator is asked for, and whether it is in force */
#include "gap/asking.h"

#include "cycle.h"

#include <string.h>

static bool same(double a, double b)
{
	return a == b || (isnan(a) && isnan(b));
}

void asking_init(struct asking *a)
{
	*a = (struct asking) { .in_force = true, .ignition_v = (double)NAN };
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		a->now[i] = a->place[i] = a->hand[i] = (double)NAN;
}

static uint32_t tried_fields(const struct asking *a)
{
	return a->trial.fields | a->leased.fields;
}

static bool is_tried(const struct asking *a, int i)
{
	return tried_fields(a) >> i & 1;
}

static double tried(const struct asking *a, int i)
{
	return a->leased.fields >> i & 1 ? a->leased.value[i] :
					   a->trial.value[i];
}

/* It is tried, or it was, and nobody else asks for it. */
static bool is_lent(const struct cycle *c, int i)
{
	return is_tried(&c->asking, i) ||
	       (c->asking.lent >> i & 1 && isnan(c->out.pulse[i]));
}

/* What the place asks for, or who tries the generator. */
static double asked_for(const struct cycle *c, int i)
{
	const struct asking *a = &c->asking;

	return !is_lent(c, i) ? c->out.pulse[i] :
	       is_tried(a, i) ? tried(a, i) : a->before[i];
}

/* ... as the generator can do it. */
static double wanted(const struct cycle *c, int i)
{
	return process_nearest(&c->config.asking.field[i], i, asked_for(c, i));
}

double asking_off_us(const struct cycle *c, double off_us)
{
	const struct asking_config *k = &c->config.asking;
	const struct process_delivers *d = &k->field[INTERP_TECH_OFF_US];

	return !k->limited ? off_us : d->by_hand ? (double)NAN :
	       process_nearest(d, INTERP_TECH_OFF_US, off_us);
}

bool asking_takes(const struct cycle *c, uint32_t field, double value)
{
	const struct asking_config *k = &c->config.asking;

	return !k->limited || field >= INTERP_NGENERATOR ||
	       process_takes(&k->field[field], (int)field, value);
}

static void trial_put(struct asking_trial *t, uint32_t i, double value)
{
	t->value[i] = value;
	t->fields &= ~(1u << i);
	t->fields |= (uint32_t)!isnan(value) << i;
}

bool asking_try(struct cycle *c, uint32_t field, double value, bool leased)
{
	const struct process_delivers *d;
	struct asking *a = &c->asking;

	if (field >= INTERP_NGENERATOR) {
		a->trial.fields = a->leased.fields = 0;
		return isnan(value);
	}
	d = &c->config.asking.field[field];
	if (!isnan(value) && (d->by_hand ||
			      isnan(process_nearest(d, (int)field, value))))
		return false;
	if (!isnan(value) && !(a->lent >> field & 1)) {
		a->before[field] = a->says.tells >> field & 1 ?
				   a->says.told[field] : (double)NAN;
		a->lent |= 1u << field;
		if (d->stays && isnan(a->before[field]))
			a->unknown |= 1u << field;
	}
	trial_put(leased ? &a->leased : &a->trial, field, value);
	a->lease = leased ? c->config.asking.lease_cycles : a->lease;
	return true;
}

/* Who asked for these may have vanished. */
static void lease_step(struct asking *a)
{
	a->lease -= a->lease > 0;
	if (a->lease == 0)
		a->leased.fields = 0;
}

/* -- What a person sets ---------------------------------------------------- */

/* The fields that nobody has set yet, a bit each. */
static uint32_t unset(const struct cycle *c)
{
	uint32_t fields = 0;

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (isnan(c->out.pulse[i]) ? c->asking.unknown >> i & 1 :
		    c->config.asking.field[i].by_hand &&
		    c->out.pulse[i] != c->asking.hand[i])
			fields |= 1u << i;
	return fields;
}

static bool would_spark(const struct cycle *c)
{
	return c->config.asking.limited && state_duty[c->state].power &&
	       !c->job.power_off && !c->config.dry_run;
}

bool asking_hand(struct cycle *c)
{
	if (!would_spark(c) || !unset(c))
		return false;
	c->asking.stands = unset(c);
	return true;
}

/* Somebody started it again.  What was set for another job is not known. */
static void hear_hand(struct cycle *c)
{
	struct asking *a = &c->asking;

	for (int i = 0; i < INTERP_NGENERATOR && a->path != c->out.path; i++)
		a->hand[i] = (double)NAN;
	a->path = c->out.path;
	if (!a->stands || !state_duty[c->state].running)
		return;
	a->unknown &= ~a->stands;
	a->stands = 0;
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (!isnan(c->out.pulse[i]))
			a->hand[i] = c->out.pulse[i];
}

/* -- What the generator is asked for --------------------------------------- */

static bool is_the_places(const struct cycle *c)
{
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (!same(wanted(c, i), c->asking.place[i]))
			return false;
	return true;
}

static bool turns_round(const struct cycle *c)
{
	const double now = c->asking.place[INTERP_TECH_POLARITY];

	return (wanted(c, INTERP_TECH_POLARITY) < 0) != (now < 0);
}

/* Nothing of it changes in the period in which the sparks go off: that may take
 * another way, and longer. */
static bool is_dark(const struct cycle *c)
{
	const uint64_t least = turns_round(c) ?
			       c->config.asking.polarity_cycles : 0;

	return c->asking.dark > 0 && c->asking.dark >= least;
}

static void ask(struct cycle *c)
{
	struct asking *a = &c->asking;
	double off_us;

	if (!is_the_places(c)) {
		if (!is_dark(c))
			return;
		for (int i = 0; i < INTERP_NGENERATOR; i++) {
			a->now[i] = a->place[i] = wanted(c, i);
			if (!isnan(c->out.pulse[i]))
				a->unknown &= ~(1u << i);
		}
		a->needed = ++a->version;
		a->age = 0;
	}
	if (is_lent(c, INTERP_TECH_OFF_US))
		return;
	off_us = asking_off_us(c, arcing_off_us(c));
	if (same(off_us, a->now[INTERP_TECH_OFF_US]))
		return;
	a->now[INTERP_TECH_OFF_US] = off_us;
	a->version++;
}

static bool is_confirmed(const struct cycle *c, uint32_t version)
{
	const struct asking *a = &c->asking;

	return c->config.asking.answers ?
	       (int32_t)(a->says.in_force - version) >= 0 :
	       a->age > c->config.asking.settle_cycles || version == 0;
}

/* Whatever is asked for is in force at once, and yet each change of it has its
 * version. */
static void ask_freely(struct cycle *c)
{
	struct asking *a = &c->asking;
	double now[INTERP_NGENERATOR];

	memcpy(now, c->out.pulse, sizeof(now));
	now[INTERP_TECH_OFF_US] = arcing_off_us(c);
	for (int i = 0; a->lent && i < INTERP_NGENERATOR; i++)
		now[i] = is_lent(c, i) ? asked_for(c, i) : now[i];
	/* Hardly ever is there anything new. */
	if (memcmp(now, a->now, sizeof(now)) == 0)
		return;
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		if (same(a->now[i], now[i]))
			continue;
		a->now[i] = now[i];
		a->version++;
		a->age = 0;
	}
}

/* Until it has what it was asked for, it may have what it had. */
static void bound_ignition(struct asking *a)
{
	const double now = a->now[INTERP_TECH_IGNITION_V];

	if (a->has || isnan(now) || !(a->ignition_v > now))
		a->ignition_v = now;
}

/* It has it again, and keeps it. */
static void give_back(struct cycle *c)
{
	if (c->asking.has && !c->loaded)
		c->asking.lent = tried_fields(&c->asking);
}

void asking_step(struct cycle *c, const struct io_inputs *in)
{
	struct asking *a = &c->asking;

	a->says = in->generator;
	a->age++;
	lease_step(a);
	if (!c->config.asking.limited) {
		ask_freely(c);
		a->has = is_confirmed(c, a->version);
		bound_ignition(a);
		give_back(c);
		return;
	}
	hear_hand(c);
	a->dark = c->out.power ? 0 : a->dark + 1;
	/* Where these end, nothing may have changed. */
	if (c->state != STATE_JUMP && c->state != STATE_RETRACT)
		ask(c);
	a->in_force = is_the_places(c) && !unset(c) &&
		      is_confirmed(c, a->needed);
	a->has = is_the_places(c) && is_confirmed(c, a->version);
	bound_ignition(a);
	give_back(c);
}

bool asking_waits(const struct cycle *c)
{
	return would_spark(c) && !c->asking.in_force;
}
