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
#include "grow.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_MAX	99999999	/* of a program */
#define LABEL_MAX	9999		/* of one that is called */
#define A_CALL		"M98 P1000, with L3 to repeat it; or M98 P31000; or " \
			"M98 <NAME> in Fanuc's dialects"

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
	p = nc_skip_void(p, end);
	return p < end && (*p & 0xdf) >= 'A' && (*p & 0xdf) <= 'Z' &&
	       p + 1 < end && (p[1] & 0xdf) >= 'A' && (p[1] & 0xdf) <= 'Z';
}

/* -- Where programs begin ------------------------------------------------- */

const uint8_t *nc_name_end(const uint8_t *at, const uint8_t *end)
{
	const uint8_t *p = at + 1;

	while (p < end && (isalnum(*p) || (*p && strchr("+-_. ", *p))))
		p++;
	return p < end && *p == '>' && p > at + 1 ? p + 1 : NULL;
}

/* What may begin a program in the line from @p to @end: the first thing in it,
 * or the first behind its N. */
static const uint8_t *first_of(const struct nc_dialect *d, const uint8_t *p,
			       const uint8_t *end)
{
	uint64_t ignored = 0;

	p = nc_skip_void(p, end);
	if (d->label != 'N' && p < end && (*p | 0x20) == 'n') {
		p = nc_skip_blanks(p + 1, end);
		p = nc_skip_void(nc_digits(p, end, &ignored), end);
	}
	return p;
}

/* The number behind the O (or the N, if the dialect has that) at @p; 0: there
 * is none. */
static uint32_t label_of(const struct nc_dialect *d, const uint8_t *p,
			 const uint8_t *end)
{
	const uint8_t *first;
	uint64_t n = 0;

	if (p == end || ((*p & 0xdf) != d->label &&
			 !(*p == ':' && d->classes[':'] == NC_WORD + NC_O)))
		return 0;
	first = nc_skip_blanks(p + 1, end);
	p = nc_digits(first, end, &n);
	/* LinuxCNC's o100 sub is not a label. */
	if (is_keyword(p, end))
		return 0;
	return p - first <= NC_DIGITS_MAX && n <= NUMBER_MAX ? (uint32_t)n : 0;
}

static bool is_name(const struct nc_dialect *d, const uint8_t *p,
		    const uint8_t *end)
{
	return p < end && d->classes[*p] == NC_LETTER_NAME &&
	       nc_name_end(p, end);
}

bool nc_begins_program(const struct nc_reader *r, const uint8_t *p,
		       const uint8_t *end)
{
	p = first_of(r->d, p, end);
	return r->d->label == 'O' && (label_of(r->d, p, end) ||
				      is_name(r->d, p, end));
}

/* Lower case means the same as upper case. */
static bool same_name(const uint8_t *a, const uint8_t *b)
{
	for (; *a != '>' && toupper(*a) == toupper(*b); a++)
		b++;
	return *a == *b;
}

static struct nc_label *named(struct nc_reader *r, const uint8_t *at)
{
	for (size_t i = 0; i < r->nnamed; i++, r->executed++) {
		const struct nc_label *l = &r->named[i];

		if (same_name(r->text + l->place.offset + l->name, at))
			return &r->named[i];
	}
	return NULL;
}

static int refuse_second(struct nc_reader *r, struct nc_label l,
			 const uint8_t *at, uint32_t first)
{
	nc_go(r, l.place);
	nc_begin_line(r);
	r->line = l.place.line;
	return nc_refuse(r, at, "each of them once",
			 "a second %s; the first is in line %u",
			 nc_quote_word(r, at).s, first);
}

static int note_name(struct nc_reader *r, struct nc_label l, const uint8_t *at)
{
	const struct nc_label *was = named(r, at);

	if (was)
		return refuse_second(r, l, at, was->place.line);
	if (r->nnamed == r->named_room &&
	    grow_array(&r->named, &r->named_room, sizeof(*r->named)))
		return -ENOMEM;
	l.name = (uint32_t)(at - r->text - (ptrdiff_t)l.place.offset);
	r->named[r->nnamed++] = l;
	return 0;
}

/* Note what begins a program in a line, if anything does. */
static int note_label(struct nc_reader *r, struct nc_label l,
		      const uint8_t *end)
{
	const uint8_t *at = first_of(r->d, r->text + l.place.offset, end);
	const uint32_t n = label_of(r->d, at, end);

	if (is_name(r->d, at, end))
		return note_name(r, l, at);
	if (n == 0 || n > LABEL_MAX)
		return 0;
	if (r->labels[n].place.line && r->d->label == 'O')
		return refuse_second(r, l, at, r->labels[n].place.line);
	if (r->labels[n].place.line)
		r->labels[n].second = l.place.line;
	else
		r->labels[n] = l;
	return 0;
}

/* Look at every line, once. */
static int find_labels(struct nc_reader *r)
{
	struct nc_label l = { .place.line = 1 };
	const uint8_t *p = r->text;
	int err = 0;

	if (r->labels)
		return 0;
	r->labels = calloc(LABEL_MAX + 1, sizeof(r->labels[0]));
	if (!r->labels)
		return -ENOMEM;
	for (; !err && p < r->end; l.place.line++) {
		const uint8_t *end = nc_line_end(p, r->end);

		l.place.offset = (size_t)(p - r->text);
		err = note_label(r, l, end);
		p = nc_line_next(end, r->end);
	}
	return err;
}

