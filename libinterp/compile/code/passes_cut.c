/* SPDX-License-Identifier: Apache-2.0 */
/*
 * passes_cut.c - what G152 cuts, and in which order
 *
 * The work is done in rounds.  Each contour has a turn in the first round, then
 * each has one in the second, and so on.  A turn begins when the wire is
 * threaded in the start hole, and ends when the wire is cut.
 */
#include "code/passes.h"

#include <stdio.h>
#include <string.h>

#define M_CUT		50	/* the wire */
#define M_THREAD	60

/* Which part of a contour is cut in a turn. */
enum part {
	PART_ALL,			/* with its tab, if there is one */
	PART_OPEN,			/* without its tab */
	PART_TAB,
};

struct round {
	enum part part;
	uint32_t first, end;		/* passes */
};

#define ROUNDS_MAX	3

/* A turn. */
struct cutting {
	struct nc_reader *r;
	const struct nc_cavity *cavity;
	const struct contour_tape *t;
	uint32_t n;			/* of the cavity, from 1 */
	struct round round;
};

/* -- Between the turns ---------------------------------------------------- */

static bool is_for_plc(const struct nc_reader *r, uint8_t number)
{
	const struct interp_mcode *all = r->o->mcode;

	return all && all[number].sync != INTERP_MCODE_NONE;
}

static int stop(struct nc_reader *r)
{
	return contour_action(&r->contour, INTERP_STOP, 0, &r->word, r->diag);
}

/* The PLC's M code.  On a machine without it, the job stops so that a person
 * does it. */
static int wire_action(struct nc_reader *r, uint8_t number)
{
	if (!is_for_plc(r, number))
		return stop(r);
	return contour_action(&r->contour, INTERP_MCODE,
			      interp_mcode_arg(number, r->o->mcode[number]),
			      &r->word, r->diag);
}

