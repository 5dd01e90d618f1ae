/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_limits.c - promises of the greatest speeds of a program, and of moves
 * that keep to them in both directions
 *
 * The programs are random; the seed is printed.
 */
#include "cycle_help.h"

#include "interp/limits.h"
#include "seed.h"

#define ROUNDS	SEED_ROUNDS(60)
#define SEGS	60

static uint64_t seed;

/* The machine of walk_help.h. */
#define V_MAX	80.0
#define A_MAX	1000.0
#define J_MAX	20000.0

static const double corner = INTERP_CORNER_MM;

static float node_of_turn(double degrees)
{
	const double phi = degrees * M_PI / 180;
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES] = { 100 };
	struct made m;
	float v;

	line(b, end);
	end[0] += 50 * cos(phi);
	end[1] += 50 * sin(phi);
	line(b, end);
	m = finish(b);
	v = m.p.segs[1].node_mm_s;
	unmake(&m);
	return v;
}

static void a_node_is_passed_as_the_arc_that_cuts_its_corner(void **st)
{
	static const double turns[] = { 1, 5, 20, 45, 60, 90, 110 };

	(void)st;
	for (int i = 0; i < 7; i++) {
		const double phi = turns[i] * M_PI / 180;
		const double half = cos(phi / 2);
		const double r = corner * half / (1 - half);
		/* What the weaker of X and Y leaves in this direction. */
		const double most = fmin(sqrt(A_MAX * sqrt(2) * r),
					 cbrt(J_MAX * sqrt(2) * r * r));
		const double least = fmin(sqrt(A_MAX * r), cbrt(J_MAX * r * r));
		/* From one speed of Y or X to the other with its jerk. */
		const double smooth = cbrt(36 * corner * corner * J_MAX) /
				      fmax(sin(phi), 1 - cos(phi));
		const double v = (double)node_of_turn(turns[i]);

		assert_true(v <= fmin(most, smooth) * (1 + 1e-6));
		assert_true(v >= fmin(least, smooth) * (1 - 1.0 / 31));
	}
}

/* Each node of the tiny lines turns by less than a rounding could; together
 * they are no longer than a rounding shows on. */
static float least_over_tiny(double degrees, int n, double mm, bool arcs)
{
	const double phi = degrees * M_PI / 180;
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES] = { 5, 5 };
	float least = INFINITY;
	struct made m;

	if (arcs)
		arc(b, end, 0, 5, false);
	else
		line(b, end);
	for (int i = 0; i < n; i++) {
		end[i % 2] += i < 2 ? mm : -mm;
		line(b, end);
	}
	/* From the tangent of the arc, which goes along Y, or of the line. */
	end[0] += 5 * cos(phi + M_PI / (arcs ? 2 : 4));
	end[1] += 5 * sin(phi + M_PI / (arcs ? 2 : 4));
	line(b, end);
	m = finish(b);
	for (int i = 1; i <= n + 1; i++)
		least = fminf(least, m.p.segs[i].node_mm_s);
	unmake(&m);
	return least;
}

static void tiny_lines_hide_no_corner(void **st)
{
	static const double turns[] = { 20, 60, 90, 150, 180 };
	static const double mm[] = { 0.0002, 0.001, 0.002, 0.003, 0.005 };

	(void)st;
	for (int i = 0; i < 5 * 5 * 3 * 2; i++) {
		const double turn = turns[i % 5], tiny = mm[i / 5 % 5];
		const int n = 1 + i / 25 % 3;
		const double v = (double)least_over_tiny(turn, n, tiny,
							 i >= 75);

		/* Oblique to X and Y they leave sqrt(2) more. */
		if (v > 1.43 * (double)node_of_turn(turn))
			fail_msg("%g degrees over %d lines of %g mm%s: %g mm/s",
				 turn, n, tiny, i < 75 ? "" : " behind an arc",
				 v);
	}
}

