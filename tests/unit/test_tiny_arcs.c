/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_tiny_arcs.c - promises of all arcs of a few pulses
 *
 * Every centre, start and end of a small lattice, in both directions, with
 * every strategy: each arc is walked in the right direction to its end and
 * back, or refused.
 */
#include "walk_help.h"
#include "seed.h"

/* Of the start from the centre, and of the end. */
#define START	3
#define END	5

/* An arc that is walked stays so near to its circle, in pulses; of min-switch
 * by its tolerance more, and by a rounding of its centre. */
#define NEAR	2.5
#define ROUNDED	0.8
#define TOLERANCE	2.0

/* Of a text, in pulses. */
#define SAME	1e-3

#define RANDOM	20000

static uint64_t seed;

struct tiny {
	double from[2], to[2];		/* pulses, from the centre */
	double centre[2];
	bool clockwise;
	double z_mm;			/* beside it; 0: flat */
	enum interp_strategy how;
};

/* The angle from start to end, on round; a whole turn if they are in one
 * direction, as far as a text can say it. */
static double sweep_of(const struct tiny *t)
{
	const double turn = 2 * acos(-1);
	const double same = SAME / hypot(t->from[0], t->from[1]);
	double s = atan2(t->to[1], t->to[0]) - atan2(t->from[1], t->from[0]);

	if (t->clockwise)
		s = -s;
	while (s < 0)
		s += turn;
	return s < same || turn - s < same ? turn : s;
}

static void say(const struct tiny *t, const char *what)
{
	fail_msg("%s: %s from %g %g to %g %g round %g %g %s beside %g", what,
		 interp_strategy_name(t->how), t->from[0], t->from[1],
		 t->to[0], t->to[1], t->centre[0], t->centre[1],
		 t->clockwise ? "clockwise" : "ccw",
		 t->z_mm);
}

/* The angle that the points go round the centre, in the arc's direction; that
 * of a second half that became a line, which may pass through it, is not
 * known. */
static double turned(const struct tiny *t, const struct points *p)
{
	double sum = 0;
	bool begun = false;

	for (size_t k = 1; k < p->n; k++) {
		const double ax = p->at[k - 1].pos[0] - t->centre[0];
		const double ay = p->at[k - 1].pos[1] - t->centre[1];
		const double bx = p->at[k].pos[0] - t->centre[0];
		const double by = p->at[k].pos[1] - t->centre[1];

		if (begun && p->at[k].kind == INTERP_LINE)
			return sweep_of(t);
		begun |= p->at[k].kind == INTERP_ARC;
		if (begun)
			sum += atan2(ax * by - ay * bx, ax * bx + ay * by);
	}
	return t->clockwise ? -sum : sum;
}

static void check_circle(const struct tiny *t, const struct points *p)
{
	const double r0 = hypot(t->from[0], t->from[1]);
	const double r1 = hypot(t->to[0], t->to[1]);
	/* Where the radii differ, the centre moves between lattice points. */
	const bool rounded = t->centre[0] != 0 || fabs(r1 - r0) > 1e-9;
	const double near = NEAR + (rounded ? ROUNDED : 0) +
			    (t->how == INTERP_MIN_SWITCH ? TOLERANCE : 0);

	for (size_t k = 0; k < p->n; k++) {
		const double r = hypot(p->at[k].pos[0] - t->centre[0],
				       p->at[k].pos[1] - t->centre[1]);

		if (p->at[k].kind == INTERP_ARC &&
		    (r > fmax(r0, r1) + near || r < fmin(r0, r1) - near))
			say(t, "off the circle");
	}
	/* Right round the centre the angle of a pulse is anything. */
	if (fmin(r0, r1) > (rounded ? 2 : 0.9) + fabs(r1 - r0) / 2 &&
	    fabs(turned(t, p) - sweep_of(t)) > 3 / fmin(r0, r1))
		say(t, "the wrong way round");
}

static void check_walk(const struct tiny *t, const struct made *m)
{
	struct points p = walk_all(m, 1e-4);
	uint64_t s = 5;

	for (int a = 0; a < 2; a++)
		if (fabs(p.at[p.n - 1].pos[a] - t->centre[a] - t->to[a]) > 0.51)
			say(t, "not at its end");
	if (!wander(m, &p, &s, 8))
		say(t, "another way back");
	for (uint32_t i = 1; i + 1 < m->p.head->nsegs; i++)
		if (!(m->p.segs[i].feed_max_mm_s > 0.01) ||
		    !(m->p.segs[i].length_mm > 0))
			say(t, "no speed");
	if (m->p.head->nsegs > 2 && m->p.segs[2].kind == INTERP_ARC)
		check_circle(t, &p);
	points_free(&p);
}

