/* SPDX-License-Identifier: Apache-2.0 */
/* work.c - G10: work offsets that the program writes */
#include "code/reader.h"

#include <math.h>

#define A_WRITE	"G10 L2 P1 X.. for the origin of G54, L20 for the place where " \
		"the machine stands; P2 to P9 for G55 to G59.3, P0 for the " \
		"one in force"

int nc_write_offset(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double *here = nc_here(r);
	const double l = nc_has(r, NC_L) ? b->value[NC_L] : 0;
	const double p = nc_has(r, NC_P) ? b->value[NC_P] : 0;
	const bool moves = r->incremental && !r->d->g91_sets;
	uint32_t work;

	if (l != 2 && l != 20)
		return nc_refuse(r, b->code_at[NC_ONE_SHOT], A_WRITE,
				 nc_has(r, NC_L) ? "G10 L%g" : "G10 without L",
				 l);
	if (p != floor(p) || !(p >= 0 && p <= INTERP_NC_NWORK))
		return nc_refuse(r, b->at[NC_P], A_WRITE, "G10 with P%g", p);
	if (r->tool.on)
		return nc_refuse(r, b->code_at[NC_ONE_SHOT], "G49 before it",
				 "G10 under G43.4");
	work = p > 0 ? (uint32_t)p - 1 : r->work;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double to = b->value[i] * r->scale[i];
		double *mm = &r->work_mm[work][i];

		if (!(b->words & NC_BIT(i)))
			continue;
		*mm = l == 2 ? (moves ? *mm : 0) + to :
			       here[i] - to - r->shift_mm[i] -
			       (i == INTERP_Z ? r->electrode_mm : 0);
	}
	nc_set_offset(r);
	if (l == 20 && work == r->work)
		r->unnamed &= ~b->words;
	return 0;
}
