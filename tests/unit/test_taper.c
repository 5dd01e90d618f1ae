/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_taper.c - promises of two contours walked together
 */
#include "walk_help.h"
#include "seed.h"

#include "interp/angle.h"

#define PULSE	0.001

/* Two contours on the lattice, places from their own centres, pulses. */
struct pair {
	int from[2][2], to[2][2];
	int centre[2][2];
	bool arc[2], clockwise[2];
};

static const int axis_of[2][2] = {
	{ INTERP_X, INTERP_Y }, { INTERP_U, INTERP_V },
};

static void place(const struct pair *p, const int at[2][2],
		  double ret[INTERP_NAXES])
{
	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	for (int i = 0; i < 2; i++) {
		for (int j = 0; j < 2; j++)
			ret[axis_of[i][j]] = (p->centre[i][j] + at[i][j]) *
					     PULSE;
	}
}

static double sweep_of(const struct pair *p, int i)
{
	return interp_build_sweep(
		(double[]) { p->from[i][0] * PULSE, p->from[i][1] * PULSE },
		(double[]) { p->to[i][0] * PULSE, p->to[i][1] * PULSE },
		(double[]) { 0, 0 }, p->clockwise[i]);
}

static struct made make_pair(enum interp_strategy s, const struct pair *p)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };
	struct interp_build *b = begin(s);
	struct interp_build_contour c[2];
	struct interp_diag d = { 0 };
	double at[INTERP_NAXES];

	for (int i = 0; i < 2; i++)
		c[i] = (struct interp_build_contour) {
			.arc = p->arc[i], .sweep = sweep_of(p, i),
			.centre_mm = { p->centre[i][0] * PULSE,
				       p->centre[i][1] * PULSE },
		};
	place(p, p->from, at);
	line(b, at);
	place(p, p->to, at);
	if (interp_build_pair(b, at, c, &w, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
	return finish(b);
}

/* What a walk of the pair's segment showed at worst. */
struct shown {
	double lag;			/* by angle, radian */
	double apart;			/* by share of length */
	double radial[2];		/* off either circle, pulses */
	int pulses[2];
	uint32_t kind;
};

static double wrap(double a)
{
	return a - 2 * M_PI * floor(a / (2 * M_PI) + 0.5);
}

static double share(const struct pair *p, int i, double x, double y,
		    double turned)
{
	const double dx = p->to[i][0] - p->from[i][0];
	const double dy = p->to[i][1] - p->from[i][1];
	double whole;

	if (!p->arc[i])
		return ((x - p->from[i][0]) * dx + (y - p->from[i][1]) * dy) /
		       (dx * dx + dy * dy);
	whole = atan2(p->to[i][1], p->to[i][0]) -
		atan2(p->from[i][1], p->from[i][0]);
	if (p->clockwise[i])
		whole = -whole;
	while (whole <= 1e-12)
		whole += 2 * M_PI;
	return turned / whole;
}

struct watch {
	const struct pair *p;
	double angle[2], turned[2];	/* turned: in the way round */
};

static void watch_side(struct watch *w, int i, const int32_t *pos,
		       double ret[2])
{
	const double x = pos[axis_of[i][0]] - w->p->centre[i][0];
	const double y = pos[axis_of[i][1]] - w->p->centre[i][1];
	const double angle = atan2(y, x);
	const double by = wrap(angle - w->angle[i]);

	w->turned[i] += w->p->clockwise[i] ? -by : by;
	w->angle[i] = angle;
	ret[0] = x;
	ret[1] = y;
}

static void watch_point(struct watch *w, const int32_t *pos, double phase,
			struct shown *s)
{
	double at[2][2], done[2];

	for (int i = 0; i < 2; i++) {
		const double r = hypot(w->p->from[i][0], w->p->from[i][1]);

		watch_side(w, i, pos, at[i]);
		done[i] = share(w->p, i, at[i][0], at[i][1], w->turned[i]);
		if (w->p->arc[i])
			s->radial[i] = fmax(s->radial[i],
				fabs(hypot(at[i][0], at[i][1]) - r));
	}
	s->apart = fmax(s->apart, fabs(done[0] - done[1]));
	s->lag = fmax(s->lag, fabs(wrap(w->angle[1] - w->angle[0] - phase)));
}

static void check_end(const struct pair *p, const int (*at)[2],
		      const int32_t *pos)
{
	for (int i = 0; i < 2; i++) {
		for (int j = 0; j < 2; j++)
			assert_int_equal(pos[axis_of[i][j]],
					 p->centre[i][j] + at[i][j]);
	}
}

/* To the end, back and to the end again; the same points each time. */
static void there_and_back(const struct made *m, const struct points *out)
{
	struct interp_cursor c;
	size_t n = out->n;

	assert_int_equal(interp_cursor_init(&c, &m->p), 0);
	run(&c, 0.37, NULL);
	interp_cursor_aim(&c, -1e9);
	for (;;) {
		n--;
		assert_memory_equal(c.pos, out->at[n].pos, sizeof(c.pos));
		if (interp_cursor_step(&c) != INTERP_MOVED)
			break;
	}
	assert_int_equal(n, 0);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED)
		assert_memory_equal(c.pos, out->at[++n].pos, sizeof(c.pos));
	assert_int_equal(n, out->n - 1);
}

