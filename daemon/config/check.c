/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check.c - what one key alone cannot tell
 */
#include "keys.h"

#include <assert.h>
#include <errno.h>
#include <math.h>

#define PERIOD_MIN_US	20		/* a shorter one is a slip of units */

/* @low is below @high in every instance of the section. */
struct order {
	enum config_section_id section;
	const char *low, *high;
	bool or_equal;
};

static const struct order orders[] = {
	{ SECTION_AXIS, "travel_min_mm", "travel_max_mm", false },
	{ SECTION_AXIS, "travel_min_mm", "start_mm", true },
	{ SECTION_AXIS, "start_mm", "travel_max_mm", true },
	{ SECTION_WIRE, "z_lower_mm", "z_upper_mm", false },
	{ SECTION_WIRE, "z_program_mm", "z_second_mm", false },
	{ SECTION_GAP, "short_v", "servo_v", false },
	{ SECTION_GAP, "servo_v", "open_v", false },
	{ SECTION_SIM, "spark_v", "open_v", false },
	{ SECTION_SIM, "short_gap_mm", "best_gap_mm", false },
	{ SECTION_SIM, "best_gap_mm", "open_gap_mm", false },
};

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

static int key_of(enum config_section_id s, const char *name)
{
	int k = config_key_find(s, name);

	assert(k >= 0);
	return k;
}

/* The file is to be mended where the later of the two keys stands. */
static void blame(struct check *q, int key_a, int key_b, int instance)
{
	uint32_t a = q->lines->at[key_a][instance];
	uint32_t b = q->lines->at[key_b][instance];

	q->diag->line = a > b ? a : b;
	q->diag->column = 0;
}

static int check_order(struct check *q, const struct order *o, int instance)
{
	int a = key_of(o->section, o->low), b = key_of(o->section, o->high);
	const struct config_key *low = &config_key[a], *high = &config_key[b];
	double x = *(const double *)config_key_in(low, instance, q->c);
	double y = *(const double *)config_key_in(high, instance, q->c);
	const char *how = o->or_equal ? "at most" : "below";
	char section[32], unit[16], xs[32], ys[32];

	if (o->or_equal ? x <= y : x < y)
		return 0;

	blame(q, a, b, instance);
	config_section_name(o->section, instance, section, sizeof(section));
	config_key_unit(low, instance, unit, sizeof(unit));
	config_number(x, xs, sizeof(xs));
	config_number(y, ys, sizeof(ys));
	snprintf(q->diag->found, sizeof(q->diag->found),
		 "%s.%s %s%s is not %s %s %s%s", section, o->low, xs, unit,
		 how, o->high, ys, unit);
	snprintf(q->diag->wanted, sizeof(q->diag->wanted), "%s %s %s",
		 o->low, how, o->high);
	return -EINVAL;
}

static int check_extent(struct check *q, const char *name, int instance)
{
	int k = key_of(SECTION_AXIS, name);
	double x = *(const double *)config_key_in(&config_key[k], instance,
						  q->c);
	double pulse_mm = q->c->axes.axis[instance].pulse_mm;
	char unit[16], xs[32];

	if (fabs(x / pulse_mm) <= INTERP_PULSES_MAX)
		return 0;

	blame(q, k, key_of(SECTION_AXIS, "pulse_mm"), instance);
	config_key_unit(&config_key[k], instance, unit, sizeof(unit));
	config_number(x, xs, sizeof(xs));
	snprintf(q->diag->found, sizeof(q->diag->found),
		 "axis.%s.%s %s%s is %.0f pulses",
		 config_section[SECTION_AXIS].instance[instance], name, xs,
		 unit, x / pulse_mm);
	snprintf(q->diag->wanted, sizeof(q->diag->wanted),
		 "at most %d pulses either way: %.6g%s with this pulse_mm",
		 INTERP_PULSES_MAX, INTERP_PULSES_MAX * pulse_mm, unit);
	return -EINVAL;
}

static int check_period(struct check *q)
{
	int k = key_of(SECTION_MACHINE, "period_us");

	if (q->c->period_us == 0 || q->c->period_us >= PERIOD_MIN_US)
		return 0;

	blame(q, k, k, 0);
	snprintf(q->diag->found, sizeof(q->diag->found),
		 "machine.period_us %g us is too short", q->c->period_us);
	snprintf(q->diag->wanted, sizeof(q->diag->wanted),
		 "0 for the backend's own, or %d us and more", PERIOD_MIN_US);
	return -EINVAL;
}

static int check_present(struct check *q)
{
	int k = key_of(SECTION_AXIS, "present");

	if (q->c->axes.present)
		return 0;

	blame(q, k, k, INTERP_NAXES - 1);
	snprintf(q->diag->found, sizeof(q->diag->found), "no axis is present");
	snprintf(q->diag->wanted, sizeof(q->diag->wanted),
		 "at least one [axis.*] with present = yes");
	return -EINVAL;
}

/* Guides are X Y below and U V above. */
static int check_guides(struct check *q)
{
	static const int four[] = { INTERP_X, INTERP_Y, INTERP_U, INTERP_V };
	int k = key_of(SECTION_WIRE, "guides");

	if (q->c->wire.guides == INTERP_GUIDES_OFF)
		return 0;
	for (int i = 0; i < 4; i++) {
		if (q->c->axes.present & 1u << four[i])
			continue;
		blame(q, k, k, 0);
		snprintf(q->diag->found, sizeof(q->diag->found),
			 "wire.guides without an axis %c",
			 INTERP_AXIS_LETTERS[four[i]]);
		snprintf(q->diag->wanted, sizeof(q->diag->wanted),
			 "X Y U V present, or guides = off");
		return -EINVAL;
	}
	return 0;
}

int config_check(const struct machine_config *c,
		 const struct config_lines *lines, struct interp_diag *diag)
{
	struct check q = { c, lines, diag };
	size_t norders = sizeof(orders) / sizeof(orders[0]);

	for (size_t i = 0; i < norders; i++)
		for (int j = 0;
		     j < config_section[orders[i].section].ninstances; j++)
			if (check_order(&q, &orders[i], j))
				return -EINVAL;

	for (int j = 0; j < INTERP_NAXES; j++)
		if (check_extent(&q, "travel_min_mm", j) ||
		    check_extent(&q, "travel_max_mm", j))
			return -EINVAL;

	return check_period(&q) || check_present(&q) || check_guides(&q) ?
	       -EINVAL : 0;
}
