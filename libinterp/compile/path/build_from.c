/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_from.c - a program that begins inside another one
 *
 * What was cut before is left out, but for the last run of cutting up to the
 * place: the electrode comes in along it.  The tables (arcs, curves, conditions
 * and so on) stay as they are; only segments and nodes are made anew.
 */
#include "path/builder.h"

#include "interp/build_from.h"
#include "interp/mcode_arg.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One program, and the way that is put in front of its rest. */
struct from {
	struct interp_build *b, *way;
	const struct interp_build_from *o;
	struct interp_build_entry *entry;
	struct interp_diag *diag;
	uint32_t far;			/* the last segment that is not done
					 * again as a whole */
	uint32_t last;			/* the last that is left out */
};

static struct interp_seg *segs_of(const struct interp_build *b)
{
	return b->segs.at;
}

/* Before this place everything was done, and actions at it were not. */
static uint32_t find_far(const struct interp_build *b, double far_mm)
{
	const struct interp_seg *s = segs_of(b);
	uint32_t i = 0;

	while (i + 1 < b->segs.n && s[i + 1].s_mm < far_mm)
		i++;
	return i;
}

/* The first segment of this line, or of the next that has any.  0: none.
 * Subprograms may stand behind their calls, so the segments are not in the
 * order of the lines. */
static uint32_t find_line(const struct interp_build *b, uint32_t line)
{
	const struct interp_seg *s = segs_of(b);
	uint32_t at = 0;

	for (uint32_t i = 1; i < b->segs.n; i++)
		if (s[i].line >= line && (!at || s[i].line < s[at].line))
			at = i;
	return at;
}

/* Where a rapid probing motion ends is not off the work but in it. */
static bool is_positioning(const struct interp_seg *s)
{
	return s->flags & INTERP_SEG_RAPID && s->length_mm > 0 &&
	       !(s->flags & INTERP_SEG_SENSED);
}

/* The last positioning up to there: its end is off the work.  A part with a
 * time is done from its begin on, unless it is over. */
static uint32_t find_last(const struct interp_build *b, uint32_t far)
{
	const struct interp_seg *s = segs_of(b);
	uint32_t last = 0;

	for (uint32_t i = far; i > 0; i--) {
		if (s[i].kind == INTERP_TIMED && s[i].arg > far)
			last = 0;
		if (last == 0 && is_positioning(&s[i]))
			last = i;
	}
	return last;
}

/* Was something felt that is not known, or that the way in would need? */
static int check_probing(const struct from *f, uint32_t i)
{
	const struct interp_seg *s = segs_of(f->b) + i;
	const bool ended = i < f->far || f->entry->far_mm >=
			   s->s_mm + s->length_mm - 1e-9;

	if (!(s->flags & INTERP_SEG_SENSED) || !ended)
		return 0;
	if (!f->o->probed_known)
		return interp_diag_say(f->diag, "what was probed before that "
			"place is not known; a program that probes again, or "
			"G92 in place of probing");
	if (i > f->last)
		return interp_diag_say(f->diag,
			"nothing was positioned between "
			"this probing and that place, so no way in is known "
			"that is off the work; a G0 behind it");
	return 0;
}

static int check(const struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);

	f->diag->line = s[f->b->segs.n - 1].line;
	if (f->entry->far_mm >= f->b->length_mm)
		return interp_diag_say(f->diag, "nothing of the path is left "
				       "behind %.3f mm; a place before its end "
				       "at %.3f mm", f->entry->far_mm,
				       f->b->length_mm);
	for (uint32_t i = 0; i <= f->far; i++) {
		f->diag->line = s[i].line;
		if (check_probing(f, i) < 0)
			return -EINVAL;
	}
	return 0;
}

void interp_build_set(struct interp_build *b, uint32_t cond, uint32_t field,
		      double value)
{
	struct interp_cond *c = b->conds.at;

	if (cond < b->conds.n && field < INTERP_NTECH)
		c[cond].tech.v[field] = value;
}

/* -- The way in ----------------------------------------------------------- */

static void entry_of(const struct from *f, double to[INTERP_NAXES])
{
	const struct interp_build *b = f->b;
	const int64_t *node = (const int64_t *)b->nodes.at +
			      (size_t)(f->last + 1) * b->naxes;
	int64_t at[INTERP_NAXES];

	memcpy(at, b->first, sizeof(at));
	for (uint32_t k = 0; k < b->naxes; k++)
		at[b->column[k]] = node[k];
	build_mm(b, BUILD_ALL_AXES, at, to);
}

