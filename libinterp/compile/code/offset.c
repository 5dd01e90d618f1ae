/* SPDX-License-Identifier: Apache-2.0 */
/*
 * offset.c - wire offset and taper: G40 G41 G42, G50 G51 G52, D and H
 */
#include "code/reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define NC_NKEYS	10	/* registers that the machine file has */
#define OFFSET_MAX_MM	100.0

int nc_refuse_wire(struct nc_reader *r, const uint8_t *at)
{
	return nc_refuse(r, at, "wire.guides absolute or relative in the "
			 "machine file", "%s on a machine without wire guides",
			 nc_quote_word(r, at).s);
}

int nc_define_register(struct nc_reader *r, const uint8_t *at, uint32_t n,
		       double value)
{
	const double mm = value * r->unit_mm;

	if (!(fabs(mm) <= OFFSET_MAX_MM))
		return nc_refuse(r, at, "an offset of -100 to 100 mm",
				 "an offset of %g mm", mm);
	r->registers[n] = (struct nc_register) { true, mm };
	r->block.unit_at = at;
	r->block.groups |= NC_BIT(NC_REGISTER);
	return 0;
}

static int refuse_register(struct nc_reader *r, const uint8_t *at)
{
	const uint32_t n = r->selected;
	const bool defines = r->d->defines || r->d->registers;
	const char letter = r->d->classes['H'] == NC_LETTER_D ? 'H' : 'D';
	char wanted[96] = "";

	if (defines)
		snprintf(wanted, sizeof(wanted), "%c%u=0.11 before it%s",
			 letter, n, n < NC_NKEYS ? "; or " : "");
	if (n < NC_NKEYS)
		snprintf(wanted + strlen(wanted), sizeof(wanted) -
			 strlen(wanted), "[wire] offset_%u_mm of the machine "
			 "file", n);
	return nc_refuse(r, at, wanted[0] ? wanted : "one of D0 to D9, which "
			 "the machine file can fill, [wire] offset_1_mm",
			 "an offset by register %u, which is not defined", n);
}

/* What is set here is in force from the next motion on. */
static int set_side(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_register *g = &r->registers[r->selected];
	const double set = r->offset_side ? r->set_slope : 0;

	if (r->offset_side && !g->known)
		return refuse_register(r, at);
	contour_side(&r->contour, r->offset_side * g->mm,
		     set + r->taper_side * r->slope);
	r->set_used |= set != 0;
	r->word.origin = nc_origin(r, 0, r->contour.offset_mm);
	return 0;
}

int nc_run_register(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const enum nc_slot slot = nc_has(r, NC_D) ? NC_D : NC_H;

	if (nc_has(r, NC_D) && nc_has(r, NC_H))
		return nc_refuse(r, b->at[NC_H], "D or H",
				 "H on a line with D");
	/* The line may have filled the register of the tool's length. */
	if (!nc_has(r, slot) && r->tool.on)
		nc_tool_length(r);
	if (!nc_has(r, slot))
		return set_side(r, r->line_at);
	if (r->tool.on && !nc_has_group(r, NC_TOOL_POINT))
		return nc_refuse(r, b->at[slot], "G43.4 H1 for another length",
				 "%s under G43.4",
				 nc_quote_word(r, b->at[slot]).s);
	r->selected = (uint32_t)b->value[slot];
	r->h_alone = slot == NC_H && !nc_has_group(r, NC_TOOL_POINT);
	/* If G41 is on the line, that word does it. */
	return nc_has_group(r, NC_OFFSET) ? 0 : set_side(r, b->at[slot]);
}

/* In the tables left is 1 and right is 2. */
static int side_of(const struct nc_code *code)
{
	return code->value == 0 ? 0 : code->value == 1 ? 1 : -1;
}

static int refuse_tip(struct nc_reader *r, enum nc_group group)
{
	return nc_refuse(r, r->block.code_at[group], "G49 before it",
			 "a wire's offset or taper under G43.4");
}

