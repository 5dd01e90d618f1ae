/* SPDX-License-Identifier: Apache-2.0 */
/*
 * scan_again.c - a line with the same words as the line before it
 *
 * Most lines of a long text differ from the line before them only in their
 * numbers.  What a line is follows from its words: which groups it has, what
 * they take, whether it may be carried out.  So it is enough to find the same
 * words again, each with a number that it takes, and to carry them out.
 *
 * A line is such a pattern if its words do nothing but move along a line or an
 * arc and set F.  Then they have not changed anything on which the check of a
 * line depends.  Everything in front of a number, up to its letter, is compared
 * byte by byte.  A line that is not the same, in whatever way, is read by
 * nc_scan_line(), which also makes all refusals.
 */
#include "code/number.h"
#include "code/reader.h"

#include <ctype.h>

/* A line of such words is shorter, and so is what is left of it. */
#define MOST_BYTES	(8 + NC_PATTERN_WORDS * 16)

/* Is @v, from @first to @end, a value of @slot and nothing else?  A length
 * without a point may be another one; C120 is a condition. */
static inline bool takes(const struct nc_reader *r, unsigned int slot,
			 const uint8_t *first, const uint8_t *end, double v)
{
	const struct nc_word *w = &nc_words[slot];

	return v >= w->min && v <= w->max && (!w->whole || nc_is_whole(v)) &&
	       (!((r->lengths | NC_BIT(NC_C)) & NC_BIT(slot)) ||
		memchr(first, '.', (size_t)(end - first)));
}

bool nc_scan_again(struct nc_reader *r)
{
	const struct nc_pattern *pattern = &r->pattern;
	struct nc_block *b = &r->block;
	const uint8_t *p = r->at;

	if (!pattern->n)
		return false;
	nc_begin_line(r);
	if (r->stop - p < MOST_BYTES)
		return false;
	for (uint32_t i = 0; i < pattern->n; i++) {
		const struct nc_pattern_word *w = &pattern->word[i];
		const uint8_t *first = p + w->bytes;
		const unsigned int slot = w->slot;
		uint64_t text;

		memcpy(&text, p, sizeof(text));
		if ((text ^ w->text) & w->mask)
			return false;
		p = nc_number(first, r->stop, &b->value[slot]);
		if (!p || r->stop - p < MOST_BYTES ||
		    !takes(r, slot, first, p, b->value[slot]))
			return false;
		b->at[slot] = first - 1;
	}
	if (nc_classes[*p] != NC_EOL)
		return false;
	b->code_at[NC_MOTION] = b->at[pattern->behind] - pattern->back;
	nc_end_line(r, p);
	return true;
}

/* -- The pattern ---------------------------------------------------------- */

static bool is_pattern(const struct nc_reader *r)
{
	const struct nc_block *b = &r->block;

	return (b->groups & ~NC_BIT(NC_FEED)) == NC_BIT(NC_MOTION) &&
	       b->code[NC_MOTION]->value < NC_SPLINE &&
	       !(b->words & NC_BIT(NC_SPARE)) && !r->mapped && !r->loose &&
	       !r->figure.vague && !r->curve.open;
}

/* The word whose letter comes first of those in @words. */
static unsigned int first_of(const struct nc_block *b, uint32_t words)
{
	unsigned int first = (unsigned int)__builtin_ctz(words);

	for (; words; words &= words - 1) {
		const unsigned int slot = (unsigned int)__builtin_ctz(words);

		if (b->at[slot] < b->at[first])
			first = slot;
	}
	return first;
}

/* Words and blanks, and nothing else that could mean something, from @p up to
 * the letter of @slot.  Return: the place behind its number, or NULL. */
static const uint8_t *add_word(struct nc_reader *r, const uint8_t *p,
			       unsigned int slot)
{
	struct nc_pattern_word *w = &r->pattern.word[r->pattern.n];
	const uint8_t *letter = r->block.at[slot];
	uint8_t text[sizeof(w->text)] = { 0 }, mask[sizeof(w->mask)] = { 0 };
	double v;

	if (r->pattern.n == NC_PATTERN_WORDS ||
	    letter - p >= (ptrdiff_t)sizeof(text))
		return NULL;
	w->bytes = 0;
	for (; p <= letter; p++) {
		if (!isalnum(*p) && nc_classes[*p] != NC_BLANK)
			return NULL;
		text[w->bytes] = *p;
		mask[w->bytes++] = 0xff;
	}
	memcpy(&w->text, text, sizeof(text));
	memcpy(&w->mask, mask, sizeof(mask));
	w->slot = (uint8_t)slot;
	r->pattern.n++;
	return nc_number(p, r->stop, &v);
}

/* The G word of the motion stands in front of a word; if there is none, the
 * first slot stands for it. */
static bool find_motion(struct nc_reader *r)
{
	const struct nc_block *b = &r->block;
	const uint8_t *at = b->code_at[NC_MOTION];
	const uint8_t *behind = NULL;

	for (uint32_t left = b->words; left; left &= left - 1) {
		const unsigned int slot = (unsigned int)__builtin_ctz(left);

		if (b->at[slot] >= at && (!behind || b->at[slot] < behind)) {
			behind = b->at[slot];
			r->pattern.behind = (uint8_t)slot;
			r->pattern.back = (uint8_t)(behind - at);
		}
	}
	return behind;
}

static bool make(struct nc_reader *r)
{
	const uint8_t *p = r->line_at;

	for (uint32_t left = r->block.words; left; ) {
		const unsigned int slot = first_of(&r->block, left);

		p = add_word(r, p, slot);
		if (!p)
			return false;
		left &= ~NC_BIT(slot);
	}
	return p < r->stop && nc_classes[*p] == NC_EOL && find_motion(r);
}

void nc_note_pattern(struct nc_reader *r)
{
	struct nc_pattern *pattern = &r->pattern;
	const uint32_t words = is_pattern(r) ? r->block.words : 0;

	/* A line that nothing repeats is not worth it. */
	if (words && words == pattern->words && !make(r))
		pattern->n = 0;
	pattern->words = words;
}
