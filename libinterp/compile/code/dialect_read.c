/* SPDX-License-Identifier: Apache-2.0 */
/*
 * dialect_read.c - a file of dialects/ into the tables that the reader uses
 *
 *	[dialect]	what it is called, what it begins from
 *	[rules]		a few properties of its numbers and its flow
 *	[letters]	what a letter or a sign begins
 *	[words]		what G, M and T words mean
 *
 * docs/nc-code.md tells users how to write one.
 */
#include "code/dialect.h"
#include "code/meanings.h"
#include "code/number.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A part of a line. */
struct piece {
	const char *at;
	size_t n;
};

struct reading {
	struct interp_dialect *d;
	const char *line_at;
	uint32_t line;
	struct interp_diag *diag;
};

#define PIECE(p)	(int)(p).n, (p).at

static int refuse(struct reading *f, const char *at, const char *wanted,
		  const char *found, struct piece what)
{
	f->diag->line = f->line;
	f->diag->column = (uint32_t)(at - f->line_at) + 1;
	snprintf(f->diag->found, sizeof(f->diag->found), "%s %.*s", found,
		 what.n > 40 ? 40 : (int)what.n, what.at);
	snprintf(f->diag->wanted, sizeof(f->diag->wanted), "%s", wanted);
	return -EINVAL;
}

/* -- Parts of a line
 * -------------------------------------------------------- */

static struct piece trim(struct piece p)
{
	while (p.n && isblank((unsigned char)*p.at))
		p.at++, p.n--;
	while (p.n && isspace((unsigned char)p.at[p.n - 1]))
		p.n--;
	return p;
}

static bool is(struct piece p, const char *word)
{
	return strlen(word) == p.n && memcmp(p.at, word, p.n) == 0;
}

/* Take off what stands before the first @c, and @c itself; everything if there
 * is no @c. */
static struct piece cut(struct piece *p, char c)
{
	const char *at = memchr(p->at, c, p->n);
	const struct piece head = { p->at, at ? (size_t)(at - p->at) : p->n };

	p->at += head.n + (at != NULL);
	p->n -= head.n + (at != NULL);
	return trim(head);
}

/* The next line: it ends in LF, in CR LF, or in CR alone. */
static struct piece cut_line(struct piece *p)
{
	const char *lf = memchr(p->at, '\n', p->n);
	const size_t n = lf ? (size_t)(lf - p->at) : p->n;
	const char *cr = memchr(p->at, '\r', n);

	return cut(p, !cr || cr + 1 == lf ? '\n' : '\r');
}

/* The next word, up to a blank.  After the last word, n is 0. */
static struct piece next_word(struct piece *p)
{
	*p = trim(*p);
	return cut(p, ' ');
}

/* -- [rules] -------------------------------------------------------------- */

static const struct rule {
	const char *key;
	size_t at;
	const char *words[3];
	uint8_t value[3];
} rules[] = {
#define RULE(field)	offsetof(struct nc_dialect, field)
	{ "length_without_point", RULE(point),
	  { "free", "last-decimal", "refused" },
	  { NC_POINT_FREE, NC_POINT_LAST, NC_POINT_WANTED } },
	{ "centre", RULE(arc_places), { "from-start", "place" }, { 0, 1 } },
	{ "end", RULE(m2_ends), { "free", "M2" }, { 0, 1 } },
	{ "feed", RULE(no_feed), { "wanted", "optional" }, { 0, 1 } },
	{ "subprograms", RULE(label), { "O", "N" }, { 'O', 'N' } },
	{ "conditions_defined", RULE(defines), { "no", "yes" }, { 0, 1 } },
	{ "registers_defined", RULE(registers), { "no", "yes" }, { 0, 1 } },
	{ "ways_without_number", RULE(lone_ways), { "no", "yes" }, { 0, 1 } },
	{ "top_of_wire", RULE(lean), { "place", "lean" }, { 0, 1 } },
	{ "macros", RULE(macros), { "none", "fanuc", "linuxcnc" },
	  { MACRO_NONE, MACRO_FANUC, MACRO_LINUXCNC } },
	{ "dwell_p", RULE(dwell_ms), { "seconds", "milliseconds" }, { 0, 1 } },
	{ "g10_under_g91", RULE(g91_sets), { "moves", "sets" }, { 0, 1 } },
	{ "units", RULE(inches), { "millimetres", "inches" }, { 0, 1 } },
};

