/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_edge_arcs.c - paths that touch the end of the travel
 *
 * What lies inside is accepted; what leaves the travel by a lattice point is
 * refused.  Random texts of every dialect, and random arcs of thousands of
 * pulses, by every strategy: the travel is made as narrow as their walk.
 */
#include "interp/angle.h"
#include "random_compile.h"
#include "seed.h"

#define ROUNDS		SEED_ROUNDS(300)
#define LARGE_ROUNDS	SEED_ROUNDS(60)
#define HUGE_MM		100	/* of 1e-6 mm a pulse */
#define HUGE_CIRCLES	100

static uint64_t seed;

struct narrow {
	struct script text;
	const char *dialect;
	struct interp_machine m;
	struct interp_build_options o;
	struct made made;
};

static void wide(struct narrow *k)
{
	k->m = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		k->m.axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 100, 1000, 20000
		};
}

static bool compile(struct narrow *k)
{
	return random_compile(&k->text, k->dialect, &k->o, &k->made);
}

/* A path that ends where the machine says may lie elsewhere. */
static bool is_sensed(const struct interp_program *p)
{
	for (uint32_t i = 0; i < p->head->nsegs; i++)
		if (p->segs[i].flags & INTERP_SEG_SENSED)
			return true;
	return false;
}

struct reach {
	int32_t low[INTERP_NAXES], high[INTERP_NAXES];
};

static void reach_add(struct reach *r, const struct interp_cursor *c)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (c->pos[i] < r->low[i])
			r->low[i] = c->pos[i];
		if (c->pos[i] > r->high[i])
			r->high[i] = c->pos[i];
	}
}

static struct reach walk(const struct narrow *k)
{
	struct reach r = { { 0 }, { 0 } };
	struct interp_cursor c;
	enum interp_step s;

	assert_int_equal(interp_cursor_init(&c, &k->made.p), 0);
	do {
		interp_cursor_aim(&c, 1e3);
		while ((s = interp_cursor_step(&c)) == INTERP_MOVED)
			reach_add(&r, &c);
		if (s == INTERP_AT_ACTION)
			s = interp_cursor_pass(&c);
	} while (s == INTERP_ARRIVED);
	assert_int_equal(s, INTERP_AT_END);
	return r;
}

/* Is it taken with so many pulses less to one side? */
static bool fits(struct narrow *k, int axis, bool up, int32_t pulses)
{
	struct interp_axis_limits *l = &k->m.axis[axis];
	const struct interp_axis_limits was = *l;
	bool taken;

	if (up)
		l->travel_max_mm = pulses * l->pulse_mm;
	else
		l->travel_min_mm = pulses * l->pulse_mm;
	taken = compile(k);
	if (taken)
		unmake(&k->made);
	*l = was;
	return taken;
}

static void say(const struct narrow *k, int axis, int32_t at, const char *what)
{
	fail_msg("%s: %c at %d, --dialect %s --strategy %s\n%s", what,
		 INTERP_AXIS_LETTERS[axis], at, k->dialect,
		 interp_strategy_name(k->o.strategy), k->text.at);
}

/* One axis at a time may stay so far within a circle that lies outside, and the
 * places of a curve may lie to both sides of its sharp tip. */
static int32_t within(const struct narrow *k, bool curves)
{
	return k->o.strategy == INTERP_SIMULTANEOUS && !curves ? 0 : 3;
}

/* Return: how many axes were tried. */
static int try_edges(struct narrow *k)
{
	struct reach r;
	bool sensed;
	int32_t in;
	int n = 0;

	if (!compile(k))
		return 0;
	sensed = is_sensed(&k->made.p);
	in = within(k, k->made.p.head->ncurves > 0);
	r = walk(k);
	unmake(&k->made);
	for (int i = 0; i < 2 * INTERP_NAXES && !sensed; i++) {
		const int axis = i / 2;
		const bool up = i % 2;
		const int32_t at = up ? r.high[axis] : r.low[axis];

		if (at == 0)
			continue;
		n++;
		if (!fits(k, axis, up, at + (up ? in : -in)))
			say(k, axis, at, "refused");
		if (fits(k, axis, up, at + (up ? -1 : 1)))
			say(k, axis, at, "leaves the travel");
	}
	return n;
}

