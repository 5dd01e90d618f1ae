/* SPDX-License-Identifier: Apache-2.0 */
/* note.c - notes what is ignored, and what other controls read differently */
#include "code/reader.h"

#include <stdarg.h>
#include <stdio.h>

static void say(struct nc_reader *r, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

static void say(struct nc_reader *r, const char *format, ...)
{
	char text[320];
	va_list ap;

	va_start(ap, format);
	vsnprintf(text, sizeof(text), format, ap);
	va_end(ap);
	r->o->notes->say(r->o->notes->arg, r->line, text);
}

void nc_note_code(struct nc_reader *r, const uint8_t *at,
		  const struct nc_code *code)
{
	const bool listed = code >= r->d->code &&
			    code < r->d->code + NC_NCODES;
	const size_t which = listed ? (size_t)(code - r->d->code) :
				      (size_t)NC_NCODES + code->text;
	uint8_t *told = &r->told[which / 8];
	const uint8_t bit = (uint8_t)(1u << which % 8);

	if (!r->o->notes || (*told & bit))
		return;
	*told |= bit;
	say(r, code->group == NC_IGNORED ? "%s is ignored: %s" : "%s: %s",
	    nc_quote_word(r, at).s, r->d->text + code->text);
}

/* Was this kind noted before?  From now on it was. */
static bool told(struct nc_reader *r, enum nc_told kind)
{
	const bool was = r->told_once & NC_BIT(kind);

	r->told_once |= NC_BIT(kind);
	return was;
}

void nc_note_point(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_quote word = nc_quote_word(r, at);

	if (!r->o->notes || !r->o->notes->plan || told(r, NC_TOLD_POINT))
		return;
	if (r->d->point == NC_POINT_LAST)
		say(r, "%s has no decimal point: its last digit counts %s "
		    "here, and 1 on many other controls", word.s,
		    r->unit_mm > 1 ? "0.0001" : "0.001");
	else
		say(r, "%s has no decimal point: it is read as %s.0 here, and "
		    "counts the last decimal on many controls of EDM machines",
		    word.s, word.s);
}

void nc_note_skipped(struct nc_reader *r)
{
	if (r->o->notes && !told(r, NC_TOLD_SKIPPED))
		say(r, "/: lines that begin with it are skipped, as with block "
		    "delete switched on");
}

void nc_note_columns(struct nc_reader *r, char letter, uint32_t number)
{
	char name[16];

	if (r->o->notes && r->o->notes->plan && !told(r, NC_TOLD_COLUMNS))
		say(r, "the numbers behind %s have no effect: the technology "
		    "table has no line inline %c, which says what each of them "
		    "means", interp_tech_name(letter, number, name,
					      sizeof(name)), letter);
}

void nc_note_title(struct nc_reader *r)
{
	if (r->o->notes)
		say(r, "%% begins the text; what stands behind it on its line "
		    "is its title, and is not carried out");
}

void nc_note_print(struct nc_reader *r, const char *word)
{
	if (r->o->notes && !told(r, NC_TOLD_PRINT))
		say(r, "%s is ignored: nothing is printed or sent from a "
		    "program here; edmctl history has what it came to", word);
}

void nc_note_vacant(struct nc_reader *r, uint32_t n)
{
	if (r->o->notes && !told(r, NC_TOLD_VACANT))
		say(r, "#%u has no value: nothing is kept from before the "
		    "program; a word with it is left out", n);
}

static void say_at(struct nc_reader *r, uint32_t line, const char *text)
{
	const uint32_t here = r->line;

	if (!r->o->notes)
		return;
	r->line = line;
	say(r, "%s", text);
	r->line = here;
}

void nc_note_tape(struct nc_reader *r, uint32_t line)
{
	say_at(r, line, "nothing behind the % that ends the text is read");
}

void nc_note_rest(struct nc_reader *r, uint32_t line)
{
	say_at(r, line, "nothing behind the end of the program is carried "
	       "out, except subprograms that it calls");
}

void nc_note_electrode(struct nc_reader *r, enum nc_group group,
		       const char *why)
{
	if (r->o->notes && !told(r, group == NC_ELECTRODE ?
				 NC_TOLD_ELECTRODE : NC_TOLD_CHANGE))
		say(r, "%s %s", nc_quote_word(r, r->block.code_at[group]).s,
		    why);
}

/* G0 C120: did the author of the program mean an axis? */
static void note_condition(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint8_t *at;

	if (!nc_has_group(r, NC_CONDITION) || b->cond_letter != 'C' ||
	    !nc_has_group(r, NC_MOTION) || r->absent & NC_BIT(NC_C) ||
	    told(r, NC_TOLD_CONDITION))
		return;
	at = b->code_at[NC_CONDITION];
	say(r, "%s calls a condition; the axis would be %s.",
	    nc_quote_word(r, at).s, nc_quote_word(r, at).s);
}

static void note_dwell(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;

	if (!nc_has_group(r, NC_ONE_SHOT) || r->d->dwell_ms ||
	    b->code[NC_ONE_SHOT]->value != NC_DWELL || !nc_has(r, NC_P) ||
	    b->value[NC_P] < 60 || told(r, NC_TOLD_DWELL))
		return;
	say(r, "a dwell of %g s: P counts seconds here, and milliseconds in "
	    "Fanuc's dialects", b->value[NC_P]);
}

void nc_note_line(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;

	note_condition(r);
	note_dwell(r);
	if (nc_has_group(r, NC_UNITS) && b->code[NC_UNITS]->value &&
	    !told(r, NC_TOLD_INCHES))
		say(r, "lengths and feeds are in inches from here on");
}
