/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scan.c - one line of text into a block of words
 *
 * There is one pass over the bytes.  The class of a byte chooses the function
 * that continues.
 */
#include "code/macro.h"
#include "code/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define KNOWN_MAX	240

#define A_NUMBER	"a sign, digits and one decimal point, as in " \
			"X-12.345; no exponent"

typedef const uint8_t *scan_fn(struct nc_reader *r, const uint8_t *at);

static const uint8_t *refuse_number(struct nc_reader *r, const uint8_t *at)
{
	nc_refuse(r, at, A_NUMBER, "%s is not a word with a number",
		  nc_quote_run(r, at).s);
	return NULL;
}

static const uint8_t *refuse_range(struct nc_reader *r, const uint8_t *at,
				   const struct nc_word *w)
{
	nc_refuse(r, at, w->range, "%s is out of range",
		  nc_quote_word(r, at).s);
	return NULL;
}

static const uint8_t *refuse_fraction(struct nc_reader *r, const uint8_t *at,
				      const struct nc_word *w)
{
	nc_refuse(r, at, w->range, "%s is not a whole number",
		  nc_quote_word(r, at).s);
	return NULL;
}

static const uint8_t *refuse_twice(struct nc_reader *r, const uint8_t *at)
{
	nc_refuse(r, at, "each letter once on a line", "a second word %s",
		  nc_quote_word(r, at).s);
	return NULL;
}

static bool has_point(const uint8_t *p, const uint8_t *end)
{
	while (p < end && *p != '.')
		p++;
	return p < end;
}

/* Behind M98 nothing is a length, and L is how often on other controls. */
static bool is_call(const struct nc_block *b)
{
	return b->groups & NC_BIT(NC_STOP) &&
	       b->code[NC_STOP]->value == NC_CALL;
}

/* A length without a decimal point.  0 is 0 everywhere.  Other values are taken
 * as they are, or in the last of their decimals (0.001 mm, 0.0001 inches), or
 * are refused; where they are refused, angles are, too. */
static bool pointed_length(struct nc_reader *r, const uint8_t *at,
			   const uint8_t *end, double *v)
{
	if (*v == 0 || has_point(at, end))
		return true;
	if (r->d->point != NC_POINT_WANTED)
		nc_note_point(r, at);
	if (r->d->point == NC_POINT_LAST)
		*v /= nc_pow10[r->unit_mm > 1 ? 4 : 3];
	if (r->d->point == NC_POINT_LAST && !r->block.unit_at)
		r->block.unit_at = at;
	if (r->d->point != NC_POINT_WANTED || is_call(&r->block))
		return true;
	nc_refuse(r, at, "a decimal point, as in X10.0: without one some "
		  "controls read thousandths", "%s without a decimal point",
		  nc_quote_word(r, at).s);
	return false;
}

/*
 * X- and X: a direction without a place.  It depends on the other words whether
 * the line may have it, so this is checked when all words are known.  Return:
 * the place behind it, or NULL if it is something else.
 */
static const uint8_t *scan_toward(struct nc_reader *r, const uint8_t *at,
				  unsigned int slot)
{
	struct nc_block *b = &r->block;
	const uint8_t *p = at + 1;
	const uint8_t sign = p < r->stop && (*p == '+' || *p == '-') ? *p++ : 0;

	if (!r->d->lone_ways || slot > NC_Z)
		return NULL;
	if (p < r->stop && nc_classes[*p] != NC_BLANK &&
	    nc_classes[*p] != NC_EOL && *p != '(' && *p != ';')
		return NULL;
	b->words |= NC_BIT(slot);
	b->toward |= NC_BIT(slot);
	b->value[slot] = sign ? (sign == '+' ? 1 : -1) : 0;
	b->at[slot] = at;
	r->word_at = at;
	return p;
}

/* Read a word with a value. */
static inline const uint8_t *scan_value(struct nc_reader *r, const uint8_t *at,
					unsigned int slot)
{
	const struct nc_word *w = &nc_words[slot];
	struct nc_block *b = &r->block;
	const uint8_t *p;
	double v;

	if ((b->words & NC_BIT(slot)) && slot != NC_SPARE)
		return refuse_twice(r, at);
	p = nc_number(at + 1, r->stop, &v);
	if (!p)
		p = scan_toward(r, at, slot);
	if (!p)
		return refuse_number(r, at);
	if (b->toward & NC_BIT(slot))
		return p;
	if ((r->lengths & NC_BIT(slot)) && !pointed_length(r, at, p, &v))
		return NULL;
	if (!(v >= w->min && v <= w->max))
		return refuse_range(r, at, w);
	if (!w->whole)
		r->value_end = p;
	else if (!nc_is_whole(v))
		return refuse_fraction(r, at, w);
	b->words |= NC_BIT(slot);
	b->value[slot] = v;
	b->at[slot] = at;
	r->word_at = at;
	return p;
}

