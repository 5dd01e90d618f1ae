/* SPDX-License-Identifier: Apache-2.0 */
/*
 * passes.c - G150 G151 G152: contours cut in several passes
 *
 * A contour is an ordinary subprogram under G41 or G42.  It is read once, onto
 * a tape, and cut from that as often as there are passes.
 */
#include "code/reader.h"
#include "wire/replay.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define WORDS_WANTED	"G150 H1 E001 for each pass, then G151 P1000 X0 Y0 " \
			"for each contour, then G152"
#define M_CUT		50	/* the wire */
#define M_THREAD	60

static const uint8_t *my_word(const struct nc_reader *r)
{
	return r->block.code_at[NC_ONE_SHOT];
}

/* The list must not grow while it is carried out. */
static int refuse_inside(struct nc_reader *r)
{
	if (!r->contour.recording)
		return 0;
	return nc_refuse(r, my_word(r), WORDS_WANTED, "%s inside a contour",
			 nc_quote_word(r, my_word(r)).s);
}

int nc_pass(struct nc_reader *r)
{
	struct nc_passes *s = &r->passes;
	const struct nc_register *g = &r->registers[r->selected];

	if (refuse_inside(r))
		return -EINVAL;
	if (s->npasses == NC_NPASSES)
		return nc_refuse(r, my_word(r), "up to 16 passes",
				 "a pass too many");
	if (!g->known || !(g->mm > 0))
		return nc_refuse(r, my_word(r), "a register with an offset "
				 "above 0, as in H1=0.18 and G150 H1",
				 "a pass with register %u, which has none",
				 r->selected);
	if (!(r->feed_mm_s > 0))
		return nc_refuse(r, my_word(r), "an F word in this line or "
				 "before it", "a pass without a feed");
	s->pass[s->npasses] = (struct nc_pass) { .reg = r->selected,
						 .offset_mm = g->mm,
						 .word = r->word };
	s->pass[s->npasses].word.rapid = false;
	s->pass[s->npasses++].word.feed_mm_s = r->feed_mm_s;
	return 0;
}

int nc_cavity(struct nc_reader *r)
{
	struct nc_passes *s = &r->passes;
	double at_mm[INTERP_NAXES];

	if (refuse_inside(r))
		return -EINVAL;
	if (s->ncavities == NC_NCAVITIES)
		return nc_refuse(r, my_word(r), "up to 256 contours, or another "
				 "G152", "a contour too many");
	if (!nc_has(r, NC_P) || !nc_has(r, NC_X) || !nc_has(r, NC_Y))
		return nc_refuse(r, my_word(r), "the number of its subprogram "
				 "and the place of its start hole, as in G151 "
				 "P1000 X10 Y10", "G151 without P, X or Y");
	nc_target(r, at_mm);
	s->cavity[s->ncavities++] = (struct nc_cavity) {
		.number = r->block.value[NC_P], .line = r->line,
		.hole_mm = { at_mm[INTERP_X], at_mm[INTERP_Y] },
	};
	return 0;
}

/* -- Onto the tape ------------------------------------------------------------ */

static int refuse_contour(struct nc_reader *r, const struct nc_cavity *c)
{
	return nc_refuse_at(r, c->line, "a lead in under G41 or G42, a contour "
			    "that ends where it begins, and a lead out under "
			    "G40", "a contour P%g that is not whole", c->number);
}

/* Behind it the line of the G152 is the one in hand again. */
static int record(struct nc_reader *r, const struct nc_cavity *c,
		  struct contour_tape *t)
{
	const struct nc_block block = r->block;
	const uint8_t *line_at = r->line_at;
	const uint32_t depth = r->depth;
	const uint8_t *code_at = my_word(r);
	int err;

