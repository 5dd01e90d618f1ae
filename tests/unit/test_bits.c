/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_bits.c - min-switch has nearly the fewest changes of axis, with any mu
 *
 * Random lines of 2 to 8 axes, with mu along an axis or square to the line, are
 * walked there, back and about.  For each strategy it is also tested how far it
 * stays from the programmed line if the ends lie between pulses.
 */
#include "walk_help.h"

#include "pulse/couple.h"
#include "pulse/greedy.h"
#include "seed.h"

#define LINES	SEED_ROUNDS(3000)

static uint64_t seed;

struct job {
	struct interp_build_options o;
	double from[INTERP_NAXES], to[INTERP_NAXES];
	uint32_t axes;
};

static void say(const struct job *j, const char *what)
{
	fail_msg("%s: %s, mu %g%s, coupling %s, to %g %g %g from %g %g", what,
		 interp_strategy_name(j->o.strategy),
		 j->o.tolerance_milli / 1000.0,
		 j->o.perpendicular ? " square" : "",
		 interp_coupling_name(j->o.coupling), j->to[0], j->to[1],
		 j->to[2], j->from[0], j->from[1]);
}

static struct interp_build *job_begin(const struct job *j)
{
	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	return interp_build_create(&j->o);
}

static struct made job_make(const struct job *j)
{
	struct interp_build *b = job_begin(j);

	line(b, j->from);
	line(b, j->to);
	return finish(b);
}

static struct job random_job(enum interp_strategy s, uint32_t axes)
{
	static const uint32_t mus[] = { 1000, 1500, 2000, 5000 };
	const double most = rnd(&seed) % 4 ? 0.3 : 3;
	struct job j = { .axes = axes, .o = {
		.machine = &help_machine, .strategy = s,
		.tolerance_milli = rnd(&seed) % 2 ? mus[rnd(&seed) % 4] :
				   1000 + (uint32_t)(rnd(&seed) % 5000),
		.perpendicular = rnd(&seed) % 2,
	} };

	for (uint32_t i = 0; i < axes; i++)
		j.to[i] = round(uniform(&seed, -most, most) * 1000) / 1000;
	return j;
}

/* The axis that leads to point @i. */
static int moved(const struct points *p, size_t i)
{
	int axis = 0;

	while (p->at[i].pos[axis] == p->at[i - 1].pos[axis])
		axis++;
	return axis;
}

static size_t changes_of(const struct points *p)
{
	size_t n = 0;

	for (size_t i = 2; i < p->n; i++)
		n += moved(p, i) != moved(p, i - 1);
	return n;
}

/* Of a line in X and Y from 0. */
static struct greedy_line line_of(const struct job *j)
{
	const int64_t x = llabs(llround(j->to[0] * 1000));
	const int64_t y = llabs(llround(j->to[1] * 1000));
	const struct pair_tube t = { j->o.tolerance_milli,
				     j->o.perpendicular };

	return (struct greedy_line) {
		.a = x > y ? x : y, .b = x > y ? y : x,
		.half_width = pair_half_width(x > y ? x : y, x > y ? y : x, t),
	};
}

static void check_tube(const struct job *j, const struct points *p)
{
	const struct greedy_line l = line_of(j);
	const int64_t x = llround(j->to[0] * 1000),
		      y = llround(j->to[1] * 1000);

	for (size_t i = 0; i < p->n; i++) {
		const int64_t e = y * p->at[i].pos[0] - x * p->at[i].pos[1];

		if (llabs(e) > l.half_width)
			say(j, "a point leaves the tube");
	}
}

static void two_axes_have_few_changes_at_any_mu(void **state)
{
	double sum = 0, fewest = 0;
	int kept = 0;

	(void)state;
	seed = seed_take();
	for (int i = 0; i < LINES; i++) {
		const struct job j = random_job(INTERP_MIN_SWITCH, 2);
		struct greedy_line l = line_of(&j);
		struct greedy_runs r = { .run = NULL };
		struct points p;
		struct made m;

		if (l.b == 0)
			continue;
		greedy_plan(&l, &r);
		m = job_make(&j);
		p = walk_all(&m, 1e9);
		check_tube(&j, &p);
		if (100 * changes_of(&p) > 103 * (r.n - 1))
			say(&j, "more than 3 % over the fewest changes");
		if (!wander(&m, &p, &seed, 30))
			say(&j, "the way back is another one");
		sum += (double)changes_of(&p);
		fewest += (double)(r.n - 1);
		kept += m.p.segs[1].arg != 0;
		points_free(&p);
		unmake(&m);
	}
	print_message("    %.4f of the fewest; %d of %d lines planned\n",
		      sum / fewest, kept, LINES);
	assert_true(kept > LINES / 4);
}

