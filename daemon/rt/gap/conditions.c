/* SPDX-License-Identifier: Apache-2.0 */
/*
 * conditions.c - the values in force: machine file, condition, `set`
 */
#include "gap/conditions.h"

#include "cycle.h"
#include "process.h"

#include <math.h>
#include <string.h>

static double period_s(const struct cycle *c)
{
	return (double)c->config.period_ns * 1e-9;
}

/* The condition at this place and what is `set` in it. It is a copy, because
 * the program is in memory that another process wrote. */
static struct interp_tech wanted(const struct cycle *c, uint16_t cond)
{
	struct interp_tech t = c->cursor.p.conds[cond].tech;

	for (uint32_t i = 0; i < c->conditions.nsets; i++) {
		const struct conditions_set *s = &c->conditions.set[i];

		if (s->cond == cond)
			t.v[s->field] = s->value;
	}
	return t;
}

/* In @cond, behind what the program @said.  An electrode is positive where
 * nobody says it: one of a job before may have been negative. */
static double polarity(const struct cycle *c, uint16_t cond, uint32_t said)
{
	const struct conditions *p = &c->conditions;
	double is = said == INTERP_AUX_POWER_NEGATIVE ? -1 : said ? 1 :
		    c->cursor.p.conds[cond].tech.v[INTERP_TECH_POLARITY];

	for (uint32_t i = 0; i < p->nsets; i++) {
		if (p->set[i].cond == cond &&
		    p->set[i].field == INTERP_TECH_POLARITY)
			is = p->set[i].value;
	}
	return isnan(is) ? 1 : is;
}

static void put_polarity(struct cycle *c)
{
	c->out.pulse[INTERP_TECH_POLARITY] =
		polarity(c, c->conditions.cond, c->conditions.said);
}

/* What edmd's own servo goes by too; NAN: it does not cross. */
static double reference(const struct cycle *c, int field, double value)
{
	return c->config.asking.field[field].there ? value : (double)NAN;
}

static void put(struct cycle *c, const struct interp_tech *t)
{
	c->gap = c->config.gap;
	c->jump = c->config.jump;
	for (int i = 0; i < INTERP_NTECH; i++) {
		double *at = process_setting((enum interp_tech_id)i, &c->gap,
					     &c->jump);

		if (at && interp_tech_given(t, (enum interp_tech_id)i))
			*at = t->v[i];
		if (i < INTERP_NGENERATOR)
			c->out.pulse[i] = at ? reference(c, i, *at) : t->v[i];
	}
	if (t->v[INTERP_TECH_JUMP_EVERY_S] > 0)
		c->jump.every.cycles = (uint64_t)fmax(1, floor(
			c->jump.every.s / period_s(c) + 0.5));
	put_polarity(c);
}

static bool gives_nothing(const struct interp_tech *t)
{
	for (int i = 0; i < INTERP_NTECH; i++) {
		if (interp_tech_given(t, (enum interp_tech_id)i))
			return false;
	}
	return true;
}

/* Are these values, put over those of this machine, in order? */
static bool fits(const struct cycle *c, const struct interp_tech *t)
{
	struct interp_tech sum;

	if (gives_nothing(t))
		return true;
	if (!interp_tech_ok(t))
		return false;
	process_base(&sum, &c->config.gap, &c->config.jump);
	interp_tech_over(&sum, t);
	return !interp_tech_order(&sum);
}

static bool apply(struct cycle *c, uint16_t cond)
{
	const struct interp_tech t = wanted(c, cond);

	if (!fits(c, &t))
		return false;
	c->conditions.cond = cond;
	c->out.cond_letter = c->cursor.p.conds[cond].letter;
	c->out.cond_number = c->cursor.p.conds[cond].number;
	put(c, &t);
	return true;
}

/* Over M3 and M4, either way.  Return: has it come to another one? */
static bool hear_program(struct cycle *c)
{
	const struct interp_seg *s = c->cursor.p.segs;
	struct conditions *p = &c->conditions;
	const uint32_t was = p->said;

	while (p->at != c->cursor.index) {
		const bool back = p->at > c->cursor.index;
		const struct interp_seg *over = &s[back ? p->at-- : ++p->at];
		const uint32_t aux = INTERP_AUX_OF(over->arg);

		if (over->kind != INTERP_AUX || aux > INTERP_AUX_POWER_NEGATIVE)
			continue;
		if (back || aux == INTERP_AUX_POWER_OFF)
			p->said = INTERP_AUX_WAS(over->arg);
		else
			p->said = aux;
	}
	return p->said != was;
}

bool conditions_begin(struct cycle *c)
{
	c->conditions.nsets = 0;
	c->conditions.at = c->conditions.said = 0;
	hear_program(c);
	c->conditions.of_cut = c->cursor.seg.cond;
	c->conditions.said_of_cut = c->conditions.said;
	return apply(c, c->conditions.of_cut);
}

