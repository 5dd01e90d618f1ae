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
	*a = (struct asking) { .in_force = true, .anew = true };
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		a->now[i] = a->place[i] = a->hand[i] = (double)NAN;
}

static bool is_tried(const struct asking *a, int i)
{
	return (a->trial.fields | a->leased.fields) >> i & 1;
}

static double tried(const struct asking *a, int i)
{
	return a->leased.fields >> i & 1 ? a->leased.value[i] :
					   a->trial.value[i];
}

static bool is_lent(const struct asking *a, int i)
{
	return a->lent >> i & 1;
}

/* A person sets it, or may have set it, until the job is started again:
 * wherever the machine is moved meanwhile. */
static bool is_left(const struct cycle *c, int i)
{
	return c->asking.stands >> i & 1 && c->config.asking.field[i].stays;
}

/* What the place asks for, or who tries the generator, or it was asked for and
 * nobody asks any more. */
static double asked_for(const struct cycle *c, int i)
{
	const struct asking *a = &c->asking;

	return is_tried(a, i) ? tried(a, i) : is_left(c, i) ? (double)NAN :
	       isnan(c->out.pulse[i]) && is_lent(a, i) ? a->before[i] :
							 c->out.pulse[i];
}

/* ... as the generator can do it. */
static double wanted(const struct cycle *c, int i)
{
	return process_nearest(&c->config.asking.field[i], i, asked_for(c, i));
}

/* What it has set by now; NAN: nobody knows.  What is measured is not that. */
static double has_by_now(const struct cycle *c, int i)
{
	const struct process_delivers *d = &c->config.asking.field[i];
	const struct io_generator *says = &c->asking.says;

	return says->tells >> i & 1 && !d->measured ?
	       process_nearest(d, i, says->told[i]) : (double)NAN;
}

/* Before @value is asked for.  Others than registers can be asked for their
 * own setting. */
static void lend(struct cycle *c, int i, double value)
{
	struct asking *a = &c->asking;

	if (!c->config.asking.field[i].stays || is_lent(a, i) || isnan(value))
		return;
	a->lent |= 1u << i;
	a->before[i] = has_by_now(c, i);
}

double asking_off_us(const struct cycle *c, double off_us)
{
	const struct asking_config *k = &c->config.asking;
	const struct process_delivers *d = &k->field[INTERP_TECH_OFF_US];

	if (!k->limited)
		return off_us;
	/* One that nobody gave could not be taken back. */
	if (d->by_hand ||
	    (d->stays && isnan(c->out.pulse[INTERP_TECH_OFF_US])))
		return (double)NAN;
	return process_nearest(d, INTERP_TECH_OFF_US, off_us);
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

	a->anew = true;
	if (field >= INTERP_NGENERATOR) {
		a->trial.fields = a->leased.fields = 0;
		return isnan(value);
	}
	d = &c->config.asking.field[field];
	if (!isnan(value) && (d->by_hand ||
			      isnan(process_nearest(d, (int)field, value))))
		return false;
	lend(c, (int)field, value);
	trial_put(leased ? &a->leased : &a->trial, field, value);
	a->lease = leased ? c->config.asking.lease_cycles : a->lease;
	return true;
}

/* Who asked for these may have vanished. */
static void lease_step(struct asking *a)
{
	a->lease -= a->lease > 0;
	if (a->lease > 0 || !a->leased.fields)
		return;
	a->leased.fields = 0;
	a->anew = true;
}

/* -- What a person sets ---------------------------------------------------- */

/* It keeps what it was asked for, and nobody knows what it had. */
static bool is_unknown(const struct cycle *c, int i)
{
	return c->config.asking.field[i].stays && is_lent(&c->asking, i) &&
	       isnan(c->asking.before[i]);
}

