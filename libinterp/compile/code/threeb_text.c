/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb_text.c - text into records
 *
 * Records are accepted as the various post-processors write them: with and
 * without blanks, in upper and lower case, several on a line, behind a number
 * such as `N1 :`, in full-width letters and digits (UTF-8 or GB18030).  Other
 * text is a comment where that is harmless: behind a record, behind a mark, and
 * in front of the first record.  A text that has a counting direction with an
 * instruction is never a comment, because it is a wrong record.
 */
#include "code/threeb_reader.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define A_RECORD	"B X B Y B J G Z, as in B9900 B0 B9900 GX L1"
#define A_RECORD_4B	"B X B Y B J B R G Z, as in " \
			"B0 B5000 B10000 B5000 D GX NR2"
#define WHOLE		"a whole number of units from 0 to 999999999, " \
			"without sign or point"
#define MARKS		";(*#%/'!"

int threeb_refuse(struct threeb_text *t, const uint8_t *at, const char *wanted,
		  const char *found, ...)
{
	struct interp_diag *d = t->diag;
	va_list ap;

	d->line = t->line;
	d->column = (uint32_t)(at - t->line_at) + 1;
	snprintf(d->wanted, sizeof(d->wanted), "%s", wanted);
	va_start(ap, found);
	interp_diag_print(d->found, sizeof(d->found), found, ap);
	va_end(ap);
	return -EINVAL;
}

/* -- Characters ------------------------------------------------------------ */

#define FOREIGN		0x80		/* any other character beyond ASCII */

struct letter {
	uint8_t c;			/* upper case; 0 at the end */
	uint8_t bytes;
};

/* Full-width forms are ASCII characters plus an offset; so is the wide
 * blank. */
static struct letter wide(const uint8_t *p, size_t n)
{
	if (n >= 3 && p[0] == 0xef && p[1] == 0xbc && p[2] >= 0x81 &&
	    p[2] <= 0xbf)
		return (struct letter) { (uint8_t)(p[2] - 0x60), 3 };
	if (n >= 3 && p[0] == 0xef && p[1] == 0xbd && p[2] >= 0x80 &&
	    p[2] <= 0x9e)
		return (struct letter) { (uint8_t)(p[2] - 0x20), 3 };
	if (n >= 3 && memcmp(p, "\xe3\x80\x80", 3) == 0)
		return (struct letter) { ' ', 3 };
	if (n >= 2 && p[0] == 0xa3 && p[1] >= 0xa1 && p[1] <= 0xfe)
		return (struct letter) { (uint8_t)(p[1] - 0x80), 2 };
	if (n >= 2 && p[0] == 0xa1 && p[1] == 0xa1)
		return (struct letter) { ' ', 2 };
	return (struct letter) { FOREIGN, 1 };
}

static struct letter letter_at(const struct threeb_text *t, const uint8_t *p)
{
	struct letter l = { 0, 0 };

	if (p < t->end)
		l = *p < 0x80 ? (struct letter) { *p, 1 } :
				wide(p, (size_t)(t->end - p));
	if (l.c >= 'a' && l.c <= 'z')
		l.c = (uint8_t)(l.c - 'a' + 'A');
	if (l.c == '\t')
		l.c = ' ';
	return l;
}

static uint8_t at(const struct threeb_text *t, const uint8_t *p)
{
	return letter_at(t, p).c;
}

static const uint8_t *skip_blanks(const struct threeb_text *t,
				  const uint8_t *p)
{
	struct letter l;

	while ((l = letter_at(t, p)).c == ' ')
		p += l.bytes;
	return p;
}

static bool is_digit(uint8_t c)
{
	return c >= '0' && c <= '9';
}

static bool is_alnum(uint8_t c)
{
	return is_digit(c) || (c >= 'A' && c <= 'Z');
}

static bool is_eol(uint8_t c)
{
	return c == 0 || c == '\n' || c == '\r';
}

/* The place behind @word at @p; blanks between its letters are allowed.  NULL:
 * it is not there. */
static const uint8_t *match(const struct threeb_text *t, const uint8_t *p,
			    const char *word)
{
	for (; *word; word++) {
		const struct letter l = letter_at(t, p);

		if (l.c != (uint8_t)*word)
			return NULL;
		p = word[1] ? skip_blanks(t, p + l.bytes) : p + l.bytes;
	}
	return p;
}

/* A part of the line that can be quoted. */
struct quote {
	char s[24];
};

static struct quote quote(const struct threeb_text *t, const uint8_t *p)
{
	struct quote q = { "the end of the line" };
	size_t n = 0;

	if (is_eol(at(t, p)))
		return q;
	for (uint8_t c; n < sizeof(q.s) - 1 && !is_eol(c = at(t, p)) &&
	     c != ' '; p += letter_at(t, p).bytes)
		q.s[n++] = *p > ' ' && *p < 0x7f ? (char)*p :
			   c > ' ' && c < 0x7f ? (char)c : '?';
	q.s[n] = '\0';
	return q;
}

