/* SPDX-License-Identifier: Apache-2.0 */
/*
 * field.c - the fields of a technology condition
 */
#include "interp/tech.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define FIELD(id, ...)	[INTERP_TECH_##id] = { __VA_ARGS__ },

const struct interp_tech_field interp_tech_field[INTERP_NTECH] = {
	INTERP_TECH_ROWS(FIELD)
};

void interp_tech_clear(struct interp_tech *t)
{
	for (int i = 0; i < INTERP_NTECH; i++)
		t->v[i] = NAN;
}

bool interp_tech_value_ok(enum interp_tech_id id, double value)
{
	const struct interp_tech_field *f = &interp_tech_field[id];

	if (!(value >= f->min && value <= f->max))
		return false;
	if (f->whole && value != floor(value))
		return false;
	return id != INTERP_TECH_POLARITY || value != 0;
}

bool interp_tech_ok(const struct interp_tech *t)
{
	for (int i = 0; i < INTERP_NTECH; i++) {
		const enum interp_tech_id id = (enum interp_tech_id)i;

		if (interp_tech_given(t, id) &&
		    !interp_tech_value_ok(id, t->v[i]))
			return false;
	}
	return true;
}

void interp_tech_over(struct interp_tech *t, const struct interp_tech *over)
{
	for (int i = 0; i < INTERP_NTECH; i++) {
		if (interp_tech_given(over, (enum interp_tech_id)i))
			t->v[i] = over->v[i];
	}
}

static const struct interp_tech_order orders[] = {
	{ INTERP_TECH_SHORT_V, INTERP_TECH_SERVO_V, false },
	{ INTERP_TECH_SERVO_V, INTERP_TECH_OPEN_V, false },
	{ INTERP_TECH_WINDOW_LOW_V, INTERP_TECH_WINDOW_HIGH_V, true },
	{ INTERP_TECH_WINDOW_LOW_V, INTERP_TECH_SERVO_V, true },
	{ INTERP_TECH_SERVO_V, INTERP_TECH_WINDOW_HIGH_V, true },
	{ INTERP_TECH_SHORT_V, INTERP_TECH_WINDOW_LOW_V, false },
	{ INTERP_TECH_WINDOW_HIGH_V, INTERP_TECH_OPEN_V, false },
	{ INTERP_TECH_SHORT_V, INTERP_TECH_OPEN_V, false },
	{ INTERP_TECH_OPEN_V, INTERP_TECH_IGNITION_V, false },
};

/* A limit of the window that is 0 is derived from servo_v. */
static bool counts(const struct interp_tech *t, enum interp_tech_id id)
{
	const bool window = id == INTERP_TECH_WINDOW_LOW_V ||
			    id == INTERP_TECH_WINDOW_HIGH_V;

	return interp_tech_given(t, id) && !(window && t->v[id] == 0);
}

const struct interp_tech_order *interp_tech_order(const struct interp_tech *t)
{
	for (size_t i = 0; i < sizeof(orders) / sizeof(orders[0]); i++) {
		const struct interp_tech_order *o = &orders[i];
		const double low = t->v[o->low], high = t->v[o->high];

		if (!counts(t, o->low) || !counts(t, o->high))
			continue;
		if (!(o->or_equal ? low <= high : low < high))
			return o;
	}
	return NULL;
}

int interp_tech_find(const char *name)
{
	for (int i = 0; i < INTERP_NTECH; i++) {
		if (strcmp(interp_tech_field[i].name, name) == 0)
			return i;
	}
	return -ENOENT;
}

static double or_zero(const struct interp_tech *t, enum interp_tech_id id)
{
	return interp_tech_given(t, id) ? t->v[id] : 0;
}

double interp_tech_short_of_mm(const struct interp_tech *t,
			       const struct interp_tech *last)
{
	double mm = or_zero(t, INTERP_TECH_ALLOWANCE_MM);

	if (interp_tech_given(t, INTERP_TECH_GAP_MM) &&
	    interp_tech_given(last, INTERP_TECH_GAP_MM))
		mm += t->v[INTERP_TECH_GAP_MM] - last->v[INTERP_TECH_GAP_MM];
	return mm > 0 ? mm : 0;
}
