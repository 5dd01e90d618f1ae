/* SPDX-License-Identifier: Apache-2.0 */
/*
 * oword.c - o100 sub, call, if, while, repeat: LinuxCNC's flow
 *
 * All o words of the text are found once, in their order.  Words that belong
 * together have the same name.
 */
#include "code/macro.h"
#include "code/number.h"
#include "grow.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define ARGUMENTS_MAX	30

/* Each with the brackets that may stand behind it. */
static const struct {
	const char *word;
	uint8_t brackets;
} words[OWORD_NKINDS] = {
	[OWORD_SUB] = { "SUB", 0 }, [OWORD_ENDSUB] = { "ENDSUB", 1 },
	[OWORD_CALL] = { "CALL", ARGUMENTS_MAX },
	[OWORD_RETURN] = { "RETURN", 1 },
	[OWORD_IF] = { "IF", 1 }, [OWORD_ELSEIF] = { "ELSEIF", 1 },
	[OWORD_ELSE] = { "ELSE", 0 }, [OWORD_ENDIF] = { "ENDIF", 0 },
	[OWORD_WHILE] = { "WHILE", 1 }, [OWORD_ENDWHILE] = { "ENDWHILE", 0 },
	[OWORD_DO] = { "DO", 0 }, [OWORD_REPEAT] = { "REPEAT", 1 },
	[OWORD_ENDREPEAT] = { "ENDREPEAT", 0 },
	[OWORD_BREAK] = { "BREAK", 0 }, [OWORD_CONTINUE] = { "CONTINUE", 0 },
};

#define KIND(kind)	(1u << (kind))

/* -- Found once
 * ------------------------------------------------------------- */

/* Return: 1 if @l is at an o word, and then go behind its name; 0 if it is
 * not. */
static int take_name(struct macro_line *l, char name[MACRO_NAME_MAX])
{
	const uint8_t *p;
	uint64_t n = 0;

	if (macro_word(l, "N"))
		l->p = nc_digits(nc_skip_blanks(l->p, l->end), l->end, &n);
	if (!macro_word(l, "O"))
		return 0;
	macro_blanks(l);
	if (l->p < l->end && *l->p == '<') {
		const int err = macro_name(l, name);

		return err ? err : 1;
	}
	n = 0;
	p = nc_digits(l->p, l->end, &n);
	if (p == l->p || p - l->p > NC_DIGITS_MAX)
		return macro_refuse(l, l->p, "o100 or o<name>, written out",
				    "an o word without a number or a name");
	snprintf(name, MACRO_NAME_MAX, "%llu", (unsigned long long)n);
	l->p = p;
	return 1;
}

static bool take_kind(struct macro_line *l, uint8_t *ret)
{
	for (uint8_t i = 0; i < OWORD_NKINDS; i++) {
		const uint8_t *from = l->p;

		if (macro_word(l, words[i].word) &&
		    (l->p == l->end || !isalpha(*l->p))) {
			*ret = i;
			return true;
		}
		l->p = from;
	}
	return false;
}

static int note(struct macro_line *l, const struct oword *w, size_t *room)
{
	struct nc_macro *m = l->m;

	if (m->nowords == MACRO_OWORDS_MAX)
		return macro_refuse(l, l->p, "up to 100000 of them", "an o "
				    "word too many");
	if (m->nowords == *room &&
	    grow_array(&m->oword, room, sizeof(*m->oword)))
		return -ENOMEM;
	m->oword[m->nowords++] = *w;
	return 0;
}

/* A wrong name is refused when the program comes to it. */
static int find_all(struct macro_line *at)
{
	const struct nc_reader *r = at->r;
	struct oword w = { .place.line = 1 };
	const uint8_t *p = r->text;
	size_t room = 0;
	int err = 0;

	for (; !err && p < r->end; w.place.line++) {
		const uint8_t *begin = p;
		struct macro_line l = { .r = at->r, .m = at->m, .p = p,
					.end = nc_line_end(p, r->end) };
		struct interp_diag keep = *r->diag;

		w.place.offset = (size_t)(p - r->text);
		p = nc_line_next(l.end, r->end);
		if (take_name(&l, w.name) != 1) {
			*r->diag = keep;
			continue;
		}
		if (!take_kind(&l, &w.kind))
			continue;
		w.behind = (uint32_t)(l.p - begin);
		err = note(at, &w, &room);
	}
	return err;
}

