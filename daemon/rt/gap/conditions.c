/* SPDX-License-Identifier: Apache-2.0 */
/*
 * conditions.c - the values in force: machine file, condition, `set`
 */
#include "gap/conditions.h"

#include "cycle.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define AT(field)	offsetof(struct cycle, field)

/* The fields that are used as they are. jump_every_s, abort_count, iso and
 * polarity are not among them. */
static const struct {
	enum interp_tech_id id;
	size_t at;
} rows[] = {
	{ INTERP_TECH_PEAK_A,		AT(out.pulse.peak_a) },
	{ INTERP_TECH_ON_US,		AT(out.pulse.on_us) },
	{ INTERP_TECH_OFF_US,		AT(out.pulse.off_us) },
	{ INTERP_TECH_IGNITION_V,	AT(out.pulse.ignition_v) },
	{ INTERP_TECH_SERVO_V,		AT(gap.servo_v) },
	{ INTERP_TECH_WINDOW_LOW_V,	AT(gap.window_low_v) },
	{ INTERP_TECH_WINDOW_HIGH_V,	AT(gap.window_high_v) },
	{ INTERP_TECH_SHORT_V,		AT(gap.short_v) },
	{ INTERP_TECH_OPEN_V,		AT(gap.open_v) },
	{ INTERP_TECH_GAIN_MM_S_V,	AT(gap.gain_mm_s_v) },
	{ INTERP_TECH_INTEGRAL_S,	AT(gap.integral_s) },
	{ INTERP_TECH_FEED_MAX_MM_S,	AT(gap.feed_max_mm_s) },
	{ INTERP_TECH_RETRACT_MM_S,	AT(gap.retract_mm_s) },
	{ INTERP_TECH_JUMP_MM,		AT(jump.height_mm) },
	{ INTERP_TECH_JUMP_DEPTH_MM,	AT(jump.every_mm) },
	{ INTERP_TECH_JUMP_SHORT_OF_MM,	AT(jump.short_of_mm) },
};

#define NROWS	(sizeof(rows) / sizeof(rows[0]))

static double *value_at(struct cycle *c, size_t row)
{
	return (double *)(void *)((char *)c + rows[row].at);
}

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

static void put_polarity(struct cycle *c)
{
	const struct conditions *p = &c->conditions;
	const struct interp_tech *t = &c->cursor.p.conds[p->cond].tech;

	c->out.negative = p->said ? p->said_negative :
			  t->v[INTERP_TECH_POLARITY] < 0;
	for (uint32_t i = 0; i < p->nsets; i++) {
		if (p->set[i].cond == p->cond &&
		    p->set[i].field == INTERP_TECH_POLARITY)
			c->out.negative = p->set[i].value < 0;
	}
}

static void put(struct cycle *c, const struct interp_tech *t)
{
	const double every_s = t->v[INTERP_TECH_JUMP_EVERY_S];

	c->gap = c->config.gap;
	c->jump = c->config.jump;
	c->out.pulse = (struct io_pulse) { NAN, NAN, NAN, NAN, false };
	for (size_t i = 0; i < NROWS; i++) {
		if (interp_tech_given(t, rows[i].id))
			*value_at(c, i) = t->v[rows[i].id];
	}
	c->out.pulse.iso = t->v[INTERP_TECH_ISO] > 0;
	if (interp_tech_given(t, INTERP_TECH_ABORT_COUNT))
		c->gap.abort_count =
			(uint32_t)t->v[INTERP_TECH_ABORT_COUNT];
	if (every_s > 0)
		c->jump.every.cycles = (uint64_t)fmax(1, floor(
			every_s / period_s(c) + 0.5));
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

/* The value of the machine file; NAN for a field that its [gap] does not
 * have. */
static double machine_value(const struct cycle *c, size_t row)
{
	const size_t at = rows[row].at - AT(gap);

	return rows[row].at >= AT(gap) && at < sizeof(c->gap) ?
	       *(const double *)(const void *)
			((const char *)&c->config.gap + at) : NAN;
}

/* Are these values, put over those of this machine, in order? */
static bool fits(const struct cycle *c, const struct interp_tech *t)
{
	struct interp_tech sum;

	if (gives_nothing(t))
		return true;
	if (!interp_tech_ok(t))
		return false;
	interp_tech_clear(&sum);
	for (size_t i = 0; i < NROWS; i++)
		sum.v[rows[i].id] = machine_value(c, i);
	interp_tech_over(&sum, t);
	return !interp_tech_order(&sum);
}

static bool apply(struct cycle *c, uint16_t cond)
{
	const struct interp_tech t = wanted(c, cond);

	if (!fits(c, &t))
		return false;
	c->conditions.cond = cond;
	put(c, &t);
	return true;
}

bool conditions_begin(struct cycle *c)
{
	c->conditions.nsets = 0;
	c->conditions.said = false;
	return apply(c, c->cursor.seg.cond);
}

bool conditions_follow(struct cycle *c)
{
	return c->cursor.seg.cond == c->conditions.cond ||
	       apply(c, c->cursor.seg.cond);
}

void conditions_say(struct cycle *c, bool negative)
{
	c->conditions.said = true;
	c->conditions.said_negative = negative;
	put_polarity(c);
}

/* -- set ------------------------------------------------------------------- */

static bool is_used(uint32_t field)
{
	for (size_t i = 0; i < NROWS; i++) {
		if (rows[i].id == field)
			return true;
	}
	return field == INTERP_TECH_JUMP_EVERY_S ||
	       field == INTERP_TECH_ABORT_COUNT ||
	       field == INTERP_TECH_ISO || field == INTERP_TECH_POLARITY;
}

/* The slot where the field is set in this condition, or where it would be
 * set. */
static uint32_t place_of(const struct conditions *p, uint32_t field)
{
	uint32_t i = 0;

	while (i < p->nsets && !(p->set[i].cond == p->cond &&
				 p->set[i].field == field))
		i++;
	return i;
}

static void change(struct conditions *p, uint32_t at, uint32_t field,
		   double value)
{
	if (!isnan(value)) {
		p->nsets += at == p->nsets;
		p->set[at] = (struct conditions_set) { value, p->cond,
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

	if (!is_used(field))
		return CONDITIONS_BAD;
	if (!isnan(value) &&
	    !interp_tech_value_ok((enum interp_tech_id)field, value))
		return CONDITIONS_BAD;
	if (at == CONDITIONS_SETS_MAX && !isnan(value))
		return CONDITIONS_FULL;
	change(&c->conditions, at, field, value);
	if (apply(c, was.cond))
		return CONDITIONS_DONE;
	c->conditions = was;
	return CONDITIONS_BAD;
}

static bool restores(struct cycle *c, const struct conditions_set *s)
{
	struct interp_tech t;

	if (s->cond >= c->cursor.p.head->nconds || !is_used(s->field) ||
	    !interp_tech_value_ok((enum interp_tech_id)s->field, s->value))
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
	switch (field) {
	case INTERP_TECH_JUMP_EVERY_S:
		return (double)c->jump.every.cycles * period_s(c);
	case INTERP_TECH_ABORT_COUNT:
		return c->gap.abort_count;
	case INTERP_TECH_ISO:
		return c->out.pulse.iso;
	case INTERP_TECH_POLARITY:
		return c->out.negative ? -1 : 1;
	default:
		break;
	}
	for (size_t i = 0; i < NROWS; i++) {
		if (rows[i].id == field)
			return *(const double *)(const void *)
				((const char *)c + rows[i].at);
	}
	return NAN;
}