static void nodes_on_a_line_have_no_ceiling_and_turning_back_has_one(void **st)
{
	const double back = (double)node_of_turn(180);

	(void)st;
	assert_true(isinf(node_of_turn(0)));
	assert_true(back > 0 && back < 1.5);
}

static void an_arc_is_limited_by_what_its_axes_can_do(void **st)
{
	static const double radii[] = { 0.01, 0.1, 1, 5, 20, 60 };

	(void)st;
	for (int i = 0; i < 6; i++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		const double r = radii[i];
		const double end[INTERP_NAXES] = { r, r };
		/* Up to a half of them is kept to go along it. */
		const double most = fmin(V_MAX, fmin(sqrt(A_MAX * r),
						     cbrt(J_MAX * r * r)));
		struct made m;
		double v;

		arc(b, end, 0, r, false);
		m = finish(b);
		v = (double)m.p.segs[1].feed_max_mm_s;
		assert_true(v <= most && v >= 0.45 * most);
		unmake(&m);
	}
}

/* An acceleration that the jerk lets no move come to does not slow an arc. */
static void an_arc_is_as_fast_where_only_jerk_binds(void **st)
{
	static const double radii[] = { 0.01, 0.1, 1 };

	(void)st;
	for (int i = 0; i < 3; i++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		const double r = radii[i];
		const double end[INTERP_NAXES] = { r, r };
		struct made m;

		for (int k = 0; k < INTERP_NAXES; k++)
			help_machine.axis[k].a_max_mm_s2 = 20 * A_MAX;
		arc(b, end, 0, r, false);
		m = finish(b);
		assert_true((double)m.p.segs[1].feed_max_mm_s >
			    0.6 * cbrt(0.3 * J_MAX * r * r));
		unmake(&m);
	}
}

/* All axes at once, or one after another with twice the points. */
static void no_segment_is_faster_than_its_points_are_made(void **st)
{
	static const enum interp_strategy how[] = {
		INTERP_SIMULTANEOUS, INTERP_POINT_BY_POINT,
	};

	(void)st;
	for (int i = 0; i < 2; i++) {
		const double end[INTERP_NAXES] = { 10, 10 };
		const double most = 40000 * 0.001 * sqrt(2) / (i + 1);
		struct interp_build_options o = {
			.machine = &help_machine, .strategy = how[i],
			.points_per_s = 40000,
		};
		struct interp_build *b;
		struct made m;
		double v;

		interp_build_destroy(begin(how[i]));
		b = interp_build_create(&o);
		line(b, end);
		m = finish(b);
		v = (double)m.p.segs[1].feed_max_mm_s;
		assert_true(v <= most && v >= most * (1 - 1.0 / 31));
		unmake(&m);
	}
}

/* The slowest node of a circle of short lines, some way from its ends. */
static double slowest_of_circle(double r, double chord_mm)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const int n = (int)(5 * r / chord_mm);
	double least = INFINITY;
	struct made m;

	for (int i = 1; i <= n; i++) {
		const double at = i * chord_mm / r;
		const double end[INTERP_NAXES] = {
			round(1e4 * r * sin(at)) * 1e-4,
			round(1e4 * r * (1 - cos(at))) * 1e-4,
		};

		line(b, end);
	}
	m = finish(b);
	for (int i = n / 4; i < 3 * n / 4; i++)
		least = fmin(least, (double)m.p.segs[i].node_mm_s);
	unmake(&m);
	return least;
}

/* However short its lines are, if they are as near to it as a corner. */
static void a_polyline_is_slowed_as_the_curve_it_follows(void **st)
{
	static const double radii[] = { 0.3, 1, 3 };

	(void)st;
	for (int i = 0; i < 3; i++) {
		const double r = radii[i];
		const double most = fmin(sqrt(A_MAX * r), cbrt(J_MAX * r * r));

		for (double mm = 0.002; mm * mm < 8 * corner * r; mm *= 3) {
			const double v = slowest_of_circle(r, mm);

			assert_true(v <= 1.1 * most);
			assert_true(v >= 0.5 * most);
		}
	}
}

