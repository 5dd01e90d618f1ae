/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flow.c - subprograms and the end
 *
 * A subprogram is O1000 ... M99.  It stands behind the M2 or M30 of the main
 * program, in the same text.  In some dialects the label is N, which numbers
 * other lines too.  M98 P1000 L3 carries it out three times, and so does M98
 * P31000.  The places of the O words are found once, at the first M98.
 */
#include "code/macro.h"
#include "code/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_MAX	99999999	/* of a program */
#define LABEL_MAX	9999		/* of one that is called */
#define A_CALL		"M98 P1000, with L3 to repeat it; or M98 P31000"

const uint8_t *nc_line_end(const uint8_t *p, const uint8_t *end)
{
	while (p < end && nc_classes[*p] != NC_EOL)
		p++;
	return p;
}

const uint8_t *nc_skip_void(const uint8_t *p, const uint8_t *end)
{
	for (;;) {
		p = nc_skip_blanks(p, end);
		if (p == end || *p != '(')
			return p;
		while (p < end && *p != ')')
			p++;
		if (p < end)
			p++;
	}
}

static bool is_keyword(const uint8_t *p, const uint8_t *end)
{
	p = nc_skip_blanks(p, end);
	return p < end && (*p & 0xdf) >= 'A' && (*p & 0xdf) <= 'Z' &&
	       p + 1 < end && (p[1] & 0xdf) >= 'A' && (p[1] & 0xdf) <= 'Z';
}

/* The number behind the O (or the N, if the dialect has that) that begins the
 * line from @p to @end; 0: the line does not begin so. */
static uint32_t label_of(const struct nc_dialect *d, const uint8_t *p,
			 const uint8_t *end, const uint8_t **ret_at)
{
	const char letter = (char)d->label;
	uint64_t n = 0, ignored = 0;
	const uint8_t *first;

	p = nc_skip_void(p, end);
	if (letter != 'N' && p < end && (*p | 0x20) == 'n') {
		p = nc_skip_blanks(p + 1, end);
		p = nc_skip_void(nc_digits(p, end, &ignored), end);
	}
	if (p == end || ((*p & 0xdf) != letter &&
			 !(*p == ':' && d->classes[':'] == NC_WORD + NC_O)))
		return 0;
	*ret_at = p;
	first = nc_skip_blanks(p + 1, end);
	p = nc_digits(first, end, &n);
	/* LinuxCNC's o100 sub is not a label. */
	if (is_keyword(p, end))
		return 0;
	return p - first <= NC_DIGITS_MAX && n <= NUMBER_MAX ? (uint32_t)n : 0;
}

uint32_t nc_label_at(const struct nc_reader *r, const uint8_t *p,
		     const uint8_t *end)
{
	const uint8_t *at;

	return r->d->label == 'O' ? label_of(r->d, p, end, &at) : 0;
}

static int refuse_second(struct nc_reader *r, struct nc_label l,
			 const uint8_t *at, uint32_t n)
{
	r->mapped = false;
	r->line_at = l.at;
	r->line = l.line;
	return nc_refuse(r, at, "each O number once",
			 "a second O%u; the first is in line %u", n,
			 r->labels[n].line);
}

/* Note the O word of a line, if it has one. */
static int note_label(struct nc_reader *r, struct nc_label l,
		      const uint8_t *end)
{
	const uint8_t *at;
	const uint32_t n = label_of(r->d, l.at, end, &at);

	if (n == 0 || n > LABEL_MAX)
		return 0;
	if (r->labels[n].line && r->d->label == 'O')
		return refuse_second(r, l, at, n);
	if (r->labels[n].line)
		r->labels[n].second = l.line;
	else
		r->labels[n] = l;
	return 0;
}

/* A % alone on its line. */
static bool ends_tape(const uint8_t *p, const uint8_t *end)
{
	if (p == end || *p != '%')
		return false;
	p = nc_skip_void(p + 1, end);
	return p == end || *p == ';';
}

/* Look at every line, up to the second %. */
static int find_labels(struct nc_reader *r)
{
	struct nc_label l = { .at = r->text, .line = 1 };
	bool fresh = true;
	int err = 0;

	r->labels = calloc(LABEL_MAX + 1, sizeof(r->labels[0]));
	if (!r->labels)
		return -ENOMEM;
	for (; !err && l.at < r->end; l.line++) {
		const uint8_t *end = nc_line_end(l.at, r->end);
		const uint8_t *p = nc_skip_void(l.at, end);

		if (ends_tape(p, end) && !fresh)
			break;
		if (p < end && *p != ';' && *p != '/')
			fresh = false;
		err = note_label(r, l, end);
		l.at = nc_line_next(end, r->end);
	}
	return err;
}

