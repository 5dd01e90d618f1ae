/* SPDX-License-Identifier: Apache-2.0 */
/* macro_flow.c - IF GOTO WHILE DO END and G65, in Fanuc's form */
#include "code/macro.h"
#include "code/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* -- Jumps ---------------------------------------------------------------- */

int macro_round(struct macro_line *l, const uint8_t *at)
{
	const struct nc_reader *r = l->r;
	const uint32_t most = r->executed_max < MACRO_ROUNDS_MAX ?
			      r->executed_max : MACRO_ROUNDS_MAX;

	if (l->m->rounds++ < most)
		return 0;
	return macro_refuse(l, at, "loops that end", "a loop that has gone on "
			    "for %u rounds", most);
}

/* A line that is looked at counts as a line carried out. */
static int count(struct macro_line *l, const uint8_t *at)
{
	if (l->r->executed++ < l->r->executed_max)
		return 0;
	return macro_refuse(l, at, "fewer jumps, or nearer ones", "more than "
			    "%u lines carried out or searched",
			    l->r->executed_max);
}

/* A line that is searched for: does @match say yes to it and @n? */
struct sought {
	bool (*match)(const uint8_t *p, const uint8_t *end, uint32_t n);
	uint32_t n;
};

static const uint8_t *behind_n(const uint8_t *p, const uint8_t *end,
			       uint64_t *n)
{
	p = nc_skip_void(p, end);
	if (p == end || (*p | 0x20) != 'n')
		return p;
	return nc_digits(nc_skip_blanks(p + 1, end), end, n);
}

static bool is_n(const uint8_t *p, const uint8_t *end, uint32_t n)
{
	uint64_t found = 0;
	const uint8_t *first = nc_skip_void(p, end);

	if (first == end || (*first | 0x20) != 'n')
		return false;
	return behind_n(p, end, &found) > first + 1 && found == n;
}

static bool is_end(const uint8_t *p, const uint8_t *end, uint32_t n)
{
	uint64_t ignored = 0, found = 0;
	struct macro_line l = { .p = behind_n(p, end, &ignored), .end = end };

	if (!macro_word(&l, "END"))
		return false;
	macro_blanks(&l);
	return nc_digits(l.p, end, &found) > l.p && found == n;
}

/* Search from @from up to @stop, or up to the beginning of another program. */
static int search(struct macro_line *l, struct nc_place from,
		  const uint8_t *stop, const struct sought *sought,
		  struct nc_place *ret)
{
	struct nc_reader *r = l->r;
	const uint8_t *p = r->text + from.offset;
	int err = 0;

	ret->line = 0;
	while (!err && p < stop) {
		const uint8_t *end = nc_line_end(p, r->end);

		from.offset = (size_t)(p - r->text);
		err = count(l, l->p);
		nc_count_bytes(r, (size_t)(end - p), NC_COUNTED_BYTES);
		if (from.offset != r->frame[r->depth].entry.offset &&
		    nc_begins_program(r, p, end))
			return err;
		if (sought->match(p, end, sought->n)) {
			*ret = from;
			return err;
		}
		p = nc_line_next(end, r->end);
		from.line++;
	}
	return err;
}

/* Search forward to the end of the program, and then from its beginning. */
static int jump(struct macro_line *l, const uint8_t *at, const char *word,
		double n)
{
	struct nc_reader *r = l->r;
	const struct nc_place next = nc_next(r);
	struct sought sought = { .match = is_n };
	struct nc_place to;
	int err;

	if (isnan(n))
		return macro_refuse(l, at, "the number of an N word",
				    "%sa variable without a value", word);
	if (!(n >= 1 && n < 1e9 && n == floor(n)))
		return macro_refuse(l, at, "the number of an N word behind it",
				    "%s%g", word, n);
	sought.n = (uint32_t)n;
	err = search(l, next, r->end, &sought, &to);
	if (!err && !to.line)
		err = search(l, r->frame[r->depth].entry, r->at, &sought, &to);
	if (err)
		return err;
	if (!to.line)
		return macro_refuse(l, at,
				    "the number of an N word that begins a "
				    "line of this program",
				    "%s%g, which is not there", word, n);
	if (to.offset < next.offset)
		err = macro_round(l, at);
	nc_go(r, to);
	return err;
}

static int go_to(struct macro_line *l, const uint8_t *at)
{
	double n;
	int err = macro_value(l, &n);

	if (!err && !l->idle)
		err = jump(l, at, "GOTO ", n);
	return err ? err : 1;
}

int nc_macro_jump(struct nc_reader *r, const uint8_t *at, double n)
{
	struct macro_line l = { .r = r, .m = nc_macro_make(r), .p = at };

	return l.m ? jump(&l, at, "M99 P", n) : -ENOMEM;
}

int macro_ends(struct macro_line *l, const uint8_t *behind, uint32_t line)
{
	const uint8_t *p = nc_skip_void(behind, l->end);

	if (p < l->end && *p == ';' &&
	    l->r->d->classes[';'] == NC_BLOCK_END)
		p = nc_skip_void(p + 1, l->end);
	if (p == l->end || *p == ';')
		return 1;
	l->r->line = line;
	return macro_refuse(l, p, "them on a line of their own",
			    "words behind a jump, a loop or a call");
}

