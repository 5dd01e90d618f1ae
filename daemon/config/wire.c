/* SPDX-License-Identifier: Apache-2.0 */
/* wire.c - what the machine file says of the wire between its guides */
#include "config.h"

#include <math.h>

double config_wire_height_mm(const struct machine_config *c,
			     const struct interp_wire *w)
{
	if (c->gap.process != PROCESS_WIRE)
		return 0;
	return w->guides != INTERP_GUIDES_OFF ?
	       w->z_second_mm - w->z_program_mm :
	       config_machine_is(c, MACHINE_NO_WIRES) ? c->sim.height_mm : 0;
}

double config_wire_lean_deg(const struct machine_config *c,
			    const double pos_mm[INTERP_NAXES])
{
	const struct interp_wire *w = &c->wire;
	const bool rides = w->guides == INTERP_GUIDES_RELATIVE;
	const double u_mm = pos_mm[INTERP_U] - (rides ? 0 : pos_mm[INTERP_X]);
	const double v_mm = pos_mm[INTERP_V] - (rides ? 0 : pos_mm[INTERP_Y]);

	if (c->gap.process != PROCESS_WIRE || w->guides == INTERP_GUIDES_OFF)
		return 0;
	return atan2(hypot(u_mm, v_mm), w->z_upper_mm - w->z_lower_mm) *
	       180 / M_PI;
}

const char *config_process_name(const struct machine_config *c)
{
	return c->gap.process == PROCESS_WIRE ? "wire" : "sink";
}