/* Behind a colon the words belong to the second plane. */
static const uint8_t *scan_top(struct nc_reader *r, const uint8_t *at,
			       unsigned int slot)
{
	static const uint8_t upper[NC_NSLOTS] = {
		[NC_X] = NC_U + 1, [NC_Y] = NC_V + 1, [NC_U] = NC_U + 1,
		[NC_V] = NC_V + 1, [NC_I] = NC_UI + 1, [NC_J] = NC_UJ + 1,
	};

	if (upper[slot])
		return scan_value(r, at, upper[slot] - 1u);
	nc_refuse(r, at, "G1 G2 G3, X Y and I J behind a :",
		  "%s behind a :", nc_quote_word(r, at).s);
	return NULL;
}

static const uint8_t *scan_colon(struct nc_reader *r, const uint8_t *at)
{
	struct nc_block *b = &r->block;

	if (!nc_has_guides(r) || b->colon) {
		nc_refuse(r, at, "one : on a line, on a machine with "
			  "wire.guides", b->colon ? "a second :" :
			  "a : on a machine without wire guides");
		return NULL;
	}
	b->colon = true;
	b->takes |= NC_BIT(NC_UI) | NC_BIT(NC_UJ);
	return at + 1;
}

static const uint8_t *refuse_group(struct nc_reader *r, const uint8_t *at,
				   unsigned int group)
{
	nc_refuse(r, at, "one word of a modal group on a line",
		  "%s on a line with %s", nc_quote_word(r, at).s,
		  nc_quote_word(r, r->block.code_at[group]).s);
	return NULL;
}

static bool scan_upper_code(struct nc_reader *r, const uint8_t *at,
			    const struct nc_code *code)
{
	if (code->group != NC_MOTION || code->value == 0 || code->value > 3 ||
	    r->block.upper) {
		nc_refuse(r, at, "one of G1 G2 G3 behind a :", "%s behind a :",
			  nc_quote_word(r, at).s);
		return false;
	}
	r->block.upper = code;
	r->word_at = at;
	return true;
}

static const struct nc_code *find_code(struct nc_reader *r,
				       const struct nc_letter *l, uint64_t n)
{
	const struct nc_code *code = n < l->ncodes ? &l->codes[n] : &l->other;

	if (code->group == NC_UNKNOWN)
		code = &l->other;
	/* An M code that the machine file gives to the PLC goes there, whatever
	 * the dialect means by it.  Only the end of a program, calls and
	 * returns stay as they are. */
	if (l == &r->d->letter[1] &&
	    (code->group != NC_STOP || code->value < NC_FINISH)) {
		const struct nc_code *mine = nc_mcode(r, n);

		code = mine ? mine : code;
	}
	return code;
}

/* The reason at @text has a ; between what was found and what is accepted. */
static void refuse_known(struct nc_reader *r, const uint8_t *at, uint32_t text)
{
	const char *found = r->d->text + text, *wanted = strchr(found, ';');

	nc_refuse(r, at, wanted + 1 + strspn(wanted + 1, " "), "%s: %.*s",
		  nc_quote_word(r, at).s, (int)(wanted - found), found);
}

static void refuse_code(struct nc_reader *r, const uint8_t *at,
			const struct nc_letter *l, const struct nc_code *code)
{
	char known[KNOWN_MAX];

	if (code->group == NC_REFUSED)
		refuse_known(r, at, code->text);
	else
		nc_refuse(r, at, nc_codes_known(l, (char)toupper(*at), known,
						sizeof(known)),
			  "unknown word %s", nc_quote_word(r, at).s);
}