static struct shown show(enum interp_strategy strategy, const struct pair *p,
			 double phase)
{
	struct made m = make_pair(strategy, p);
	struct points out = walk_all(&m, 1e9);
	struct shown s = { .kind = m.p.segs[m.p.head->nsegs - 2].kind };
	struct watch w = { .p = p };
	size_t k = 0;

	while (out.at[k].kind != s.kind)
		k++;
	for (int i = 0; i < 2; i++)
		w.angle[i] = atan2(p->from[i][1], p->from[i][0]);
	check_end(p, p->from, out.at[k - 1].pos);
	for (; k < out.n; k++) {
		const int32_t *a = out.at[k].pos, *b = out.at[k - 1].pos;
		int moved = 0;

		for (int j = 0; j < INTERP_NAXES; j++) {
			const int d = abs(a[j] - b[j]);

			assert_true(d <= 1);
			moved += d;
			s.pulses[j >= INTERP_U] += d;
		}
		if (strategy == INTERP_POINT_BY_POINT)
			assert_int_equal(moved, 1);
		watch_point(&w, a, phase, &s);
	}
	check_end(p, p->to, out.at[out.n - 1].pos);
	there_and_back(&m, &out);
	points_free(&out);
	unmake(&m);
	return s;
}

/* -- Cones: concentric arcs ----------------------------------------------- */

static struct pair cone(double r1, double r2, double from, double sweep,
			double phase)
{
	const double r[2] = { r1, r2 };
	struct pair p = { .centre = { { 0, 0 }, { 7, -3 } },
			  .arc = { true, true },
			  .clockwise = { sweep < 0, sweep < 0 } };

	for (int i = 0; i < 2; i++) {
		const double a = from + (i ? phase : 0), b = a + sweep;

		p.from[i][0] = (int)lround(r[i] * cos(a));
		p.from[i][1] = (int)lround(r[i] * sin(a));
		p.to[i][0] = (int)lround(r[i] * cos(b));
		p.to[i][1] = (int)lround(r[i] * sin(b));
	}
	return p;
}

static double check_cone(double r1, double r2, double from, double sweep,
			 double phase)
{
	const struct pair p = cone(r1, r2, from, sweep, phase);
	const struct shown s = show(INTERP_POINT_BY_POINT, &p, phase);
	const double lag = s.lag * fmin(r1, r2);

	assert_int_equal(s.kind, INTERP_PAIR);
	if (lag > 1.7)
		fail_msg("R %.2f %.2f from %.4f by %.4f phase %.2f: lag %.3f",
			 r1, r2, from, sweep, phase, lag);
	/* A pulse off the circle, and what the rounded end is off it. */
	for (int i = 0; i < 2; i++)
		assert_true(s.radial[i] <= 1.0 + 1e-9 +
			    fabs(hypot(p.to[i][0], p.to[i][1]) -
				 hypot(p.from[i][0], p.from[i][1])));
	return lag;
}

