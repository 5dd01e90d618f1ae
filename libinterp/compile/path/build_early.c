/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_early.c - a program that begins inside, while its text is still read
 *
 * As soon as the place is passed, what is before it is left out.  From then on
 * it is a program like any other.
 */
#include "path/builder.h"

#include <errno.h>

/* After so many more segments it is asked whether the place is passed where the
 * program begins. */
#define STEP		16

/* Of a part with a time the end is not known yet. */
static bool is_timed(const struct interp_build *b)
{
	const struct interp_seg *s = b->segs.at;

	return s[b->timed].kind == INTERP_TIMED && s[b->timed].arg == 0;
}

/* What is before the place does not change any more.  A line of the text may
 * come in any order, and curves may be taken back. */
static bool may_be_early(const struct interp_build *b)
{
	const struct interp_build_from *o = b->o.from;

	return o && !o->line && !b->inside.tried && b->segs.n > 0 &&
	       b->pieces.n == 0 && !(b->o.fit_mm > 0) &&
	       b->length_mm > o->far_mm && !is_timed(b);
}

/* If the place that the options name is passed, leave out what is before it.
 * All segments are whole.  Return: 0 or -ENOMEM. */
static int build_early(struct interp_build *b)
{
	struct interp_diag diag;
	int err;

	if (!may_be_early(b))
		return 0;
	b->inside.tried = true;
	err = build_leave_out(b, b->o.from, &b->inside.entry, &diag);
	b->inside.done = err == 0;
	/* What is refused is refused once more, at the end. */
	return err == -EINVAL ? 0 : err;
}

void build_early_entry(const struct interp_build *b,
		       struct interp_build_entry *ret)
{
	const struct interp_seg *s = b->segs.at;

	*ret = b->inside.entry;
	/* The same sum as if nothing had been left out. */
	ret->length_mm = b->inside.left_mm;
	for (size_t i = b->inside.nway; i < b->segs.n; i++) {
		ret->length_mm += s[i].length_mm;
		/* The place may have been in the last one that was known. */
		if (!ret->next_line && s[i].length_mm > 0)
			ret->next_line = s[i].line;
	}
}

int build_segs_room(struct interp_build *b)
{
	struct table *t = &b->segs;

	if (build_early(b) < 0)
		return -ENOMEM;
	t->room = b->segs_room;
	if (t->n == t->room && build_table_room(t, 1) < 0)
		return -ENOMEM;
	b->segs_room = t->room;
	if (b->o.from && !b->inside.tried && t->room > t->n + STEP)
		t->room = t->n + STEP;
	return 0;
}