/* -- Words that belong together
 * --------------------------------------------- */

/* Where @i begins, for a refusal of its line. */
static const uint8_t *word_at(struct macro_line *l, uint32_t i)
{
	const struct oword *w = &l->m->oword[i];

	l->r->line_at = l->r->text + w->place.offset;
	l->r->line = w->place.line;
	return l->r->line_at;
}

/* The next o word after @i that has its name and one of @kinds; nowords:
 * none. */
static uint32_t next_of(struct macro_line *l, uint32_t i, uint32_t kinds)
{
	const struct oword *all = l->m->oword;
	uint32_t j = i + 1;

	for (; j < l->m->nowords; j++, l->r->executed++) {
		if ((kinds & KIND(all[j].kind)) &&
		    strcmp(all[j].name, all[i].name) == 0)
			break;
	}
	return j;
}

static int refuse_alone(struct macro_line *l, uint32_t i, const char *other)
{
	const struct oword *w = &l->m->oword[i];
	char wanted[80];

	snprintf(wanted, sizeof(wanted), "o%s %s behind it", w->name, other);
	return macro_refuse(l, word_at(l, i), wanted, "o%s without its %s",
			    w->name, other);
}

/* Go on at the line of @j, or behind it. */
static int go(struct macro_line *l, uint32_t j, bool behind)
{
	(behind ? nc_go_behind : nc_go)(l->r, l->m->oword[j].place);
	return 1;
}

static int skip_to(struct macro_line *l, uint32_t i, uint32_t kinds,
		   const char *other)
{
	const uint32_t j = next_of(l, i, kinds);

	return j < l->m->nowords ? go(l, j, true) : refuse_alone(l, i, other);
}

/* Behind the keyword there are at most its brackets, also where they are not
 * looked at. */
static int check_end(struct macro_line *l, uint8_t kind)
{
	const uint8_t *p = nc_skip_void(l->p, l->end);
	uint32_t n = 0;
	int err;

	for (; p < l->end && *p == '[' && n < words[kind].brackets; n++) {
		int depth = 0;

		do {
			depth += (*p == '[') - (*p == ']');
			p = nc_skip_void(p + 1, l->end);
		} while (p < l->end && depth);
	}
	err = macro_ends(l, p, l->r->line);
	return err < 0 ? err : 0;
}

/* -- if ------------------------------------------------------------------- */

static int take_if(struct macro_line *l, uint32_t i)
{
	uint32_t j = i;
	bool truth;
	int err = macro_truth(l, &truth);

	while (!err && !truth) {
		struct macro_line other = *l;

		j = next_of(l, j, KIND(OWORD_ELSEIF) | KIND(OWORD_ELSE) |
				  KIND(OWORD_ENDIF));
		if (j == l->m->nowords)
			return refuse_alone(l, i, "endif");
		if (l->m->oword[j].kind != OWORD_ELSEIF)
			return go(l, j, true);
		other.p = word_at(l, j) + l->m->oword[j].behind;
		other.end = nc_line_end(other.p, l->r->end);
		err = check_end(&other, OWORD_ELSEIF);
		if (!err)
			err = macro_truth(&other, &truth);
	}
	return err ? err : j == i ? 1 : go(l, j, true);
}

/* -- Loops ---------------------------------------------------------------- */