static const double radii[][2] = {
	{ 100, 10 }, { 100, 50 }, { 100, 100 }, { 100, 101 }, { 50, 100 },
	{ 10, 100 }, { 1000, 300 }, { 300, 1000 }, { 777, 5000 },
};

static void full_circles_follow_within_a_pulse_of_the_smaller(void **st)
{
	double worst = 0;

	(void)st;
	for (size_t i = 0; i < sizeof(radii) / sizeof(radii[0]); i++) {
		for (int k = 0; k < 4; k++) {
			const double a = k * M_PI / 2;

			worst = fmax(worst, check_cone(radii[i][0], radii[i][1],
						       a, 2 * M_PI, 0));
			worst = fmax(worst, check_cone(radii[i][0], radii[i][1],
						       a, -2 * M_PI, 0));
		}
	}
	print_message("    worst lag %.3f pulses of the smaller circle\n",
		      worst);
}

/* SR1 ... SR4 run clockwise, NR1 ... NR4 counter-clockwise. */
static void every_start_quadrant_and_both_ways_round(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(radii) / sizeof(radii[0]); i++) {
		for (int k = 0; k < 16; k++) {
			const double a = k * M_PI / 8 + 0.01;
			const double by[] = { 0.4, 1.3, 2.9, 4.4, 6.1 };

			for (int j = 0; j < 10; j++)
				check_cone(radii[i][0], radii[i][1], a,
					   j % 2 ? -by[j / 2] : by[j / 2],
					   k % 3 == 2 ? M_PI : 0);
		}
	}
}

static void ratios_to_a_thousand_to_one(void **st)
{
	static const double r[][2] = {
		{ 10000, 10 }, { 10, 10000 }, { 20000, 20 }, { 33, 33000 },
	};

	(void)st;
	for (int i = 0; i < 4; i++) {
		check_cone(r[i][0], r[i][1], M_PI / 2, -2 * M_PI, 0);
		check_cone(r[i][0], r[i][1], 0.3, 4.1, M_PI);
	}
}

static void random_cones_follow_end_exactly_and_retrace(void **st)
{
	uint64_t seed = 20260101, s = seed;
	double worst = 0;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < SEED_ROUNDS(10000); i++) {
		const double r1 = exp(uniform(&s, log(8), log(300)));
		const double r2 = exp(uniform(&s, log(8), log(300)));
		const double small = fmin(r1, r2);
		const double sweep = uniform(&s, fmin(8 / small, 1), 6.2);

		worst = fmax(worst, check_cone(r1, r2, uniform(&s, -3, 3),
					       rnd(&s) % 2 ? sweep : -sweep,
					       rnd(&s) % 4 ? 0 : M_PI));
	}
	print_message("    worst lag %.3f pulses of the smaller circle\n",
		      worst);
}

/* -- Different contours, by share of length ------------------------------- */

static struct pair different(const double a[3], const double b[3])
{
	const double *k[2] = { a, b };
	struct pair p = { .centre = { { 5, 9 }, { -4, 2 } } };

	/* { radius, from, sweep } in pulses and degrees, or { 0, dx, dy }. */
	for (int i = 0; i < 2; i++) {
		const double r = k[i][0];
		const double t0 = k[i][1] * M_PI / 180;
		const double t1 = t0 + k[i][2] * M_PI / 180;

		p.arc[i] = r > 0;
		p.clockwise[i] = r > 0 && k[i][2] < 0;
		p.from[i][0] = r > 0 ? (int)lround(r * cos(t0)) : 0;
		p.from[i][1] = r > 0 ? (int)lround(r * sin(t0)) : 0;
		p.to[i][0] = (int)lround(r > 0 ? r * cos(t1) : k[i][1]);
		p.to[i][1] = (int)lround(r > 0 ? r * sin(t1) : k[i][2]);
	}
	return p;
}

