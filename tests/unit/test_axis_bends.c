/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_bends.c - on smooth ways of many short lines every axis keeps its
 * acceleration and its jerk
 *
 * By differences over windows of several cycles, of where the axes are; the
 * seed is printed.  Lines are off a smooth way: what is commanded may be so by
 * corner_um, which counts 4 times in a second difference and 8 times in a third
 * one.  Where lines are about as short as a rounding of the path, as in a cusp
 * of the tip of a body, an axis beside it is off by its share of that rounding,
 * too, but by no more than 20 of its own.
 */
#include "axis_track.h"

#include "interp/compile.h"

#include <stdarg.h>

#define ROUNDS	SEED_ROUNDS(30)
#define CYCLES	60000
#define RING	128

/* Of the limits. */
#define MOST_A		1.05
#define MOST_J		1.0
/* Of lines that are cut from a way of the tip. */
#define MOST_A_TIP	1.0
/* Of the speed of waves no longer than two windows. */
#define MOST_QUICK	1.15

/* A corner and a rounding. */
#define OFF_MM		(INTERP_CORNER_MM + 0.001)

/* Shorter lines do not tell the share of an axis beside them. */
#define TINY_MM		(4 * PULSE_MM)

/* In parts of the limits. */
struct most {
	double a, j;
};

static uint64_t seed;
static struct most allowed, seen;

static const int windows[] = { 8, 16, 32 };

struct ring {
	double at[RING][INTERP_NAXES];
	double off[RING][INTERP_NAXES];
	int n;
	struct track places;
};

struct text {
	char at[2048];
	size_t n;
};

__attribute__((format(printf, 2, 3)))
static void put(struct text *t, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	t->n += (size_t)vsnprintf(t->at + t->n, sizeof(t->at) - t->n, format,
				  ap);
	va_end(ap);
	assert_true(t->n < sizeof(t->at));
}

static struct interp_build *build_begin(void)
{
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};

	return interp_build_create(&o);
}

/* Two waves of its direction at a time, rad and rad/mm. */
struct waves {
	double high[2], wave[2], first, deg_mm;
};

/* In lines of @mm. */
static struct made wavy(const struct waves *k, double mm)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 80, .rapid = true,
	};
	struct interp_build *b = build_begin();
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;

	for (double at = 0; at < 20; at += mm) {
		const double way = k->first +
				   k->high[0] * sin(k->wave[0] * at) +
				   k->high[1] * sin(k->wave[1] * at);

		end[INTERP_X] += mm * cos(way);
		end[INTERP_Y] += mm * sin(way);
		end[INTERP_B] += mm * k->deg_mm;
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	}
	return finish(b);
}

/* A way that bends to and fro; now and then B goes along evenly. */
static struct made sway(uint64_t *s)
{
	const double mm = pow(10, uniform(s, -2, -0.7));
	const struct waves k = {
		.high = { uniform(s, 0.3, 1.4), uniform(s, 0, 1) },
		.wave = { uniform(s, 0.2, 1.5), uniform(s, 0.2, 2.5) },
		.first = uniform(s, 0, 6.28),
		.deg_mm = rnd(s) % 3 ? 0 : uniform(s, -1, 1),
	};

	return wavy(&k, mm);
}

/* Lines and arcs with a corner between, in lines of @mm, rounded to
 * @round_mm. */
static struct made cornered(uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 80, .rapid = true,
	};
	const double mm = pow(10, uniform(s, -2, -1));
	const double round_mm = rnd(s) % 2 ? 0.001 : 1e-6;
	double at[2] = { 0, 0 }, way = uniform(s, 0, 6.28);
	struct interp_build *b = build_begin();

	for (int i = 0; i < 8; i++) {
		const double r = i % 2 ? pow(10, uniform(s, -0.3, 1)) : 1e9;
		const double long_mm = i % 2 ? fmin(r * uniform(s, 0.3, 3), 9) :
					       uniform(s, 1, 9);
		const int n = (int)ceil(long_mm / mm);
		const double turn = (rnd(s) % 2 ? 1 : -1) * long_mm / r / n;

		way += turn / 2;
		for (int k = 0; k < n; k++, way += turn) {
			double end[INTERP_NAXES] = { 0 };
			struct interp_diag d;

			for (int j = 0; j < 2; j++) {
				at[j] += long_mm / n *
					 (j ? sin(way) : cos(way));
				end[j] = round(at[j] / round_mm) * round_mm;
			}
			assert_int_equal(interp_build_line(b, end, &w, &d), 0);
		}
		way += uniform(s, -2.8, 2.8);
	}
	return finish(b);
}

static struct made of_text(const struct text *t)
{
	struct interp_kinematics k;
	const struct interp_compile_options o = { .nc = {
		.machine = &axes_machine, .feed_mm_s = 80, .kinematics = &k,
		.tip_tolerance_mm = 0.001,
	} };
	const struct interp_text text = {
		t->at, t->n, interp_dialect_by_name("generic"),
	};
	struct interp_build *b = build_begin();
	struct interp_diag d;
	uint32_t lines;

