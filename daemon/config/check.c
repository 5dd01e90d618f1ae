/* SPDX-License-Identifier: Apache-2.0 */
/* check.c - checks that need more than one key */
#include "keys.h"

#include "gap/gap.h"

#include "interp/feedforward.h"

#include <assert.h>
#include <errno.h>
#include <math.h>

#define PERIOD_MIN_US	20		/* a shorter period is a mistake of
					 * units */
#define COUNT(a)	(sizeof(a) / sizeof((a)[0]))

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
	{ SECTION_JUMP, "every_min_s", "every_max_s", true },
	{ SECTION_JUMP, "height_min_mm", "height_max_mm", true },
	{ SECTION_SIM, "spark_v", "open_v", false },
	{ SECTION_SIM, "short_gap_mm", "best_gap_mm", false },
	{ SECTION_SIM, "best_gap_mm", "open_gap_mm", false },
};

/* The same for keys whose 0 means "as the machine has it". */
static const struct order orders_if_set[] = {
	{ SECTION_GAP, "window_low_v", "window_high_v", true },
	{ SECTION_GAP, "short_v", "window_low_v", false },
	{ SECTION_GAP, "window_low_v", "servo_v", true },
	{ SECTION_GAP, "servo_v", "window_high_v", true },
	{ SECTION_GAP, "window_high_v", "open_v", false },
	{ SECTION_GAP, "open_v", "ignition_v", false },
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

/* The message points to the later of the two keys. */
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
	const struct config_key *low = config_key(a), *high = config_key(b);
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
	return interp_diag_say(q->diag, "%s.%s %s%s is not %s %s %s%s; %s %s "
			       "%s", section, o->low, xs, unit, how, o->high,
			       ys, unit, o->low, how, o->high);
}

static bool is_set(const struct check *q, enum config_section_id s,
		   const char *name)
{
	return *(const double *)config_key_in(config_key(key_of(s, name)), 0,
					      q->c) != 0;
}

static int check_orders_if_set(struct check *q)
{
	for (size_t i = 0; i < COUNT(orders_if_set); i++) {
		const struct order *o = &orders_if_set[i];

		if (is_set(q, o->section, o->low) &&
		    is_set(q, o->section, o->high) && check_order(q, o, 0))
			return -EINVAL;
	}
	return 0;
}

static int check_extent(struct check *q, const char *name, int instance)
{
	int k = key_of(SECTION_AXIS, name);
	double x = *(const double *)config_key_in(config_key(k), instance,
						  q->c);
	double pulse_mm = q->c->axes.axis[instance].pulse_mm;
	char unit[16], xs[32];

	if (fabs(x / pulse_mm) <= INTERP_PULSES_MAX)
		return 0;

	blame(q, k, key_of(SECTION_AXIS, "pulse_mm"), instance);
	config_key_unit(config_key(k), instance, unit, sizeof(unit));
	config_number(x, xs, sizeof(xs));
	return interp_diag_say(q->diag, "axis.%s.%s %s%s is %.0f pulses; at "
			       "most %d pulses either way: %.6g%s with this "
			       "pulse_mm",
			       config_section[SECTION_AXIS].instance[instance],
			       name, xs, unit, x / pulse_mm, INTERP_PULSES_MAX,
			       INTERP_PULSES_MAX * pulse_mm, unit);
}

static int check_period(struct check *q)
{
	int k = key_of(SECTION_MACHINE, "period_us");

	if (q->c->period_us == 0 || q->c->period_us >= PERIOD_MIN_US)
		return 0;

	blame(q, k, k, 0);
	return interp_diag_say(q->diag, "machine.period_us %g us is too "
			       "short; 0 for the backend's own, or %d us and "
			       "more", q->c->period_us, PERIOD_MIN_US);
}

static int check_present(struct check *q)
{
	int k = key_of(SECTION_AXIS, "present");

	if (q->c->axes.present)
		return 0;

	blame(q, k, k, INTERP_NAXES - 1);
	return interp_diag_say(q->diag, "no axis is present; at least one "
			       "[axis.*] with present = yes");
}