static double length_of(const double k[3])
{
	return k[0] > 0 ? k[0] * fabs(k[2]) * M_PI / 180 : hypot(k[1], k[2]);
}

static void different_contours_keep_equal_shares_of_length(void **st)
{
	/* The last column: the most the two may be apart, in pulses of the
	 * shorter contour. */
	static const struct {
		double a[3], b[3], pulses;
	} pairs[] = {
		{ { 0, 3000, 1000 }, { 0, 500, -2000 }, 1.5 },
		{ { 2000, 0, 90 }, { 0, 2000, 1000 }, 1.5 },
		{ { 2000, -45, 90 }, { 0, 0, 2000 }, 1.6 },
		{ { 3000, 30, 70 }, { 5000, 200, 30 }, 1.5 },
		{ { 2000, 0, 40 }, { 2000, 50, 40 }, 1.5 },
		{ { 2000, 0, -40 }, { 0, 1500, 100 }, 1.5 },
		{ { 20000, 0, 350 }, { 0, 4000, 3000 }, 1.5 },
		{ { 0, 1500, 100 }, { 1200, 80, -200 }, 1.5 },
		{ { 700, 10, 100 }, { 700, 10, -100 }, 1.6 },
	};

	(void)st;
	for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
		const struct pair p = different(pairs[i].a, pairs[i].b);
		const struct shown s = show(INTERP_POINT_BY_POINT, &p, 0);
		const double len = fmin(length_of(pairs[i].a),
					length_of(pairs[i].b));

		assert_int_equal(s.kind, INTERP_PAIR);
		print_message("    pair %zu: %.2f pulses apart\n", i,
			      s.apart * len);
		assert_true(s.apart * len <= pairs[i].pulses);
	}
}

static void random_different_contours_end_exactly_and_retrace(void **st)
{
	uint64_t seed = 7, s = seed;

	(void)st;
	print_message("    seed %llu\n", (unsigned long long)seed);
	for (int i = 0; i < SEED_ROUNDS(2000); i++) {
		double k[2][3];

		for (int j = 0; j < 2; j++) {
			k[j][0] = rnd(&s) % 2 ? uniform(&s, 8, 300) : 0;
			k[j][1] = round(uniform(&s, -300, 300));
			k[j][2] = round(uniform(&s, 5, 330)) *
				  (rnd(&s) % 2 ? 1 : -1);
		}
		const struct pair p = different(k[0], k[1]);

		show(INTERP_POINT_BY_POINT, &p, 0);
		/* Two lines at once are one line of four axes. */
		if (p.arc[0] || p.arc[1])
			show(INTERP_SIMULTANEOUS, &p, 0);
	}
}

/* In a step of one of @steps equal parts of the path, no axis goes farther than
 * its contour is long there, but for some pulses. Return: the most of them. */
static double most_more(enum interp_strategy strategy, const double k[2][3],
			int steps)
{
	const struct pair p = different(k[0], k[1]);
	struct made m = make_pair(strategy, &p);
	const uint32_t first = m.p.head->nsegs - 2;
	const double ds_mm = m.p.segs[first].length_mm / steps;
	struct interp_cursor c;
	double most = 0;

	assert_int_equal(m.p.segs[first].kind, INTERP_PAIR);
	for (int leg = 1; leg >= -1; leg -= 2) {
		const int from = leg > 0 ? 0 : steps;

		assert_int_equal(interp_cursor_init(&c, &m.p), 0);
		interp_cursor_aim(&c, m.p.segs[first].s_mm + from * ds_mm);
		while (interp_cursor_step(&c) == INTERP_MOVED)
			;
		for (int n = 0; n < steps; n++) {
			int32_t was[INTERP_NAXES];

			memcpy(was, c.pos, sizeof(was));
			interp_cursor_aim(&c, leg * ds_mm);
			while (interp_cursor_step(&c) == INTERP_MOVED)
				;
			for (int i = 0; i < 4; i++) {
				const int axis = axis_of[i / 2][i % 2];

				most = fmax(most, abs(c.pos[axis] - was[axis]) -
					    length_of(k[i / 2]) / steps);
			}
		}
	}
	unmake(&m);
	return most;
}

