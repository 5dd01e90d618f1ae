/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tool_point.c - G43.4: X Y Z are places of the tool's tip, seen from the work;
 * G43.5: I J K are the tool's direction
 */
#include "code/tip_turn.h"
#include "kinematics/vector.h"

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

/* H on the line names the register of the tool's length.  Without H the length
 * in use stays; where G43.4 was off there is none. */
static int take_length(struct nc_reader *r)
{
	struct nc_tool_point *t = &r->tool;

	if (nc_has(r, NC_D))
		return nc_refuse(r, r->block.at[NC_D], "H for the tool's "
				 "length", "D with G43.4");
	if (!nc_has(r, NC_H) && !t->on && r->h_alone)
		return refuse_on(r, "H on its line, as in G43.4 H1; a "
				 "register of 0 mm for no length",
				 "G43.4 without H, after an H on a line "
				 "without G43.4");
	if (!nc_has(r, NC_H)) {
		t->longer = t->longer && t->on;
		return 0;
	}
	t->longer = true;
	t->length = (uint32_t)r->block.value[NC_H];
	if (!r->registers[t->length].known)
		return nc_refuse(r, r->block.at[NC_H], "a register filled "
				 "before, as in H1=75 and G43.4 H1",
				 "the tool's length in register %u, which is "
				 "not defined", t->length);
	return 0;
}

/* A register and the electrode make the tool longer: the tip is then farther
 * from the holder. */
void nc_tool_length(struct nc_reader *r)
{
	struct nc_tool_point *t = &r->tool;
	const double mm = r->electrode_by[INTERP_Z] +
			  (t->longer ? r->registers[t->length].mm : 0);
	struct interp_kin_pose p;

	t->k = *r->o->kinematics;
	for (int i = 0; i < 3; i++)
		t->k.tip_mm[i] -= mm * t->k.tool_dir[i];
	memcpy(t->here_mm, r->contour.here_mm, sizeof(t->here_mm));
	interp_kin_forward(&t->k, r->contour.here_mm, &p);
	memcpy(t->here_mm, p.tip_mm, sizeof(p.tip_mm));
	r->curve.smooth = false;
}

void nc_tool_looks(struct nc_reader *r)
{
	struct interp_kin_pose p;

	interp_kin_forward(&r->tool.k, r->contour.here_mm, &p);
	memcpy(r->tool.dir, p.dir, sizeof(r->tool.dir));
}

static int switch_on(struct nc_reader *r)
{
	int err;

	if (!r->o->kinematics)
		return refuse_on(r, "kinematics.chain in the machine file",
				 "places of the tip on a machine whose joints "
				 "are not known");
	if (!has_xyz(r->o->kinematics))
		return refuse_on(r, "a kinematics.chain with X Y Z",
				 "places of the tip on a machine without X Y Z "
				 "in its chain");
	if (r->offset_side || r->taper_side || nc_has_guides(r))
		return refuse_on(r, "G40 and G50 before it, and no guides",
				 "places of the tip with a wire's offset or "
				 "taper");
	if (interp_turn_is_on(&r->contour.guides.turn))
		return refuse_on(r, "a work system that is not turned",
				 "places of the tip in a work system that is "
				 "turned");
	if (nc_is_eccentric(r))
		return refuse_on(r, "an electrode in the middle, whose x and y "
				 "are 0", "places of the tip of an electrode "
				 "whose middle is beside its holder's");
	err = take_length(r);
	if (err)
		return err;
	nc_tool_length(r);
	r->tool.on = true;
	nc_set_offset(r);
	r->tool.vector = r->block.code[NC_TOOL_POINT]->value == NC_TOOL_VECTOR;
	nc_tool_looks(r);
	return 0;
}

int nc_run_tool_point(struct nc_reader *r)
{
	r->curve.smooth = false;
	if (r->block.code[NC_TOOL_POINT]->value != NC_TOOL_OFF)
		return switch_on(r);
	r->tool.on = r->tool.vector = false;
	nc_set_offset(r);
	return 0;
}

/* -- G43.5 ---------------------------------------------------------------- */