/* The do that this while ends; nowords: this while begins a loop of its own. */
static uint32_t do_of(const struct macro_line *l, uint32_t i)
{
	const struct oword *all = l->m->oword;

	for (uint32_t j = i; j-- > 0; ) {
		if (strcmp(all[j].name, all[i].name) != 0)
			continue;
		if (all[j].kind == OWORD_DO)
			return j;
		if (all[j].kind != OWORD_BREAK && all[j].kind != OWORD_CONTINUE)
			break;
	}
	return l->m->nowords;
}

static int take_while(struct macro_line *l, uint32_t i)
{
	const uint32_t begin = do_of(l, i);
	bool truth;
	int err = macro_truth(l, &truth);

	if (err)
		return err;
	if (begin == l->m->nowords)
		return truth ? 1 : skip_to(l, i, KIND(OWORD_ENDWHILE),
					   "endwhile");
	if (!truth)
		return 1;
	err = macro_round(l, word_at(l, i));
	return err ? err : go(l, begin, true);
}

static int take_endwhile(struct macro_line *l, uint32_t i)
{
	const struct oword *all = l->m->oword;
	int err;

	for (uint32_t j = i; j-- > 0; ) {
		if (all[j].kind != OWORD_WHILE ||
		    strcmp(all[j].name, all[i].name) != 0)
			continue;
		err = macro_round(l, word_at(l, i));
		return err ? err : go(l, j, false);
	}
	return macro_refuse(l, word_at(l, i), "while before it",
			    "o%s endwhile of no loop",
			    all[i].name);
}

static int take_repeat(struct macro_line *l, uint32_t i)
{
	struct nc_macro *m = l->m;
	double n;
	int err = macro_bracket(l, &n);

	if (err)
		return err;
	if (!(n < 1e9))
		return macro_refuse(l, word_at(l, i), "fewer rounds",
				    "a repeat of %g", n);
	n = rint(n);
	if (n < 1)
		return skip_to(l, i, KIND(OWORD_ENDREPEAT), "endrepeat");
	if (m->nloops == MACRO_LOOPS)
		return macro_refuse(l, word_at(l, i), "up to 16 of them inside "
				    "each other", "a repeat too many");
	m->loop[m->nloops++] = (struct macro_loop) {
		.id = i, .depth = l->r->depth, .left = (uint32_t)n - 1,
	};
	return 1;
}

static struct macro_loop *loop_of(struct macro_line *l, uint32_t i)
{
	const struct oword *all = l->m->oword;
	struct macro_loop *loop = l->m->nloops ?
				  &l->m->loop[l->m->nloops - 1] : NULL;

	if (!loop || loop->depth != l->r->depth ||
	    strcmp(all[loop->id].name, all[i].name) != 0)
		return NULL;
	return loop;
}

static int take_endrepeat(struct macro_line *l, uint32_t i)
{
	struct macro_loop *loop = loop_of(l, i);
	int err;

	if (!loop)
		return macro_refuse(l, word_at(l, i), "repeat before it",
				    "o%s endrepeat of no loop",
				    l->m->oword[i].name);
	if (loop->left == 0) {
		l->m->nloops--;
		return 1;
	}
	loop->left--;
	err = macro_round(l, word_at(l, i));
	return err ? err : go(l, loop->id, true);
}

static int take_break(struct macro_line *l, uint32_t i, bool leave)
{
	const uint32_t j = next_of(l, i, KIND(OWORD_ENDWHILE) |
				   KIND(OWORD_ENDREPEAT) | KIND(OWORD_WHILE));

	if (j == l->m->nowords)
		return refuse_alone(l, i, "endwhile or endrepeat");
	if (leave && l->m->oword[j].kind == OWORD_ENDREPEAT && loop_of(l, i))
		l->m->nloops--;
	return go(l, j, leave);
}

/* -- Calls ---------------------------------------------------------------- */

static int take_arguments(struct macro_line *l, double *local)
{
	uint32_t n = 1;
	int err = 0;

	for (;;) {
		macro_blanks(l);
		if (err || l->p == l->end || *l->p != '[')
			return err;
		err = macro_bracket(l, &local[n++]);
	}
}

