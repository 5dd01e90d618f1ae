/* SPDX-License-Identifier: Apache-2.0 */
/* check_can402.c - checks of a CAN bus of drives */
#include "drives.h"
#include "keys.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* In both directions from 0; a drive counts modulo 2^32. */
#define INCREMENTS_MAX	2147483647.0

struct check {
	const struct machine_config *c;
	const struct config_lines *lines;
	struct interp_diag *diag;
};

static uint32_t line_of(const struct check *q, enum config_section_id s,
			const char *key, int instance)
{
	return q->lines->at[config_key_find(s, key)][instance];
}

/* Found and wanted are filled; the line is that of @key, or that of the
 * backend. */
static int refuse(struct check *q, enum config_section_id s, const char *key,
		  int instance)
{
	const uint32_t line = line_of(q, s, key, instance);

	q->diag->line = line ? line :
			line_of(q, SECTION_MACHINE, "backend", 0);
	q->diag->column = 0;
	return -EINVAL;
}

static uint32_t node_of(const struct check *q, int axis)
{
	return (uint32_t)q->c->can402.node[axis];
}

/* Each axis has a node of its own, and each node belongs to an axis that is
 * present. */
static int check_node(struct check *q, int axis)
{
	const uint32_t node = node_of(q, axis);
	const bool present = q->c->axes.present >> axis & 1;
	bool twice = node == (uint32_t)q->c->can402.master_node;
	char name[16];

	for (int i = 0; i < axis; i++)
		twice = twice || node == node_of(q, i);
	if (node == 0 || (present && !twice))
		return 0;
	snprintf(name, sizeof(name), "node_%c", INTERP_AXIS_LETTERS[axis]);
	interp_diag_say(q->diag,
			"can402.%s %u %s; a node of its own for each axis that "
			"is present, and not master_node",
			name, node,
			present ? "a second time" :
				  "for an axis that is not present");
	return refuse(q, SECTION_CAN402, name, 0);
}

/* The farthest place of an axis, as a drive counts it. */
static int check_increments(struct check *q, int axis)
{
	const struct interp_axis_limits *l = &q->c->axes.axis[axis];
	const struct config_drive *d = &q->c->drive[axis];
	const double mm = fmax(fabs(l->travel_min_mm),
			       fabs(l->travel_max_mm));
	const double increments = fabs(d->increments / d->pulses) * mm /
				  l->pulse_mm;

	if (node_of(q, axis) == 0 ||
	    (d->increments != 0 && increments < INCREMENTS_MAX))
		return 0;
	interp_diag_say(q->diag, "axis.%c.drive_increments %.0f: its travel "
			"reaches to %.0f; not 0, and a travel within %.0f "
			"increments of 0", INTERP_AXIS_LETTERS[axis],
			d->increments, increments, INCREMENTS_MAX);
	return refuse(q, SECTION_AXIS, "drive_increments", axis);
}

/* An axis that may fall must say what holds it. */
static int check_brake(struct check *q, int axis)
{
	if (node_of(q, axis) == 0 || axis != INTERP_Z ||
	    q->c->drive[axis].brake != BRAKE_UNSAID)
		return 0;
	interp_diag_say(q->diag, "axis.Z.brake: not told; free: it stays "
				 "where it is without power; drive: the "
				 "drive's own brake holds it; none: it is "
				 "held under torque; line: the brake on "
				 "gpio.brake_Z holds it");
	return refuse(q, SECTION_AXIS, "brake", axis);
}

/* Found has the word; the key comes before it. */
static int refuse_list(struct check *q, const char *key, int axis)
{
	char word[sizeof(q->diag->found)];

	memcpy(word, q->diag->found, sizeof(word));
	snprintf(q->diag->found, sizeof(q->diag->found), "axis.%c.%s: %.60s",
		 INTERP_AXIS_LETTERS[axis], key, word);
	return refuse(q, SECTION_AXIS, key, axis);
}

static int check_lists(struct check *q, int axis)
{
	const struct config_drive *d = &q->c->drive[axis];
	struct config_object object[CONFIG_SDO_MAX];
	struct config_input input[CONFIG_NINPUTS];
	uint16_t leave[CONFIG_LEAVE_MAX];
	uint32_t identity[4];
	uint8_t given;

	if (node_of(q, axis) == 0)
		return 0;
	if (config_drive_sdo(d->sdo, object, q->diag) < 0)
		return refuse_list(q, "drive_sdo", axis);
	if (config_drive_inputs(d->inputs, input, q->diag) < 0)
		return refuse_list(q, "drive_inputs", axis);
	if (config_drive_leave(d->leave, leave, q->diag) < 0)
		return refuse_list(q, "drive_leave", axis);
	if (config_drive_identity(d->identity, identity, &given, q->diag) < 0)
		return refuse_list(q, "drive_identity", axis);
	return 0;
}

/* Otherwise the fault of a lag could never be left by reset and start. */
static int check_following(struct check *q)
{
	const struct config_can402 *k = &q->c->can402;

	if (k->following_mm < k->resync_mm)
		return 0;
	interp_diag_say(q->diag, "can402.following_mm %g with resync_mm %g; "
			"following_mm below resync_mm: an axis that is off by "
			"more than following_mm is a fault, and reset and "
			"start bring it back", k->following_mm, k->resync_mm);
	return refuse(q, SECTION_CAN402, "following_mm", 0);
}

bool config_frame_is_free(const struct machine_config *c, uint32_t id)
{
	bool taken = id < 0x180 || id >= 0x580;

	for (int i = 0; i < INTERP_NAXES; i++)
		taken = taken || (c->can402.node[i] > 0 &&
				  (uint32_t)c->can402.node[i] == (id & 0x7f));
	return !taken;
}

static int check_gap_id(struct check *q)
{
	const uint32_t id = (uint32_t)q->c->can402.gap_id;

	if (id == 0 || config_frame_is_free(q->c, id))
		return 0;
	interp_diag_say(q->diag, "can402.gap_id %u, which is in use; "
			CONFIG_FRAME_WANTED, id);
	return refuse(q, SECTION_CAN402, "gap_id", 0);
}

int config_check_can402(const struct machine_config *c,
			const struct config_lines *lines,
			struct interp_diag *diag)
{
	struct check q = { c, lines, diag };
	bool any = false;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (check_node(&q, i) || check_increments(&q, i) ||
		    check_brake(&q, i) || check_lists(&q, i))
			return -EINVAL;
		any = any || node_of(&q, i) > 0;
	}
	if (config_check_brakes(c, lines, diag) || check_following(&q) ||
	    check_gap_id(&q))
		return -EINVAL;
	if (any)
		return 0;
	interp_diag_say(diag, "backend can402 without a drive; [can402] with "
			"node_X or another axis's");
	return refuse(&q, SECTION_MACHINE, "backend", 0);
}