	contour_record(&r->contour, c->hole_mm);
	r->selected = r->passes.pass[0].reg;
	err = nc_call(r, c->number, code_at);
	while (!err && r->depth > depth && !r->over && r->at < r->end)
		err = nc_read_line(r);
	contour_recorded(&r->contour, t);
	if (!err && r->depth > depth)
		err = nc_refuse_at(r, c->line, "M99 at its end",
				  "the end inside contour P%g", c->number);
	if (!err) {
		r->block = block;
		r->line_at = line_at;
	}
	return !err && !contour_tape_is_whole(t, r->contour.guides.pulse_mm) ?
	       refuse_contour(r, c) : err;
}

/* -- Cut ------------------------------------------------------------------------ */

/* The PLC's M code; on a machine without one the job stops for a person. */
static int wire_action(struct nc_reader *r, uint8_t number)
{
	const struct interp_mcode *all = r->o->mcode;

	if (all && all[number].sync != INTERP_MCODE_NONE)
		return contour_action(&r->contour, INTERP_MCODE,
				      interp_mcode_arg(number, all[number]),
				      &r->word, r->diag);
	return contour_action(&r->contour, INTERP_STOP, 0, &r->word, r->diag);
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

struct cutting {
	struct nc_reader *r;
	const struct nc_cavity *cavity;
	const struct contour_tape *t;
	uint32_t n;			/* of the cavity, from 1 */
};

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
			    (const uint32_t[]) { first, end }, &how, k->r->diag);
}

/* One pass all the way round, from the hole to the hole. */
static int cut_round(const struct cutting *k, uint32_t i)
{
	const uint32_t range[2] = { 1, k->t->n - 1 };

	say_pass(k, i, i % 2, range, "");
	return play(k, i, i % 2, 0, k->t->n);
}

/* All passes of a part, to and fro; the first goes back if @back.  What stands
 * collected leads to it. */
static int to_and_fro(const struct cutting *k, const uint32_t range[2],
		      bool back, const char *what)
{
	struct nc_passes *s = &k->r->passes;
	int err = 0;

	for (uint32_t i = 0; !err && i < s->npasses; i++, back = !back) {
		const struct contour_pass how = { s->pass[i].offset_mm,
						  &s->pass[i].word, back };

		say_pass(k, i, back, range, what);
		if (i || k->r->contour.n > 1)
			err = contour_play_step(&k->r->contour, &how,
					       k->r->diag);
		if (!err)
			err = play(k, i, back, range[0], range[1]);
	}
	return err;
}

/* The open part in all passes, a stop, then the tab; it ends where the lead out
 * begins. */
static int cut_with_tab(const struct cutting *k)
{
	const uint32_t open[2] = { 1, k->t->tab };
	const uint32_t tab[2] = { k->t->tab, k->t->n - 1 };
	const uint32_t last = k->r->passes.npasses - 1;
	int err = play(k, 0, false, 0, 1);

	if (!err)
		err = to_and_fro(k, open, false, "");
	if (!err)
		err = contour_action(&k->r->contour, INTERP_STOP, 0,
				     &k->r->word,
				    k->r->diag);
	if (!err)
		err = to_and_fro(k, tab, last % 2, "tab, ");
	return err ? err : play(k, last, false, k->t->n - 1, k->t->n);
}

/* Passes @first to @end - 1 of one contour. */
static int cut_passes(const struct cutting *k, uint32_t first, uint32_t end)
{
	struct contour *c = &k->r->contour;
	int err = go_to(k->r, k->cavity->hole_mm);

	if (!err)
		err = wire_action(k->r, M_THREAD);
	if (!err)
		err = contour_release(c, NULL, k->r->diag);
	if (!err && k->t->tab < k->t->n - 1)
		err = cut_with_tab(k);
	for (uint32_t i = first;
	     !err && k->t->tab == k->t->n - 1 && i < end; i++) {
		err = cut_round(k, i);
		/* What falls out is taken away behind the rough cut. */
		if (!err && i == 0)
			err = contour_action(c, INTERP_STOP, 0, &k->r->word,
					    k->r->diag);
		if (!err)
			err = contour_release(c, NULL, k->r->diag);
	}
	if (!err)
		err = contour_release(c, NULL, k->r->diag);
	return err ? err : wire_action(k->r, M_CUT);
}