/* -- Records --------------------------------------------------------------- */

static const char *form(const struct threeb_text *t)
{
	return t->o->fourb ? A_RECORD_4B : A_RECORD;
}

static int refuse_b(struct threeb_text *t, const uint8_t *p)
{
	return threeb_refuse(t, p, form(t), "%s where a B should be",
			     quote(t, p).s);
}

/* The digits behind a B; no digits mean 0.  NULL: refused. */
static const uint8_t *number(struct threeb_text *t, const uint8_t *p,
			     int64_t *ret)
{
	const uint8_t *first = p = skip_blanks(t, p);
	struct letter l;

	*ret = 0;
	for (; is_digit((l = letter_at(t, p)).c); p += l.bytes) {
		*ret = *ret * 10 + (l.c - '0');
		if (*ret > INTERP_THREEB_MAX) {
			threeb_refuse(t, first, WHOLE, "a number of %s",
				      quote(t, first).s);
			return NULL;
		}
	}
	if (l.c == '.' || l.c == '-' || l.c == '+') {
		threeb_refuse(t, first, WHOLE, "%s", quote(t, first).s);
		return NULL;
	}
	return skip_blanks(t, p);
}

static const uint8_t *field(struct threeb_text *t, const uint8_t *p,
			    int64_t *ret, const uint8_t **ret_at)
{
	const struct letter l = letter_at(t, p);

	if (l.c != 'B') {
		refuse_b(t, p);
		return NULL;
	}
	*ret_at = skip_blanks(t, p + l.bytes);
	return number(t, p + l.bytes, ret);
}

/* D or DD behind the radius of 4B. */
static const uint8_t *shape(const struct threeb_text *t, const uint8_t *p,
			    struct threeb_record *r)
{
	const uint8_t *next;

	for (r->shape = 0; r->shape < 2 && (next = match(t, p, "D"));
	     r->shape++)
		p = skip_blanks(t, next);
	return p;
}

static const struct {
	const char *word;
	enum threeb_kind kind;
} instructions[] = {
	{ "L", THREEB_LINE }, { "NR", THREEB_CCW }, { "SR", THREEB_CW },
};

/* Z; NULL if there is none. */
static const uint8_t *instruction(const struct threeb_text *t,
				  const uint8_t *p, struct threeb_record *r)
{
	for (size_t i = 0; i < 3; i++) {
		const uint8_t *q = match(t, p, instructions[i].word);
		struct letter l;

		if (!q)
			continue;
		q = skip_blanks(t, q);
		l = letter_at(t, q);
		if (l.c < '1' || l.c > '4' || is_digit(at(t, q + l.bytes)))
			return NULL;
		r->kind = instructions[i].kind;
		r->quadrant = (uint8_t)(l.c - '0');
		return q + l.bytes;
	}
	return NULL;
}

/* G and Z. */
static int direction(struct threeb_text *t, const uint8_t *p,
		     struct threeb_record *r)
{
	const uint8_t *next = match(t, p, "GX");

	r->count_y = !next;
	if (!next)
		next = match(t, p, "GY");
	if (!next)
		return threeb_refuse(t, p, "GX or GY, the axis J counts",
				     "%s where the counting direction "
				     "should be", quote(t, p).s);
	p = skip_blanks(t, next);
	r->z_at = p;
	next = instruction(t, p, r);
	if (!next)
		return threeb_refuse(t, p, "one of L1 ... L4, NR1 ... NR4, "
				     "SR1 ... SR4", "%s where the instruction "
				     "should be", quote(t, p).s);
	t->p = next;
	t->tail = true;
	t->begun = true;
	return (int)r->kind;
}

static int record(struct threeb_text *t, const uint8_t *p,
		  struct threeb_record *r)
{
	const uint8_t *ignored;
	const uint8_t sign = at(t, p);

	*r = (struct threeb_record) { .at = p, .minus = sign == '-' };
	if (t->over)
		return threeb_refuse(t, p, "the end code behind the last "
				     "record", "a record behind the end");
	if (sign != 'B')
		p = skip_blanks(t, p + letter_at(t, p).bytes);
	p = field(t, p, &r->x, &ignored);
	p = p ? field(t, p, &r->y, &ignored) : NULL;
	p = p ? field(t, p, &r->j, &r->j_at) : NULL;
	if (p && t->o->fourb) {
		p = field(t, p, &r->r, &r->r_at);
		p = p ? shape(t, p, r) : NULL;
	}
	return p ? direction(t, p, r) : -EINVAL;
}

/* Does a record begin here, with B and then a field or the next B? */
static bool begins_record(const struct threeb_text *t, const uint8_t *p)
{
	struct letter l = letter_at(t, p);

	if (t->o->fourb && (l.c == '+' || l.c == '-'))
		l = letter_at(t, p = skip_blanks(t, p + l.bytes));
	if (l.c != 'B')
		return false;
	l.c = at(t, skip_blanks(t, p + l.bytes));
	return is_digit(l.c) || (l.c && strchr("B+-.", l.c));
}

