/* SPDX-License-Identifier: Apache-2.0 */
/*
 * list.c - lists all refusals of a text
 *
 * After the first refusal nobody knows where the machine would be, so places
 * are not checked any more.  The words of each line are checked, from the first
 * line to the last, subprograms where they stand.  Lines with variables are
 * left out.
 */
#include "code/dialect.h"
#include "code/macro.h"

#include <errno.h>
#include <string.h>

static void say(struct nc_reader *r, const struct interp_diag *d)
{
	struct interp_diag placed = *d;

	nc_dialect_place(&placed);
	if (r->ntold++ < INTERP_NC_REFUSED_MAX)
		r->o->refused->say(r->o->refused->arg, &placed);
}

static bool is_before(const struct interp_diag *a, const struct interp_diag *b)
{
	return a->line < b->line ||
	       (a->line == b->line && a->column < b->column);
}

void nc_tell(struct nc_reader *r)
{
	const struct interp_diag *d = r->diag;

	if (!r->first_told && is_before(&r->first, d)) {
		r->first_told = true;
		say(r, &r->first);
	}
	if (d->line == r->first.line && d->column == r->first.column)
		r->first_told = true;
	say(r, d);
}

static void begin_again(struct nc_reader *r)
{
	r->listing = true;
	r->first = *r->diag;
	r->at = r->text;
	r->line = 0;
	r->depth = 0;
	r->motion = NULL;
	r->fresh = true;
	r->tape = false;
	r->curve.open = 0;
}

bool nc_has_no_code(const struct nc_reader *r)
{
	return !(r->block.groups & ~(NC_BIT(NC_FEED) | NC_BIT(NC_LABEL)));
}

/* Nobody knows what the other words of a line with a refused word belong to.
 * If it was a motion, nobody knows what its next lines mean, either. */
static bool is_known(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const bool refused = b->takes == UINT32_MAX;

	if (refused && b->words & NC_MOVES)
		r->lost = true;
	if (nc_has_group(r, NC_MOTION))
		r->lost = false;
	return !refused && !(r->lost && nc_has_no_code(r));
}

static void look_at(struct nc_reader *r, const uint8_t *end)
{
	int err = nc_scan_line(r);

	if (err == 0 && is_known(r))
		err = nc_check_line(r);
	if (err == -EINVAL)
		nc_tell(r);
	if (nc_has_group(r, NC_MOTION) && !nc_has_group(r, NC_ONE_SHOT))
		r->motion = r->block.code[NC_MOTION];
	r->at = nc_line_next(end, r->end);
}

void nc_list_refusals(struct nc_reader *r)
{
	begin_again(r);
	while (r->at < r->end && r->ntold < INTERP_NC_REFUSED_MAX) {
		const uint8_t *end = nc_line_end(r->at, r->end);

		r->line++;
		if (r->d->macros && nc_macro_wanted(r, r->at, end))
			r->at = nc_line_next(end, r->end);
		else
			look_at(r, end);
	}
	if (!r->first_told)
		say(r, &r->first);
	*r->diag = r->first;
}