/* The electrode that cuts at the place.  If another one is in the holder, a
 * person puts it in. */
static int add_electrode(struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);
	const struct interp_build_word w = { .line = s[f->far].line };
	uint32_t number = 0;

	for (uint32_t i = 0; i <= f->far; i++)
		if (s[i].kind == INTERP_ELECTRODE)
			number = s[i].arg & ~INTERP_ELECTRODE_STOP;
	f->entry->electrode = number;
	if (number == 0)
		return 0;
	return interp_build_action(f->way, INTERP_ELECTRODE, number |
				   (number != f->o->held ?
				    INTERP_ELECTRODE_STOP : 0), &w, f->diag);
}

/* What the axes are further than the program's own place. */
static double shift_mm(const struct from *f, int axis)
{
	return (double)f->b->probed.shift[axis] * INTERP_SUB /
	       f->b->sub_mm[axis];
}

/* Out of the work along one axis, over, and in along the same axis; as places
 * of the program. */
static int add_legs(struct from *f)
{
	const struct interp_build_word w = { .rapid = true };
	const int up = f->o->up;
	double at[INTERP_NAXES], *to = f->entry->entry_mm;
	int err = 0;

	memcpy(at, f->way->here_mm, sizeof(at));
	if (up >= 0) {
		at[up] = fmax(at[up], to[up]);
		err = interp_build_line(f->way, at, &w, f->diag);
		if (err == 0)
			err = add_electrode(f);
		for (int i = 0; i < INTERP_NAXES; i++)
			at[i] = i == up ? at[i] : to[i];
		if (err == 0)
			err = interp_build_line(f->way, at, &w, f->diag);
	}
	return err ? err : interp_build_line(f->way, to, &w, f->diag);
}

/* The argument of the last M code that was passed with @number.  0: none. */
static uint32_t find_unanswered(const struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);

	for (uint32_t i = f->far; f->o->unanswered && i > 0; i--)
		if (s[i].kind == INTERP_MCODE &&
		    interp_mcode_number(s[i].arg) == f->o->unanswered)
			return s[i].arg;
	return 0;
}

static int add_aux(struct from *f, uint32_t aux,
		   const struct interp_build_word *w)
{
	return aux == INTERP_NAUX ? 0 :
	       interp_build_action(f->way, INTERP_AUX, aux, w, f->diag);
}

/* The outputs are as the program has left them at the place, but for the
 * polarity: what is not left out turns the electrode itself. */
static int add_outputs(struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);
	uint32_t off = INTERP_NAUX, pump = INTERP_NAUX, said = INTERP_NAUX;
	const struct interp_build_word w = { .line = f->entry->line };
	int err = 0;

	for (uint32_t i = 0; i <= f->far; i++) {
		const uint32_t aux = INTERP_AUX_OF(s[i].arg);

		if (s[i].kind != INTERP_AUX)
			continue;
		if (aux > INTERP_AUX_POWER_NEGATIVE)
			pump = aux;
		else
			off = aux == INTERP_AUX_POWER_OFF ? aux : INTERP_NAUX;
		if (i <= f->last && aux <= INTERP_AUX_POWER_NEGATIVE &&
		    aux != INTERP_AUX_POWER_OFF)
			said = aux;
	}
	f->entry->dead = off != INTERP_NAUX;
	/* Without a way up there is a wire to be threaded. */
	if (f->o->up < 0)
		err = interp_build_action(f->way, INTERP_STOP, 0, &w, f->diag);
	f->entry->again = find_unanswered(f);
	if (err == 0 && f->entry->again)
		err = interp_build_action(f->way, INTERP_MCODE,
					  f->entry->again, &w, f->diag);
	if (err == 0)
		err = add_aux(f, pump, &w);
	if (err == 0)
		err = add_aux(f, said, &w);
	return err ? err : add_aux(f, off, &w);
}

/* Both have the same columns, in the same order. */
static int add_columns(struct from *f)
{
	struct interp_build *b = f->b;
	uint32_t moved = 0;
	int err;

	for (int i = 0; i < INTERP_NAXES; i++)
		if (f->way->first[i] !=
		    llround(f->entry->entry_mm[i] * b->sub_mm[i]))
			moved |= 1u << i;
	err = build_columns(b, moved);
	for (uint32_t k = 0; err == 0 && k < b->naxes; k++)
		err = build_columns(f->way, 1u << b->column[k]);
	return err;
}