static void each_axis_of_a_pair_goes_evenly(void **st)
{
	static const enum interp_strategy one_at_a_time[] = {
		INTERP_POINT_BY_POINT, INTERP_CENTRED,
	};
	static const double pairs[][2][3] = {
		{ { 0, 40, 30 }, { 0, 9000, 2000 } },
		{ { 0, 9000, 2000 }, { 0, 40, 30 } },
		{ { 50, 0, 90 }, { 20000, 0, 90 } },
		{ { 20000, 0, 90 }, { 50, 0, 90 } },
		{ { 30, 20, 200 }, { 0, 5000, 9000 } },
		{ { 0, 5000, 9000 }, { 30, 20, 200 } },
		{ { 700, 10, 100 }, { 700, 10, -100 } },
	};

	(void)st;
	for (size_t i = 0; i < 2 * sizeof(pairs) / sizeof(pairs[0]); i++) {
		for (int steps = 50; steps <= 5000; steps *= 100) {
			const double more = most_more(one_at_a_time[i % 2],
						      pairs[i / 2], steps);

			if (more > 3)
				fail_msg("strategy %zu, pair %zu, %d steps: "
					 "%g pulses more", i % 2, i / 2, steps,
					 more);
		}
	}
}

/* A cone's point: one contour stands, the other goes round. */
static void a_contour_may_stand_while_the_other_moves(void **st)
{
	struct pair p = cone(50, 80, 0.2, 1.9, 0);

	(void)st;
	p.arc[0] = false;
	memcpy(p.to[0], p.from[0], sizeof(p.to[0]));
	assert_int_equal(show(INTERP_POINT_BY_POINT, &p, 0).pulses[0], 0);
	assert_int_equal(show(INTERP_SIMULTANEOUS, &p, 0).kind, INTERP_ARC);
}

/* -- All at once ---------------------------------------------------------- */

static void at_once_every_axis_is_within_half_a_pulse(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(radii) / sizeof(radii[0]); i++) {
		for (int k = 0; k < 8; k++) {
			const double r1 = radii[i][0], r2 = radii[i][1];
			const struct pair p = cone(r1, r2, k, 5.0 - k * 1.1, 0);
			const struct shown s = show(INTERP_SIMULTANEOUS, &p, 0);

			/* Half a pulse on each of two axes, and as much
			 * again for a start that is rounded itself. */
			assert_int_equal(s.kind, INTERP_PAIR);
			assert_true(s.lag * fmin(r1, r2) <= 2 * 1.4143 + 0.01);
			assert_true(s.radial[0] <= 2 * 0.7072);
			assert_true(s.radial[1] <= 2 * 0.7072);
		}
	}
}

/* -- Place, and distrust -------------------------------------------------- */

static void the_place_follows_the_length_on_x_y(void **st)
{
	const struct pair p = cone(500, 200, 0.3, 4.0, 0);
	struct made m = make_pair(INTERP_POINT_BY_POINT, &p);
	const uint32_t last = m.p.head->nsegs - 2;
	struct interp_cursor c;

	(void)st;
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	assert_int_equal(interp_cursor_seek(&c, last, 0), 0);
	for (int i = 1; i <= 20; i++) {
		const double want = 4.0 * i / 20;
		double turned;

		interp_cursor_aim(&c, m.p.segs[last].length_mm / 20);
		while (interp_cursor_step(&c) == INTERP_MOVED)
			;
		turned = atan2(c.pos[INTERP_Y], c.pos[INTERP_X]) - 0.3;
		assert_true(fabs(wrap(turned - want)) < 2.5 / 500);
	}
	unmake(&m);
}

