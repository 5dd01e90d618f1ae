/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scan.c - one line of text into a block of words
 *
 * One pass over the bytes; a byte's class picks what reads on from it.
 */
#include "code/number.h"
#include "code/reader.h"

#include <errno.h>
#include <math.h>

#define ANY_WORD	"one of G M F N S T X Y Z A B C U V I J K R P L O D H E"
#define OFFSET_MAX_MM	50
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

/* A word with a value. */
static inline const uint8_t *scan_value(struct nc_reader *r, const uint8_t *at,
					unsigned int slot)
{
	const struct nc_word *w = &nc_words[slot];
	struct nc_block *b = &r->block;
	const uint8_t *p;
	double v;

	if (b->words & NC_BIT(slot))
		return refuse_twice(r, at);
	p = nc_number(at + 1, r->stop, &v);
	if (!p)
		return refuse_number(r, at);
	if (!(v >= w->min && v <= w->max))
		return refuse_range(r, at, w);
	if (!w->whole)
		r->value_end = p;
	else if (v != floor(v))
		return refuse_fraction(r, at, w);
	b->words |= NC_BIT(slot);
	b->value[slot] = v;
	b->at[slot] = at;
	r->word_at = at;
	return p;
}

/* Behind a : the words are those of the second plane. */
static const uint8_t *scan_upper(struct nc_reader *r, const uint8_t *at,
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

/* The letters of coded words. */
static const struct letter {
	const struct nc_code *codes;
	uint32_t ncodes;
	uint32_t scale;			/* 10: one decimal may follow */
	const char *known;
} letters[] = {
	{ nc_g, NC_NG, 10,
	  "one of G0 G1 G2 G3 G4 G17 G18 G19 G20 G21 G28 G40 G41 G42 G50 G51 "
	  "G52 G53 G54 ... G59 "
	  "G90 G90.1 G91 G91.1 G92 G92.1 G94" },
	{ nc_m, NC_NM, 1, "one of M0 M1 M2 M3 M4 M5 M30 M98 M99" },
	{ nc_t, NC_NM, 1, "T84 (pump on) or T85 (pump off)" },
};

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
	if (code->group != NC_MOTION || code->value == 0 || r->block.upper) {
		nc_refuse(r, at, "one of G1 G2 G3 behind a :", "%s behind a :",
			  nc_quote_word(r, at).s);
		return false;
	}
	r->block.upper = code;
	r->word_at = at;
	return true;
}

static const uint8_t *scan_code(struct nc_reader *r, const uint8_t *at)
{
	const struct letter *l = &letters[nc_classes[*at] - NC_LETTER_G];
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	const struct nc_code *code;
	struct nc_block *b = &r->block;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p == first || p - first > NC_DIGITS_MAX)
		return refuse_number(r, at);
	n *= l->scale;
	if (l->scale > 1 && p < r->stop && *p == '.' && ++p < r->stop &&
	    *p >= '0' && *p <= '9')
		n += (uint64_t)(*p++ - '0');
	if (n >= l->ncodes || l->codes[n].group == NC_UNKNOWN) {
		nc_refuse(r, at, l->known, "unknown word %s",
			  nc_quote_word(r, at).s);
		return NULL;
	}
	code = &l->codes[n];
	if (b->colon)
		return scan_upper_code(r, at, code) ? p : NULL;
	if (b->groups & NC_BIT(code->group))
		return refuse_group(r, at, code->group);
	b->groups |= NC_BIT(code->group);
	b->takes |= code->takes;
	b->code[code->group] = code;
	b->code_at[code->group] = at;
	r->word_at = at;
	return p;
}

static const uint8_t *scan_condition(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	struct nc_block *b = &r->block;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p == first || p - first > 9) {
		nc_refuse(r, at, "C or E and up to nine digits, as in E001",
			  "%s is not a condition", nc_quote_run(r, at).s);
		return NULL;
	}
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

