/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tool_point.c - G43.4: X Y Z are places of the tool's tip, seen from the work
 */
#include "code/reader.h"

#include <string.h>

static int refuse_on(struct nc_reader *r, const char *wanted,
		     const char *found)
{
	return nc_refuse(r, r->block.code_at[NC_TOOL_POINT], wanted, "%s",
			 found);
}

static bool has_xyz(const struct interp_kinematics *k)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < k->nlinear; i++)
		axes |= NC_BIT(k->joint[k->linear[i]].axis);
	return axes == (NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z));
}

/* The tool longer by a register: the tip farther from the holder. */
static int lengthen(struct nc_reader *r)
{
	const uint32_t n = nc_has(r, NC_H) ? (uint32_t)r->block.value[NC_H] : 0;

	if (!nc_has(r, NC_H))
		return 0;
	if (!r->registers[n].known)
		return nc_refuse(r, r->block.at[NC_H], "a register filled "
				 "before, as in H1=75 and G43.4 H1",
				 "the tool's length in register %u, which is "
				 "not defined", n);
	for (int i = 0; i < 3; i++)
		r->tool.k.tip_mm[i] -= r->registers[n].mm *
				       r->tool.k.tool_dir[i];
	return 0;
}

static int switch_on(struct nc_reader *r)
{
	struct interp_kin_pose p;
	int err;

	if (!r->o->kinematics)
		return refuse_on(r, "kinematics.chain in the machine file",
				 "G43.4 on a machine whose joints are not "
				 "known");
	if (!has_xyz(r->o->kinematics))
		return refuse_on(r, "a kinematics.chain with X Y Z",
				 "G43.4 on a machine without X Y Z in its "
				 "chain");
	if (r->offset_side || r->taper_side || nc_has_guides(r))
		return refuse_on(r, "G40 and G50 before it, and no guides",
				 "G43.4 with a wire's offset or taper");
	r->tool.k = *r->o->kinematics;
	err = lengthen(r);
	if (err)
		return err;
	memcpy(r->tool.here_mm, r->contour.here_mm, sizeof(r->tool.here_mm));
	interp_kin_forward(&r->tool.k, r->contour.here_mm, &p);
	memcpy(r->tool.here_mm, p.tip_mm, sizeof(p.tip_mm));
	r->tool.on = true;
	return 0;
}

int nc_run_tool_point(struct nc_reader *r)
{
	r->curve.smooth = false;
	if (r->block.code[NC_TOOL_POINT]->value)
		return switch_on(r);
	r->tool.on = false;
	return 0;
}