static void damaged_pairs_never_make_an_axis_jump(void **st)
{
	(void)st;
	for (uint64_t seed = 1; seed <= 3000; seed++) {
		uint64_t s = seed;
		const struct pair p = cone(40, 25, uniform(&s, -3, 3),
					   uniform(&s, 1, 6), 0);
		struct made m = make_pair(seed % 2, &p);

		damage(&m, &s);
		walk_damaged(&m);
		unmake(&m);
	}
}

static void a_wrong_bit_is_met_as_a_bad_segment(void **st)
{
	const struct pair p = cone(40, 25, 0.1, 2.0, 0);
	struct made m = make_pair(INTERP_POINT_BY_POINT, &p);
	struct interp_cursor c;
	enum interp_step s;

	(void)st;
	((uint64_t *)(uintptr_t)m.p.bits)[0] |= 0xffff;
	((uint64_t *)(uintptr_t)m.p.bits)[1] = ~UINT64_C(0);
	assert_int_equal(interp_cursor_init(&c, &m.p), 0);
	interp_cursor_aim(&c, 1e9);
	while ((s = interp_cursor_step(&c)) == INTERP_MOVED)
		;
	assert_int_equal(s, INTERP_BAD_SEGMENT);
	unmake(&m);
}

/* Both circles are smaller than a pulse: there is nothing to walk. */
static void circles_of_less_than_a_pulse_are_no_segment(void **st)
{
	const double r_mm[] = { 0.2 * PULSE, 0.45 * PULSE, 0.73 * PULSE };
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 1 };

	(void)st;
	for (int how = 0; how < INTERP_NSTRATEGIES; how++) {
		for (int i = 0; i < 9; i++) {
			struct interp_build *b = begin((enum interp_strategy)
						       how);
			const struct interp_build_contour c[2] = {
				{ .arc = true, .sweep = ANGLE_TURN,
				  .centre_mm = { r_mm[i % 3], 0 } },
				{ .arc = true, .sweep = ANGLE_TURN,
				  .centre_mm = { r_mm[i / 3], 0 } },
			};
			const double at[INTERP_NAXES] = { 0 };
			struct interp_diag d = { 0 };
			struct points p;
			struct made m;

			assert_int_equal(interp_build_pair(b, at, c, &w, &d),
					 0);
			line(b, (double[INTERP_NAXES]) { 1 });
			m = finish(b);
			p = walk_all(&m, 1e-4);
			points_free(&p);
			unmake(&m);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			circles_of_less_than_a_pulse_are_no_segment),
		cmocka_unit_test(full_circles_follow_within_a_pulse_of_the_smaller),
		cmocka_unit_test(every_start_quadrant_and_both_ways_round),
		cmocka_unit_test(ratios_to_a_thousand_to_one),
		cmocka_unit_test(random_cones_follow_end_exactly_and_retrace),
		cmocka_unit_test(different_contours_keep_equal_shares_of_length),
		cmocka_unit_test(random_different_contours_end_exactly_and_retrace),
		cmocka_unit_test(each_axis_of_a_pair_goes_evenly),
		cmocka_unit_test(a_contour_may_stand_while_the_other_moves),
		cmocka_unit_test(at_once_every_axis_is_within_half_a_pulse),
		cmocka_unit_test(the_place_follows_the_length_on_x_y),
		cmocka_unit_test(damaged_pairs_never_make_an_axis_jump),
		cmocka_unit_test(a_wrong_bit_is_met_as_a_bad_segment),
	};

	return cmocka_run_group_tests_name("interp/taper", tests, NULL, NULL);
}