static int go_to(struct nc_reader *r, const double hole_mm[2])
{
	double end_mm[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		end_mm[i] = r->contour.here_mm[i];
	end_mm[INTERP_X] = hole_mm[0];
	end_mm[INTERP_Y] = hole_mm[1];
	if (nc_has_guides(r)) {
		end_mm[INTERP_U] = hole_mm[0];
		end_mm[INTERP_V] = hole_mm[1];
	}
	r->word.rapid = true;
	return contour_line(&r->contour, end_mm, &r->word, r->diag);
}

/* At a tab the job stops for a person, who holds the piece before it is cut
 * free. */
static int begin_turn(const struct cutting *k)
{
	struct nc_reader *r = k->r;
	int err = go_to(r, k->cavity->hole_mm);

	if (!err && k->round.part == PART_TAB && is_for_plc(r, M_THREAD))
		err = stop(r);
	if (!err)
		err = wire_action(r, M_THREAD);
	return err ? err : contour_release(&r->contour, NULL, r->diag);
}

/* The wire is cut where it stands.  Without it the way to the next hole is
 * free. */
static int end_turn(const struct cutting *k)
{
	struct contour *c = &k->r->contour;
	int err;

	if (c->n)
		memcpy(c->here_mm, c->m[c->n - 1].end_mm, sizeof(c->here_mm));
	err = contour_release(c, NULL, k->r->diag);
	return err ? err : wire_action(k->r, M_CUT);
}

/* -- A turn --------------------------------------------------------------- */

static void say_pass(const struct cutting *k, uint32_t i, bool back,
		     const uint32_t range[2], const char *what)
{
	const struct nc_pass *p = &k->r->passes.pass[i];
	const double mm = contour_tape_length(k->t, range[0], range[1]);
	char text[200];

	if (!k->r->o->notes || !k->r->o->notes->plan)
		return;
	snprintf(text, sizeof(text), "contour %u, P%g: %spass %u, register %u "
		 "(%.4f mm), %s, %.3f mm in %.1f s", k->n, k->cavity->number,
		 what, i + 1, p->reg, p->offset_mm, back ? "back" : "forward",
		 mm, mm / p->word.feed_mm_s);
	k->r->o->notes->say(k->r->o->notes->arg, k->cavity->line, text);
}

static int play(const struct cutting *k, uint32_t i, bool back, uint32_t first,
		uint32_t end)
{
	const struct nc_pass *p = &k->r->passes.pass[i];
	const struct contour_pass how = { p->offset_mm, &p->word, back };

	return contour_play(&k->r->contour, k->t,
			    (const uint32_t[]){ first, end }, &how, k->r->diag);
}

/* The passes of a part, forward and backward; the first one goes back if
 * @back.  Motions that are already collected lead to it. */
static int to_and_fro(const struct cutting *k, const uint32_t range[2],
		      bool back, const char *what)
{
	const struct nc_passes *s = &k->r->passes;
	int err = 0;

	for (uint32_t i = k->round.first; !err && i < k->round.end;
	     i++, back = !back) {
		const struct contour_pass how = { s->pass[i].offset_mm,
						  &s->pass[i].word, back };

		say_pass(k, i, back, range, what);
		if (k->r->contour.n > 1)
			err = contour_play_step(&k->r->contour, &how,
					       k->r->diag);
		if (!err)
			err = play(k, i, back, range[0], range[1]);
	}
	return err;
}

/* From the hole to the contour, and everything but the tab. */
static int cut_open(const struct cutting *k)
{
	const uint32_t open[2] = { 1, k->t->tab };
	const int err = play(k, k->round.first, false, 0, 1);

	return err ? err : to_and_fro(k, open, false, "");
}

static int lead_out(const struct cutting *k)
{
	return play(k, k->round.end - 1, false, k->t->n - 1, k->t->n);
}

/* Lead in where the contour's lead-out is, which is the end of the tab, and
 * first go back. */
static int cut_tab(const struct cutting *k)
{
	const uint32_t tab[2] = { k->t->tab, k->t->n - 1 };
	int err = play(k, k->round.first, true, k->t->n - 1, k->t->n);

	if (!err)
		err = to_and_fro(k, tab, true, "tab, ");
	return err || (k->round.end - k->round.first) % 2 ? err : lead_out(k);
}

/* All passes of the open part, a stop, and then the tab; the wire stays in the
 * kerf.  It ends where the lead-out begins. */
static int cut_with_tab(const struct cutting *k)
{
	const uint32_t tab[2] = { k->t->tab, k->t->n - 1 };
	int err = cut_open(k);

	if (!err)
		err = stop(k->r);
	if (!err)
		err = to_and_fro(k, tab, (k->round.end - 1) % 2, "tab, ");
	return err ? err : lead_out(k);
}

/* From the hole around and back to the hole. */
static int cut_round(const struct cutting *k, uint32_t i)
{
	const uint32_t range[2] = { 1, k->t->n - 1 };
	int err;

	say_pass(k, i, i % 2, range, "");
	err = play(k, i, i % 2, 0, k->t->n);
	/* What falls out is taken away after the rough cut. */
	if (!err && i == 0)
		err = stop(k->r);
	return err ? err : contour_release(&k->r->contour, NULL, k->r->diag);
}

static int cut_whole(const struct cutting *k)
{
	int err = 0;

	if (k->t->tab < k->t->n - 1)
		return cut_with_tab(k);
	for (uint32_t i = k->round.first; !err && i < k->round.end; i++)
		err = cut_round(k, i);
	return err;
}

static int take_turn(const struct cutting *k)
{
	int err = begin_turn(k);

	if (err)
		return err;
	switch (k->round.part) {
	case PART_OPEN:
		err = cut_open(k);
		break;
	case PART_TAB:
		err = cut_tab(k);
		break;
	default:
		err = cut_whole(k);
	}
	return err ? err : end_turn(k);
}

/* -- The rounds ----------------------------------------------------------- */

/* Return: the number of rounds. */
static uint32_t rounds_of(const struct nc_passes *s,
			  struct round ret[ROUNDS_MAX])
{
	const uint32_t last = s->npasses;
	const bool tab = s->tab_mm > 0;
	const bool split = s->order == NC_ROUGHS_FIRST && last > 1;
	uint32_t n = 0;

	if (s->order == NC_BY_CONTOUR || (!split && !tab)) {
		ret[n++] = (struct round) { PART_ALL, 0, last };
		return n;
	}
	if (split)
		ret[n++] = (struct round) { tab ? PART_OPEN : PART_ALL, 0, 1 };
	ret[n++] = (struct round) { tab ? PART_OPEN : PART_ALL, split, last };
	if (tab)
		ret[n++] = (struct round) { PART_TAB, 0, last };
	return n;
}

int nc_cut_passes(struct nc_reader *r, const struct contour_tape *tape)
{
	const struct nc_passes *s = &r->passes;
	struct round round[ROUNDS_MAX];
	const uint32_t n = rounds_of(s, round);
	int err = 0;

	for (uint32_t k = 0; !err && k < n; k++) {
		for (uint32_t i = 0; !err && i < s->ncavities; i++) {
			const struct cutting turn = {
				r, &s->cavity[i], &tape[i], i + 1, round[k] };

			r->word.line = r->line;
			err = take_turn(&turn);
		}
	}
	return err;
}