static int make_way(struct from *f)
{
	struct interp_build_options o = f->b->o;
	int err;

	for (int i = 0; i < INTERP_NAXES; i++)
		o.start_mm[i] = f->o->now_mm[i] - shift_mm(f, i);
	o.fit_mm = 0;
	o.from = NULL;
	o.memory = NULL;
	f->way = interp_build_create(&o);
	if (!f->way)
		return -ENOMEM;
	/* The travel counts where the axes are, and the cycle checks it. */
	f->way->loose = f->b->loose;
	err = add_columns(f);
	if (err == 0)
		err = add_legs(f);
	if (err == 0)
		err = add_outputs(f);
	for (int i = 0; i < INTERP_NAXES; i++)
		f->entry->entry_mm[i] += shift_mm(f, i);
	return err;
}

/* -- What is left of the program ------------------------------------------ */

/* Done before the place, and not done again: a dwell of no time. */
static void forget(struct from *f, struct interp_seg *s)
{
	struct interp_build_entry *e = f->entry;

	if (s->kind == INTERP_MCODE && s->arg != e->again &&
	    e->npassed < INTERP_PASSED_MAX)
		e->passed[e->npassed++] = s->arg;
	if (s->kind == INTERP_DWELL || s->kind == INTERP_STOP ||
	    s->kind == INTERP_OPTIONAL_STOP || s->kind == INTERP_MCODE) {
		s->kind = INTERP_DWELL;
		s->arg = 0;
	}
	if (s->kind == INTERP_ELECTRODE)
		s->arg &= ~INTERP_ELECTRODE_STOP;
}

/* A part with a time that is over has none any more. */
static void forget_time(const struct from *f, struct interp_seg *s)
{
	struct interp_seg *end;

	if (s->kind != INTERP_TIMED || s->arg > f->far)
		return;
	end = segs_of(f->b) + s->arg;
	s->kind = end->kind = INTERP_DWELL;
	s->arg = end->arg = 0;
}

static void forget_all(struct from *f)
{
	struct interp_seg *s = segs_of(f->b);

	for (uint32_t i = 0; i <= f->far; i++) {
		forget(f, &s[i]);
		forget_time(f, &s[i]);
	}
}

/* Lines of the way may have bits: they go behind those of the program. */
static int take_bits(struct from *f)
{
	struct interp_build *b = f->b, *way = f->way;
	struct interp_seg *s = segs_of(way);
	const uint64_t *words = way->bits.at;

	for (size_t i = 0; i < way->segs.n; i++)
		if (s[i].kind == INTERP_LINE && s[i].arg)
			s[i].arg += (uint32_t)b->bits.n;
	for (size_t i = 0; i < way->bits.n; i++) {
		uint64_t *word = build_table_add(&b->bits);

		if (!word)
			return -ENOMEM;
		*word = words[i];
	}
	return 0;
}

static int append(struct table *to, const struct table *from, size_t first)
{
	const char *at = from->at;

	for (size_t i = first; i < from->n; i++) {
		void *row = build_table_add(to);

		if (!row)
			return -ENOMEM;
		memcpy(row, at + i * from->size, from->size);
	}
	return 0;
}

static void number_anew(const struct from *f, size_t nway)
{
	struct interp_build *b = f->b;
	struct interp_seg *s = segs_of(b);
	const size_t left_out = (size_t)f->last + 1;

	b->length_mm = 0;
	for (size_t i = 0; i < b->segs.n; i++) {
		if (i >= nway && s[i].kind == INTERP_TIMED)
			s[i].arg = (uint32_t)(s[i].arg - left_out + nway);
		s[i].s_mm = b->length_mm;
		b->length_mm += s[i].length_mm;
	}
}

/* What was left out had its own; the last of these counts for the way. */
static void place_origins(const struct from *f, size_t nway)
{
	struct interp_origin *o = f->b->origins.at;

	for (size_t i = 0; i < f->b->origins.n; i++)
		o[i].seg = o[i].seg > f->last ?
			   (uint32_t)(o[i].seg - f->last - 1 + nway) : 0;
}

static void swap(struct table *a, struct table *b)
{
	const struct table t = *a;

	*a = *b;
	*b = t;
}