static bool add_code(struct nc_reader *r, const uint8_t *at,
		     const struct nc_code *code)
{
	struct nc_block *b = &r->block;

	if (b->colon)
		return scan_upper_code(r, at, code);
	b->drops |= code->drops;
	if (code->text && code->drops && code->group != NC_IGNORED) {
		b->dropper = code;
		b->dropper_at = at;
	} else if (code->text) {
		nc_note_code(r, at, code);
	}
	r->word_at = at;
	if (code->group == NC_IGNORED) {
		if (code->value)
			b->alone_at = at;
		return true;
	}
	if (b->groups & NC_BIT(code->group)) {
		refuse_group(r, at, code->group);
		return false;
	}
	b->groups |= NC_BIT(code->group);
	b->takes |= code->takes;
	b->code[code->group] = code;
	b->code_at[code->group] = at;
	return true;
}

static const uint8_t *scan_code(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_letter *l = &r->d->letter[r->d->classes[*at] -
						  NC_LETTER_G];
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	const struct nc_code *code;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p == first || p - first > NC_DIGITS_MAX)
		return refuse_number(r, at);
	n *= l->scale;
	if (l->scale > 1 && p < r->stop && *p == '.' && ++p < r->stop &&
	    *p >= '0' && *p <= '9')
		n += (uint64_t)(*p++ - '0');
	code = find_code(r, l, n);
	if (code->group == NC_UNKNOWN || code->group == NC_REFUSED) {
		refuse_code(r, at, l, code);
		/* The rest of its line is checked, too. */
		if (!r->listing)
			return NULL;
		nc_tell(r);
		r->block.takes = UINT32_MAX;
		r->word_at = at;
		while (p < r->stop && nc_classes[*p] == NC_NUMERIC)
			p++;
		return p;
	}
	if (code->group == NC_ELECTRODE)
		r->block.electrode = n;
	return add_code(r, at, code) ? p : NULL;
}

/* Is this the = of a definition?  Return: the place behind it; else NULL. */
static const uint8_t *behind_equals(const struct nc_reader *r,
				    const uint8_t *p, bool allowed)
{
	p = nc_skip_blanks(p, r->stop);
	return allowed && p < r->stop && *p == '=' ? p + 1 : NULL;
}

static const uint8_t *scan_condition(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p, *value;
	struct nc_block *b = &r->block;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p == first || p - first > 9) {
		nc_refuse(r, at, "C or E and up to nine digits, as in E001",
			  "%s is not a condition", nc_quote_run(r, at).s);
		return NULL;
	}
	value = behind_equals(r, p, r->d->defines);
	if (value)
		return nc_define_condition(r, at, value, (uint32_t)n);
	if (b->groups & NC_BIT(NC_CONDITION)) {
		nc_refuse(r, at, "one condition on a line",
			  "a second condition %s", nc_quote_word(r, at).s);
		return NULL;
	}
	b->groups |= NC_BIT(NC_CONDITION);
	b->code_at[NC_CONDITION] = at;
	b->cond_letter = (char)(*at & 0xdf);	/* upper case */
	b->cond_number = (uint32_t)n;
	r->word_at = at;
	return p;
}

/* C120 calls a condition; C12 and C120. are places of the axis. */
static const uint8_t *scan_c(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p - first >= 3 && !(p < r->stop && *p == '.'))
		return scan_condition(r, at);
	return scan_value(r, at, NC_C);
}

/* S100 calls a condition; SC0100= defines one. */
static const uint8_t *scan_s(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *p = at + 1, *first, *value;
	uint64_t n = 0;

	if (p == r->stop || (*p | 0x20) != 'c')
		return scan_condition(r, at);
	first = nc_skip_blanks(p + 1, r->stop);
	p = nc_digits(first, r->stop, &n);
	value = behind_equals(r, p, r->d->defines);
	if (value && p > first && p - first <= 9)
		return nc_define_condition(r, at, value, (uint32_t)n);
	nc_refuse(r, at, "SC0100= and its numbers", "SC without a =");
	return NULL;
}

/* A length, or a register by its letter and number. */
static const uint8_t *scan_term(struct nc_reader *r, const uint8_t *at,
				double *v)
{
	const uint8_t *first = at < r->stop ? nc_skip_blanks(at + 1, r->stop) :
					      at;
	const uint8_t *p;
	uint64_t n = 0;

	if (at == r->stop || r->d->classes[*at] != NC_LETTER_D) {
		p = nc_number(at, r->stop, v);
		if (p)
			return pointed_length(r, at, p, v) ? p : NULL;
		nc_refuse(r, at, "a number or a register behind the =, as in "
			  "H001=0.11 or H1=0.01+H175",
			  "a definition without a number");
		return NULL;
	}
	p = nc_digits(first, r->stop, &n);
	if (p == first || n >= NC_NREGISTERS || !r->registers[n].known) {
		nc_refuse(r, at, "a register that has a value",
			  "%s, which has none", nc_quote_word(r, at).s);
		return NULL;
	}
	*v = r->registers[n].mm / r->unit_mm;
	return p;
}