/* The fields that nobody has set yet, a bit each. */
static uint32_t unset(const struct cycle *c)
{
	uint32_t fields = 0;

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (isnan(c->out.pulse[i]) ? is_unknown(c, i) :
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
	if (!would_spark(c) || !unset(c) || !c->asking.has)
		return false;
	c->asking.stands = unset(c);
	return true;
}

void asking_begin(struct cycle *c)
{
	struct asking *a = &c->asking;

	asking_try(c, INTERP_NGENERATOR, (double)NAN, false);
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		a->hand[i] = (double)NAN;
	a->stands = 0;
	a->begun = false;
}

/* Somebody started it again. */
static void hear_hand(struct cycle *c)
{
	struct asking *a = &c->asking;

	if (!a->stands || !state_duty[c->state].running)
		return;
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (!isnan(c->out.pulse[i]))
			a->hand[i] = c->out.pulse[i];
		else
			a->lent &= ~(a->stands & 1u << i);
	a->stands = 0;
	a->needed = ++a->version;	/* it tells what it has now */
	a->age = 0;
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

/* The off time of a step against arcs; without one, @off_us. */
static double against_arcs(const struct cycle *c, double off_us)
{
	const double longer_us = asking_off_us(c, arcing_off_us(c));
	const bool of_others = is_tried(&c->asking, INTERP_TECH_OFF_US) ||
			       is_left(c, INTERP_TECH_OFF_US);

	return isnan(longer_us) || of_others ? off_us : longer_us;
}

static void ask(struct cycle *c)
{
	struct asking *a = &c->asking;
	const bool begins = !a->begun && state_duty[c->state].power;
	double off_us;

	if (begins || !is_the_places(c)) {
		if (!is_dark(c))
			return;
		a->begun = a->begun || begins;
		for (int i = 0; i < INTERP_NGENERATOR; i++) {
			lend(c, i, wanted(c, i));
			a->now[i] = a->place[i] = wanted(c, i);
		}
		a->needed = ++a->version;
		a->age = 0;
	}
	off_us = against_arcs(c, a->place[INTERP_TECH_OFF_US]);
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
 * version.  Return: is there anything new?  Hardly ever. */
static bool ask_freely(struct cycle *c)
{
	struct asking *a = &c->asking;
	const double off_us = arcing_off_us(c);

	if (!a->anew && same(off_us, a->arcing_off_us) &&
	    memcmp(a->place, c->out.pulse, sizeof(a->place)) == 0)
		return false;
	memcpy(a->place, c->out.pulse, sizeof(a->place));
	a->arcing_off_us = off_us;
	a->anew = false;
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		const double want = asked_for(c, i);
		const double now = i == INTERP_TECH_OFF_US ?
				   against_arcs(c, want) : want;

		if (same(a->now[i], now))
			continue;
		lend(c, i, now);
		a->now[i] = now;
		a->version++;
		a->age = 0;
	}
	return true;
}

/* Until it has what it is asked for, it may have what it had.  What it is not
 * asked for is as the machine file says, or not known. */
static void bound_ignition(struct cycle *c)
{
	const double asked = c->asking.now[INTERP_TECH_IGNITION_V];
	const double own = c->gap.ignition_v > 0 ? c->gap.ignition_v :
						   (double)INFINITY;
	const double now = isnan(asked) ? own : asked;

	if (c->asking.has || c->asking.ignition_v < now)
		c->asking.ignition_v = now;
}

/* It has it again, and keeps it. */
static void give_back(struct cycle *c)
{
	struct asking *a = &c->asking;

	if (!a->has || c->loaded || !a->lent)
		return;
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		if (isnan(c->out.pulse[i]) && !is_tried(a, i) &&
		    !is_unknown(c, i))
			a->lent &= ~(1u << i);
	a->anew = true;
}

void asking_step(struct cycle *c, const struct io_inputs *in)
{
	struct asking *a = &c->asking;

	a->says = in->generator;
	a->age++;
	lease_step(a);
	if (!c->config.asking.limited) {
		const bool stays = !ask_freely(c) && a->has;

		a->begun = a->begun || state_duty[c->state].power;
		a->has = is_confirmed(c, a->version);
		if (!stays || !a->has)
			bound_ignition(c);
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
	bound_ignition(c);
	give_back(c);
}

void asking_restore(struct cycle *c)
{
	const struct interp_program *p = &c->cursor.p;
	struct asking *a = &c->asking;

	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		for (uint32_t k = 0; k < p->head->nconds; k++)
			a->lent |= (uint32_t)!isnan(p->conds[k].tech.v[i]) << i;
		a->before[i] = (double)NAN;
	}
	for (uint32_t k = 0; k < c->conditions.nsets; k++)
		if (c->conditions.set[k].field < INTERP_NGENERATOR)
			a->lent |= 1u << c->conditions.set[k].field;
	a->stands = c->stand.why == STAND_SETTING ? c->stand.of : 0;
}

bool asking_waits(const struct cycle *c)
{
	return would_spark(c) && !c->asking.in_force;
}