/* -- Random programs, to the end and back --------------------------------- */

static void random_line(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = rnd(s) % 3 ? 60 : uniform(s, 1, 80),
		.rapid = rnd(s) % 6 == 0,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;
	static double way = 0;
	const double mm = pow(10, uniform(s, -2.5, 1));

	way += uniform(s, -1, 1) * (rnd(s) % 8 ? 0.2 : 3.1);
	memcpy(end, interp_build_here(b), sizeof(end));
	if (hypot(end[INTERP_X], end[INTERP_Y]) > 100)
		way = atan2(-end[INTERP_Y], -end[INTERP_X]);
	end[INTERP_X] += mm * cos(way);
	end[INTERP_Y] += mm * sin(way);
	if (rnd(s) % 5 == 0)
		end[INTERP_A] += uniform(s, -2, 2) * mm;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void random_arc(struct interp_build *b, uint64_t *s)
{
	const double *here = interp_build_here(b);
	const double r = pow(10, uniform(s, -1, 1));
	const double turn = uniform(s, 0, 6.28);
	const double ca = here[0] + r * cos(turn), cb = here[1] + r * sin(turn);
	const double to = turn + 3.14159 + uniform(s, 0.1, 3);
	const double end[INTERP_NAXES] = {
		[0] = ca + r * cos(to), [1] = cb + r * sin(to),
		[INTERP_A] = here[INTERP_A],
	};

	if (hypot(here[0], here[1]) < 100)
		arc(b, end, ca, cb, rnd(s) % 2);
}

static void load_random(struct rig *r, uint64_t *s, int segs)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();

	k.dry_run = true;
	k.gap.retract_mm_s = 70;
	for (int i = 0; i < segs; i++) {
		if (rnd(s) % 10 == 0)
			random_arc(b, s);
		else
			random_line(b, s);
		if (rnd(s) % 9 == 0)
			action(b, INTERP_AUX, INTERP_AUX_PUMP_ON);
	}
	rig_load(r, b, &k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static void assert_below(double v, double most)
{
	assert_true(v <= most * (1 + 1e-9));
}

/* Every node between two places of the path, and where it is. */
static void check_ceilings(const struct rig *r, uint32_t from, double v)
{
	const struct interp_seg *s = r->m.p.segs;
	const uint32_t to = r->c.cursor.index;
	const uint32_t low = from < to ? from : to,
		       high = from < to ? to : from;

	for (uint32_t i = low; i < high; i++)
		assert_below(v, (double)s[i].node_mm_s);
	if (s[from].kind < INTERP_BEGIN && from == to)
		assert_below(v, (double)s[from].feed_max_mm_s);
}

static void step_within(struct rig *r)
{
	const struct cycle_config *k = &r->c.config;
	const double v = r->c.mover.v_mm_s, a = r->c.mover.a_mm_s2;
	const double at = place(r);
	const uint32_t index = r->c.cursor.index;
	double now;

	step(r, OPEN_V);
	now = r->c.mover.v_mm_s;
	assert_true(fabs(now - v) <= k->travel_a_mm_s2 * PERIOD_S * (1 + 1e-9));
	/* A stop less than 1e-9 mm ahead is met, a little early. */
	assert_true(fabs(r->c.mover.a_mm_s2 - a) <=
		    k->travel_j_mm_s3 * PERIOD_S * (1 + 1e-9) +
		    (now != 0 ? 0 : cbrt(6e-9 * k->travel_j_mm_s3 *
					 k->travel_j_mm_s3)));
	assert_true(fabs(r->c.mover.a_mm_s2) <= k->travel_a_mm_s2 * (1 + 1e-9));
	/* It is where the speed leads, give or take what lies at a stop. */
	assert_near(place(r) - at, (v + now) / 2 * PERIOD_S,
		    k->travel_j_mm_s3 * PERIOD_S * PERIOD_S * PERIOD_S / 6 +
		    3e-9);
	check_ceilings(r, index, fmin(fabs(v), fabs(now)));
}

static void no_ceiling_is_passed_there_and_back(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct rig r;

		load_random(&r, &s, SEGS);
		r.c.config.hold_at_end = true;
		for (int n = 0; n < 400000 && r.c.state == STATE_TRAVEL; n++)
			step_within(&r);
		assert_int_equal(r.c.state, STATE_HOLD);
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
		for (int n = 0; n < 400000 && r.c.hold.moving; n++)
			step_within(&r);
		assert_true(place(&r) == 0);
		tell(&r, CYCLE_START);
		for (int n = 0; n < 400000 && r.c.state == STATE_TRAVEL; n++)
			step_within(&r);
		assert_near(place(&r), r.m.p.head->length_mm, 1e-6);
		rig_free(&r);
	}
}

/* Jumps of random heights on a random path: the same ceilings. */
static void a_jump_keeps_to_every_ceiling(void **st)
{
	uint64_t s = seed + 1;
	int jumps = 0;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		double v = 0, a = 0;
		bool stood = false;
		struct rig r;

		load_random(&r, &s, SEGS / 4);
		r.c.config.dry_run = false;
		r.c.gap.retract_mm_s = 5;
		r.c.gap.approach_mm_s = 20;
		r.c.gap.feed_max_mm_s = 20;
		r.c.gap.gain_mm_s_v = 1;
		r.c.jump.height_mm = pow(10, uniform(&s, -1, 1));
		r.c.jump.v_max_mm_s = 70;
		for (int n = 0; n < 20000 && state_duty[r.c.state].running;
		     n++) {
			const uint32_t index = r.c.cursor.index;
			const bool in = r.c.state == STATE_JUMP;

			step(&r, SPARKING_V);
			/* From the cut it first comes to a stand. */
			stood = r.c.state == STATE_JUMP &&
				(stood || r.c.mover.v_mm_s <= 0);
			if (in && stood) {
				assert_true(fabs(r.c.mover.a_mm_s2 - a) <=
					    J_MAX * PERIOD_S * (1 + 1e-9) + 20);
				check_ceilings(&r, index,
					       fmin(fabs(v),
						    fabs(r.c.mover.v_mm_s)));
			}
			jumps += r.c.state == STATE_JUMP && !in;
			v = r.c.mover.v_mm_s;
			a = r.c.mover.a_mm_s2;
		}
		assert_int_equal(r.c.fault.first, FAULT_NONE);
		rig_free(&r);
	}
	assert_true(jumps > ROUNDS);
}

