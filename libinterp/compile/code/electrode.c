/* SPDX-License-Identifier: Apache-2.0 */
/*
 * electrode.c - T words: which electrode cuts, and how far it shifts Z
 *
 * An electrode that is d mm longer than the reference has its tip d mm lower,
 * so Z must stand d mm higher.  What it has lost by wear counts the other way.
 * The shift is a whole number of pulses, so every lattice point of the program
 * is moved by it and none is rounded otherwise.
 *
 * The middle of an electrode may be beside the axis that C turns about.  Then X
 * Y are shifted too, by what is given for C 0, turned as C is.  Where a rapid
 * motion turns C, X Y go along, so that the middle stays over the same place.
 * A C in the table turns the work, and the electrode stays as it is.
 */
#include "code/reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct interp_electrode *find(const struct nc_reader *r,
					   uint64_t number)
{
	const struct interp_electrodes *t = r->o->electrodes;

	for (size_t i = 0; t && i < t->n; i++)
		if (t->at[i].number == number)
			return &t->at[i];
	return NULL;
}

/* Is it in the table, or may it be missing? */
static bool is_known(const struct nc_reader *r, uint64_t number)
{
	return number == 0 || r->o->electrodes->unknown_ok || find(r, number);
}

static int refuse_unknown(struct nc_reader *r, uint64_t number,
			  const uint8_t *at)
{
	const struct interp_electrodes *t = r->o->electrodes;
	char wanted[160];
	size_t n = (size_t)snprintf(wanted, sizeof(wanted), t->n ? "one of" :
				    "electrode add; the table is empty");

	for (size_t i = 0; i < t->n && n < sizeof(wanted) - 40; i++)
		n += (size_t)snprintf(wanted + n, sizeof(wanted) - n, " T%u",
				      t->at[i].number);
	if (t->n)
		snprintf(wanted + n, sizeof(wanted) - n, ", or electrode add");
	if (at)
		return nc_refuse(r, at, wanted, "electrode %.0f, which is not "
				 "in the table", (double)number);
	return nc_refuse_at(r, 0, wanted, "electrode %.0f, which is not in the "
			    "table", (double)number);
}

/* A table that turns the work does not turn the electrode. */
static int refuse_turned(struct nc_reader *r, const struct interp_electrode *e)
{
	return nc_refuse_at(r, r->line, "an electrode with c 0", "electrode "
			    "%u, which is straight where C stands at %g: C "
			    "does not turn it on this machine", e->number,
			    e->by[INTERP_C]);
}

static int take(struct nc_reader *r, uint32_t number)
{
	const struct interp_electrode *e = find(r, number);

	if (e && e->by[INTERP_C] != 0 &&
	    (!nc_turns_electrode(r) || r->absent & NC_BIT(INTERP_C)))
		return refuse_turned(r, e);
	r->electrode = r->next = number;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double pulse_mm = r->o->machine->axis[i].pulse_mm;

		r->electrode_by[i] = e && !(r->absent & NC_BIT(i)) ?
				     round(e->by[i] / pulse_mm) * pulse_mm : 0;
	}
	nc_set_offset(r);
	return 0;
}

/* Its middle, or its faces, are not where those of the one before were. */
static int take_other(struct nc_reader *r, uint32_t number)
{
	const uint32_t xy = NC_BIT(INTERP_X) | NC_BIT(INTERP_Y);
	double was[INTERP_NAXES];
	int err;

	memcpy(was, r->electrode_by, sizeof(was));
	err = take(r, number);
	if (was[INTERP_X] != r->electrode_by[INTERP_X] ||
	    was[INTERP_Y] != r->electrode_by[INTERP_Y])
		r->unplaced |= xy;
	if (was[INTERP_C] != r->electrode_by[INTERP_C])
		r->unplaced |= NC_BIT(INTERP_C);
	return err;
}

int nc_place_electrode(struct nc_reader *r, bool rapid)
{
	if (!r->incremental && !nc_has_group(r, NC_MACHINE))
		r->unplaced &= ~r->block.words;
	if (rapid || !r->unplaced)
		return 0;
	return nc_refuse_at(r, r->line, r->unplaced & NC_BIT(INTERP_C) ?
			    "G90 G0 with X Y and C before it" :
			    "G90 G0 with X Y before it",
			    "a cut before electrode %u, which sits otherwise in "
			    "its holder than the one before, was sent to its "
			    "place", r->electrode);
}

void nc_electrode_at(const struct nc_reader *r, double c_deg,
		     double ret_mm[INTERP_NAXES])
{
	const struct interp_turn c =
		interp_turn_of(nc_is_eccentric(r) && nc_turns_electrode(r) ?
			       c_deg : 0, false);

	interp_turn_to(&c, r->electrode_by, ret_mm);
}