static struct interp_build_options options(struct narrow *k, uint64_t *s)
{
	return (struct interp_build_options) {
		.machine = &k->m, .tolerance_milli = 2000,
		.strategy = (enum interp_strategy)
			    (rnd(s) % INTERP_NSTRATEGIES),
	};
}

static void the_travel_counts_in_pulses(void **st)
{
	static struct narrow k;
	uint64_t s = seed;
	int n = 0;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		wide(&k);
		k.dialect = random_text(&k.text, &s);
		k.o = options(&k, &s);
		n += try_edges(&k);
	}
	print_message("    %d ends of a travel\n", n);
	assert_true(n > ROUNDS);
}

/* An arc of up to 30 mm; at times it is a helix, or a whole circle. */
static void put_large(struct script *t)
{
	const double r = exp(uniform(t->seed, log(0.1), log(30)));
	const double from = uniform(t->seed, 0, 6.283);
	const double turn = rnd(t->seed) % 4 ? uniform(t->seed, 0, 6.283) : 0;
	const double x = uniform(t->seed, -20, 20);

	t->n = 0;
	put(t, "G90 G21 F100\nG1 X%.3f Y%.3f\n", x + r * cos(from),
	    r * sin(from));
	put(t, "G%d X%.3f Y%.3f I%.3f J%.3f", rnd(t->seed) % 2 ? 2 : 3,
	    x + r * cos(from + turn), r * sin(from + turn), -r * cos(from),
	    -r * sin(from));
	if (rnd(t->seed) % 3 == 0)
		put(t, " Z%.3f", uniform(t->seed, -1, 1));
	put(t, "\nM2\n");
}

static void an_arc_of_thousands_of_pulses_is_looked_at(void **st)
{
	static struct narrow k;
	uint64_t s = seed;
	int n = 0;

	(void)st;
	k.dialect = "generic";
	k.text.seed = &s;
	for (int i = 0; i < LARGE_ROUNDS; i++) {
		wide(&k);
		put_large(&k.text);
		k.o = options(&k, &s);
		n += try_edges(&k);
	}
	print_message("    %d ends of a travel\n", n);
	assert_true(n > LARGE_ROUNDS);
}

/* Point by point, all of them would take a quarter of an hour. */
static void a_huge_circle_takes_few_looks(void **st)
{
	static struct narrow k;
	const struct interp_build_options o = {
		.machine = &k.m, .strategy = INTERP_SIMULTANEOUS,
	};
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .sweep = ANGLE_TURN,
	};
	const struct interp_build_word w = { .feed_mm_s = 1 };
	const double there[INTERP_NAXES] = { HUGE_MM };
	struct interp_diag d;
	struct interp_build *b;

	(void)st;
	wide(&k);
	for (int i = 0; i < INTERP_NAXES; i++) {
		k.m.axis[i].pulse_mm = 1e-6;
		k.m.axis[i].travel_min_mm = -HUGE_MM;
		k.m.axis[i].travel_max_mm = HUGE_MM;
	}
	b = interp_build_create(&o);
	assert_non_null(b);
	assert_int_equal(interp_build_line(b, there, &w, &d), 0);
	for (int i = 0; i < HUGE_CIRCLES; i++)
		assert_int_equal(interp_build_arc(b, there, &arc, &w, &d), 0);
	interp_build_destroy(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_travel_counts_in_pulses),
		cmocka_unit_test(an_arc_of_thousands_of_pulses_is_looked_at),
		cmocka_unit_test(a_huge_circle_takes_few_looks),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