/* C120 calls a condition, C12 and C120. are places of the axis. */
static const uint8_t *scan_c(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	uint64_t n = 0;

	p = nc_digits(first, r->stop, &n);
	if (p - first >= 3 && !(p < r->stop && *p == '.'))
		return scan_condition(r, at);
	return scan_value(r, at, NC_C);
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

/* H1 uses a register, H1=0.11 fills it. */
static const uint8_t *scan_register(struct nc_reader *r, const uint8_t *at)
{
	const bool h = nc_classes[*at] == NC_LETTER_H;
	const uint8_t *first = nc_skip_blanks(at + 1, r->stop), *p;
	uint64_t n = 0;
	double v;

	p = nc_skip_blanks(nc_digits(first, r->stop, &n), r->stop);
	if (p == first || p == r->stop || *p != '=')
		return scan_value(r, at, h ? NC_H : NC_D);
	if (p - first > NC_DIGITS_MAX || n >= INTERP_NOFFSETS)
		return refuse_range(r, at, &nc_words[NC_H]);
	p = nc_number(p + 1, r->stop, &v);
	if (!p || !(fabs(v * r->unit_mm) <= OFFSET_MAX_MM)) {
		nc_refuse(r, at, "a register of 0 to 99 and an offset of up to "
			  "50 mm, as in H1=0.11", "%s is no such offset",
			  nc_quote_run(r, at).s);
		return NULL;
	}
	r->registers_mm[n] = v * r->unit_mm;
	r->block.groups |= NC_BIT(NC_REGISTER);
	r->word_at = at;
	r->value_end = p;
	return p;
}

/* A digit, point or sign where a letter should be. */
static const uint8_t *scan_stray(struct nc_reader *r, const uint8_t *at)
{
	if (at > r->line_at && nc_classes[at[-1]] == NC_NUMERIC)
		nc_refuse(r, at, A_NUMBER, "%s is not a word with a number",
			  nc_quote_run(r, r->word_at).s);
	else
		nc_refuse(r, at, ANY_WORD " before a number; no blank inside a "
			  "number", "the number %s without a letter",
			  nc_quote_word(r, at).s);
	return NULL;
}

static const uint8_t *scan_bad(struct nc_reader *r, const uint8_t *at)
{
	const uint8_t upper = *at & 0xdf;

	if (upper >= 'A' && upper <= 'Z')
		nc_refuse(r, at, ANY_WORD, "unknown word %s",
			  nc_quote_word(r, at).s);
	else if (*at > ' ' && *at < 0x7f)
		nc_refuse(r, at, ANY_WORD, "'%c', which begins no word", *at);
	else
		nc_refuse(r, at, "ASCII text; other characters in comments "
			  "only, and no NUL", "byte 0x%02x", *at);
	return NULL;
}

/* Any byte but NUL may be in a comment. */
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

static const uint8_t *scan_slash(struct nc_reader *r, const uint8_t *at)
{
	if (nc_skip_blanks(r->line_at, at) == at)
		return scan_to_end(r, at);
	nc_refuse(r, at, "/ as the first character of a line, to skip it",
		  "a / inside a line");
	return NULL;
}

static const uint8_t *scan_percent(struct nc_reader *r, const uint8_t *at)
{
	if (r->block.words || r->block.groups) {
		nc_refuse(r, at, "% alone on its line",
			  "%% behind other words");
		return NULL;
	}
	r->block.groups |= NC_BIT(NC_TAPE);
	r->block.code_at[NC_TAPE] = at;
	return at + 1;
}

static const uint8_t *scan_blank(struct nc_reader *r, const uint8_t *at)
{
	(void)r;
	return at + 1;
}

static scan_fn *const scan_other[NC_NCLASSES] = {
	[NC_BAD]	= scan_bad,
	[NC_BLANK]	= scan_blank,
	[NC_LETTER_C]	= scan_c,
	[NC_LETTER_E]	= scan_e,
	[NC_LETTER_G]	= scan_code,
	[NC_LETTER_M]	= scan_code,
	[NC_LETTER_T]	= scan_code,
	[NC_LETTER_D]	= scan_register,
	[NC_LETTER_H]	= scan_register,
	[NC_NUMERIC]	= scan_stray,
	[NC_OPEN]	= scan_comment,
	[NC_SEMICOLON]	= scan_to_end,
	[NC_SLASH]	= scan_slash,
	[NC_PERCENT]	= scan_percent,
	[NC_COLON]	= scan_colon,
};

/* Words from @p to the end of the line, which is returned. */
static const uint8_t *scan_words(struct nc_reader *r, const uint8_t *p)
{
	while (p && p < r->stop) {
		const unsigned int class = nc_classes[*p];

		if (class == NC_BLANK) {
			p++;
			continue;
		}
		if (class == NC_EOL)
			return p;
		if (class - NC_WORD < NC_NSLOTS)
			p = r->block.colon ?
			    scan_upper(r, p, class - NC_WORD) :
			    scan_value(r, p, class - NC_WORD);
		else
			p = scan_other[class](r, p);
	}
	return p;
}

int nc_scan_line(struct nc_reader *r)
{
	struct nc_block *b = &r->block;
	const uint8_t *p = r->at;

	r->line_at = p;
	r->stop = r->end - p > INTERP_NC_LINE_MAX ? p + INTERP_NC_LINE_MAX :
						    r->end;
	r->value_end = NULL;
	b->words = 0;
	b->groups = 0;
	b->takes = NC_ANYWHERE;
	b->upper = NULL;
	b->colon = false;

	p = scan_words(r, p);
	if (!p)
		return -EINVAL;
	if (p < r->end && nc_classes[*p] != NC_EOL)
		return nc_refuse(r, p, "lines of up to 4096 bytes",
				 "a line longer than %d bytes",
				 INTERP_NC_LINE_MAX);
	if (b->words & NC_BIT(NC_F))
		b->groups |= NC_BIT(NC_FEED);
	if (b->words & (NC_BIT(NC_D) | NC_BIT(NC_H)))
		b->groups |= NC_BIT(NC_REGISTER);
	if (b->words & NC_BIT(NC_O))
		b->groups |= NC_BIT(NC_LABEL);
	r->at = nc_line_next(p, r->end);
	return 0;
}
