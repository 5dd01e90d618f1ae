/* SPDX-License-Identifier: Apache-2.0 */
/*
 * macro_expr.c - values of expressions
 *
 * Angles are in degrees.  A vacant variable is NAN.  In arithmetic it counts as
 * 0.  EQ and NE can tell it from 0 if both sides are compared as variables.
 */
#include "code/macro.h"
#include "code/number.h"

#include <errno.h>
#include <math.h>

/* LinuxCNC's own TOLERANCE_EQUAL since 2.9.4; it was 1e-4. */
#define LINUXCNC_EQUAL	1e-6

/* From loose to tight; NOTHING ends an expression. */
enum { NOTHING, LOGIC, RELATION, SUM, PRODUCT, POWER };

enum op { NONE, OR, XOR, AND, EQ, NE, GT, GE, LT, LE, ADD, SUB, MUL, DIV, MOD,
	  POW };

static const struct {
	const char *word;
	uint8_t op, fanuc, linuxcnc;	/* how tight it binds */
} ops[] = {
	{ "**", POW, NOTHING, POWER },
	{ "+", ADD, SUM, SUM }, { "-", SUB, SUM, SUM },
	{ "*", MUL, PRODUCT, PRODUCT }, { "/", DIV, PRODUCT, PRODUCT },
	{ "MOD", MOD, PRODUCT, PRODUCT },
	{ "AND", AND, PRODUCT, LOGIC },
	{ "OR", OR, SUM, LOGIC }, { "XOR", XOR, SUM, LOGIC },
	{ "EQ", EQ, RELATION, RELATION }, { "NE", NE, RELATION, RELATION },
	{ "GT", GT, RELATION, RELATION }, { "GE", GE, RELATION, RELATION },
	{ "LT", LT, RELATION, RELATION }, { "LE", LE, RELATION, RELATION },
};

#define NOPS	(sizeof(ops) / sizeof(ops[0]))

static bool is_fanuc(const struct macro_line *l)
{
	return l->r->d->macros == MACRO_FANUC;
}

/* The operator at l->p.  Return: how tightly it binds, or NOTHING. */
static uint8_t next_op(struct macro_line *l, size_t *ret)
{
	const uint8_t *from;

	macro_blanks(l);
	from = l->p;
	for (size_t i = 0; i < NOPS; i++) {
		const uint8_t tight = is_fanuc(l) ? ops[i].fanuc :
						    ops[i].linuxcnc;

		if (tight && macro_word(l, ops[i].word)) {
			*ret = i;
			l->p = from;
			return tight;
		}
	}
	return NOTHING;
}

static double number(double v)
{
	return isnan(v) ? 0 : v;
}

/* In Fanuc's form it works on bits, in LinuxCNC's on truth values. */
static double logic(bool bits, uint8_t op, double a, double b)
{
	const uint32_t i = bits ? (uint32_t)(int64_t)a : a != 0;
	const uint32_t j = bits ? (uint32_t)(int64_t)b : b != 0;

	return op == AND ? i & j : op == OR ? i | j : i ^ j;
}

static bool equal(bool vacant, double a, double b)
{
	if (vacant && (isnan(a) || isnan(b)))
		return isnan(a) && isnan(b);
	return vacant ? a == b :
	       fabs(number(a) - number(b)) < LINUXCNC_EQUAL;
}

static double modulo(bool fanuc, double a, double b)
{
	const double left = fmod(a, b);

	/* In LinuxCNC's form it is never negative. */
	return !fanuc && left < 0 ? left + fabs(b) : left;
}

static int apply(struct macro_line *l, const uint8_t *at, size_t i,
		 double *a, double b)
{
	const bool fanuc = is_fanuc(l);
	const double x = number(*a), y = number(b);
	const uint8_t op = ops[i].op;

	if (l->idle)
		return 0;
	if ((op == DIV || op == MOD) && y == 0)
		return macro_refuse(l, at, "a divisor other than 0",
				    "a division by 0");
	if ((op == AND || op == OR || op == XOR) && fanuc &&
	    !(fabs(x) < 2147483648.0 && fabs(y) < 2147483648.0))
		return macro_refuse(l, at, "whole numbers of 32 bits",
				    "%s of %g and %g", ops[i].word, x, y);
	switch (op) {
	case ADD: *a = x + y; break;
	case SUB: *a = x - y; break;
	case MUL: *a = x * y; break;
	case DIV: *a = x / y; break;
	case MOD: *a = modulo(fanuc, x, y); break;
	case POW: *a = pow(x, y); break;
	case EQ: *a = equal(fanuc, *a, b); break;
	case NE: *a = !equal(fanuc, *a, b); break;
	case GT: *a = x > y; break;
	case GE: *a = x >= y || equal(fanuc, *a, b); break;
	case LT: *a = x < y; break;
	case LE: *a = x <= y || equal(fanuc, *a, b); break;
	default: *a = logic(fanuc, op, x, y); break;
	}
	if (isfinite(*a))
		return 0;
	return macro_refuse(l, at, "a number", "%s, which comes to no number",
			    ops[i].word);
}