static const uint8_t *scan_sum(struct nc_reader *r, const uint8_t *p,
			       double *ret)
{
	double sign = 1, v;

	*ret = 0;
	for (;;) {
		p = scan_term(r, nc_skip_blanks(p, r->stop), &v);
		if (!p)
			return NULL;
		*ret += sign * v;
		p = nc_skip_blanks(p, r->stop);
		if (p == r->stop || (*p != '+' && *p != '-'))
			return p;
		sign = *p++ == '-' ? -1 : 1;
	}
}

/* H1 selects an offset register; H1=0.11 defines it. */
static const uint8_t *scan_register(struct nc_reader *r, const uint8_t *at)
{
	const enum nc_slot slot = (*at | 0x20) == 'd' ? NC_D : NC_H;
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p, *value;
	uint64_t n = 0;
	double v;

	p = nc_digits(first, r->stop, &n);
	value = behind_equals(r, p, r->d->defines || r->d->registers);
	if (!value)
		return scan_value(r, at, slot);
	if (p == first || p - first > 9 || n >= NC_NREGISTERS)
		return refuse_range(r, at, &nc_words[slot]);
	r->word_at = at;
	p = scan_sum(r, value, &v);
	return !p || nc_define_register(r, at, (uint32_t)n, v) ? NULL : p;
}

static const uint8_t *scan_upper(struct nc_reader *r, const uint8_t *at)
{
	if (nc_has_guides(r))
		return scan_value(r, at, (*at | 0x20) == 'u' ? NC_U : NC_V);
	nc_refuse_wire(r, at);
	return NULL;
}

static const uint8_t *scan_turn(struct nc_reader *r, const uint8_t *at)
{
	static const char second[] = "AIJ";
	static const uint8_t slot[] = { NC_R, NC_I, NC_J };
	const uint8_t *p = nc_skip_blanks(at + 1, r->stop);
	const char *is = p < r->stop && isalpha(*p) ?
			 strchr(second, toupper(*p)) : NULL;

	return is ? scan_value(r, p, slot[is - second]) :
		    scan_value(r, at, NC_R);
}

static const uint8_t *scan_comma(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *p = nc_skip_blanks(at + 1, r->stop);
	const int letter = p < r->stop ? toupper(*p) : 0;

	if (letter == 'R' || letter == 'C')
		return scan_value(r, p, letter == 'R' ? NC_COMMA_R :
							NC_COMMA_C);
	nc_refuse(r, at, ",R with the radius of a corner, or ,C with how far "
		  "it is cut", "%s, a comma in front of something else",
		  nc_quote_run(r, at).s);
	return NULL;
}

/* X1E5 is meant as an exponent, not as a condition. */
static const uint8_t *scan_e(struct nc_reader *r, const uint8_t *at)
{
	if (at != r->value_end)
		return scan_condition(r, at);
	nc_refuse(r, at, "a number without exponent; a blank before a "
		  "condition, as in X1 E001",
		  "an E right behind the number of %s", nc_quote_run(r,
		  r->word_at).s);
	return NULL;
}

static void refuse_stray(struct nc_reader *r, const uint8_t *at)
{
	char wanted[240], letters[KNOWN_MAX];

	snprintf(wanted, sizeof(wanted), "%s before a number; no blank inside "
		 "a number", nc_letters_known(r->d, letters, sizeof(letters)));
	nc_refuse(r, at, wanted, "the number %s without a letter",
		  nc_quote_word(r, at).s);
}

/* A digit, a point or a sign stands where a letter should be. */
static const uint8_t *scan_stray(struct nc_reader *r, const uint8_t *at)
{
	if (at > r->line_at && nc_classes[at[-1]] == NC_NUMERIC)
		nc_refuse(r, at, A_NUMBER, "%s is not a word with a number",
			  nc_quote_run(r, r->word_at).s);
	else
		refuse_stray(r, at);
	return NULL;
}