static int read_rule(struct reading *f, struct piece key, struct piece value)
{
	for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
		const struct rule *r = &rules[i];
		char wanted[96];

		if (!is(key, r->key))
			continue;
		for (int j = 0; j < 3 && r->words[j]; j++) {
			if (is(value, r->words[j])) {
				((uint8_t *)f->d->nc)[r->at] = r->value[j];
				return 0;
			}
		}
		snprintf(wanted, sizeof(wanted), "%s, %s%s%s", r->words[0],
			 r->words[1], r->words[2] ? ", " : "",
			 r->words[2] ? r->words[2] : "");
		return refuse(f, value.at, wanted, "a rule that is", value);
	}
	return refuse(f, key.at,
		      "one of length_without_point centre end feed subprograms "
		      "conditions_defined registers_defined "
		      "ways_without_number top_of_wire macros dwell_p "
		      "g10_under_g91 units",
		      "rule", key);
}

/* -- [letters] ------------------------------------------------------------ */

/* What may stand for a class, besides the name of a slot. */
static const struct {
	const char *name;
	uint8_t class;
} begins[] = {
	{ "code-G", NC_LETTER_G }, { "code-M", NC_LETTER_M },
	{ "code-T", NC_LETTER_T },
	{ "condition", NC_LETTER_E },
	{ "condition-or-axis", NC_LETTER_C },
	{ "condition-S", NC_LETTER_S },
	{ "register", NC_LETTER_D },
	{ "top", NC_LETTER_U },
	{ "top-centre-I", NC_WORD + NC_UI },
	{ "top-centre-J", NC_WORD + NC_UJ },
	{ "taper-angle", NC_WORD + NC_ANGLE },
	{ "R-or-turn", NC_LETTER_R },
	{ "of-ignored-words", NC_WORD + NC_SPARE },
	{ "comment", NC_SEMICOLON }, { "block-end", NC_BLOCK_END },
	{ "top-words", NC_COLON }, { "corner-words", NC_COMMA },
	{ "program-number", NC_WORD + NC_O },
	{ "program-name", NC_LETTER_NAME },
	{ "none", NC_BAD },
};

/* X Y ...: the slot with the letter's own name. */
static int slot_of(char letter)
{
	for (int i = 0; i < NC_NSLOTS; i++) {
		if (nc_words[i].letter == letter && isupper(letter) &&
		    i != NC_ANGLE && i != NC_UI && i != NC_UJ &&
		    !(NC_CORNER & NC_BIT(i)))
			return i;
	}
	return -1;
}

static void set_class(struct reading *f, unsigned char c, uint8_t class)
{
	f->d->nc->classes[c] = class;
	f->d->nc->classes[tolower(c)] = class;
}

static int refuse_letter(struct reading *f, struct piece p)
{
	return refuse(f, p.at, "a letter from A to Z, or semicolon, colon, "
		      "comma, angle",
		      "letter", p);
}

static int read_values(struct reading *f, struct piece value)
{
	struct piece w;

	while ((w = next_word(&value)).n) {
		const int slot = w.n == 1 ? slot_of(*w.at) : -1;

		if (slot < 0)
			return refuse(f, w.at, "letters of X Y Z A B C U V I J "
				      "K R F N S P L O D H Q", "letter", w);
		set_class(f, (unsigned char)*w.at, (uint8_t)(NC_WORD + slot));
	}
	return 0;
}