/* The segments of the way, and those behind what is left out, in the memory of
 * these: that may become the program. */
static int join_segs(struct interp_build *b, const struct table *way,
		     size_t left_out)
{
	const size_t rest = b->segs.n - left_out, size = b->segs.size;
	char *at;

	b->segs.room = b->segs_room;
	if (way->n > left_out &&
	    build_table_room(&b->segs, way->n - left_out) < 0)
		return -ENOMEM;
	b->segs_room = b->segs.room;
	at = b->segs.at;
	memmove(at + way->n * size, at + left_out * size, rest * size);
	memcpy(at, way->at, way->n * size);
	b->segs.n = way->n + rest;
	return 0;
}

static int join(struct from *f)
{
	struct interp_build *b = f->b, *way = f->way;
	const size_t nway = way->segs.n, left_out = (size_t)f->last + 1;
	int err = take_bits(f);

	/* The last node of the way is the first of the rest. */
	if (err == 0)
		err = append(&way->nodes, &b->nodes,
			     (left_out + 1) * b->naxes);
	b->inside.left_mm = left_out < b->segs.n ?
			    segs_of(b)[left_out].s_mm : b->length_mm;
	if (err == 0)
		err = join_segs(b, &way->segs, left_out);
	if (err < 0)
		return err;
	f->entry->way_mm = b->depth.known_mm = way->length_mm;
	swap(&b->nodes, &way->nodes);
	b->timed = 0;
	b->inside.nway = (uint32_t)nway;
	memcpy(b->first, way->first, sizeof(b->first));
	number_anew(f, nway);
	place_origins(f, nway);
	return 0;
}

/* Its lines are done in the order of the path, so the last is found there. */
static int refuse_line(const struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);
	uint32_t last = 0;

	for (uint32_t i = 0; i < f->b->segs.n; i++)
		if (s[i].length_mm > 0 && s[i].line > last)
			last = s[i].line;
	f->diag->line = f->o->line;
	return interp_diag_say(f->diag,
			       "nothing moves on the path from line %u on; "
			       "a line that moves, as %u",
			       f->o->line, last);
}

static int find_place(struct from *f)
{
	const struct interp_seg *s = segs_of(f->b);
	struct interp_build_entry *e = f->entry;
	uint32_t at;

	e->length_mm = f->b->length_mm;
	if (!f->o->line) {
		f->far = find_far(f->b, f->o->far_mm);
		e->far_mm = f->o->far_mm;
		e->line = s[f->far].line;
		return 0;
	}
	at = find_line(f->b, f->o->line);
	if (!at || s[at].s_mm >= f->b->length_mm)
		return refuse_line(f);
	/* A positioning motion is not followed: the way in leads to its end. */
	f->far = is_positioning(&s[at]) ? at : at - 1;
	e->far_mm = s[at].s_mm;
	e->line = s[at].line;
	return 0;
}

int build_leave_out(struct interp_build *b, const struct interp_build_from *o,
		    struct interp_build_entry *ret, struct interp_diag *diag)
{
	struct from f = { .b = b, .o = o, .entry = ret, .diag = diag };
	const struct interp_seg *s;
	int err;

	*ret = (struct interp_build_entry) { .npassed = 0 };
	err = find_place(&f);
	if (err < 0)
		return err;
	f.last = find_last(b, f.far);
	err = check(&f);
	if (err < 0)
		return err;
	s = segs_of(b);
	b->probed = o->probed;
	b->depth = o->depth;
	ret->from_mm = s[f.last].s_mm + s[f.last].length_mm;
	for (size_t i = f.last + 1; !ret->next_line && i < b->segs.n; i++)
		ret->next_line = s[i].length_mm > 0 ? s[i].line : 0;
	entry_of(&f, ret->entry_mm);
	err = make_way(&f);
	if (err == 0) {
		forget_all(&f);
		err = join(&f);
	}
	interp_build_destroy(f.way);
	return err;
}

int interp_build_from(struct interp_build *b, const struct interp_build_from *o,
		      struct interp_build_entry *ret, struct interp_diag *diag)
{
	const int err = interp_build_flush(b, diag);

	diag->column = 1;
	if (err < 0)
		return err;
	if (b->inside.done) {
		build_early_entry(b, ret);
		return 0;
	}
	return build_leave_out(b, o, ret, diag);
}