/* Ten lines up, ten down: it stands at each node between. */
static void a_jump_stands_at_every_node_if_it_is_told_to(void **st)
{
	(void)st;
	for (int stop = 0; stop < 2; stop++) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct cycle_config k = usual_config();
		struct rig r;
		int stands = 0;

		k.stop_at_nodes = stop;
		k.jump.height_mm = 1;
		k.jump.short_of_mm = 0;
		k.jump.every.cycles = 3000;
		for (int i = 1; i <= 40; i++)
			cut_to(b, -0.1 * i);
		rig_load(&r, b, &k);
		tell(&r, CYCLE_START);
		until(&r, STATE_JUMP, SPARKING_V, 5000);
		for (int n = 0; n < 5000 && r.c.state == STATE_JUMP; n++) {
			const double v = r.c.mover.v_mm_s;

			step(&r, SPARKING_V);
			stands += v != 0 && r.c.mover.v_mm_s == 0 &&
				  r.c.state == STATE_JUMP;
		}
		assert_int_equal(r.c.state, STATE_APPROACH);
		assert_in_range(stands, stop ? 19 : 1, stop ? 23 : 3);
		rig_free(&r);
	}
}

static void an_override_changes_speed_without_a_step(void **st)
{
	uint64_t s = seed + 2;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct rig r;

		load_random(&r, &s, SEGS);
		for (int n = 0; n < 400000 && r.c.state == STATE_TRAVEL; n++) {
			if (rnd(&s) % 50 == 0)
				tell_mm(&r, CYCLE_OVERRIDE,
					rnd(&s) % 9 ? uniform(&s, 0.2, 2) : 0);
			if (n > 100000)
				tell_mm(&r, CYCLE_OVERRIDE, 1);
			step_within(&r);
		}
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		rig_free(&r);
	}
}