static int keep_text(struct reading *f, struct piece text, uint16_t *ret)
{
	struct nc_dialect *d = f->d->nc;

	if (text.n == 0)
		return 0;
	/* The text is printed as it is, and a NUL would end it. */
	for (size_t i = 0; i < text.n; i++)
		if (iscntrl((unsigned char)text.at[i]) && text.at[i] != '\t')
			return refuse(f, text.at + i, "letters in a reason",
				      "a control character behind",
				      (struct piece) { text.at, i });
	if (d->used + text.n + 1 > sizeof(d->text))
		return refuse(f, text.at, "shorter reasons: 12 kB in all",
			      "no room for", text);
	*ret = d->used;
	memcpy(d->text + d->used, text.at, text.n);
	d->used = (uint16_t)(d->used + text.n + 1);
	return 0;
}

/* Behind the ; a refusal says what would be accepted. */
static bool says_wanted(struct piece text)
{
	cut(&text, ';');
	return trim(text).n > 0;
}

/* Q = refuse: ...; Q = ignore-line: ... */
static int read_reason(struct reading *f, struct piece key, struct piece value)
{
	struct piece text = value;
	const bool refused = is(cut(&text, ':'), "refuse");

	if (key.n != 1 || !isupper((unsigned char)*key.at))
		return refuse_letter(f, key);
	text = trim(text);
	if (text.n == 0 || (refused && !says_wanted(text)))
		return refuse(f, value.at, "refuse: what it means elsewhere; "
			      "what would be accepted here", "not enough in",
			      value);
	set_class(f, (unsigned char)*key.at, refused ? NC_LETTER_REFUSED :
						       NC_LETTER_REST);
	return keep_text(f, text, &f->d->nc->reason[*key.at - 'A']);
}

static int read_letter(struct reading *f, struct piece key, struct piece value)
{
	struct piece rest = value, head = cut(&rest, ':');

	const bool one = key.n == 1 && isupper((unsigned char)*key.at);
	const unsigned char c = is(key, "semicolon") ? ';' :
				is(key, "colon") ? ':' :
				is(key, "comma") ? ',' :
				is(key, "angle") ? '<' :
				one ? (unsigned char)*key.at : 0;

	if (is(key, "values"))
		return read_values(f, value);
	if (is(head, "refuse") || is(head, "ignore-line"))
		return read_reason(f, key, value);
	if (!c)
		return refuse_letter(f, key);
	for (size_t i = 0; i < sizeof(begins) / sizeof(begins[0]); i++) {
		if (is(value, begins[i].name)) {
			set_class(f, c, begins[i].class);
			return 0;
		}
	}
	return refuse(f, value.at, "code-G -M -T, condition, "
		      "condition-or-axis, condition-S, register, top, "
		      "top-centre-I -J, taper-angle, "
		      "R-or-turn, "
		      "of-ignored-words, comment, block-end, top-words, "
		      "corner-words, "
		      "program-number, program-name, none, "
		      "refuse: or ignore-line:",
		      "a letter cannot be", value);
}

/* -- [words] -------------------------------------------------------------- */