void nc_forget_labels(struct nc_reader *r)
{
	free(r->labels);
	free(r->named);
}

/* A % alone on its line. */
static bool is_percent(const uint8_t *p, const uint8_t *end)
{
	p = nc_skip_void(p + 1, end);
	return p == end || *p == ';';
}

const uint8_t *nc_tape_end(const uint8_t *text, const uint8_t *end)
{
	const uint8_t *p = text, *stop = text, *line;
	bool begun = false;

	for (; p < end && !begun; p = nc_line_next(stop, end)) {
		stop = nc_line_end(p, end);
		p = nc_skip_void(p, stop);
		begun = p < stop && *p != ';' && *p != '/';
	}
	while (p < end && (p = memchr(p, '%', (size_t)(end - p)))) {
		for (line = p; nc_classes[line[-1]] != NC_EOL; line--)
			;
		stop = nc_line_end(p, end);
		if (nc_skip_void(line, stop) == p)
			return is_percent(p, stop) ? p : stop;
		p = stop;
	}
	return end;
}

/* -- Calls and returns ---------------------------------------------------- */

/* Does a word that must not stand in front of an O stand in front of @at? */
static bool is_behind(const struct nc_block *b, const uint8_t *at)
{
	const uint32_t codes = ~(NC_BIT(NC_LABEL) | NC_BIT(NC_FEED));

	for (int i = 0; i < NC_NSLOTS; i++) {
		if ((b->words & NC_BIT(i)) && i != NC_N && b->at[i] < at)
			return true;
	}
	for (int i = 0; i < NC_NGROUPS; i++) {
		if ((b->groups & codes & NC_BIT(i)) && b->code_at[i] < at)
			return true;
	}
	return false;
}

int nc_run_label(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint8_t *at = b->at[nc_has(r, NC_O) ? NC_O : NC_NAME];
	struct nc_frame *f = &r->frame[r->depth];

	if (is_behind(b, at))
		return nc_refuse(r, at, "O or <NAME> as the first word of its "
				 "line", "%s behind other words",
				 nc_quote_word(r, at).s);
	if (!r->fresh)
		return nc_refuse(r, at, r->depth ?
				 "M99 at the end of a subprogram" :
				 "M2 or M30 at the end of the main program",
				 "the next program, %s, without an end of this "
				 "one", nc_quote_word(r, at).s);
	f->number = nc_has(r, NC_O) ? (uint32_t)b->value[NC_O] : 0;
	f->entry = nc_this(r);
	return 0;
}

/* Go on in the program that begins at @l. */
static int enter(struct nc_reader *r, const struct nc_label *l,
		 uint32_t repeats, const uint8_t *at)
{
	struct nc_frame *f = &r->frame[r->depth + 1];

	if (r->depth == INTERP_NC_DEPTH_MAX)
		return nc_refuse(r, at, "up to 8 calls inside each other",
				 "a call inside %d others",
				 INTERP_NC_DEPTH_MAX);
	*f = (struct nc_frame) { .left = repeats - 1, .entry = l->place,
				 .back = nc_next(r) };
	r->depth++;
	nc_go(r, l->place);
	r->fresh = true;
	return 0;
}

static int enter_number(struct nc_reader *r, uint32_t number,
			uint32_t repeats, const uint8_t *at)
{
	const struct nc_label *l = &r->labels[number];
	int err;

	if (l->place.line == 0)
		return nc_refuse(r, at, r->d->label == 'O' ?
				 "the number of an O word that begins a line "
				 "of this text" :
				 "the number of an N word that begins a line "
				 "of this text", "a call of %c%u, which is not "
				 "there", r->d->label, number);
	if (l->second)
		return nc_refuse(r, at, "a number that one line has",
				 "a call of N%u, which lines %u and %u have",
				 number, l->place.line, l->second);
	/* With variables, a recursion may end. */
	for (uint32_t i = 0; !r->d->macros && i <= r->depth; i++) {
		if (r->frame[i].number == number)
			return nc_refuse(r, at, "calls of other subprograms",
					 "recursion: %c%u is being carried out "
					 "already", r->d->label, number);
	}
	err = enter(r, l, repeats, at);
	if (err)
		return err;
	r->frame[r->depth].number = number;
	snprintf(r->frame[r->depth].name, sizeof(r->frame[0].name), "%c%u",
		 r->d->label, number);
	return 0;
}

int nc_call(struct nc_reader *r, double number, uint32_t times,
	    const uint8_t *at)
{
	int err;

	if (number != floor(number) || !(number >= 1 && number <= LABEL_MAX))
		return nc_refuse(r, at, "a whole number of 1 to 9999",
				 "P%g names no subprogram", number);
	err = find_labels(r);
	return err ? err : enter_number(r, (uint32_t)number, times, at);
}