static double cruise_at(double override)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;
	double v;

	k.dry_run = true;
	cut_to(b, -100);
	rig_load(&r, b, &k);
	assert_int_equal(tell_mm(&r, CYCLE_OVERRIDE, override), ANSWER_DONE);
	tell(&r, CYCLE_START);
	steps(&r, OPEN_V, 1000);
	v = r.c.mover.v_mm_s;
	rig_free(&r);
	return v;
}

static void an_override_is_a_factor_from_0_to_2(void **st)
{
	const struct cycle_config k = usual_config();
	struct cycle c;

	(void)st;
	for (int i = 0; i <= 8; i++)
		assert_near(cruise_at(i / 4.0), 10 * i / 4.0, 1e-9);
	cycle_init(&c, &k);
	for (int i = 0; i < 3; i++) {
		static const double bad[] = { -0.01, 2.01, NAN };
		const struct cycle_command m = { .verb = CYCLE_OVERRIDE,
						 .arg_mm = bad[i] };

		assert_int_equal(cycle_command(&c, &m), ANSWER_BAD_ARGUMENT);
		assert_true(c.override == 1);
	}
}

/* -- A hold at every cycle ------------------------------------------------ */

static void
a_hold_at_every_cycle_of_a_thousand_lines_stops_where_it_says(void **st)
{
	uint64_t s = seed + 3;
	struct rig r;

	(void)st;
	load_random(&r, &s, 1000);
	/* A thousand lines at a slow F take above a million cycles. */
	for (int n = 0; n < 4000000 && r.c.state == STATE_TRAVEL; n++) {
		struct rig fork = r;
		struct interp_scurve_limits l;
		double way;

		/* What its axes allow, if it began to move. */
		tell(&fork, CYCLE_HOLD);
		step_within(&fork);
		l = (struct interp_scurve_limits) {
			1, fork.c.mover.l.a_max_mm_s2,
			fork.c.mover.l.a_max_mm_s2,
			fork.c.mover.l.j_max_mm_s3,
		};
		way = l.a_up_mm_s2 > 0 ?
		      interp_scurve_way_mm(&l, r.c.mover.v_mm_s,
					   r.c.mover.a_mm_s2, 0) : 0;
		for (int k = 0; k < 2000 && fork.c.mover.v_mm_s != 0; k++)
			step_within(&fork);
		assert_int_equal(fork.c.state, STATE_HOLD);
		assert_near(place(&fork) - place(&r), way, 1e-6);
		step_within(&r);
	}
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

/* -- A million segments --------------------------------------------------- */

#define MILLION	SEED_ROUNDS(1000000)
#define PITCH	0.00019

/* Cycles to walk back to the start, or on to the end. */
static uint64_t walk_whole(struct rig *r, double to)
{
	uint64_t n = 0, stops = 0;

	do {
		step(r, OPEN_V);
		stops += r->c.mover.v_mm_s == 0;
		n++;
	} while (fabs(place(r) - to) > 1e-6 && n < 200000);
	assert_near(place(r), to, 1e-6);
	assert_true(stops <= 2);
	return n;
}

static uint64_t there_and_back(int pieces, uint64_t *ret_back)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = usual_config();
	struct rig r;
	uint64_t n;

	k.dry_run = true;
	k.hold_at_end = true;
	k.gap.retract_mm_s = 60;
	for (int i = 1; i <= pieces; i++)
		rapid_to(b, -MILLION * PITCH * (double)i / pieces);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	n = walk_whole(&r, r.m.p.head->length_mm);
	step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_HOLD);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 1e9), ANSWER_DONE);
	*ret_back = walk_whole(&r, 0);
	assert_int_equal(r.out.target[INTERP_Z], 0);
	assert_int_equal(r.c.totals.pulses[INTERP_Z],
			 2 * lround(MILLION * PITCH / PULSE_MM));
	rig_free(&r);
	return n;
}