static int take_call(struct macro_line *l, uint32_t i)
{
	double local[MACRO_LOCALS] = { 0 };
	struct nc_macro *m = l->m;
	struct nc_reader *r = l->r;
	const struct oword *all = m->oword;
	uint32_t j = 0;
	int err = take_arguments(l, local);

	if (err)
		return err;
	while (j < m->nowords && !(all[j].kind == OWORD_SUB &&
				   strcmp(all[j].name, all[i].name) == 0))
		j++;
	if (j == m->nowords)
		return macro_refuse(l, word_at(l, i),
				    "a sub of this text; other files are not "
				    "read",
				    "a call of o%s, which is not there",
				    all[i].name);
	if (r->depth == INTERP_NC_DEPTH_MAX)
		return macro_refuse(l, word_at(l, i),
				    "up to 8 calls inside each other",
				    "a call inside %d others",
				    INTERP_NC_DEPTH_MAX);
	r->frame[r->depth + 1] = (struct nc_frame) {
		.back = nc_next(r), .entry = all[j].place,
	};
	r->depth++;
	snprintf(r->frame[r->depth].name, sizeof(r->frame[0].name), "o%s",
		 all[j].name);
	m->level++;
	m->own_level[r->depth] = true;
	memcpy(m->local[m->level], local, sizeof(local));
	return go(l, j, true);
}

static int take_return(struct macro_line *l, uint32_t i)
{
	struct nc_reader *r = l->r;
	const uint8_t *at = word_at(l, i);
	double v = 0;
	bool given;
	int err = 0;

	if (r->depth == 0 || !l->m->own_level[r->depth])
		return macro_refuse(l, at, "call before it", "o%s return or "
				    "endsub outside its sub",
				    l->m->oword[i].name);
	macro_blanks(l);
	given = l->p < l->end && *l->p == '[';
	if (given)
		err = macro_bracket(l, &v);
	if (!err)
		err = macro_set_named(l, at, "_value", v);
	if (!err)
		err = macro_set_named(l, at, "_value_returned", given);
	if (err)
		return err;
	nc_macro_leave(r);
	nc_go(r, r->frame[r->depth].back);
	r->depth--;
	return 1;
}

static int carry_out(struct macro_line *l, uint32_t i)
{
	switch (l->m->oword[i].kind) {
	case OWORD_SUB:
		return skip_to(l, i, KIND(OWORD_ENDSUB), "endsub");
	case OWORD_ENDSUB:
	case OWORD_RETURN:
		return take_return(l, i);
	case OWORD_CALL:
		return take_call(l, i);
	case OWORD_IF:
		return take_if(l, i);
	case OWORD_ELSEIF:
	case OWORD_ELSE:
		return skip_to(l, i, KIND(OWORD_ENDIF), "endif");
	case OWORD_WHILE:
		return take_while(l, i);
	case OWORD_ENDWHILE:
		return take_endwhile(l, i);
	case OWORD_REPEAT:
		return take_repeat(l, i);
	case OWORD_ENDREPEAT:
		return take_endrepeat(l, i);
	case OWORD_BREAK:
		return take_break(l, i, true);
	case OWORD_CONTINUE:
		return take_break(l, i, false);
	default:			/* do, endif */
		return 1;
	}
}

int macro_oword(struct macro_line *l)
{
	struct nc_macro *m = l->m;
	char name[MACRO_NAME_MAX];
	uint32_t low = 0, high;
	uint8_t kind;
	int err = take_name(l, name);

	if (err != 1 || !take_kind(l, &kind))
		return err < 0 ? err : 0;
	err = check_end(l, kind);
	if (!err && !m->oword)
		err = find_all(l);
	if (err)
		return err;
	/* Find the o word of this line. */
	for (high = m->nowords; low < high; ) {
		const uint32_t mid = (low + high) / 2;

		if (m->oword[mid].place.offset < nc_this(l->r).offset)
			low = mid + 1;
		else
			high = mid;
	}
	return carry_out(l, low);
}
