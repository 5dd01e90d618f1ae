/* SPDX-License-Identifier: Apache-2.0 */
/* work.c - G10 and G52: work offsets that the program writes or shifts */
#include "code/reader.h"

#include <math.h>

#define A_WRITE	"G10 L2 P1 X.. for the origin of G54, R for its turn, L20 for the place where " \
		"the machine stands; P2 to P9 for G55 to G59.3, P0 for the " \
		"one in force"

/* L20: the origin from which the machine stands where the words say, seen by
 * the turn of that system. */
static void write_here(struct nc_reader *r, uint32_t work)
{
	const struct nc_block *b = &r->block;
	const struct interp_turn t = interp_turn_of(r->turn_deg[work], false);
	double at[INTERP_NAXES], by[INTERP_NAXES], *mm = r->work_mm[work];

	interp_turn_to(&r->contour.guides.turn, nc_here(r), at);
	nc_electrode_at(r, at[INTERP_C], by);
	for (int i = 0; i < INTERP_NAXES; i++)
		at[i] -= by[i];
	interp_turn_back(&t, at, at);
	interp_turn_back(&t, mm, mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		if (b->words & NC_BIT(i))
			mm[i] = at[i] - b->value[i] * r->scale[i] -
				r->shift_mm[i];
	interp_turn_to(&t, mm, mm);
}

static void write_origin(struct nc_reader *r, uint32_t work)
{
	const struct nc_block *b = &r->block;
	const bool moves = r->incremental && !r->d->g91_sets;

	for (int i = 0; i < INTERP_NAXES; i++) {
		double *mm = &r->work_mm[work][i];

		if (b->words & NC_BIT(i))
			*mm = (moves ? *mm : 0) + b->value[i] * r->scale[i];
	}
	if (nc_has(r, NC_R))
		r->turn_deg[work] = b->value[NC_R];
}

int nc_write_offset(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double l = nc_has(r, NC_L) ? b->value[NC_L] : 0;
	const double p = nc_has(r, NC_P) ? b->value[NC_P] : 0;
	uint32_t work;
	int err;

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
	if (l == 20 && nc_has(r, NC_R))
		return nc_refuse(r, b->at[NC_R], A_WRITE, "R with G10 L20");
	if (l == 2)
		write_origin(r, work);
	else
		write_here(r, work);
	err = nc_set_turn(r);
	if (err)
		return err;
	if (l == 20 && work == r->work) {
		r->unnamed &= ~b->words;
		r->unplaced &= ~b->words;
	}
	return 0;
}

/* Fanuc keeps this apart from the shift by G92, and LinuxCNC has one shift for
 * both.  So an axis has one or the other here. */
int nc_local_place(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint8_t *at = b->code_at[NC_ONE_SHOT];

	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it", "G52 under G43.4");
	if (r->incremental)
		return nc_refuse(r, at, "G90 before it", "G52 under G91");
	if (!(b->words & NC_AXES))
		return nc_refuse(r, at, "axis words, as in G52 X0 Y0, which "
				 "cancels it", "G52 without axis words");
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (!(b->words & NC_BIT(i)))
			continue;
		if (r->shift_mm[i] != 0 && !(r->local & NC_BIT(i)))
			return nc_refuse(r, b->at[i], "G92.1 before it",
					 "G52 %c where G92 is in force",
					 nc_words[i].letter);
		r->shift_mm[i] = b->value[i] * r->scale[i];
		r->local |= NC_BIT(i);
	}
	nc_set_offset(r);
	return 0;
}