	interp_kin_clear(&k);
	k.tip_mm[2] = -75;
	assert_int_equal(interp_kin_parse(&k, "C(0 0 -120) A(0 15 -80) X Y Z",
					  &d), 0);
	if (interp_compile(&text, &o, b, &lines, &d) != 0)
		fail_msg("%s; %s\n%s", d.found, d.wanted, t->at);
	return finish(b);
}

/* An arc of the tip, the tool leaning. */
static struct made tip_arc(uint64_t *s)
{
	const double r = pow(10, uniform(s, 0, 1.3)), at = uniform(s, 0, 6.28);
	const double x = uniform(s, -10, 10), y = uniform(s, -10, 10);
	const double sweep = uniform(s, 0.5, 6);
	const bool back = rnd(s) % 2;
	const double to = back ? at - sweep : at + sweep;
	struct text t = { .n = 0 };

	put(&t, "G90 G43.5 F4800\nG0 X%.5f Y%.5f Z-62 I%.5f J%.5f K1\n",
	    x + r * cos(at), y + r * sin(at), uniform(s, 0.1, 0.5),
	    uniform(s, 0.1, 0.5));
	put(&t, "G%d X%.5f Y%.5f I%.5f J%.5f\nM2\n", back ? 2 : 3,
	    x + r * cos(to), y + r * sin(to), -r * cos(at), -r * sin(at));
	return of_text(&t);
}

static struct made body(uint64_t *s)
{
	static const double knots[] = { 0, 0, 0, 0, .35, .7, 1, 1, 1, 1 };
	double at[] = { 30, 0, -60 }, turn[] = { 0, 0, 0 };
	struct text t = { .n = 0 };

	put(&t, "G90 G43.4 F4800\nG0 X30 Y0 Z-60\nG6.3 ");
	for (int i = 0; i < 6; i++) {
		put(&t, "P%g R%.3f X%.4f Y%.4f Z%.4f Q1 I%.5f J%.5f K%.5f\n",
		    knots[i], uniform(s, 0.8, 1.2), at[0], at[1], at[2],
		    turn[0], turn[1], turn[2]);
		for (int k = 0; k < 3; k++) {
			at[k] += uniform(s, -1, 1) * (k < 2 ? 12 : 4);
			turn[k] += uniform(s, -0.2, 0.2);
		}
	}
	for (int i = 6; i < 10; i++)
		put(&t, "P%g\n", knots[i]);
	put(&t, "M2\n");
	return of_text(&t);
}

static double place_of(const struct ring *k, int back, int axis)
{
	return k->at[(k->n - 1 - back) % RING][axis];
}

/* The most of so many cycles. */
static double off_of(const struct ring *k, int cycles, int axis)
{
	double most = 0;

	for (int back = 0; back <= cycles; back++)
		most = fmax(most, k->off[(k->n - 1 - back) % RING][axis]);
	return INTERP_CORNER_MM + PULSE_MM + most;
}

static void check_window(const struct ring *k, int window, int axis,
			 uint32_t index)
{
	const struct interp_axis_limits *l = &axes_machine.axis[axis];
	const double t = PERIOD_S * window, off = off_of(k, 3 * window, axis);
	const double p[4] = {
		place_of(k, 0, axis), place_of(k, window, axis),
		place_of(k, 2 * window, axis), place_of(k, 3 * window, axis),
	};
	const double a = (fabs(p[0] - 2 * p[1] + p[2]) - 4 * off) / (t * t);
	const double j = (fabs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) - 8 * off) /
			 (t * t * t);

	seen.a = fmax(seen.a, a / l->a_max_mm_s2);
	seen.j = fmax(seen.j, j / l->j_max_mm_s3);
	if (seen.a > allowed.a || seen.j > allowed.j)
		fail_msg("axis %c near segment %u, over %d cycles: %g of %g "
			 "mm/s2, %g of %g mm/s3", INTERP_AXIS_LETTERS[axis],
			 (unsigned)index, window, a, l->a_max_mm_s2, j,
			 l->j_max_mm_s3);
}

/* By which an axis is off, where the path is about as short as a rounding. */
static double tiny_off(const struct rig *r, int axis)
{
	const struct interp_seg *s = &r->c.cursor.seg;

	return s->kind == INTERP_LINE && s->length_mm < TINY_MM ?
	       PULSE_MM * fmin(rate_of(r, axis), 20) : 0;
}

static void watch(struct rig *r, struct ring *k)
{
	step(r, OPEN_V);
	places_of(&k->places, r, k->at[k->n % RING]);
	for (int j = 0; j < INTERP_NAXES; j++)
		k->off[k->n % RING][j] = tiny_off(r, j);
	k->n++;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < INTERP_NAXES; j++)
			if (k->n > 3 * windows[i])
				check_window(k, windows[i], j,
					     r->c.cursor.index);
}

static void there_and_back(struct made m)
{
	const struct cycle_config k = dry(4000, 2e5);
	struct ring ring = { .n = 0 };
	struct rig r;

	rig_take(&r, m, &k);
	track_there(&r, &ring, watch, CYCLES);
	ring.n = 0;
	track_back(&r, &ring, watch, CYCLES);
	rig_free(&r);
}

