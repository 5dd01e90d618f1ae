/* SPDX-License-Identifier: Apache-2.0 */
/*
 * lines.c - two axes, one at a time: changes of axis and deviation of each
 * rule, counted on whole lines of 10000 main pulses
 */
#include "tried/greedy_walk.h"
#include "path/build_bits.h"

#include <stdio.h>
#include <stdlib.h>

#define Q	10000
#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

static const int slopes[] = { 100, 500, 1000, 2500, 3333, 5000, 6180, 7500,
			      9000, 9900, 10000 };
static const uint32_t mus[] = { 500, 1000, 1500, 2000, 5000, 10000 };

/* What is counted of one line. */
struct tally {
	size_t changes;
	int64_t lo, hi;			/* of e */
};

enum rule { PBP, CENTRED, PRINTED, MAIN_DIRECTION, MIN_SWITCH, GREEDY };

static const char *const names[] = {
	"point-by-point", "centred", "main direction as printed",
	"main-direction", "min-switch", "the fewest there can be",
};

/* A line by some rule: pair, or the yardstick's list of runs. */
struct line {
	struct interp_pair pair;
	uint32_t run[40000];
	struct greedy_runs runs;
	struct greedy_walk walk;
	bool greedy;
};

static void line_set(struct line *l, enum rule rule, int64_t b, uint32_t mu)
{
	static const enum interp_strategy strategies[] = {
		[PBP] = INTERP_POINT_BY_POINT, [CENTRED] = INTERP_CENTRED,
		[MAIN_DIRECTION] = INTERP_MAIN_DIRECTION,
		[MIN_SWITCH] = INTERP_MIN_SWITCH,
		[GREEDY] = INTERP_POINT_BY_POINT,
	};
	const struct pair_tube t = { mu, false };
	const int64_t half = pair_half_width(Q, b, t);
	const struct greedy_line g = { Q, b, half };

	l->pair = (struct interp_pair) { .a = Q, .b = b };
	l->greedy = rule == GREEDY;
	if (rule == PRINTED)
		/* Judges the point it is at, not the one it would come to. */
		pair_set_limit(&l->pair, half, false);
	else
		pair_set(&l->pair, strategies[rule], t, false);
	if (!l->greedy)
		return;
	l->runs = (struct greedy_runs) { .run = l->run,
					 .room = COUNT(l->run) };
	greedy_plan(&g, &l->runs);
	l->walk = (struct greedy_walk) { .r = &l->runs };
}

static bool line_forward(struct line *l)
{
	if (!l->greedy)
		return pair_forward(&l->pair);
	if (greedy_forward(&l->walk)) {
		pair_main(&l->pair, 1);
		return true;
	}
	pair_second(&l->pair, 1);
	return false;
}

static struct tally walk(enum rule rule, int64_t b, uint32_t mu)
{
	static struct line l;
	struct tally t = { 0 };
	bool was = false;

	line_set(&l, rule, b, mu);
	for (int64_t n = 0; n < Q + b; n++) {
		const bool main = line_forward(&l);

		t.changes += n > 0 && main != was;
		was = main;
		t.lo = l.pair.dev < t.lo ? l.pair.dev : t.lo;
		t.hi = l.pair.dev > t.hi ? l.pair.dev : t.hi;
	}
	if (l.pair.m != Q || l.pair.s != b || l.pair.dev != 0)
		abort();
	return t;
}

/* -- Tables --------------------------------------------------------------- */

static void heading(const char *what, enum rule rule)
{
	printf("\n### %s: %s\n\n| slope |", what, names[rule]);
	if (rule <= CENTRED) {
		printf(" any mu |\n|---|---|\n");
		return;
	}
	for (size_t i = 0; i < COUNT(mus); i++)
		printf(" mu %g |", mus[i] / 1000.0);
	printf("\n|---|");
	for (size_t i = 0; i < COUNT(mus); i++)
		printf("---|");
	printf("\n");
}

static void print_changes(struct tally t, int64_t b, bool ok)
{
	(void)b;
	printf(" %zu%s |", t.changes, ok ? "" : "*");
}

static void print_mean_run(struct tally t, int64_t b, bool ok)
{
	printf(" %.2f%s |", (double)(Q + b) / (double)(t.changes + 1),
	       ok ? "" : "*");
}

static void print_deviation(struct tally t, int64_t b, bool ok)
{
	(void)b;
	printf(" %.3f to %.3f%s |", (double)t.lo / Q, (double)t.hi / Q,
	       ok ? "" : "*");
}

typedef void (*print_fn)(struct tally t, int64_t b, bool ok);

static void table(const char *what, enum rule rule, print_fn print)
{
	const size_t columns = rule <= CENTRED ? 1 : COUNT(mus);

	heading(what, rule);
	for (size_t i = 0; i < COUNT(slopes); i++) {
		printf("| %g |", (double)slopes[i] / Q);
		for (size_t j = 0; j < columns; j++) {
			const struct pair_tube t = { mus[j], false };

			print(walk(rule, slopes[i], mus[j]), slopes[i],
			      rule <= PRINTED ||
			      pair_tube_ok(Q, slopes[i], t));
		}
		printf("\n");
	}
}