/* Evaluate operators that bind at least as tightly as @least, from left to
 * right. */
static int climb(struct macro_line *l, uint8_t least, double *ret)
{
	int err = macro_value(l, ret);
	uint8_t tight;
	size_t i;

	while (!err && (tight = next_op(l, &i)) >= least && tight) {
		const uint8_t *at = l->p;
		double right;

		macro_word(l, ops[i].word);
		err = climb(l, (uint8_t)(tight + 1), &right);
		if (!err)
			err = apply(l, at, i, ret, right);
	}
	return err;
}

static int enter(struct macro_line *l)
{
	macro_blanks(l);
	if (l->p == l->end || *l->p != '[')
		return macro_refuse(l, l->p, "[ and an expression",
				    "no [ where one belongs");
	if (++l->brackets > MACRO_BRACKETS)
		return macro_refuse(l, l->p, "up to 32 brackets inside each "
				    "other", "a bracket too many");
	l->p++;
	return 0;
}

static int leave(struct macro_line *l)
{
	macro_blanks(l);
	if (l->p == l->end || *l->p != ']')
		return macro_refuse(l, l->p, "an operator, or ]",
				    "an expression without its ]");
	l->brackets--;
	l->p++;
	return 0;
}

int macro_expression(struct macro_line *l, double *ret)
{
	return climb(l, LOGIC, ret);
}

int macro_bracket(struct macro_line *l, double *ret)
{
	int err = enter(l);

	if (!err)
		err = climb(l, LOGIC, ret);
	return err ? err : leave(l);
}

int macro_truth(struct macro_line *l, bool *ret)
{
	double v;
	const int err = macro_bracket(l, &v);

	*ret = !err && number(v) != 0;
	return err;
}

/* -- Functions ------------------------------------------------------------ */

static double fup(double v)
{
	return v < 0 ? floor(v) : ceil(v);
}

/*
 * FIX, FUP and ROUND of a value that is a whole number by rule, as 2 SIN[30],
 * must not see the rounding of pi: so right angles are taken off first, which
 * is exact, and the rest is computed in long double, as LinuxCNC does.
 */
#define DEGREE_LONG	(3.14159265358979323846264338327950288L / 180)

/* 0.0 is added because -0 would turn ATAN[SIN[180]]/[-1] to -180. */
static double sin_quarters(double v, int quarters)
{
	int q;
	const long double rest = remquo(v, 90, &q) * DEGREE_LONG;
	const int turn = (q + quarters) & 3;
	const long double c = turn & 1 ? cosl(rest) : sinl(rest);

	return (double)(turn & 2 ? -c : c) + 0.0;
}

static double sin_deg(double v) { return sin_quarters(v, 0); }
static double cos_deg(double v) { return sin_quarters(v, 1); }
static double tan_deg(double v) { return sin_deg(v) / cos_deg(v); }
static double asin_deg(double v) { return (double)(asinl(v) / DEGREE_LONG); }
static double acos_deg(double v) { return (double)(acosl(v) / DEGREE_LONG); }

/* In a word ROUND may keep some decimals: macro.c */
static double rounded(const struct macro_line *l, double (*f)(double), double v)
{
	return f == round && l->parts > 0 ? round(v * l->parts) / l->parts :
					    f(v);
}

static const struct {
	const char *name;
	double (*fanuc)(double v), (*linuxcnc)(double v);
} functions[] = {
	{ "SIN", sin_deg, sin_deg }, { "COS", cos_deg, cos_deg },
	{ "TAN", tan_deg, tan_deg },
	{ "ASIN", asin_deg, asin_deg }, { "ACOS", acos_deg, acos_deg },
	{ "SQRT", sqrt, sqrt }, { "SQR", sqrt, NULL },
	{ "ABS", fabs, fabs }, { "LN", log, log }, { "EXP", exp, exp },
	{ "ROUND", round, round }, { "RND", round, NULL },
	/* In LinuxCNC's form they are floor and ceiling. */
	{ "FIX", trunc, floor }, { "FUP", fup, ceil },
};