int nc_check_eccentric(struct nc_reader *r, const double end_mm[INTERP_NAXES])
{
	if (!nc_is_eccentric(r) || !nc_turns_electrode(r) ||
	    end_mm[INTERP_C] == nc_here(r)[INTERP_C])
		return 0;
	return nc_refuse_at(r, r->line, "an electrode in the middle, or C "
			    "turned by G0 before the cut", "a cut in which C "
			    "turns electrode %u, whose middle is %.4f mm "
			    "beside the axis of C",
			    r->electrode, hypot(r->electrode_by[INTERP_X],
						r->electrode_by[INTERP_Y]));
}

/* It has its mark in the program, from which its wear is counted. */
static int mark(struct nc_reader *r, uint32_t number, bool stops)
{
	r->word.line = r->line ? r->line : 1;
	r->word.rapid = false;
	return contour_action(&r->contour, INTERP_ELECTRODE, number |
			      (stops ? INTERP_ELECTRODE_STOP : 0), &r->word,
			      r->diag);
}

int nc_electrode_begin(struct nc_reader *r)
{
	const struct interp_electrodes *t = r->o->electrodes;
	const uint32_t number = !t ? 0 : t->chosen ? t->chosen : t->held;
	int err;

	/* Where there is a table, the first mark says what cuts from the
	 * beginning, even if that is none. */
	if ((number == 0 && (!t || t->n == 0)) || nc_has_guides(r))
		return 0;
	if (!is_known(r, number))
		return refuse_unknown(r, number, NULL);
	/* It is no motion or action of the program. */
	err = mark(r, number, number != t->held);
	return err ? err : take(r, number);
}

static int change(struct nc_reader *r, bool stops, const uint8_t *at)
{
	const uint32_t number = r->next;
	int err;

	if (number == r->electrode)
		return 0;
	if (++r->nchanges >= INTERP_ELECTRODES_MAX)
		return nc_refuse(r, at, "up to 63 of them, or several jobs",
				 "more than 63 changes of the electrode");
	err = nc_room(r);
	if (!err)
		err = mark(r, number, stops);
	return err ? err : take_other(r, number);
}

static int check(struct nc_reader *r, const uint8_t *at)
{
	if (r->tool.on)
		return nc_refuse(r, at, "G49 before it",
				 "another electrode under G43.4");
	if (nc_has_guides(r))
		return nc_refuse(r, at, "no T words, or a machine that sinks",
				 "an electrode on a machine with wire guides");
	if (r->offset_side || r->taper_side)
		return nc_refuse(r, at, "G40 and G50 before it",
				 "another electrode under an offset or a "
				 "taper");
	return 0;
}

/* Is M6 the machine's own? */
static bool plc_changes(const struct nc_reader *r)
{
	return r->o->mcode &&
	       r->o->mcode[NC_M_CHANGE].sync != INTERP_MCODE_NONE;
}

int nc_run_electrode(struct nc_reader *r)
{
	const struct interp_electrodes *t = r->o->electrodes;
	const uint64_t number = r->block.electrode;
	const uint8_t *at = r->block.code_at[NC_ELECTRODE];
	const bool next = r->block.code[NC_ELECTRODE]->value ==
			  NC_ELECTRODE_NEXT;
	int err;

	/* Such programs come from machines with a changer, and were cut here
	 * before there was a table. */
	if (next && (!t || (t->n == 0 && !t->held && !t->chosen))) {
		nc_note_electrode(r, NC_ELECTRODE, "is ignored: there is no "
				  "table of electrodes");
		return 0;
	}
	err = check(r, at);
	if (err)
		return err;
	if (number > INTERP_ELECTRODE_MAX)
		return nc_refuse(r, at, "T1 to T9999, or T0: none",
				 "no electrode has the number %.0f",
				 (double)number);
	if (!t)
		nc_note_electrode(r, NC_ELECTRODE, "shifts nothing: the length "
				  "and the wear of electrodes are not known "
				  "here");
	else if (!is_known(r, number))
		return refuse_unknown(r, number, at);
	r->next = (uint32_t)number;
	return next || plc_changes(r) ? 0 : change(r, true, at);
}

int nc_run_electrode_change(struct nc_reader *r)
{
	const uint8_t *at = r->block.code_at[NC_ELECTRODE_CHANGE];
	const int err = r->next == r->electrode ? 0 : check(r, at);

	/* A T word beside it has said what comes of both. */
	if (r->next == r->electrode &&
	    !(r->block.groups & NC_BIT(NC_ELECTRODE)))
		nc_note_electrode(r, NC_ELECTRODE_CHANGE, "changes nothing: "
				  "no T word called another electrode");
	return err ? err : change(r, true, at);
}

int nc_electrode_by_plc(struct nc_reader *r, const uint8_t *at)
{
	const int err = r->next == r->electrode ? 0 : check(r, at);

	return err ? err : change(r, false, at);
}