/* The rotary axes that turn the tool. */
static uint32_t turning(const struct interp_kinematics *k)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < k->nturn; i++)
		axes |= NC_BIT(k->joint[k->turn[i]].axis);
	return axes;
}

int nc_tool_vector(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	const bool motion = nc_has_group(r, NC_MOTION);
	uint32_t angles;

	if (nc_has_group(r, NC_TOOL_POINT) ?
	    b->code[NC_TOOL_POINT]->value != NC_TOOL_VECTOR : !r->tool.vector)
		return 0;
	if (motion && b->code[NC_MOTION]->value <= 1)
		b->takes |= NC_CENTRE;
	angles = r->o->kinematics && motion ?
		 b->words & turning(r->o->kinematics) : 0;
	if (!angles)
		return 0;
	return nc_refuse(r, b->at[__builtin_ctz(angles)],
			 "I J K, from the tip into the holder; G43.4 for "
			 "angles",
			 "an angle of a rotary that turns the tool, under "
			 "G43.5");
}

struct swing {
	const double *from_mm, *to_mm;
	double dir[3], side[3];		/* where it begins; square to that, the
					 * direction in which it turns */
	double angle;
};

static void swing_at(const void *of, double t, struct nc_pose *ret)
{
	const struct swing *s = of;
	const double c = cos(s->angle * t), d = sin(s->angle * t);

	for (int i = 0; i < INTERP_NAXES; i++)
		ret->mm[i] = t < 1 ? s->from_mm[i] +
			     (s->to_mm[i] - s->from_mm[i]) * t : s->to_mm[i];
	for (int i = 0; i < 3; i++)
		ret->dir[i] = c * s->dir[i] + d * s->side[i];
}

/* The tool turns in the plane of both directions.  Return: false if they are
 * opposite. */
static bool swing_set(struct swing *s, const double from[3], const double to[3])
{
	double x[3], sine;

	vec_cross(from, to, x);
	sine = vec_length(x);
	s->angle = atan2(sine, vec_dot(from, to));
	memcpy(s->dir, from, sizeof(s->dir));
	memset(s->side, 0, sizeof(s->side));
	if (!(sine > 1e-12))
		return vec_dot(from, to) > 0;
	vec_cross(x, from, s->side);
	for (int i = 0; i < 3; i++)
		s->side[i] /= sine;
	return true;
}

/* The direction that the line names, or else the previous one. */
static int direction(struct nc_reader *r, double ret[3])
{
	double n;

	memcpy(ret, r->tool.dir, sizeof(r->tool.dir));
	if (!r->tool.vector || !(r->block.words & NC_CENTRE))
		return 0;
	for (int i = 0; i < 3; i++)
		ret[i] = nc_has(r, (enum nc_slot)(NC_I + i)) ?
			 r->block.value[NC_I + i] : 0;
	n = vec_length(ret);
	for (int i = 0; i < 3; i++)
		ret[i] /= n;
	if (n > 0 && isfinite(n))
		return 0;
	return nc_refuse(r, r->block.code_at[NC_MOTION], "I J K from the tip "
			 "into the holder, as in I0 J0 K1",
			 "a direction of length 0");
}

int nc_tool_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		 bool rapid)
{
	struct swing s = { .to_mm = end_mm };
	const struct nc_pose_way w = { .at = swing_at, .of = &s };
	double from[INTERP_NAXES], to[3];
	int err;

	if (!r->tool.vector)
		return nc_tip_line(r, end_mm, rapid);
	err = direction(r, to);
	if (err)
		return err;
	if (!swing_set(&s, r->tool.dir, to))
		return nc_refuse(r, r->block.code_at[NC_MOTION], "a direction "
				 "between them first", "a direction opposite "
				 "to the last one");
	if (!(s.angle > 0))
		return nc_tip_line(r, end_mm, rapid);
	memcpy(from, r->tool.here_mm, sizeof(from));
	s.from_mm = from;
	err = nc_pose_way(r, &w);
	memcpy(r->tool.dir, to, sizeof(to));
	return err;
}