/* ATAN[1]/[2], and in Fanuc's form also ATAN[1,2]. */
static int atangent(struct macro_line *l, double *ret)
{
	double y, x = 1;
	bool two = false;
	int err = enter(l);

	if (!err)
		err = climb(l, LOGIC, &y);
	macro_blanks(l);
	if (!err && is_fanuc(l) && l->p < l->end && *l->p == ',') {
		two = true;
		l->p++;
		err = climb(l, LOGIC, &x);
	}
	if (!err)
		err = leave(l);
	macro_blanks(l);
	if (!err && !two && l->p < l->end && *l->p == '/') {
		l->p++;
		err = macro_bracket(l, &x);
	}
	if (!err)
		*ret = (double)(atan2l(number(y), number(x)) / DEGREE_LONG);
	return err;
}

static int power(struct macro_line *l, double *ret)
{
	const uint8_t *at = l->p;
	double to;
	int err = enter(l);

	if (!err)
		err = climb(l, LOGIC, ret);
	macro_blanks(l);
	if (!err && (l->p == l->end || *l->p++ != ','))
		err = macro_refuse(l, at, "POW[2,3]", "POW without a comma");
	if (!err)
		err = climb(l, LOGIC, &to);
	if (!err)
		err = leave(l);
	if (err)
		return err;
	*ret = pow(number(*ret), number(to));
	return l->idle || isfinite(*ret) ? 0 :
	       macro_refuse(l, at, "a number", "POW, which comes to none");
}

/* EXISTS[#<name>] */
static int exists(struct macro_line *l, double *ret)
{
	char name[MACRO_NAME_MAX];
	int err = enter(l);

	macro_blanks(l);
	if (!err && (l->p == l->end || *l->p != '#'))
		err = macro_refuse(l, l->p, "EXISTS[#<name>]",
				  "EXISTS of no parameter");
	if (err)
		return err;
	l->p++;
	err = macro_name(l, name);
	if (err)
		return err;
	*ret = macro_find(l->m, name) != NULL;
	return leave(l);
}

static int function(struct macro_line *l, double *ret)
{
	const uint8_t *at = l->p;
	double v;

	if (macro_word(l, "ATAN"))
		return atangent(l, ret);
	if (is_fanuc(l) && macro_word(l, "POW"))
		return power(l, ret);
	if (!is_fanuc(l) && macro_word(l, "EXISTS"))
		return exists(l, ret);
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		double (*f)(double) = is_fanuc(l) ? functions[i].fanuc :
						    functions[i].linuxcnc;
		int err;

		if (!f || !macro_word(l, functions[i].name))
			continue;
		err = macro_bracket(l, &v);
		if (err)
			return err;
		*ret = rounded(l, f, number(v));
		return l->idle || isfinite(*ret) ? 0 :
		       macro_refuse(l, at, "a value the function has",
				    "%s[%g]", functions[i].name, v);
	}
	return macro_refuse(l, at, "a number, a #variable, [ ] or one of SIN "
			    "COS TAN ASIN ACOS ATAN SQRT ABS ROUND FIX FUP LN "
			    "EXP", "no value where one belongs");
}

static int variable(struct macro_line *l, double *ret)
{
	char name[MACRO_NAME_MAX];
	const uint8_t *at = l->p++;
	const double parts = l->parts;
	double which;
	int err;

	macro_blanks(l);
	if (!is_fanuc(l) && l->p < l->end && *l->p == '<') {
		err = macro_name(l, name);
		return err ? err : macro_get_named(l, at, name, ret);
	}
	if (++l->brackets > MACRO_BRACKETS)
		return macro_refuse(l, at, "up to 32 of them", "a # too many");
	l->parts = 0;			/* the number of a variable is whole */
	err = macro_value(l, &which);
	l->parts = parts;
	l->brackets--;
	*ret = 0;
	return err || l->idle ? err : macro_get(l, at, number(which), ret);
}

int macro_value(struct macro_line *l, double *ret)
{
	const uint8_t *p;
	bool minus = false;
	int err;

	macro_blanks(l);
	if (l->p < l->end && (*l->p == '-' || *l->p == '+')) {
		minus = *l->p++ == '-';
		macro_blanks(l);
	}
	if (l->p < l->end && *l->p == '#') {
		err = variable(l, ret);
	} else if (l->p < l->end && *l->p == '[') {
		err = macro_bracket(l, ret);
	} else {
		p = nc_number(l->p, l->end, ret);
		err = p ? 0 : function(l, ret);
		l->p = p ? p : l->p;
	}
	if (!err && minus)
		*ret = -*ret;
	return err;
}