static void a_million_nodes_on_a_line_cost_no_time_and_no_pulse(void **st)
{
	uint64_t one_back, back;
	const uint64_t one = there_and_back(1, &one_back);
	const uint64_t many = there_and_back(MILLION, &back);

	(void)st;
	assert_in_range(many, one - 2, one + 2);
	assert_in_range(back, one_back - 2, one_back + 2);
}

/* -- Chains that lie ------------------------------------------------------ */

static void spoil(struct interp_seg *g, uint64_t *s)
{
	static const uint16_t bad[] = { 0, 1, 2, 17, 1000, 65535 };
	const uint16_t v = bad[rnd(s) % 6];

	switch (rnd(s) % 4) {
	case 0:
		g->slower_ahead = v;
		break;
	case 1:
		g->slower_behind = v;
		break;
	case 2:
		g->slower_feed = v;
		break;
	default:
		g->node_mm_s = rnd(s) % 2 ? 1e-3f : INFINITY;
		break;
	}
}

static void a_chain_that_lies_is_slow_or_a_fault_and_never_a_step(void **st)
{
	uint64_t s = seed + 4;

	(void)st;
	for (int i = 0; i < 3 * ROUNDS; i++) {
		struct interp_seg *segs;
		struct rig r;
		bool back = false;

		load_random(&r, &s, SEGS);
		r.c.config.hold_at_end = true;
		segs = (void *)((char *)r.m.block + r.m.p.head->segs_at);
		for (int n = 0; n < 20; n++)
			spoil(&segs[rnd(&s) % r.m.p.head->nsegs], &s);
		for (int n = 0; n < 100000 && r.c.state != STATE_FAULT; n++) {
			const double v = r.c.mover.v_mm_s;

			step(&r, OPEN_V);
			if (r.c.state != STATE_FAULT)
				assert_true(fabs(r.c.mover.v_mm_s - v) <=
					    A_MAX * PERIOD_S * (1 + 1e-9));
			if (r.c.state == STATE_HOLD && !r.c.hold.moving) {
				if (back)
					break;
				back = true;
				tell_mm(&r, CYCLE_RETRACT, 1e9);
			}
		}
		assert_true(r.c.fault.first == FAULT_NONE ||
			    r.c.fault.first == FAULT_PROGRAM);
		rig_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_node_is_passed_as_the_arc_that_cuts_its_corner),
		cmocka_unit_test(tiny_lines_hide_no_corner),
		cmocka_unit_test(nodes_on_a_line_have_no_ceiling_and_turning_back_has_one),
		cmocka_unit_test(an_arc_is_limited_by_what_its_axes_can_do),
		cmocka_unit_test(an_arc_is_as_fast_where_only_jerk_binds),
		cmocka_unit_test(no_segment_is_faster_than_its_points_are_made),
		cmocka_unit_test(a_polyline_is_slowed_as_the_curve_it_follows),
		cmocka_unit_test(no_ceiling_is_passed_there_and_back),
		cmocka_unit_test(a_jump_keeps_to_every_ceiling),
		cmocka_unit_test(a_jump_stands_at_every_node_if_it_is_told_to),
		cmocka_unit_test(an_override_changes_speed_without_a_step),
		cmocka_unit_test(an_override_is_a_factor_from_0_to_2),
		cmocka_unit_test(a_hold_at_every_cycle_of_a_thousand_lines_stops_where_it_says),
		cmocka_unit_test(a_million_nodes_on_a_line_cost_no_time_and_no_pulse),
		cmocka_unit_test(a_chain_that_lies_is_slow_or_a_fault_and_never_a_step),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