static const struct meaning {
	const char *name;
	struct nc_code code;
} meanings[] = {
#define MEANING(name, group, value, takes) \
	{ name, { NC_##group, value, 0, takes, 0 } },
#define ONE_SHOT(name, id, run, takes) \
	{ name, { NC_ONE_SHOT, NC_##id, 0, takes, 0 } },
	NC_MEANINGS(MEANING)
	NC_ONE_SHOTS(ONE_SHOT)
	{ "ignore", { NC_IGNORED, 0, 0, 0, 0 } },
	{ "ignore-alone", { NC_IGNORED, 1, 0, 0, 0 } },
	{ "refuse", { NC_REFUSED, 0, 0, 0, 0 } },
	{ "none", { NC_UNKNOWN, 0, 0, 0, 0 } },
};

const char *interp_dialect_meaning(int i)
{
	return i >= 0 && i < (int)(sizeof(meanings) / sizeof(meanings[0])) ?
	       meanings[i].name : NULL;
}

/* The letters behind `ignore`: the slots that they fill. */
static int read_drops(struct reading *f, struct piece letters, uint32_t *ret)
{
	struct piece w;

	while ((w = next_word(&letters)).n) {
		const uint8_t class = f->d->nc->classes[(uint8_t)*w.at];
		const int slot = slot_of(*w.at);

		if (w.n != 1 || !isupper((unsigned char)*w.at))
			return refuse_letter(f, w);
		if (class >= NC_WORD && class < NC_OTHER)
			*ret |= NC_BIT(class - NC_WORD);
		else if (slot >= 0)
			*ret |= NC_BIT(slot);
	}
	return 0;
}

static int read_meaning(struct reading *f, struct piece value,
			struct nc_code *ret)
{
	struct piece text = value, head = cut(&text, ':'), w, left;
	const size_t n = sizeof(meanings) / sizeof(meanings[0]);
	size_t i = 0;
	int err;

	w = next_word(&head);
	while (i < n && !is(w, meanings[i].name))
		i++;
	if (i == n)
		return refuse(f, value.at, "a meaning that edmsim "
			      "--document-dialects lists, ignore, refuse or "
			      "none", "no word means", w);
	*ret = meanings[i].code;
	text = trim(text);
	if (ret->group == NC_REFUSED && !says_wanted(text))
		return refuse(f, value.at, "refuse: what it means elsewhere; "
			      "what would be accepted here", "not enough in",
			      value);
	left = head;
	if (ret->group != NC_IGNORED && left.n &&
	    !is(next_word(&left), "ignore"))
		return refuse(f, head.at, "ignore and letters, or a :",
			      "behind a meaning:", head);
	err = read_drops(f, left, &ret->drops);
	return err ? err : keep_text(f, text, &ret->text);
}

/* G59.1, M*: the place where its meaning is stored. */
static struct nc_code *place_of(struct reading *f, struct piece w)
{
	struct nc_dialect *d = f->d->nc;
	const char *end = w.at + w.n, *p = w.at + 1;
	struct nc_letter *l;
	uint64_t n = 0;

	if (w.n < 2 || !strchr("GMT", *w.at))
		return NULL;
	l = &d->letter[*w.at == 'G' ? 0 : *w.at == 'M' ? 1 : 2];
	if (w.n == 2 && *p == '*')
		return &l->other;
	if (w.n > 7 || !isdigit((unsigned char)*p))
		return NULL;
	p = (const char *)nc_digits((const uint8_t *)p, (const uint8_t *)end,
				    &n);
	n *= l->scale;
	if (l->scale > 1 && end - p == 2 && *p == '.' &&
	    isdigit((unsigned char)p[1])) {
		n += (uint64_t)(p[1] - '0');
		p = end;
	}
	return p == end && n < l->ncodes ? &l->codes[n] : NULL;
}

static int read_words(struct reading *f, struct piece key, struct piece value)
{
	struct nc_code code;
	struct piece w;
	int err = read_meaning(f, value, &code);

	while (!err && (w = next_word(&key)).n) {
		struct nc_code *at = place_of(f, w);

		if (!at)
			return refuse(f, w.at, "G0 to G199.9, M0 to M999, T0 "
				      "to T99, or G* M* T* for all others",
				      "no word", w);
		*at = code;
	}
	return err;
}

/* -- [dialect] ------------------------------------------------------------ */

static void point_letters(struct nc_dialect *d)
{
	d->letter[0].codes = d->code;
	d->letter[1].codes = d->code + NC_NG;
	d->letter[2].codes = d->code + NC_NG + NC_NM;
}

static void begin_tables(struct nc_dialect *d)
{
	memcpy(d->classes, nc_classes, sizeof(d->classes));
	d->letter[0] = (struct nc_letter) { .ncodes = NC_NG, .scale = 10 };
	d->letter[1] = (struct nc_letter) { .ncodes = NC_NM, .scale = 1 };
	d->letter[2] = (struct nc_letter) { .ncodes = NC_NT, .scale = 1 };
	point_letters(d);
	d->label = 'O';
	d->used = 1;
}

static int read_base(struct reading *f, struct piece value)
{
	const struct interp_dialect *base;
	char name[32];

	snprintf(name, sizeof(name), "%.*s", PIECE(value));
	base = interp_dialect_base(name);
	if (!base || base->reads != DIALECT_NC)
		return refuse(f, value.at, "a dialect of the ones built in",
			      "no base", value);
	*f->d->nc = *base->nc;
	point_letters(f->d->nc);
	return 0;
}

static int keep_name(struct reading *f, struct piece value, char *to,
		     size_t size)
{
	if (value.n == 0 || value.n >= size)
		return refuse(f, value.at, "1 to 31 letters", "a name of",
			      value);
	memcpy(to, value.at, value.n);
	to[value.n] = '\0';
	return 0;
}

static int read_head(struct reading *f, struct piece key, struct piece value)
{
	struct interp_dialect *d = f->d;

	if (is(key, "base"))
		return read_base(f, value);
	if (is(key, "also"))
		return keep_name(f, value, d->also, sizeof(d->also));
	if (is(key, "suffix"))
		return keep_name(f, value, d->suffix, sizeof(d->suffix));
	if (is(key, "about"))
		return 0;
	if (!is(key, "reads"))
		return refuse(f, key.at, "about, base, also, suffix or reads",
			      "key", key);
	if (!is(value, "nc") && !is(value, "3b") && !is(value, "4b"))
		return refuse(f, value.at, "nc, 3b or 4b", "no reader", value);
	d->reads = is(value, "nc") ? DIALECT_NC : is(value, "3b") ?
		   DIALECT_3B : DIALECT_4B;
	return 0;
}

/* -- Lines ---------------------------------------------------------------- */

static const struct section {
	const char *name;
	int (*read)(struct reading *f, struct piece key, struct piece value);
} sections[] = {
	{ "[dialect]", read_head },
	{ "[rules]", read_rule },
	{ "[letters]", read_letter },
	{ "[words]", read_words },
};

static int read_section(struct reading *f, struct piece line,
			const struct section **ret)
{
	for (size_t i = 0; i < sizeof(sections) / sizeof(sections[0]); i++) {
		if (is(line, sections[i].name)) {
			*ret = &sections[i];
			return 0;
		}
	}
	return refuse(f, line.at, "[dialect], [rules], [letters] or [words]",
		      "section", line);
}

static int read_line(struct reading *f, struct piece line,
		     const struct section **in)
{
	struct piece value, key;

	line = trim(line);
	if (line.n == 0 || *line.at == '#' || *line.at == ';')
		return 0;
	if (*line.at == '[')
		return read_section(f, line, in);
	value = line;
	key = cut(&value, '=');
	if (!*in || value.at == line.at + line.n)
		return refuse(f, line.at, *in ? "KEY = VALUE" :
			      "a section, such as [words], before it", "line",
			      line);
	return (*in)->read(f, key, trim(value));
}

int nc_dialect_read(struct interp_dialect *d, const char *text, size_t bytes,
		 struct interp_diag *diag)
{
	struct reading f = { .d = d, .diag = diag };
	struct piece all = { text, bytes };
	const struct section *in = NULL;
	int err = 0;

	begin_tables(d->nc);
	while (!err && all.n) {
		f.line++;
		f.line_at = all.at;
		err = read_line(&f, cut_line(&all), &in);
	}
	return err;
}

int interp_dialect_read(struct interp_dialect **ret, const char *name,
			const struct interp_text *text,
			struct interp_diag *diag)
{
	struct interp_dialect *d = calloc(1, sizeof(*d));
	int err;

	if (!d)
		return -ENOMEM;
	interp_dialect_word(0);		/* bases are there */
	d->nc = calloc(1, sizeof(*d->nc));
	if (!d->nc) {
		free(d);
		return -ENOMEM;
	}
	snprintf(d->name, sizeof(d->name), "%s", name);
	err = nc_dialect_read(d, text->at, text->bytes, diag);
	if (err)
		interp_dialect_free(d);
	else
		*ret = d;
	return err;
}

void interp_dialect_free(struct interp_dialect *d)
{
	if (!d)
		return;
	free(d->nc);
	free(d);
}
