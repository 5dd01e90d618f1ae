/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire_help.h - the wire guides of the tests of wire contours
 */
#ifndef WIRE_HELP_H
#define WIRE_HELP_H

#include "nc_read.h"

static const struct interp_wire no_guides = { .corner_angle_deg = 180 };

/*
 * Planes at 0 and 40, guides 20 below and 40 above: k is -0.5 and 2, and the
 * planes are at 0.2 and 0.6 of the way between the guides.
 */
static const struct interp_wire guides = {
	.guides = INTERP_GUIDES_ABSOLUTE, .z_lower_mm = -20, .z_upper_mm = 80,
	.z_program_mm = 0, .z_second_mm = 40, .angle_max_deg = 30,
	.corner_angle_deg = 180,
};

#endif /* WIRE_HELP_H */