/* -- Random lines --------------------------------------------------------- */

#define LINES	2000

static uint64_t rnd(uint64_t *s)
{
	uint64_t z = *s += 0x9e3779b97f4a7c15u;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

/* Changes of the bursts. */
static int64_t burst_changes(int64_t a, int64_t b, struct pair_tube t)
{
	struct interp_pair p = { .a = a, .b = b };

	pair_set(&p, INTERP_MIN_SWITCH, t, false);
	return pair_burst_changes(&p);
}

static int64_t pbp_changes(int64_t a, int64_t b)
{
	struct interp_pair p = { .a = a, .b = b };
	int64_t n = 0;
	bool was;

	pair_set_limit(&p, 0, false);
	was = pair_forward(&p);
	for (int64_t i = 1; i < a + b; i++) {
		const bool main = pair_forward(&p);

		n += main != was;
		was = main;
	}
	return n;
}

struct sums {
	double few, bursts, worst, kept, bits;
};

static void add_line(struct sums *s, int64_t a, int64_t b, struct pair_tube t)
{
	const struct greedy_line l = { a, b, pair_half_width(a, b, t) };
	struct greedy_runs r = { .run = NULL };
	double few, n;

	greedy_plan(&l, &r);
	few = (double)(r.n - 1);
	n = (double)burst_changes(a, b, t) / few;
	s->few += few / (double)pbp_changes(a, b);
	s->bursts += n;
	s->worst = n > s->worst ? n : s->worst;
	s->kept += 100 * n > BUILD_BITS_ENOUGH ? 1 : n;
	s->bits += 100 * n > BUILD_BITS_ENOUGH;
}

static void random_row(struct pair_tube t)
{
	struct sums s = { 0 };
	uint64_t seed = 1;

	for (int i = 0; i < LINES; i++) {
		const int64_t a = 1000 + (int64_t)(rnd(&seed) % 9000);
		const int64_t b = 1 + (int64_t)(rnd(&seed) % (uint64_t)a);

		add_line(&s, a, b, t);
	}
	printf("| %g | %s | %.3f | %.3f | %.3f | %.3f | %.1f %% |\n",
	       t.milli / 1000.0, t.perpendicular ? "square" : "axial",
	       s.few / LINES, s.bursts / LINES, s.worst, s.kept / LINES,
	       100 * s.bits / LINES);
}

static void random_lines(void)
{
	static const uint32_t at[] = { 1000, 1200, 1500, 2000, 2300, 3000,
				       5000, 10000 };

	printf("\n## Random lines\n\n%d lines of 1000 to 9999 main pulses, of "
	       "any slope, with seed 1. The tolerance\nmu is measured along "
	       "the secondary axis or square to the line. All columns are\n"
	       "about changes of axis. *The fewest* is a share of what "
	       "point-by-point needs.\n*Bursts* is how many the bursts need "
	       "for each one of the fewest, the mean of\nall lines, and "
	       "*worst* is the worst line. *Program* is the same for a "
	       "program\ncompiled with min-switch. *With bits* is the share of "
	       "lines that store one bit\nfor each pulse, because their bursts "
	       "needed more than %d %% of the fewest.\n\n| mu | measured | the "
	       "fewest | bursts | worst | program | with bits |\n"
	       "|---|---|---|---|---|---|---|\n", LINES,
	       BUILD_BITS_ENOUGH);
	for (int square = 0; square < 2; square++) {
		for (size_t i = 0; i < COUNT(at); i++)
			random_row((struct pair_tube) { at[i], square });
	}
}

int main(void)
{
	printf("# Pulse-increment rules, counted\n\n`make experiments` prints "
	       "this page. Every figure is counted on whole walks, so\nit is "
	       "the same on every machine.\n\n## Two axes, lines of 10000 main "
	       "pulses\n\nThe rules are those of "
	       "`libinterp/core/pulse/pair.h`. *The fewest there can be*\nis "
	       "counted by `libinterp/compile/pulse/greedy.h`, which plans a "
	       "list of runs.\n*Main direction as printed* is the rule of the "
	       "paper: it judges the present\npoint, and each axis stops when "
	       "it has given all its pulses. `main-direction`\njudges the "
	       "point after the next pulse. The deviation is measured along "
	       "the\nsecondary axis, in pulses. A star marks a tolerance that "
	       "no walk of one axis at\na time can keep; the builder refuses "
	       "it.\n");
	for (int rule = PBP; rule <= GREEDY; rule++)
		table("Changes of axis", (enum rule)rule, print_changes);
	for (int rule = PBP; rule <= GREEDY; rule++)
		table("Mean run, pulses", (enum rule)rule, print_mean_run);
	for (int rule = PBP; rule <= GREEDY; rule++)
		table("Deviation", (enum rule)rule, print_deviation);
	random_lines();
	return 0;
}