/* -- Text around them
 * ------------------------------------------------------- */

static const struct {
	const char *word;
	uint32_t bit;
} ends[] = {
	{ "DD", INTERP_THREEB_DD }, { "D", INTERP_THREEB_D },
	{ "E", INTERP_THREEB_E }, { "MJ", INTERP_THREEB_MJ },
};

/* An end code that stands alone: its letters do not begin a longer word. */
static const uint8_t *end_code(const struct threeb_text *t, const uint8_t *p,
			       uint32_t *ret)
{
	const uint32_t known = t->o->ends ? t->o->ends : INTERP_THREEB_ENDS;

	for (size_t i = 0; i < sizeof(ends) / sizeof(ends[0]); i++) {
		const uint8_t *q = match(t, p, ends[i].word);

		if (!(known & ends[i].bit) || !q || is_alnum(at(t, q)))
			continue;
		*ret = ends[i].bit;
		return q;
	}
	return NULL;
}

/* Is there a counting direction with an instruction before the line ends? */
static bool hides_record(const struct threeb_text *t, const uint8_t *p)
{
	struct threeb_record r;

	for (uint8_t c; !is_eol(c = at(t, p)); p += letter_at(t, p).bytes) {
		const uint8_t *q;

		if (c != 'G')
			continue;
		q = match(t, p, "GX");
		if (!q)
			q = match(t, p, "GY");
		if (q && instruction(t, skip_blanks(t, q), &r))
			return true;
	}
	return false;
}

/* Go past a comment, if what is here may be one. */
static int comment(struct threeb_text *t)
{
	const uint8_t *p = t->p;
	const uint8_t c = at(t, p);

	if (!strchr(MARKS, c)) {
		if ((is_digit(c) && !t->tail) || hides_record(t, p))
			return refuse_b(t, p);
		if (t->begun && !t->tail && !t->over && c != FOREIGN)
			return threeb_refuse(t, p, "a record, an end code "
					     "(DD D E MJ) or a comment behind "
					     ";", "%s", quote(t, p).s);
	}
	while (p < t->end && !is_eol(*p))
		p++;
	t->p = p;
	return 0;
}

/* N1, N1: or N 1 : in front of a record or an end; else NULL. */
static const uint8_t *numbered(const struct threeb_text *t, const uint8_t *p)
{
	const uint8_t *first;
	struct letter l;

	if (at(t, p) != 'N')
		return NULL;
	first = p = skip_blanks(t, p + letter_at(t, p).bytes);
	for (; is_digit((l = letter_at(t, p)).c); p += l.bytes)
		;
	if (p == first)
		return NULL;
	p = skip_blanks(t, p);
	l = letter_at(t, p);
	return l.c == ':' ? skip_blanks(t, p + l.bytes) : p;
}

static void line_over(struct threeb_text *t)
{
	if (t->p + 1 < t->end && t->p[0] == '\r' && t->p[1] == '\n')
		t->p++;
	t->line_at = ++t->p;
	t->line++;
	t->tail = false;
}

/* The record, end or line break at t->p; THREEB_OVER: look again. */
static int look(struct threeb_text *t, struct threeb_record *ret)
{
	const uint8_t *past = numbered(t, t->p), *q;
	uint32_t code;

	if (past) {
		t->p = past;
		t->tail = t->tail && !is_digit(at(t, past));
	}
	if (begins_record(t, t->p))
		return record(t, t->p, ret);
	q = end_code(t, t->p, &code);
	if (q) {
		*ret = (struct threeb_record) { .at = t->p };
		t->p = q;
		t->tail = true;
		t->begun = true;
		if (code == INTERP_THREEB_D && !t->o->d_ends)
			return t->over ? THREEB_OVER : THREEB_PAUSE;
		t->over = true;
		return THREEB_END;
	}
	if (is_eol(at(t, t->p)))
		return THREEB_OVER;
	return comment(t) ? -EINVAL : THREEB_OVER;
}

int threeb_next(struct threeb_text *t, struct threeb_record *ret)
{
	int what = THREEB_OVER;

	while (what == THREEB_OVER) {
		t->p = skip_blanks(t, t->p);
		if (t->p >= t->end)
			break;
		if (is_eol(*t->p))
			line_over(t);
		else
			what = look(t, ret);
	}
	return what;
}

int threeb_open(struct threeb_text *t, const char *text, size_t bytes)
{
	const uint8_t *nul;

	t->p = (const uint8_t *)text;
	t->end = t->p + bytes;
	t->line_at = t->p;
	t->line = 1;
	nul = memchr(t->p, 0, bytes);
	if (nul) {
		while (t->p < nul) {
			if (is_eol(*t->p))
				line_over(t);
			else
				t->p++;
		}
		return threeb_refuse(t, nul, "text, and no NUL", "byte 0x00");
	}
	if (bytes >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
		t->line_at = t->p += 3;
	return 0;
}