static void try(struct made (*random)(uint64_t *s), struct most most)
{
	uint64_t s = seed;

	allowed = most;
	seen = (struct most) { 0, 0 };
	for (int i = 0; i < ROUNDS; i++) {
		set_machine(&s);
		there_and_back(random(&s));
	}
	print_message("most: %.2f of the acceleration, %.2f of the jerk\n",
		      seen.a, seen.j);
}

static void ways_that_bend_to_and_fro_keep_the_limits(void **st)
{
	(void)st;
	try(sway, (struct most) { MOST_A, MOST_J });
}

static void so_do_lines_and_arcs_with_corners(void **st)
{
	(void)st;
	try(cornered, (struct most) { MOST_A, MOST_J });
}

/* Over all waves between these places; what the ends are slower by is not of
 * them. */
static double mean_mm_s(struct made m, double from_mm, double to_mm)
{
	const struct cycle_config k = dry(4000, 2e5);
	double cycles = 0;
	struct rig r;

	rig_take(&r, m, &k);
	tell(&r, CYCLE_START);
	for (int n = 0; n < CYCLES && r.c.state == STATE_TRAVEL; n++) {
		step(&r, OPEN_V);
		cycles += place(&r) >= from_mm && place(&r) < to_mm;
	}
	rig_free(&r);
	return (to_mm - from_mm) / (cycles * PERIOD_S);
}

/*
 * Y goes to and fro by @high / @wave.  What does so within half a wave, T,
 * takes a jerk of 24 / T^3 of that at least, whatever its form is; it may be
 * off by a corner and a rounding.
 */
static double most_mm_s(const struct waves *k)
{
	const double y_mm = k->high[0] / k->wave[0] - OFF_MM;
	const double jerk = axes_machine.axis[INTERP_Y].j_max_mm_s3;

	if (y_mm < OFF_MM / 2)
		return INFINITY;
	return M_PI / k->wave[0] * cbrt(jerk / (24 * y_mm));
}

static void try_waves(const struct waves *k, double mm)
{
	const double waves_mm = 4 * 2 * M_PI / k->wave[0];
	const double v = mean_mm_s(wavy(k, mm), 5, 5 + waves_mm) /
			 most_mm_s(k);

	seen.a = fmax(seen.a, v);
	if (v > MOST_QUICK)
		fail_msg("%g rad, %g rad/mm, lines of %g mm: %g",
			 k->high[0], k->wave[0], mm, v);
}

static void so_do_ways_that_bend_quickly(void **st)
{
	static const struct waves known[] = {
		{ .high = { 0.032 }, .wave = { 3.14 } },
		{ .high = { 0.062 }, .wave = { 4.83 } },
		{ .high = { 0.127 }, .wave = { 7.85 } },
		{ .high = { 0.16 }, .wave = { 6.28 } },
	};
	uint64_t s = seed;

	(void)st;
	seen.a = 0;
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i] = (struct interp_axis_limits) {
			PULSE_MM, -1000, 1000, 80, 1000, 20000
		};
	axes_machine.present = 0xff;
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		for (double mm = 0.02; mm < 0.1; mm += 0.015)
			try_waves(&known[i], mm);
	for (int i = 0; i < ROUNDS; i++) {
		const double mm = pow(10, uniform(&s, -2, -1.1));
		const struct waves k = {
			.high = { uniform(&s, 0.02, 0.4) },
			.wave = { uniform(&s, 2.5, 6.3) },
		};

		set_machine(&s);
		try_waves(&k, mm);
	}
	print_message("most: %.2f of the speed\n", seen.a);
}

static void arcs_of_a_leaning_tool_keep_the_limits(void **st)
{
	(void)st;
	try(tip_arc, (struct most) { MOST_A_TIP, MOST_J });
}

static void bodies_keep_the_limits(void **st)
{
	(void)st;
	try(body, (struct most) { MOST_A_TIP, MOST_J });
}

/* C at a peak of its rate, and A and C on bends, where the lines are long or
 * a rounding may be as much: what these need to speed up was not left. */
static void so_do_bodies_whose_bends_no_window_shows(void **st)
{
	static const uint64_t known[] = {
		0xc18e8d966e13bf63, 0x3970e0d2b5a7d197, 0x2935874b44cff5d9,
		0x1cb870695ad3e8f2,
	};

	(void)st;
	allowed = (struct most) { MOST_A_TIP, MOST_J };
	seen = (struct most) { 0, 0 };
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		uint64_t s = known[i];

		set_machine(&s);
		there_and_back(body(&s));
	}
	print_message("most: %.2f of the acceleration, %.2f of the jerk\n",
		      seen.a, seen.j);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ways_that_bend_to_and_fro_keep_the_limits),
		cmocka_unit_test(so_do_lines_and_arcs_with_corners),
		cmocka_unit_test(so_do_ways_that_bend_quickly),
		cmocka_unit_test(arcs_of_a_leaning_tool_keep_the_limits),
		cmocka_unit_test(bodies_keep_the_limits),
		cmocka_unit_test(so_do_bodies_whose_bends_no_window_shows),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