/* Without its bits, so by bursts. */
static size_t burst_changes(const struct job *j)
{
	struct made m = job_make(j);
	struct points p;
	size_t n;

	((struct interp_seg *)(uintptr_t)m.p.segs)[1].arg = 0;
	p = walk_all(&m, 1e9);
	n = changes_of(&p);
	points_free(&p);
	unmake(&m);
	return n;
}

static void check_damage(struct made *m)
{
	for (int i = 0; i < 4; i++) {
		damage(m, &seed);
		walk_damaged(m);
	}
}

static void more_axes_go_back_as_they_came(void **state)
{
	double sum = 0, bursts = 0;
	int kept = 0;

	(void)state;
	seed = seed_take();
	for (int i = 0; i < LINES / 4; i++) {
		struct job j = random_job(INTERP_MIN_SWITCH,
					  3 + (uint32_t)(rnd(&seed) % 6));
		struct points p;
		struct made m;

		j.o.coupling = (enum interp_coupling)(rnd(&seed) %
						      INTERP_NCOUPLINGS);
		j.o.tolerance_milli += 2000;
		m = job_make(&j);
		p = walk_all(&m, 1e9);
		if (!wander(&m, &p, &seed, 30))
			say(&j, "the way back is another one");
		if (m.p.segs[1].arg != 0) {
			kept++;
			sum += (double)changes_of(&p);
			bursts += (double)burst_changes(&j);
		}
		points_free(&p);
		check_damage(&m);
		unmake(&m);
	}
	print_message("    %d lines planned: %.3f of the changes that bursts "
		      "make\n", kept, sum / bursts);
	assert_true(kept > LINES / 40);
}

/* -- Against the line that was programmed --------------------------------- */

/* What docs/interpolation.md promises, square to it, in pulses. */
static double promised(const struct job *j)
{
	const double x = fabs(j->to[0] - j->from[0]);
	const double y = fabs(j->to[1] - j->from[1]);
	const double c = fmax(x, y) / hypot(x, y), s = fmin(x, y) / hypot(x, y);
	const double mu = j->o.tolerance_milli / 1000.0;

	switch (j->o.strategy) {
	case INTERP_SIMULTANEOUS:
		return (c + s) / 2;
	case INTERP_POINT_BY_POINT:
		return c + (c + s) / 2;
	case INTERP_CENTRED:
		return c + s;
	default:
		return mu * (j->o.perpendicular ? 1 : c) + (c + s) / 2;
	}
}

static double strayed(const struct job *j, const struct points *p)
{
	const double dx = j->to[0] - j->from[0], dy = j->to[1] - j->from[1];
	double most = 0;

	for (size_t i = 0; i < p->n; i++) {
		const double x = p->at[i].pos[0] - j->from[0] * 1000;
		const double y = p->at[i].pos[1] - j->from[1] * 1000;

		most = fmax(most, fabs(x * dy - y * dx) / hypot(dx, dy));
	}
	return most;
}

/* A line between pulses: lattice points of its second segment alone. */
static double off_lattice(enum interp_strategy s, double *ret_share)
{
	struct job j = random_job(s, 2);
	struct points p = { 0 };
	struct interp_cursor c;
	struct made m;
	double most;

	j.o.tolerance_milli += 500;
	for (int i = 0; i < 2; i++) {
		j.from[i] = uniform(&seed, -0.001, 0.001);
		j.to[i] += uniform(&seed, -0.0005, 0.0005);
	}
	m = job_make(&j);
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	assert_int_equal(interp_cursor_seek(&c, m.p.head->nsegs - 2, 0), 0);
	points_add(&p, &c);
	run(&c, 1e9, &p);
	most = strayed(&j, &p);
	*ret_share = most / promised(&j);
	/* A subpulse more: nodes are whole ones. */
	if (most > promised(&j) + 1e-4)
		say(&j, "farther from the programmed line than promised");
	points_free(&p);
	unmake(&m);
	return most;
}

static void the_promise_holds_between_pulses(void **state)
{
	(void)state;
	seed = seed_take();
	for (int s = 0; s < INTERP_NSTRATEGIES; s++) {
		double share = 0, most = 0, one;

		for (int i = 0; i < LINES; i++) {
			most = fmax(most, off_lattice((enum interp_strategy)s,
						      &one));
			share = fmax(share, one);
		}
		print_message("    %-15s strays %.3f pulses, %.3f of what is "
			      "promised\n",
			      interp_strategy_name((enum interp_strategy)s),
			      most, share);
		assert_true(share > 0.8);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(two_axes_have_few_changes_at_any_mu),
		cmocka_unit_test(more_axes_go_back_as_they_came),
		cmocka_unit_test(the_promise_holds_between_pulses),
	};

	return cmocka_run_group_tests_name("interp/bits", tests, NULL, NULL);
}