static const uint8_t *scan_bad(struct nc_reader *r, const uint8_t *at)
{
	char known[KNOWN_MAX];

	nc_letters_known(r->d, known, sizeof(known));
	const uint8_t upper = *at & 0xdf;

	if (upper >= 'A' && upper <= 'Z')
		nc_refuse(r, at, known, "unknown word %s",
			  nc_quote_word(r, at).s);
	else if (*at > ' ' && *at < 0x7f)
		nc_refuse(r, at, known, "'%c', which begins no word", *at);
	else
		nc_refuse(r, at, "ASCII text; other characters in comments "
			  "only, and no NUL", "byte 0x%02x", *at);
	return NULL;
}

/* A comment may have any byte except NUL. */
static const uint8_t *scan_comment(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *p;

	for (p = at + 1; p < r->stop && nc_classes[*p] != NC_EOL; p++) {
		if (*p == ')')
			return p + 1;
		if (*p == 0)
			return scan_bad(r, p);
	}
	if (p == r->stop && r->stop < r->end)
		return p;		/* too long: said by the caller */
	nc_refuse(r, at, "a ) on the same line", "a ( comment without an end");
	return NULL;
}

static const uint8_t *scan_to_end(struct nc_reader *r, const uint8_t *at)
{
	for (; at < r->stop && nc_classes[*at] != NC_EOL; at++) {
		if (*at == 0)
			return scan_bad(r, at);
	}
	return at;
}

/* A ; ends a block, and a line has one block.  If there is no block in front of
 * it, it begins a comment. */
static const uint8_t *scan_block_end(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *p = nc_skip_blanks(at + 1, r->stop);

	if (nc_skip_blanks(r->line_at, at) == at)
		return scan_to_end(r, p);
	if (p == r->stop || nc_classes[*p] == NC_EOL || *p == '(')
		return p;
	nc_refuse(r, p, "each block on a line of its own",
		  "words behind the ; that ends a block");
	return NULL;
}

static const uint8_t *scan_slash(struct nc_reader *r, const uint8_t *at)
{
	if (nc_skip_blanks(r->line_at, at) == at) {
		nc_note_skipped(r);
		return scan_to_end(r, at);
	}
	nc_refuse(r, at, "/ as the first character of a line, to skip it",
		  "a / inside a line");
	return NULL;
}

/* The first % begins the text; what stands behind it is the title of a tape.
 * The one that ends the text ended it for all of the reader: nc_tape_end(). */
static const uint8_t *scan_percent(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *p = nc_skip_void(at + 1, nc_line_end(at, r->stop));

	if (r->block.words || r->block.groups) {
		nc_refuse(r, at, "% alone on its line",
			  "%% behind other words");
		return NULL;
	}
	if (r->tape || !r->fresh) {
		nc_refuse(r, at, "% alone on its line", "words behind %%");
		return NULL;
	}
	r->tape = true;
	if (p < r->stop && nc_classes[*p] != NC_EOL && *p != ';')
		nc_note_title(r);
	return scan_to_end(r, p);
}

/* <PART>: the name of a program. */
static const uint8_t *scan_name(struct nc_reader *r, const uint8_t *at)
{
	struct nc_block *b = &r->block;
	const uint8_t *p = nc_name_end(at, r->stop);

	if (b->words & NC_BIT(NC_NAME))
		return refuse_twice(r, at);
	if (!p) {
		nc_refuse(r, at, "<NAME>, of letters, digits and + - _ .",
			  "a program's name without an end");
		return NULL;
	}
	b->words |= NC_BIT(NC_NAME);
	b->at[NC_NAME] = at;
	r->word_at = at;
	return p;
}

static const uint8_t *scan_blank(struct nc_reader *r, const uint8_t *at)
{
	(void)r;
	return at + 1;
}

static const uint8_t *scan_refused(struct nc_reader *r, const uint8_t *at)
{
	refuse_known(r, at, r->d->reason[(*at & 0xdf) - 'A']);
	return NULL;
}

static const uint8_t *scan_rest(struct nc_reader *r, const uint8_t *at)
{
	const struct nc_code code = {
		.group = NC_IGNORED, .text = r->d->reason[(*at & 0xdf) - 'A'],
	};

	nc_note_code(r, at, &code);
	return scan_to_end(r, at);
}