static struct interp_build *begin_at(const struct tiny *t)
{
	const struct interp_build_options o = {
		.machine = &help_machine, .strategy = t->how,
		.tolerance_milli = (uint32_t)(TOLERANCE * 1000),
	};
	struct interp_build *b = interp_build_create(&o);
	double at[INTERP_NAXES] = { 0 };

	for (int a = 0; a < 2; a++)
		at[a] = (t->centre[a] + t->from[a]) * 1e-3;
	line(b, at);
	return b;
}

/* Return: was it taken? */
static bool try_one(const struct tiny *t)
{
	struct interp_build_arc word = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = t->centre[0] * 1e-3,
		.centre_b_mm = t->centre[1] * 1e-3,
	};
	struct interp_build *b = begin_at(t);
	struct interp_diag d = { 0 };
	double end[INTERP_NAXES];
	struct made m;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] = (t->centre[0] + t->to[0]) * 1e-3;
	end[INTERP_Y] = (t->centre[1] + t->to[1]) * 1e-3;
	end[INTERP_Z] = t->z_mm;
	arc_turn(&word, b, end, t->clockwise);
	if (interp_build_arc(b, end, &word, &help_word, &d) != 0) {
		assert_true(d.found[0] && d.wanted[0]);
		interp_build_destroy(b);
		return false;
	}
	m = finish(b);
	check_walk(t, &m);
	unmake(&m);
	return true;
}

static void try_ends(struct tiny t, int *taken, int *all)
{
	for (t.to[0] = -END; t.to[0] <= END; t.to[0]++) {
		for (t.to[1] = -END; t.to[1] <= END; t.to[1]++) {
			const bool good = try_one(&t);
			const double r0 = hypot(t.from[0], t.from[1]);
			const double r1 = hypot(t.to[0], t.to[1]);

			/* What fits a circle is never refused. */
			if (r0 > 0 && fabs(r0 - r1) < 0.5 && !good)
				say(&t, "refused");
			*taken += good;
			*all += 1;
		}
	}
}

static void by_every_strategy(double z_mm)
{
	int taken = 0, all = 0;

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	for (int how = 0; how < INTERP_NSTRATEGIES; how++) {
		struct tiny t = { .how = (enum interp_strategy)how,
				  .z_mm = z_mm };

		for (t.from[0] = -START; t.from[0] <= START; t.from[0]++) {
			for (t.from[1] = -START; t.from[1] <= START;
			     t.from[1]++) {
				t.clockwise = false;
				try_ends(t, &taken, &all);
				t.clockwise = true;
				try_ends(t, &taken, &all);
			}
		}
	}
	print_message("    %d of %d taken\n", taken, all);
}

static void every_tiny_arc_is_walked_or_refused(void **st)
{
	(void)st;
	by_every_strategy(0);
}

static void every_tiny_helix_too(void **st)
{
	(void)st;
	by_every_strategy(0.003);
}

/* Ends and centre anywhere between the points of the lattice. */
static void off_the_lattice_too(void **st)
{
	uint64_t s = seed;
	int taken = 0;

	(void)st;
	for (int i = 0; i < RANDOM; i++) {
		const double r = uniform(&s, 0.3, 6), a = uniform(&s, 0, 6.3);
		const double by = rnd(&s) % 4 ? uniform(&s, 0, 6.3) :
				  rnd(&s) % 4 ? uniform(&s, -1, 1) / r : 0;
		const double b = a + by;
		const double to = r + (rnd(&s) % 2 ? uniform(&s, 0.1, 2) : 0);
		struct tiny t = {
			.from = { r * cos(a), r * sin(a) },
			.to = { to * cos(b), to * sin(b) },
			.centre = { uniform(&s, -3, 3), uniform(&s, -3, 3) },
			.clockwise = rnd(&s) % 2,
			.z_mm = rnd(&s) % 3 ? 0 : uniform(&s, -5e-3, 5e-3),
			.how = (enum interp_strategy)(rnd(&s) %
						      INTERP_NSTRATEGIES),
		};

		taken += try_one(&t);
	}
	print_message("    %d of %d taken\n", taken, RANDOM);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_tiny_arc_is_walked_or_refused),
		cmocka_unit_test(every_tiny_helix_too),
		cmocka_unit_test(off_the_lattice_too),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