static int cut_all(struct nc_reader *r, const struct contour_tape *tape,
		   bool roughs_first)
{
	struct nc_passes *s = &r->passes;
	const uint32_t rounds = roughs_first && s->npasses > 1 ? 2 : 1;
	int err = 0;

	for (uint32_t round = 0; !err && round < rounds; round++) {
		const uint32_t first = round;
		const uint32_t end = rounds == 2 && round == 0 ? 1 : s->npasses;

		for (uint32_t i = 0; !err && i < s->ncavities; i++) {
			const struct cutting k = { r, &s->cavity[i], &tape[i],
						   i + 1 };

			r->word.line = r->line;
			err = cut_passes(&k, first, end);
		}
	}
	return err;
}

static int refuse_tab(struct nc_reader *r, const struct nc_cavity *c)
{
	return nc_refuse_at(r, c->line, "a tab shorter than the contour",
			    "a tab of %g mm on contour P%g",
			    r->passes.tab_mm, c->number);
}

static int record_all(struct nc_reader *r, struct contour_tape *tape)
{
	struct nc_passes *s = &r->passes;
	int err = 0;

	for (uint32_t i = 0; !err && i < s->ncavities; i++) {
		err = record(r, &s->cavity[i], &tape[i]);
		if (!err && s->tab_mm > 0)
			err = contour_tape_split(&tape[i], s->tab_mm);
		if (err == -ERANGE)
			err = refuse_tab(r, &s->cavity[i]);
	}
	return err;
}

static int check_cut(struct nc_reader *r, bool roughs_first)
{
	struct nc_passes *s = &r->passes;

	if (!s->npasses || !s->ncavities)
		return nc_refuse(r, my_word(r), WORDS_WANTED,
				 "G152 without %s before it", s->npasses ?
				 "a contour" : "a pass");
	if (r->contour.offset_mm != 0 || r->contour.slope != 0 ||
	    r->contour.recording)
		return nc_refuse(r, my_word(r), "G40 and G50 before it; they "
				 "belong into the contours",
				 "G152 under an offset or a taper");
	if (!(s->tab_mm >= 0))
		return nc_refuse(r, r->block.at[NC_R], "R of 0 or more, the "
				 "length of the tab", "a tab of %g mm",
				 s->tab_mm);
	if (roughs_first && s->tab_mm > 0)
		return nc_refuse(r, r->block.at[NC_L], "L1 without a tab: the "
				 "wire stays in the kerf until the tab is cut",
				 "G152 L%g with a tab", r->block.value[NC_L]);
	return 0;
}

int nc_cut(struct nc_reader *r)
{
	struct nc_passes *s = &r->passes;
	const bool roughs_first = nc_has(r, NC_L);
	struct contour_tape *tape;
	int err;

	s->tab_mm = nc_has(r, NC_R) ? r->block.value[NC_R] * r->unit_mm : 0;
	err = check_cut(r, roughs_first);
	if (!err)
		err = contour_flush(&r->contour, r->diag);
	if (err)
		return err;
	tape = calloc(s->ncavities, sizeof(*tape));
	if (!tape)
		return -ENOMEM;
	const struct interp_build_word word = r->word;
	const uint32_t selected = r->selected;
	double here_mm[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++)
		here_mm[i] = r->contour.here_mm[i];
	err = record_all(r, tape);
	for (int i = 0; i < INTERP_NAXES; i++)
		r->contour.here_mm[i] = here_mm[i];
	r->word = word;
	r->selected = selected;
	r->segs++;
	if (!err)
		err = cut_all(r, tape, roughs_first);
	for (uint32_t i = 0; i < s->ncavities; i++)
		free(tape[i].m);
	free(tape);
	s->npasses = s->ncavities = 0;
	return err;
}