static scan_fn *const scan_other[NC_NCLASSES] = {
	[NC_BAD]	= scan_bad,
	[NC_BLANK]	= scan_blank,
	[NC_LETTER_C]	= scan_c,
	[NC_LETTER_E]	= scan_e,
	[NC_LETTER_G]	= scan_code,
	[NC_LETTER_M]	= scan_code,
	[NC_LETTER_T]	= scan_code,
	[NC_LETTER_S]	= scan_s,
	[NC_LETTER_D]	= scan_register,
	[NC_LETTER_U]	= scan_upper,
	[NC_LETTER_R]	= scan_turn,
	[NC_COMMA]	= scan_comma,
	[NC_NUMERIC]	= scan_stray,
	[NC_OPEN]	= scan_comment,
	[NC_SEMICOLON]	= scan_to_end,
	[NC_BLOCK_END]	= scan_block_end,
	[NC_SLASH]	= scan_slash,
	[NC_PERCENT]	= scan_percent,
	[NC_COLON]	= scan_colon,
	[NC_LETTER_NAME] = scan_name,
	[NC_LETTER_REFUSED] = scan_refused,
	[NC_LETTER_REST] = scan_rest,
};

/* Read the words from @p to the end of the line.  Return: that end. */
static const uint8_t *scan_words(struct nc_reader *r, const uint8_t *p)
{
	const uint8_t *classes = r->d->classes;

	while (p && p < r->stop) {
		const unsigned int class = classes[*p];

		if (class == NC_BLANK) {
			p++;
			continue;
		}
		if (class == NC_EOL)
			return p;
		if (class - NC_WORD < NC_NSLOTS)
			p = r->block.colon ?
			    scan_top(r, p, class - NC_WORD) :
			    scan_value(r, p, class - NC_WORD);
		else
			p = scan_other[class](r, p);
	}
	return p;
}

/* Words with a value that do something by themselves. */
static void add_groups(struct nc_block *b)
{
	if (b->words & NC_BIT(NC_F))
		b->groups |= NC_BIT(NC_FEED);
	if (b->words & NC_BIT(NC_O))
		b->groups |= NC_BIT(NC_LABEL);
	/* Beside M98 it is the one that is called. */
	if (b->words & NC_BIT(NC_NAME) && !(b->groups & NC_BIT(NC_STOP))) {
		b->groups |= NC_BIT(NC_LABEL);
		b->takes |= NC_BIT(NC_NAME);
	}
	if (b->words & NC_OFFSETS)
		b->groups |= NC_BIT(NC_REGISTER);
}

static int refuse_long(struct nc_reader *r, const uint8_t *at)
{
	return nc_refuse(r, at, "lines of up to 4096 bytes",
			 "a line longer than %d bytes", INTERP_NC_LINE_MAX);
}

/* Begin the line at r->at, or what macros make of it. */
static int begin_line(struct nc_reader *r)
{
	const uint8_t *p = r->at, *end;
	struct nc_place place;
	int err;

	nc_begin_line(r);
	if (!r->d->macros || r->listing)
		return 0;
	end = nc_line_end(p, r->stop);
	if (end < r->end && nc_classes[*end] != NC_EOL)
		return refuse_long(r, end);
	r->at = nc_line_next(end, r->end);
	place = nc_this(r);
	err = nc_macro_line(r, p, end);
	if (err <= 0) {
		r->at = p;
		return err;
	}
	nc_count_bytes(r, (size_t)(end - p), NC_COUNTED_MACRO);
	r->macro->place = place;
	r->mapped = true;
	r->line_at = r->macro->text;
	r->stop = r->line_at + r->macro->used;
	return 0;
}

int nc_scan_line(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	const uint8_t *p;
	int err = begin_line(r);

	r->value_end = NULL;
	b->words = 0;
	b->groups = 0;
	b->takes = NC_ANYWHERE;
	b->upper = NULL;
	b->colon = false;
	b->toward = 0;
	b->drops = 0;
	b->dropper = NULL;
	b->alone_at = NULL;
	b->unit_at = NULL;

	if (err)
		return err;
	p = scan_words(r, r->line_at);
	if (!p)
		return -EINVAL;
	if (b->dropper && (b->words & b->dropper->drops))
		nc_note_code(r, b->dropper_at, b->dropper);
	b->words &= ~b->drops;
	b->toward &= ~b->drops;
	if (!r->mapped && p < r->end && nc_classes[*p] != NC_EOL)
		return refuse_long(r, p);
	if (b->words & (NC_BIT(NC_F) | NC_BIT(NC_O) | NC_BIT(NC_NAME) |
			NC_OFFSETS))
		add_groups(b);
	if (r->mapped)
		return 0;
	nc_end_line(r, p);
	return 0;
}