/* The first word of the line, among those that must not stand in front of an
 * O. */
static const uint8_t *first_word(const struct nc_block *b)
{
	const uint32_t codes = ~(NC_BIT(NC_LABEL) | NC_BIT(NC_FEED));
	const uint8_t *at = b->at[NC_O];

	for (int i = 0; i < NC_NSLOTS; i++) {
		if ((b->words & NC_BIT(i)) && i != NC_N && b->at[i] < at)
			at = b->at[i];
	}
	for (int i = 0; i < NC_NGROUPS; i++) {
		if ((b->groups & codes & NC_BIT(i)) && b->code_at[i] < at)
			at = b->code_at[i];
	}
	return at;
}

int nc_run_label(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint8_t *at = b->at[NC_O];

	if (first_word(b) < at)
		return nc_refuse(r, at, "O as the first word of its line",
				 "%s behind other words",
				 nc_quote_word(r, at).s);
	if (!r->fresh)
		return nc_refuse(r, at, r->depth ?
				 "M99 at the end of a subprogram" :
				 "M2 or M30 at the end of the main program",
				 "the next program, %s, without an end of this "
				 "one", nc_quote_word(r, at).s);
	r->frame[r->depth].number = (uint32_t)b->value[NC_O];
	r->frame[r->depth].entry = r->line_at;
	r->frame[r->depth].entry_line = r->line;
	return 0;
}

static int enter(struct nc_reader *r, uint32_t number, uint32_t repeats,
		 const uint8_t *at)
{
	const struct nc_label *l = &r->labels[number];

	if (l->line == 0)
		return nc_refuse(r, at, r->d->label == 'O' ?
				 "the number of an O word that begins a line "
				 "of this text" :
				 "the number of an N word that begins a line "
				 "of this text", "a call of %c%u, which is not "
				 "there", r->d->label, number);
	if (l->second)
		return nc_refuse(r, at, "a number that one line has",
				 "a call of N%u, which lines %u and %u have",
				 number, l->line, l->second);
	/* With variables, a recursion may end. */
	for (uint32_t i = 0; !r->d->macros && i <= r->depth; i++) {
		if (r->frame[i].number == number)
			return nc_refuse(r, at, "calls of other subprograms",
					 "recursion: %c%u is being carried out "
					 "already", r->d->label, number);
	}
	if (r->depth == INTERP_NC_DEPTH_MAX)
		return nc_refuse(r, at, "up to 8 calls inside each other",
				 "a call inside %d others",
				 INTERP_NC_DEPTH_MAX);
	r->frame[++r->depth] = (struct nc_frame) {
		.number = number, .left = repeats - 1,
		.entry = l->at, .entry_line = l->line,
		.back = r->at, .return_line = r->line,
	};
	r->at = l->at;
	r->line = l->line - 1;
	r->fresh = true;
	return 0;
}

int nc_call(struct nc_reader *r, double number, uint32_t times,
	    const uint8_t *at)
{
	if (number != floor(number) || !(number >= 1 && number <= LABEL_MAX))
		return nc_refuse(r, at, "a whole number of 1 to 9999",
				 "P%g names no subprogram", number);
	if (!r->labels) {
		const int err = find_labels(r);

		if (err)
			return err;
	}
	return enter(r, (uint32_t)number, times, at);
}

/* M98 P1000 L3, or P31000: the last four digits are the number. */
static int call(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double p = nc_has(r, NC_P) ? b->value[NC_P] : 0;
	uint32_t number = p > 0 ? (uint32_t)p : 0, repeats = 1;

	if (!nc_has(r, NC_P))
		return nc_refuse(r, b->code_at[NC_STOP], A_CALL,
				 "M98 without P");
	if (number > LABEL_MAX && !nc_has(r, NC_L)) {
		repeats = number / (LABEL_MAX + 1);
		number %= LABEL_MAX + 1;
	}
	if (p != floor(p) || number == 0 || number > LABEL_MAX)
		return nc_refuse(r, b->at[NC_P], A_CALL,
				 "%s names no subprogram",
				 nc_quote_word(r, b->at[NC_P]).s);
	if (nc_has(r, NC_L))
		repeats = (uint32_t)b->value[NC_L];
	if (!r->labels) {
		const int err = find_labels(r);

		if (err)
			return err;
	}
	return enter(r, number, repeats, b->at[NC_P]);
}