int nc_run_offset(struct nc_reader *r)
{
	if (r->tool.on && r->block.code[NC_OFFSET]->value)
		return refuse_tip(r, NC_OFFSET);
	r->offset_side = side_of(r->block.code[NC_OFFSET]);
	return set_side(r, r->block.code_at[NC_OFFSET]);
}

int nc_run_taper(struct nc_reader *r)
{
	if (r->tool.on && r->block.code[NC_TAPER]->value)
		return refuse_tip(r, NC_TAPER);
	if (r->set_slope != 0 && r->block.code[NC_TAPER]->value)
		return nc_refuse(r, r->block.code_at[NC_TAPER], "one of them",
				 "a taper of the program beside the one that "
				 "is set for it");
	r->taper_side = side_of(r->block.code[NC_TAPER]);
	return set_side(r, r->block.code_at[NC_TAPER]);
}

int nc_run_taper_corner(struct nc_reader *r)
{
	r->contour.corner = (enum interp_taper_corner)
			    r->block.code[NC_TAPER_CORNER]->value;
	return 0;
}

/* NC code has words for the rest. */
int nc_setting_begin(struct nc_reader *r)
{
	const struct interp_setting *s = &r->o->set;

	if (s->wire_mm != 0 || s->turn_deg != 0 || s->mirror ||
	    (s->scale != 0 && s->scale != 1))
		return interp_diag_say(r->diag, "an offset, a scale, a turn or "
				       "an image set for NC code; its words, or "
				       "3B and 4B");
	return contour_set_taper(&r->contour, s->taper_deg, &r->set_slope,
				 r->diag);
}

int nc_setting_end(struct nc_reader *r)
{
	if (r->set_slope == 0 || r->set_used)
		return 0;
	r->diag->line = r->diag->column = 0;
	return interp_diag_say(r->diag, "a taper set for a program that has no "
			       "wire offset; G41 or G42 where its contour "
			       "begins, with a register of 0 if need be");
}

static int refuse_angle(struct nc_reader *r, const uint8_t *at, double deg)
{
	const double most = r->contour.guides.wire->angle_max_deg;
	char wanted[96];

	snprintf(wanted, sizeof(wanted),
		 "-%g to %g degrees, wire.angle_max_deg of the machine", most,
		 most);
	return nc_refuse(r, at, wanted, "a taper of %g degrees", deg);
}

static int refuse_no_angle(struct nc_reader *r)
{
	char letter = 'A', wanted[64];

	for (char c = 'A'; c <= 'Z'; c++)
		if (r->d->classes[(uint8_t)c] == NC_WORD + NC_ANGLE)
			letter = c;
	snprintf(wanted, sizeof(wanted), "an angle in degrees, as in G51 %c2.5",
		 letter);
	return nc_refuse(r, r->block.code_at[NC_TAPER], wanted,
			 "a taper without %c", letter);
}

/* In some dialects A is an axis and the angle of a taper; in others it is only
 * the angle. */
int nc_take_angle(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	const enum nc_slot slot = nc_has(r, NC_ANGLE) ? NC_ANGLE : NC_A;
	const uint8_t *at = b->code_at[NC_TAPER];

	if (!nc_has_group(r, NC_TAPER) || !b->code[NC_TAPER]->value)
		return 0;
	if (nc_has(r, slot) && b->value[slot] == 0)
		r->slope = 0;
	else if (!nc_has_guides(r))
		return nc_refuse_wire(r, at);
	else if (nc_has(r, slot))
		r->slope = contour_tangent(&r->contour, b->value[slot]);
	else if (r->slope == 0)
		return refuse_no_angle(r);
	if (isnan(r->slope))
		return refuse_angle(r, b->at[slot], b->value[slot]);
	b->words &= ~NC_BIT(slot);
	return 0;
}
