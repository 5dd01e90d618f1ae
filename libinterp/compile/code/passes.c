/* SPDX-License-Identifier: Apache-2.0 */
/*
 * passes.c - G150 G151 G152: contours cut in several passes
 *
 * A contour is an ordinary subprogram under G41 or G42.  It is read once, onto
 * a tape.  From the tape it is cut as many times as there are passes.
 */
#include "code/passes.h"

#include <errno.h>
#include <stdlib.h>

#define WORDS_WANTED	"G150 H1 E001 for each pass, then G151 P1000 X0 Y0 " \
			"for each contour, then G152"

static const uint8_t *my_word(const struct nc_reader *r)
{
	return r->block.code_at[NC_ONE_SHOT];
}

/* The list must not grow while it is being carried out. */
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
		return nc_refuse(r, my_word(r),
				 "up to 256 contours, or another G152",
				 "a contour too many");
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

/* -- Onto the tape -------------------------------------------------------- */

static int refuse_contour(struct nc_reader *r, const struct nc_cavity *c)
{
	return nc_refuse_at(r, c->line,
			    "one motion that leads in under G41 or G42, a "
			    "contour that ends where it begins, and one "
			    "motion that leads out under G40",
			    "a contour P%g that is not whole", c->number);
}

/* Afterwards the line of the G152 is the present line again. */
static int record(struct nc_reader *r, const struct nc_cavity *c,
		  struct contour_tape *t)
{
	const struct nc_block block = r->block;
	const uint8_t *line_at = r->line_at;
	const bool mapped = r->mapped;
	const uint32_t depth = r->depth;
	const uint8_t *code_at = my_word(r);
	int err;

	contour_record(&r->contour, c->hole_mm);
	r->selected = r->passes.pass[0].reg;
	err = nc_call(r, c->number, 1, code_at);
	while (!err && r->depth > depth && !r->over && r->at < r->end)
		err = nc_read_line(r);
	contour_recorded(&r->contour, t);
	if (!err && r->depth > depth)
		err = nc_refuse_at(r, c->line, "M99 at its end",
				  "the end inside contour P%g", c->number);
	if (!err) {
		r->block = block;
		r->line_at = line_at;
		r->mapped = mapped;
	}
	return !err && !contour_tape_is_whole(t, r->contour.guides.pulse_mm) ?
	       refuse_contour(r, c) : err;
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

/* L of a G152: the order in which several contours are cut. */
static int read_order(struct nc_reader *r)
{
	struct nc_passes *s = &r->passes;
	const double l = nc_has(r, NC_L) ? r->block.value[NC_L] : 0;

	s->order = l == 0 ? NC_BY_CONTOUR : l == 1 ? NC_ROUGHS_FIRST :
		   NC_TABS_LAST;
	if (l > 2 || (s->order == NC_TABS_LAST && !(s->tab_mm > 0)))
		return nc_refuse(r, r->block.at[NC_L],
				 "L1: all rough cuts first; L2 with a tab, as "
				 "in R1: all tabs last",
				 "G152 L%g%s", l,
				 l > 2 ? "" : " without a tab");
	return 0;
}

static int check_cut(struct nc_reader *r)
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
	return read_order(r);
}

int nc_cut(struct nc_reader *r)
{
	struct nc_passes *s = &r->passes;
	struct contour_tape *tape;
	int err;

	s->tab_mm = nc_has(r, NC_R) ? r->block.value[NC_R] * r->unit_mm : 0;
	err = check_cut(r);
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
	for (uint32_t i = 0; i < s->npasses; i++)
		s->pass[i].word.origin = nc_origin(r, i + 1,
						   s->pass[i].offset_mm);
	if (!err)
		err = nc_cut_passes(r, tape);
	for (uint32_t i = 0; i < s->ncavities; i++)
		free(tape[i].m);
	free(tape);
	s->npasses = s->ncavities = 0;
	return err;
}
