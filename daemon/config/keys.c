/* SPDX-License-Identifier: Apache-2.0 */
/*
 * keys.c - the sections of the machine file, and the table of all its keys
 */
#include "keys_rows.h"

#include <assert.h>

static const char *const axes[INTERP_NAXES] = {
	"X", "Y", "Z", "A", "B", "C", "U", "V"
};

static const char *const works[INTERP_NC_NWORK] = {
	"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"
};

const struct config_section config_section[CONFIG_NSECTIONS] = {
	[SECTION_MACHINE] = { "machine", NULL, 1,
		"the controller and its cycle" },
	[SECTION_AXIS] = { "axis", axes, INTERP_NAXES,
		"one axis: its pulse, travel and limits; A B C are rotary" },
	[SECTION_WORK] = { "work", works, INTERP_NC_NWORK,
		"origin of a work coordinate system, in machine coordinates" },
	[SECTION_WIRE] = { "wire", NULL, 1,
		"a wire machine's guides, planes and corners; docs/taper.md" },
	[SECTION_KINEMATICS] = { "kinematics", NULL, 1,
		"the joints from work to tool, for G43.4; docs/kinematics.md" },
	[SECTION_GAP] = { "gap", NULL, 1,
		"the gap servo: feed from the gap; docs/gap-servo.md" },
	[SECTION_JUMP] = { "jump", NULL, 1,
		"the lift that flushes the gap" },
	[SECTION_GEOMETRY] = { "geometry", NULL, 1,
		"errors of the machine that its encoders do not see; "
		"docs/homing.md" },
	[SECTION_CONTOUR] = { "contour", NULL, 1,
		"compensation of the contour error; docs/contour.md" },
	[SECTION_PROBE] = { "probe", NULL, 1,
		"feeling for the work; docs/probe.md" },
	[SECTION_SPEED] = { "speed", NULL, 1,
		"how fast the nodes of a program are passed" },
	[SECTION_CAN402] = { "can402", NULL, 1,
		"drives of CiA 402 on a CAN bus, for backend can402" },
	[SECTION_GENERATOR] = { "generator", NULL, 1,
		"how what a condition asks for reaches the generator; "
		"docs/generator.md" },
	[SECTION_PLC] = { "plc", NULL, 1,
		"a PLC on a CAN bus, edmd is its CANopen slave; docs/plc.md" },
	[SECTION_NC] = { "nc", NULL, 1,
		"how programs are read; docs/nc-code.md" },
	[SECTION_TECH] = { "tech", NULL, 1,
		"technology conditions; docs/technology.md" },
	[SECTION_ELECTRODE] = { "electrode", NULL, 1,
		"the reference at which electrodes are measured; "
		"docs/electrodes.md" },
	[SECTION_SIM] = { "sim", NULL, 1,
		"the simulated machine of backend sim" },
	[SECTION_GPIO] = { "gpio", NULL, 1,
		"lines of a GPIO chip, for backend gpio; docs/gpio.md" },
	[SECTION_LCM] = { "lcm", NULL, 1,
		"messages on this machine" },
	[SECTION_DDS] = { "dds", NULL, 1,
		"messages to the fleet" },
	[SECTION_JOBS] = { "jobs", NULL, 1,
		"the job service" },
	[SECTION_PANEL] = { "panel", NULL, 1,
		"the operator's page, edm-panel" },
};

/* The rows are counted through all files. */
static const struct config_keys *const part[] = {
	&config_keys_machine,
	&config_keys_axis,
	&config_keys_geometry,
	&config_keys_gap,
	&config_keys_bus,
	&config_keys_generator,
	&config_keys_sim,
	&config_keys_gpio,
	&config_keys_panel,
};

const struct config_key *config_key(int row)
{
	size_t i = (size_t)row;

	assert(row >= 0 && row <= CONFIG_NKEYS_MAX);
	for (size_t p = 0; p < ROWS_IN(part); p++) {
		if (i < part[p]->n)
			return &part[p]->row[i];
		i -= part[p]->n;
	}
	return NULL;
}

_Static_assert(INTERP_NAXES <= CONFIG_NINSTANCES_MAX, "an axis too many");
