/* SPDX-License-Identifier: Apache-2.0 */
/* mcode.c - M codes that the machine gives to its PLC */
#include "code/reader.h"

const struct nc_code *nc_mcode(struct nc_reader *r, uint64_t n)
{
	const struct interp_mcode *all = r->o->mcode;
	bool after;

	if (!all || n >= INTERP_NMCODES || all[n].sync == INTERP_MCODE_NONE)
		return NULL;
	after = all[n].sync == INTERP_MCODE_AFTER;
	/* A second one of its kind does not replace the first; it is refused as
	 * a second word of its group. */
	if (!(r->block.groups & NC_BIT(after ? NC_MCODE_AFTER : NC_MCODE)))
		r->block.mcode[after] = (struct nc_code) {
			.group = after ? NC_MCODE_AFTER : NC_MCODE,
			.value = (uint8_t)n,
		};
	return &r->block.mcode[after];
}

int nc_run_mcode(struct nc_reader *r, enum nc_group group)
{
	const uint8_t number = r->block.code[group]->value;

	const uint8_t *at = r->block.code_at[group];
	int err = nc_action(r, INTERP_MCODE,
			    interp_mcode_arg(number, r->o->mcode[number]), at);

	if (!err && number == NC_M_CHANGE)
		err = nc_electrode_by_plc(r, at);
	return err;
}
