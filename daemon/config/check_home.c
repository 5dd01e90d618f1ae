/* SPDX-License-Identifier: Apache-2.0 */
/* check_home.c - whether the machine can find its places as it is told to */
#include "drives.h"
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
	[HOME_DRIVE]		= MACHINE_HOMES,
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

static const char *word_of(const struct machine_config *c, int axis)
{
	return config_key(config_key_find(SECTION_AXIS, "home_method"))->word(
		(int)c->manual[axis].method);
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
			word_of(q->c, axis),
			config_backend(q->c)->name, words);
	return refuse(q, axis);
}

/* An input of its drive, or a line of [gpio]; a model has all switches. */
static bool has_switch(const struct machine_config *c, int axis)
{
	struct config_input input[CONFIG_NINPUTS];
	struct config_line_at at;
	struct interp_diag none;

	if (config_machine_is(c, MACHINE_NO_WIRES))
		return true;
	if (config_machine_is(c, MACHINE_DRIVES)) {
		config_drive_inputs(c->drive[axis].inputs, input, &none);
		return input[INPUT_HOME].wired;
	}
	config_line_read(c->gpio.line[LINE_HOME + axis], &at);
	return at.wired;
}

static int check_switch(struct check *q, int axis)
{
	if (!(needs[q->c->manual[axis].method] & MACHINE_SWITCHES) ||
	    has_switch(q->c, axis))
		return 0;
	if (config_machine_is(q->c, MACHINE_DRIVES)) {
		interp_diag_say(q->diag, "axis.%c.home_method %s and no home "
				"in its drive_inputs; drive_inputs = home:2, "
				"with the bit of object 60FD, or home_method = "
				"none",
				INTERP_AXIS_LETTERS[axis], word_of(q->c, axis));
		return refuse(q, axis);
	}
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

/* Its own method has a number. */
static int check_drive(struct check *q, int axis)
{
	if (q->c->manual[axis].method != HOME_DRIVE ||
	    q->c->drive[axis].home != 0)
		return 0;
	interp_diag_say(q->diag, "axis.%c.home_method drive and no drive_home; "
			"drive_home = the number of its method, object 6098: "
			"1 to 34, 35 or 37 where it stands, or the maker's "
			"own; or home_method = none",
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
		if (check_switch(&q, i) || check_absolute(&q, i) ||
		    check_drive(&q, i))
			return -EINVAL;
	}
	return 0;
}
