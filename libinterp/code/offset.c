/* SPDX-License-Identifier: Apache-2.0 */
/*
 * offset.c - wire offset and taper: G40 G41 G42, G50 G51 G52, D and H
 */
#include "code/reader.h"

#include <math.h>
#include <stdio.h>

/* What is in force holds from the next motion on. */
static void set_side(struct nc_reader *r)
{
	const double offset = r->offset_side && r->offset_register >= 0 ?
			      r->registers_mm[r->offset_register] : 0;

	contour_side(&r->contour, r->offset_side * offset,
		     r->taper_side * r->slope);
}

int nc_run_register(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;

	if (nc_has(r, NC_D) && nc_has(r, NC_H))
		return nc_refuse(r, b->at[NC_H], "D or H",
				 "D and H on one line, two names of a register");
	if (nc_has(r, NC_D))
		r->offset_register = (int)b->value[NC_D];
	if (nc_has(r, NC_H))
		r->offset_register = (int)b->value[NC_H];
	set_side(r);
	return 0;
}

/* Left is 1 and right is 2 in the tables. */
static int side_of(const struct nc_code *code)
{
	return code->value == 0 ? 0 : code->value == 1 ? 1 : -1;
}

int nc_run_offset(struct nc_reader *r)
{
	r->offset_side = side_of(r->block.code[NC_OFFSET]);
	if (r->offset_side && r->offset_register < 0)
		return nc_refuse(r, r->block.code_at[NC_OFFSET],
				 "a register, as in G41 D1",
				 "an offset without D or H");
	set_side(r);
	return 0;
}

int nc_run_taper(struct nc_reader *r)
{
	r->taper_side = side_of(r->block.code[NC_TAPER]);
	set_side(r);
	return 0;
}

static int refuse_angle(struct nc_reader *r, double deg)
{
	char wanted[96];

	snprintf(wanted, sizeof(wanted),
		 "-%g to %g degrees, wire.angle_max_deg of the machine",
		 r->contour.guides.wire->angle_max_deg,
		 r->contour.guides.wire->angle_max_deg);
	return nc_refuse(r, r->block.at[NC_A], wanted,
			 "a taper of %g degrees", deg);
}

int nc_take_angle(struct nc_reader *r)
{
	struct nc_block *b = &r->block;

	if (!nc_has_group(r, NC_TAPER) || !b->code[NC_TAPER]->value)
		return 0;
	if (!nc_has_guides(r))
		return nc_refuse(r, b->code_at[NC_TAPER],
				 "wire.guides absolute or relative in the "
				 "machine file",
				 "a taper on a machine without wire guides");
	if (nc_has(r, NC_A)) {
		r->slope = contour_tangent(&r->contour, b->value[NC_A]);
		if (isnan(r->slope))
			return refuse_angle(r, b->value[NC_A]);
		b->words &= ~NC_BIT(NC_A);
	} else if (r->slope == 0) {
		return nc_refuse(r, b->code_at[NC_TAPER],
				 "an angle in degrees, as in G51 A2.5",
				 "a taper without A");
	}
	return 0;
}