/* Behind an action, where there are to be sparks, it is that of the cut ahead:
 * the action may be the program's begin, and have none.  Whoever is held there
 * keeps it. */
static uint16_t cond_here(const struct cycle *c)
{
	const struct interp_program *p = &c->cursor.p;
	const struct interp_seg *here = &c->cursor.seg;
	struct interp_seg ahead;

	if (here->kind < INTERP_BEGIN || here->kind == INTERP_END)
		return here->cond;
	ahead = p->segs[c->cursor.index + 1];
	return interp_program_seg_ok(p, c->cursor.index + 1, &ahead) &&
	       ahead.kind < INTERP_BEGIN &&
	       (ahead.cond == c->conditions.cond ||
		state_duty[c->state].power) ? ahead.cond : here->cond;
}

/* Jumps, retracts, and whoever is held in one, are behind it. */
static bool is_at_the_front(const struct cycle *c)
{
	return interp_cursor_place_mm(&c->cursor) >=
	       c->far_mm - MOVER_ONTO_MM;
}

bool conditions_follow(struct cycle *c)
{
	const uint16_t cond = cond_here(c);

	if (hear_program(c))
		put_polarity(c);
	if (is_at_the_front(c)) {
		c->conditions.of_cut = cond;
		c->conditions.said_of_cut = c->conditions.said;
	}
	return cond == c->conditions.cond || apply(c, cond);
}

/* -- set ------------------------------------------------------------------- */

static bool is_used(uint32_t field)
{
	return field < INTERP_NTECH &&
	       interp_tech_is_live((enum interp_tech_id)field);
}

/* The slot where the field is set in the condition of the cut, or where it
 * would be. */
static uint32_t place_of(const struct conditions *p, uint32_t field)
{
	uint32_t i = 0;

	while (i < p->nsets && !(p->set[i].cond == p->of_cut &&
				 p->set[i].field == field))
		i++;
	return i;
}

static void change(struct conditions *p, uint32_t at, uint32_t field,
		   double value)
{
	if (!isnan(value)) {
		p->nsets += at == p->nsets;
		p->set[at] = (struct conditions_set) { value, p->of_cut,
						    (uint8_t)field };
	} else if (at < p->nsets) {
		p->set[at] = p->set[--p->nsets];
	}
}

enum conditions_result conditions_set(struct cycle *c, uint32_t field,
				      double value)
{
	const struct conditions was = c->conditions;
	const uint32_t at = place_of(&was, field);
	struct interp_tech of_cut;

	if (!is_used(field))
		return CONDITIONS_BAD;
	if (!isnan(value) &&
	    !(interp_tech_value_ok((enum interp_tech_id)field, value) &&
	      asking_takes(c, field, value)))
		return CONDITIONS_BAD;
	if (at == CONDITIONS_SETS_MAX && !isnan(value))
		return CONDITIONS_FULL;
	change(&c->conditions, at, field, value);
	of_cut = wanted(c, was.of_cut);
	if (fits(c, &of_cut) && apply(c, was.cond))
		return CONDITIONS_DONE;
	c->conditions = was;
	return CONDITIONS_BAD;
}

static bool restores(struct cycle *c, const struct conditions_set *s)
{
	struct interp_tech t;

	if (s->cond >= c->cursor.p.head->nconds || !is_used(s->field) ||
	    !interp_tech_value_ok((enum interp_tech_id)s->field, s->value) ||
	    !asking_takes(c, s->field, s->value))
		return false;
	t = wanted(c, s->cond);
	return fits(c, &t);
}

bool conditions_restore(struct cycle *c, const struct conditions_set *sets,
		     uint32_t n)
{
	struct conditions *p = &c->conditions;
	bool good = n <= CONDITIONS_SETS_MAX;

	p->nsets = good ? n : 0;
	if (p->nsets > 0)
		memcpy(p->set, sets, n * sizeof(*sets));
	for (uint32_t i = 0; i < p->nsets && good; i++)
		good = restores(c, &sets[i]);
	if (!good)
		p->nsets = 0;
	return apply(c, p->cond) && good;
}

double conditions_value(const struct cycle *c, uint32_t field)
{
	const struct conditions *p = &c->conditions;
	struct interp_tech now, of_cut;

	if (!is_used(field) || !c->loaded)
		return (double)NAN;
	if (field == INTERP_TECH_POLARITY)
		return polarity(c, p->of_cut, p->said_of_cut);
	if (p->of_cut != p->cond) {
		of_cut = wanted(c, p->of_cut);
		process_base(&now, &c->config.gap, &c->config.jump);
		interp_tech_over(&now, &of_cut);
		return now.v[field];
	}
	process_base(&now, &c->gap, &c->jump);
	return field < INTERP_NGENERATOR && !process_is_setting((int)field) ?
	       c->out.pulse[field] : now.v[field];
}
