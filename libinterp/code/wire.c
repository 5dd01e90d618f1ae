/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wire.c - offset and taper, as far as there is none
 *
 * G40 and G50 cancel what is not there.  G41 and G42 with a register that is
 * known to be 0, and G51 and G52 with A0, change nothing and are taken; every
 * other would cut a part of another size, and is refused.
 */
#include "code/reader.h"

int nc_refuse_wire(struct nc_reader *r, const uint8_t *at)
{
	return nc_refuse(r, at, "the path of the wire itself: G40, an offset "
			 "defined as 0, G50 or A0, and no U or V",
			 "%s: wire offset/taper: not in this version",
			 nc_quote_word(r, at).s);
}

int nc_define_register(struct nc_reader *r, const uint8_t *at, uint32_t n,
		       double value)
{
	if (!(value >= -100 && value <= 100))
		return nc_refuse(r, at, "an offset of -100 to 100 mm",
				 "an offset of %g mm", value * r->unit_mm);
	r->registers[n] = (struct nc_register) { true, value * r->unit_mm };
	return 0;
}

static bool is_nothing(const struct nc_reader *r)
{
	const struct nc_register *g = &r->registers[r->selected];

	return g->known && g->mm == 0;
}

int nc_run_register(struct nc_reader *r)
{
	const enum nc_slot slot = nc_has(r, NC_D) ? NC_D : NC_H;

	if (nc_has(r, NC_D) && nc_has(r, NC_H))
		return nc_refuse(r, r->block.at[NC_H], "D or H",
				 "H on a line with D");
	r->selected = (uint32_t)r->block.value[slot];
	if (r->offset_on && !is_nothing(r))
		return nc_refuse_wire(r, r->block.at[slot]);
	return 0;
}

int nc_run_offset(struct nc_reader *r)
{
	r->offset_on = r->block.code[NC_OFFSET]->value != 0;
	if (r->offset_on && !is_nothing(r))
		return nc_refuse_wire(r, r->block.code_at[NC_OFFSET]);
	return 0;
}

int nc_run_taper(struct nc_reader *r)
{
	if (r->block.code[NC_TAPER]->value == 0)
		return 0;
	if (nc_has(r, NC_ANGLE) && r->block.value[NC_ANGLE] == 0)
		return 0;
	return nc_refuse_wire(r, r->block.code_at[NC_TAPER]);
}