static int take_if(struct macro_line *l, const uint8_t *at)
{
	bool truth;
	int err = macro_truth(l, &truth);

	if (err)
		return err;
	/* What is not done is read all the same, up to its end. */
	l->idle = !truth;
	if (macro_word(l, "GOTO"))
		return go_to(l, at);
	if (!macro_word(l, "THEN"))
		return macro_refuse(l, l->p, "GOTO or THEN behind IF [ ]",
				    "an IF without either");
	err = macro_assign(l);
	return err ? err : 1;
}

/* -- Loops ---------------------------------------------------------------- */

/* The number behind DO or END. */
static int take_number(struct macro_line *l, uint32_t *ret)
{
	uint64_t n = 0;
	const uint8_t *p;

	macro_blanks(l);
	p = nc_digits(l->p, l->end, &n);
	if (p == l->p || n < 1 || n > 3)
		return macro_refuse(l, l->p,
				    "DO1, DO2 or DO3, and END with the same "
				    "number",
				    "DO or END without one");
	l->p = p;
	*ret = (uint32_t)n;
	return 0;
}

static struct macro_loop *loop_of(struct macro_line *l, uint32_t id)
{
	for (uint32_t i = l->m->nloops; i-- > 0; ) {
		struct macro_loop *loop = &l->m->loop[i];

		if (loop->depth == l->r->depth && loop->id == id)
			return loop;
	}
	return NULL;
}

static int begin_loop(struct macro_line *l, const uint8_t *at, uint32_t id)
{
	struct macro_loop *loop = loop_of(l, id);

	if (!loop && l->m->nloops == MACRO_LOOPS)
		return macro_refuse(l, at, "up to 16 loops inside each other, "
				    "calls counted", "a loop too many");
	if (!loop)
		loop = &l->m->loop[l->m->nloops++];
	*loop = (struct macro_loop) {
		.id = id, .depth = l->r->depth, .place = nc_this(l->r),
	};
	return 1;
}

/* WHILE [ ] DO1, and DO1 alone. */
static int take_while(struct macro_line *l, const uint8_t *at, bool truth)
{
	struct nc_reader *r = l->r;
	struct nc_place to;
	struct sought sought = { .match = is_end };
	int err = take_number(l, &sought.n);

	if (err)
		return err;
	if (truth)
		return begin_loop(l, at, sought.n);
	err = search(l, nc_next(r), r->end, &sought, &to);
	if (err)
		return err;
	if (!to.line)
		return macro_refuse(l, at, "END with the number of its DO, in "
				    "the same program", "a WHILE without END%u",
				    sought.n);
	nc_go_behind(r, to);
	return 1;
}

static int take_end(struct macro_line *l, const uint8_t *at)
{
	struct macro_loop *loop;
	uint32_t id;
	int err = take_number(l, &id);

	if (err)
		return err;
	loop = loop_of(l, id);
	if (!loop)
		return macro_refuse(l, at, "WHILE [ ] DO or DO before it",
				    "END%u of no loop", id);
	err = macro_round(l, at);
	nc_go(l->r, loop->place);
	return err ? err : 1;
}

/* -- Calls ---------------------------------------------------------------- */

/* The variables of A ... Z behind G65; 0: the letter is not an argument. */
static const uint8_t argument[26] = {
	1, 2, 3, 7, 8, 9, 0, 11, 4, 5, 6, 0, 13, 0, 0, 0, 17, 18, 19, 20, 21,
	22, 23, 24, 25, 26
};

#define TIMES_MAX	9999

/* With L the macro is gone through again with the variables that it has left:
 * the arguments are set once. */
struct call {
	double local[MACRO_LOCALS];
	double number, times;		/* P and L */
	const uint8_t *name;		/* <NAME>; NULL: P has its number */
	uint32_t triples;		/* how many groups of I J K began */
	uint8_t last;			/* the last of I J K */
};

/* A second I, J or K that is not in the order I J K begins the next group of
 * three: #7 #8 #9, ... */
static uint32_t variable_of(struct call *c, uint8_t letter)
{
	if (letter < 'I' || letter > 'K')
		return argument[letter - 'A'];
	if (letter <= c->last)
		c->triples++;
	c->last = letter;
	return 4 + 3 * c->triples + (uint32_t)(letter - 'I');
}

/* A number behind @at that needs a decimal point, as a length in a word does:
 * without one Fanuc counts it in the last decimal of its letter. */
static bool wants_point(const struct macro_line *l, const uint8_t *at, double v)
{
	const uint8_t *p = nc_skip_blanks(at + 1, l->end);

	if (l->r->d->point == NC_POINT_FREE || v == 0 ||
	    !strchr("ABCIJKQRUVWXYZ", toupper(*at)))
		return false;
	for (; p < l->p; p++) {
		if (!strchr("+-0123456789 \t", *p))
			return false;
	}
	return true;
}