int nc_call_name(struct nc_reader *r, uint32_t times, const uint8_t *at)
{
	const struct nc_quote name = nc_quote_word(r, at);
	const struct nc_label *l;
	int err = find_labels(r);

	if (err)
		return err;
	l = named(r, at);
	if (!l)
		return nc_refuse(r, at, "a <NAME> that begins a line of this "
				 "text; other files are not read",
				 "a call of %s, which is not there", name.s);
	err = enter(r, l, times, at);
	if (!err)
		snprintf(r->frame[r->depth].name, sizeof(r->frame[0].name),
			 "%s", name.s);
	return err;
}

/* M98 P1000 L3, or P31000: the last four digits are the number; M98 <NAME>. */
static int call(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const double p = nc_has(r, NC_P) ? b->value[NC_P] : 0;
	uint32_t number = p > 0 ? (uint32_t)p : 0;
	uint32_t repeats = nc_has(r, NC_L) ? (uint32_t)b->value[NC_L] : 1;

	if (nc_has(r, NC_P) == nc_has(r, NC_NAME))
		return nc_refuse(r, b->code_at[NC_STOP], A_CALL,
				 nc_has(r, NC_P) ? "M98 with P and a <NAME>" :
				 "M98 without P");
	if (nc_has(r, NC_NAME))
		return nc_call_name(r, repeats, b->at[NC_NAME]);
	if (number > LABEL_MAX && !nc_has(r, NC_L)) {
		repeats = number / (LABEL_MAX + 1);
		number %= LABEL_MAX + 1;
	}
	if (p != floor(p) || number == 0 || number > LABEL_MAX)
		return nc_refuse(r, b->at[NC_P], A_CALL,
				 "%s names no subprogram",
				 nc_quote_word(r, b->at[NC_P]).s);
	return nc_call(r, number, repeats, b->at[NC_P]);
}

static void leave(struct nc_reader *r)
{
	nc_macro_leave(r);
	nc_go(r, r->frame[r->depth].back);
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
		nc_go(r, f->entry);
		r->fresh = true;
		return 0;
	}
	leave(r);
	return 0;
}

/* Has a line words that would be carried out, or a % that ends nothing because
 * words follow it?  Of what has none: comments, the bytes with which a file is
 * filled up. */
static bool has_words(const uint8_t *p, const uint8_t *end)
{
	p = nc_skip_void(p, end);
	return p < end && (isalpha(*p) || *p == '%');
}

/* Has a line words, and not one % more? */
static bool is_more(const uint8_t *p, const uint8_t *end)
{
	const uint8_t *at = nc_skip_void(p, end);

	return has_words(p, end) && !(*at == '%' && is_percent(at, end));
}

static bool begins_with_percent(const struct nc_reader *r)
{
	const uint8_t *stop;

	for (const uint8_t *p = r->text; p < r->end;
	     p = nc_line_next(stop, r->end)) {
		stop = nc_line_end(p, r->end);
		p = nc_skip_void(p, stop);
		if (p < stop && *p != ';' && *p != '/')
			return *p == '%';
	}
	return false;
}

/* Nothing behind the % that ends the text is read.  If no % began the text, it
 * may as well have got between the lines. */
int nc_check_tape(struct nc_reader *r)
{
	const uint8_t *at = r->text, *p = at, *end = r->text_end;
	uint32_t line = 0, n;

	if (r->end == end || *r->end != '%')
		return 0;
	for (; p <= r->end; p = nc_line_next(nc_line_end(p, end), end)) {
		at = p;
		line++;
	}
	for (n = line + 1; p < end && !is_more(p, nc_line_end(p, end)); n++)
		p = nc_line_next(nc_line_end(p, end), end);
	if (p == end)
		return 0;
	if (begins_with_percent(r)) {
		nc_note_tape(r, n);
		return 0;
	}
	r->line = line;
	r->line_at = at;
	return nc_refuse(r, r->end, "a % in front of the program too, or none",
			 "a %% with words behind it, in line %u, and no %% "
			 "before the program", n);
}

/* Behind the end there may be subprograms.  Other words are a second program,
 * or the end came too early. */
static void note_rest(struct nc_reader *r)
{
	const uint8_t *p = r->at, *end;
	uint32_t line = r->line + 1;

	for (; p < r->end; p = nc_line_next(end, r->end), line++) {
		end = nc_line_end(p, r->end);
		p = nc_skip_void(p, end);
		if (p < end && (strchr(r->d->label == 'N' ? "Nn" : "Oo", *p) ||
				nc_begins_program(r, p, end)))
			return;
		if (has_words(p, end)) {
			nc_note_rest(r, line);
			return;
		}
	}
}

static int finish(struct nc_reader *r)
{
	if (r->depth == 0)
		note_rest(r);
	r->over = true;
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
	if (r->depth > 0 && !r->over)
		return nc_refuse_at(r, r->line,
				    "M99 at the end of a subprogram",
				    "the end of the text inside %s",
				    r->frame[r->depth].name);
	if (r->d->m2_ends && !r->over)
		return nc_refuse_at(r, r->line, "M02 at the end",
				    "the end of the text without M02");
	if (r->curve.open && !r->over)
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
