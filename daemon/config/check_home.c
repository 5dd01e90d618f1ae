/* SPDX-License-Identifier: Apache-2.0 */
/* check_home.c - whether the machine can find its places as it is told to */
#include "keys.h"

#include "cycle.h"

#include <errno.h>
#include <string.h>

/* What a method needs of the backend: backends.h has what each backend has. */
static const uint32_t needs[HOME_NMETHODS] = {
	[HOME_NONE]		= 0,
	[HOME_SWITCH]		= MACHINE_SWITCHES,
	[HOME_SWITCH_INDEX]	= MACHINE_SWITCHES | MACHINE_INDEX,
	[HOME_ABSOLUTE]		= MACHINE_OWN_PLACE,
};

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

static int refuse(struct check *q, int axis)
{
	const int k = config_key_find(SECTION_AXIS, "home_method");
	const int b = config_key_find(SECTION_MACHINE, "backend");
	const uint32_t at = q->lines->at[k][axis];

	q->diag->line = at ? at : q->lines->at[b][0];
	q->diag->column = 0;
	return -EINVAL;
}

static bool can(const struct machine_config *c, int method)
{
	return (config_backend(c)->is & needs[method]) == needs[method];
}

static int refuse_method(struct check *q, int axis)
{
	const struct config_key *k =
		config_key(config_key_find(SECTION_AXIS, "home_method"));
	char words[64] = "";

	for (int i = 0; i < HOME_NMETHODS; i++)
		if (can(q->c, i))
			snprintf(words + strlen(words),
				 sizeof(words) - strlen(words), "%s%s",
				 *words ? ", " : "", k->word(i));
	interp_diag_say(q->diag, "axis.%c.home_method %s, which backend %s "
			"cannot do; one of %s", INTERP_AXIS_LETTERS[axis],
			k->word((int)q->c->manual[axis].method),
			config_backend(q->c)->name, words);
	return refuse(q, axis);
}

/* The line is one of [gpio]; a model has all switches. */
static int check_line(struct check *q, int axis)
{
	struct config_line_at at;

	config_line_read(q->c->gpio.line[LINE_HOME + axis], &at);
	if (at.wired || q->c->manual[axis].method != HOME_SWITCH ||
	    config_machine_is(q->c, MACHINE_NO_WIRES))
		return 0;
	interp_diag_say(q->diag, "axis.%c.home_method switch and gpio.home_%c "
			"is none; gpio.home_%c = the number of a line, or "
			"home_method = none", INTERP_AXIS_LETTERS[axis],
			INTERP_AXIS_LETTERS[axis], INTERP_AXIS_LETTERS[axis]);
	return refuse(q, axis);
}

/* The count of another drive begins anywhere. */
static int check_absolute(struct check *q, int axis)
{
	if (q->c->manual[axis].method != HOME_ABSOLUTE ||
	    !config_machine_is(q->c, MACHINE_DRIVES) ||
	    q->c->drive[axis].absolute)
		return 0;
	interp_diag_say(q->diag, "axis.%c.home_method absolute of a drive that "
			"is not; absolute = yes, if the drive knows its place "
			"when it is switched on, or home_method = none",
			INTERP_AXIS_LETTERS[axis]);
	return refuse(q, axis);
}

int config_check_home(const struct machine_config *c,
		      const struct config_lines *lines,
		      struct interp_diag *diag)
{
	struct check q = { c, lines, diag };

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(c->axes.present >> i & 1))
			continue;
		if (!can(c, (int)c->manual[i].method))
			return refuse_method(&q, i);
		if (check_line(&q, i) || check_absolute(&q, i))
			return -EINVAL;
	}
	return 0;
}