/* Return: 1: there is a <NAME>. */
static int take_name(struct macro_line *l, struct call *c)
{
	const uint8_t *at = l->p, *p;

	if (*at != '<' || l->r->d->classes['<'] != NC_LETTER_NAME)
		return 0;
	p = nc_name_end(at, l->end);
	if (!p || c->name || c->number != 0)
		return macro_refuse(l, at, "one program, by P or by <NAME>",
				    p ? "a second program behind G65" :
				    "a program's name without an end");
	c->name = at;
	l->p = p;
	return 1;
}

static int take_argument(struct macro_line *l, struct call *c)
{
	const uint8_t *at = l->p, letter = (uint8_t)toupper(*at);
	uint32_t which = 0;
	double v;
	int err = take_name(l, c);

	if (err)
		return err < 0 ? err : 0;
	l->p++;
	if (letter >= 'A' && letter <= 'Z')
		which = variable_of(c, letter);
	if (which >= MACRO_LOCALS || (!which && letter != 'P' && letter != 'L'))
		return macro_refuse(l, at,
				    "P and L, and A B C D E F H I J K M Q R S "
				    "T U V W X Y Z with values",
				    "'%c' behind G65",
				    *at);
	err = macro_value(l, &v);
	if (err)
		return err;
	if (wants_point(l, at, v))
		return macro_refuse(l, at, "a decimal point, as in X10.0: "
				    "without one Fanuc reads thousandths",
				    "%c%g without a decimal point", *at, v);
	if (letter == 'L' && (v != floor(v) || !(v >= 1 && v <= TIMES_MAX)))
		return macro_refuse(l, at, "a whole number of 1 to 9999",
				    "L%g times", v);
	if (which)
		c->local[which] = v;
	else
		*(letter == 'P' ? &c->number : &c->times) = v;
	return c->name && c->number != 0 ?
	       macro_refuse(l, at, "one program, by P or by <NAME>",
			    "a second program behind G65") : 0;
}

static int take_call(struct macro_line *l, const uint8_t *at)
{
	struct nc_reader *r = l->r;
	struct nc_macro *m = l->m;
	struct call c = { .times = 1 };
	int err = 0;

	for (int i = 0; i < MACRO_LOCALS; i++)
		c.local[i] = NAN;
	for (;;) {
		l->p = nc_skip_void(l->p, l->end);
		if (err || l->p == l->end || *l->p == ';')
			break;
		err = take_argument(l, &c);
	}
	if (!err)
		err = c.name ? nc_call_name(r, (uint32_t)c.times, c.name) :
		      nc_call(r, c.number, (uint32_t)c.times, at);
	if (err)
		return err;
	m->level++;
	m->own_level[r->depth] = true;
	for (int i = 0; i < MACRO_LOCALS; i++)
		m->local[m->level][i] = c.local[i];
	return 1;
}

/* What is between [ and its ] is text: #1[53] in it says how a number is
 * printed. */
static int skip_printed(struct macro_line *l)
{
	const uint8_t *at = l->p;
	int open = 0;

	macro_blanks(l);
	do {
		if (l->p == l->end)
			return macro_refuse(l, at, "[ ] with what is printed",
					    "a DPRNT or BPRNT without its ]");
		open += (*l->p == '[') - (*l->p == ']');
		l->p++;
	} while (open > 0);
	return l->p[-1] == ']' ? 1 :
	       macro_refuse(l, at, "[ ] with what is printed",
			    "a DPRNT or BPRNT without its [");
}

/* What is sent to a printer or a computer beside the control. */
static int skip_print(struct macro_line *l)
{
	static const struct { const char *word; bool prints; } rows[] = {
		{ "POPEN", false }, { "PCLOS", false },
		{ "DPRNT", true }, { "BPRNT", true },
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		if (!macro_word(l, rows[i].word))
			continue;
		nc_note_print(l->r, rows[i].word);
		return rows[i].prints ? skip_printed(l) : 1;
	}
	return 0;
}

static int take_flow(struct macro_line *l)
{
	uint64_t ignored = 0;
	const uint8_t *at;
	bool truth;
	int err;

	l->p = behind_n(l->p, l->end, &ignored);
	macro_blanks(l);
	at = l->p;
	err = skip_print(l);
	if (err)
		return err;
	if (macro_word(l, "IF"))
		return take_if(l, at);
	if (macro_word(l, "GOTO"))
		return go_to(l, at);
	if (macro_word(l, "G65"))
		return take_call(l, at);
	if (macro_word(l, "END"))
		return take_end(l, at);
	if (macro_word(l, "DO"))
		return take_while(l, at, true);
	if (!macro_word(l, "WHILE"))
		return 0;
	err = macro_truth(l, &truth);
	if (!err && !macro_word(l, "DO"))
		err = macro_refuse(l, l->p, "WHILE [ ] DO1",
				   "WHILE without DO");
	return err ? err : take_while(l, at, truth);
}

int macro_flow(struct macro_line *l)
{
	const uint32_t line = l->r->line;
	const int err = take_flow(l);

	return err == 1 ? macro_ends(l, l->p, line) : err;
}
