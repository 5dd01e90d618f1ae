/* SPDX-License-Identifier: Apache-2.0 */
/*
 * field.c - the fields of a technology condition
 */
#include "interp/tech.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* Where the machine file has the same value, its range is the same. */
/* clang-format off */
const struct interp_tech_field interp_tech_field[INTERP_NTECH] = {
	[INTERP_TECH_PEAK_A] = { "peak_a", "A", 0, 1000,
		false, "peak current of a pulse" },
	[INTERP_TECH_ON_US] = { "on_us", "us", 0.1, 100000,
		false, "length of a pulse" },
	[INTERP_TECH_OFF_US] = { "off_us", "us", 0.1, 100000,
		false, "pause after a pulse" },
	[INTERP_TECH_POLARITY] = { "polarity", "", -1, 1,
		true, "of the electrode: 1 positive, -1 negative" },
	[INTERP_TECH_IGNITION_V] = { "ignition_v", "V", 10, 1000,
		false, "open-circuit voltage" },
	[INTERP_TECH_ISO] = { "iso", "", 0, 1,
		true, "1: the pulse is timed from its ignition" },
	[INTERP_TECH_SERVO_V] = { "servo_v", "V", 0.1, 500,
		false, "mean gap voltage to hold" },
	[INTERP_TECH_WINDOW_LOW_V] = { "window_low_v", "V", 0, 500,
		false, "the servo stands from here ..." },
	[INTERP_TECH_WINDOW_HIGH_V] = { "window_high_v", "V", 0, 500,
		false, "... to here" },
	[INTERP_TECH_SHORT_V] = { "short_v", "V", 0, 500,
		false, "below: a short circuit" },
	[INTERP_TECH_OPEN_V] = { "open_v", "V", 0.1, 500,
		false, "above: no sparks yet" },
	[INTERP_TECH_GAIN_MM_S_V] = { "gain_mm_s_v", "mm/s/V", 1e-6, 10,
		false, "feed per volt outside the window" },
	[INTERP_TECH_INTEGRAL_S] = { "integral_s", "s", 0, 1000,
		false, "reset time of the integral; 0: none" },
	[INTERP_TECH_FEED_MAX_MM_S] = { "feed_max_mm_s", "mm/s", 1e-6, 100,
		false, "fastest feed while eroding" },
	[INTERP_TECH_RETRACT_MM_S] = { "retract_mm_s", "mm/s", 0.001, 1000,
		false, "back along the path on a short" },
	[INTERP_TECH_ABORT_COUNT] = { "abort_count", "", 0, 1e9,
		true,
		"retracts without erosion between, then a fault; 0: never" },
	[INTERP_TECH_JUMP_MM] = { "jump_mm", "mm", 0, 500,
		false, "height of a jump; 0: none" },
	[INTERP_TECH_JUMP_EVERY_S] = { "jump_every_s", "s", 0.01, 86400,
		false, "erosion between two jumps" },
	[INTERP_TECH_JUMP_DEPTH_MM] = { "jump_depth_mm", "mm", 0, 1000,
		false, "depth eroded between two jumps; 0: by time" },
	[INTERP_TECH_JUMP_SHORT_OF_MM] = { "jump_short_of_mm", "mm", 0, 10,
		false, "a jump comes back to this far above the cut" },
	[INTERP_TECH_GAP_MM] = { "gap_mm", "mm", 0, 10,
		false, "spark gap, per side" },
	[INTERP_TECH_ALLOWANCE_MM] = { "allowance_mm", "mm", 0, 100,
		false, "left for the conditions after it, per side" },
	[INTERP_TECH_ORBIT_MM] = { "orbit_mm", "mm", 0, 100,
		false, "radius of the orbit, per side" },
	[INTERP_TECH_ORBIT_STEP_DEG] = { "orbit_step_deg", "deg", 0, 90,
		false, "step of a spherical orbit" },
	[INTERP_TECH_REMOVAL_MM3_MIN] = { "removal_mm3_min", "mm3/min",
		0, 1e6, false, "removal to expect" },
	[INTERP_TECH_WEAR] = { "wear", "", 0, 10,
		false, "electrode lost per part removed" },
	[INTERP_TECH_ROUGHNESS_UM] = { "roughness_um", "um Ra", 0, 1000,
		false, "surface to expect" },
};
/* clang-format on */

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

double interp_tech_orbit_mm(const struct interp_tech *t, double undersize_mm)
{
	const double mm = undersize_mm - or_zero(t, INTERP_TECH_GAP_MM) -
			  or_zero(t, INTERP_TECH_ALLOWANCE_MM);

	return mm > 0 ? mm : 0;
}