static void leave(struct nc_reader *r)
{
	const struct nc_frame *f = &r->frame[r->depth];

	nc_macro_leave(r);
	r->at = f->back;
	r->line = f->return_line;
	r->depth--;
}

/* M99 P90: to N90 of the program that called, or of the main program itself.
 * What becomes of the other times is told differently for each control. */
static int back_to(struct nc_reader *r)
{
	const uint8_t *at = r->block.at[NC_P];

	if (r->d->macros != MACRO_FANUC)
		return nc_refuse(r, at, "M99 alone; dialect fanuc-sinker and "
				 "others have M99 P", "M99 with P");
	if (r->frame[r->depth].left > 0)
		return nc_refuse(r, at, "a call without L, or M99 without P",
				 "M99 P with %u times still to go",
				 r->frame[r->depth].left);
	if (r->depth > 0)
		leave(r);
	return nc_macro_jump(r, at, r->block.value[NC_P]);
}

static int back(struct nc_reader *r)
{
	struct nc_frame *f = &r->frame[r->depth];

	if (nc_has(r, NC_P))
		return back_to(r);
	if (r->depth == 0)
		return nc_refuse(r, r->block.code_at[NC_STOP],
				 "M2 or M30 at the end of the main program",
				 "M99 outside a subprogram");
	if (f->left > 0) {
		f->left--;
		r->at = f->entry;
		r->line = f->entry_line - 1;
		r->fresh = true;
		return 0;
	}
	leave(r);
	return 0;
}

/* Has a line words that would be carried out?  Of what has none: comments,
 * the end of a tape, the bytes with which a file is filled up. */
static bool has_words(const uint8_t *p, const uint8_t *end)
{
	p = nc_skip_void(p, end);
	return p < end && isalpha(*p);
}

/* Behind the end there may be subprograms.  Other words are a second program,
 * or the end came too early. */
static void note_rest(struct nc_reader *r)
{
	const char *label = r->d->label == 'N' ? "Nn" : "Oo";
	const uint8_t *p = r->at, *end;
	uint32_t line = r->line + 1;

	for (; p < r->end; p = nc_line_next(end, r->end), line++) {
		end = nc_line_end(p, r->end);
		p = nc_skip_void(p, end);
		if (ends_tape(p, end))
			return;
		if (p < end && (strchr(label, *p) || nc_label_at(r, p, end)))
			return;
		if (has_words(p, end)) {
			nc_note_rest(r, line);
			return;
		}
	}
}

static int finish(struct nc_reader *r)
{
	if (r->depth == 0 && !r->over)
		note_rest(r);
	r->over = NC_FINISHED;
	r->word.line = r->line;
	return contour_action(&r->contour, INTERP_END, 0, &r->word, r->diag);
}

static int halt(struct nc_reader *r)
{
	return nc_action(r, INTERP_STOP, 0, r->block.code_at[NC_STOP]);
}

static int optional_halt(struct nc_reader *r)
{
	return nc_action(r, INTERP_OPTIONAL_STOP, 0,
			 r->block.code_at[NC_STOP]);
}

int nc_run_stop(struct nc_reader *r)
{
	static int (*const stops[])(struct nc_reader *) = {
		[NC_HALT]		= halt,
		[NC_OPTIONAL_HALT]	= optional_halt,
		[NC_FINISH]		= finish,
		[NC_CALL]		= call,
		[NC_RETURN]		= back,
	};

	return stops[r->block.code[NC_STOP]->value](r);
}

int nc_end_of_text(struct nc_reader *r)
{
	if (r->depth > 0 && r->over != NC_FINISHED)
		return nc_refuse_at(r, r->line,
				    "M99 at the end of a subprogram",
				    "the end of the text inside %c%u",
				    r->d->label, r->frame[r->depth].number);
	if (r->d->m2_ends && r->over != NC_FINISHED)
		return nc_refuse_at(r, r->line, "M02 at the end",
				    "the end of the text without M02");
	if (r->curve.open && r->over != NC_FINISHED)
		return nc_refuse_at(r, r->curve.line,
				    r->curve.open != NC_NURBS_BLOCK ?
				    "all its knots, in blocks of their own" :
				    "G5.3 behind its last control point",
				    "a curve that does not end");
	if (r->segs == 0)
		return nc_refuse_at(r, 0, "at least one motion or action",
				    "empty program");
	return contour_flush(&r->contour, r->diag);
}