static int check_compensation(struct check *q)
{
	const int k = key_of(SECTION_CONTOUR, "method");
	const int methods = interp_compensate_parse(q->c->contour.method);
	const int both = INTERP_COMPENSATE_FEEDFORWARD |
			 INTERP_COMPENSATE_ZPETC;

	if (methods >= 0 && (methods & both) != both)
		return 0;
	blame(q, k, k, 0);
	return interp_diag_say(q->diag, "contour.method %.40s; none, or of "
			       "feedforward, cross-coupled, predictive, "
			       "zpetc joined by +, feedforward and zpetc not "
			       "together", q->c->contour.method);
}

/* The longest travel of any linear axis, @ret_axis; 0: there is none. */
static double config_longest_mm(const struct machine_config *c, int *ret_axis)
{
	double most = 0;

	*ret_axis = INTERP_Z;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &c->axes.axis[i];
		double travel = l->travel_max_mm - l->travel_min_mm;

		if (interp_axis_is_rotary((enum interp_axis)i) ||
		    !(c->axes.present & 1u << i) || travel <= most)
			continue;
		most = travel;
		*ret_axis = i;
	}
	return most;
}

/* A jump goes along the path, and the path lies within the travel. */
static int check_jump(struct check *q, const char *name)
{
	int k = key_of(SECTION_JUMP, name), axis;
	double mm = *(const double *)config_key_in(config_key(k), 0, q->c);
	double most = config_longest_mm(q->c, &axis);
	uint32_t at = q->lines->at[k][0], travel_at;

	if (mm <= most || most == 0)
		return 0;

	travel_at = q->lines->at[key_of(SECTION_AXIS, "travel_max_mm")][axis];
	q->diag->line = at > travel_at ? at : travel_at;
	q->diag->column = 0;
	return interp_diag_say(q->diag, "jump.%s %g mm is higher than any "
			       "axis travels; at most %g mm, the travel of "
			       "axis.%s", name, mm, most,
			       config_section[SECTION_AXIS].instance[axis]);
}

/* The guides are X Y below and U V above. */
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
		return interp_diag_say(q->diag, "wire.guides without an axis "
				       "%c; X Y U V present, or guides = off",
				       INTERP_AXIS_LETTERS[four[i]]);
	}
	return 0;
}

bool config_jump_fits(const struct machine_config *c, double mm, char *wanted,
		      size_t size)
{
	int axis;
	const double most = config_longest_mm(c, &axis);

	if (!(mm > most) || most == 0)
		return true;
	snprintf(wanted, size, "at most %g mm, the travel of axis.%c", most,
		 INTERP_AXIS_LETTERS[axis]);
	return false;
}

int config_check(const struct machine_config *c,
		 const struct config_lines *lines, struct interp_diag *diag)
{
	struct check q = { c, lines, diag };
	const struct config_backend *backend = config_backend(c);

	for (size_t i = 0; i < COUNT(orders); i++)
		for (int j = 0;
		     j < config_section[orders[i].section].ninstances; j++)
			if (check_order(&q, &orders[i], j))
				return -EINVAL;

	for (int j = 0; j < INTERP_NAXES; j++)
		if (check_extent(&q, "travel_min_mm", j) ||
		    check_extent(&q, "travel_max_mm", j))
			return -EINVAL;

	if (backend->check && backend->check(c, lines, diag))
		return -EINVAL;
	return check_period(&q) || check_present(&q) ||
	       check_guides(&q) || config_check_home(c, lines, diag) ||
	       config_check_generator(c, lines, diag) ||
	       config_check_plc(c, lines, diag) ||
	       config_check_sim(c, lines, diag) ||
	       check_orders_if_set(&q) || check_jump(&q, "height_mm") ||
	       (c->jump.adaptive && check_jump(&q, "height_max_mm")) ||
	       check_compensation(&q) ? -EINVAL : 0;
}
