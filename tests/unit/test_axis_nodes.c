/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_nodes.c - what an axis does at nodes, it could do smoothly within
 * corner_um
 *
 * By differences over windows of several cycles along random paths; the seed is
 * printed.
 *
 * At a node the speed of an axis may make a step: so large that a motion within
 * the axis's limits stays within corner_um of it.  That is sqrt(8 a corner) by
 * the acceleration and cbrt(36 j corner^2) by the jerk, for each node in the
 * window.  On a curve of many lines it need not be: there what is commanded is
 * such a motion, and off it by corner_um at most, which counts 4 times in a
 * second difference and 8 times in a third one.
 */
#include "axis_track.h"

#define ROUNDS	SEED_ROUNDS(60)
#define CYCLES	20000
#define RING	64

/* Of the limit: where an axis brakes into a node at which it turns, it may take
 * a little more. */
#define MOST	1.2

static uint64_t seed;

static const int windows[] = { 4, 8, 16 };

struct ring {
	double at[RING][INTERP_NAXES];
	uint32_t nodes[RING];		/* passed so far */
	uint32_t index, passed;
	int n;
	struct track places;
};

/* From lines as short as a rounding to long ones, to and fro. */
static void random_turns(struct interp_build *b, uint64_t *s)
{
	static const uint8_t axes[] = { INTERP_X, INTERP_Y, INTERP_C };
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	for (int i = 0; i < 3; i++) {
		const double mm = pow(10, uniform(s, -2.5, 0.5));

		if (rnd(s) % 3 > 0)
			end[axes[i]] += rnd(s) % 2 ? mm : -mm;
	}
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* Lines of a wave: several nodes turn the same way. */
static void random_wave(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
	};
	const double step = pow(10, uniform(s, -0.7, 0.3));
	const double high = uniform(s, 0.01, 0.2), at = uniform(s, 0.3, 1);
	double end[INTERP_NAXES], y;
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	y = end[INTERP_Y];
	for (int i = 1; i < 15; i++) {
		end[INTERP_X] += step;
		end[INTERP_Y] = y + high * sin(at * i);
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	}
}

/* Onto an arc that touches the line before it. */
static void random_slot(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
	};
	const double r = pow(10, uniform(s, -0.5, 1.2));
	const double way = uniform(s, 0, 6.28), sweep = uniform(s, 0.3, 3);
	const double *here = interp_build_here(b);
	struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
	};
	const double side = rnd(s) % 2 ? -1 : 1;
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, here, sizeof(end));
	end[0] += 5 * cos(way);
	end[1] += 5 * sin(way);
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	a.centre_a_mm = end[0] - side * r * sin(way);
	a.centre_b_mm = end[1] + side * r * cos(way);
	end[0] = a.centre_a_mm + side * r * sin(way + side * sweep);
	end[1] = a.centre_b_mm - side * r * cos(way + side * sweep);
	a.sweep = side * sweep;
	assert_int_equal(interp_build_arc(b, end, &a, &w, &d), 0);
}

static struct made random_nodes(uint64_t *s)
{
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	struct interp_build *b = interp_build_create(&o);

	for (int i = 0; i < SEGS; i++) {
		if (rnd(s) % 6 == 0)
			random_arc(b, s);
		else if (rnd(s) % 6 == 0)
			random_wave(b, s);
		else if (rnd(s) % 6 == 0)
			random_slot(b, s);
		else if (rnd(s) % 6 == 0)
			random_nurbs(b, s, 2);
		else
			random_turns(b, s);
	}
	return finish(b);
}

static void note_place(struct ring *k, const struct rig *r)
{
	const uint32_t i = r->c.cursor.index;

	if (k->n > 0)
		k->passed += i > k->index ? i - k->index : k->index - i;
	k->index = i;
	places_of(&k->places, r, k->at[k->n % RING]);
	k->nodes[k->n % RING] = k->passed;
	k->n++;
}

static double place_of(const struct ring *k, int back, int axis)
{
	return k->at[(k->n - 1 - back) % RING][axis];
}

static uint32_t nodes_in(const struct ring *k, int back)
{
	return k->passed - k->nodes[(k->n - 1 - back) % RING];
}

/* What the offset is in a difference of order @k; or what the steps are. */
static double allowed(const struct ring *ring, int window, int k,
		      const struct interp_axis_limits *l)
{
	const uint32_t n = nodes_in(ring, k * window);
	const double t = PERIOD_S * window, corner = INTERP_CORNER_MM;
	const double step = fmin(sqrt(8 * l->a_max_mm_s2 * corner),
				 cbrt(36 * l->j_max_mm_s3 * corner * corner));

	return fmax(pow(2, k) * (corner + PULSE_MM) / pow(t, k),
		    n * step / pow(t, k - 1));
}

static void check_window(const struct ring *k, int window, int axis)
{
	const struct interp_axis_limits *l = &axes_machine.axis[axis];
	const double t = PERIOD_S * window;
	const double p[4] = {
		place_of(k, 0, axis), place_of(k, window, axis),
		place_of(k, 2 * window, axis), place_of(k, 3 * window, axis),
	};
	const double a = fabs(p[0] - 2 * p[1] + p[2]) / (t * t);
	const double j = fabs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) / (t * t * t);

	/* Between nodes test_axis_limits.c is stricter. */
	if (nodes_in(k, 2 * window) == 0)
		return;
	if (a > MOST * l->a_max_mm_s2 + allowed(k, window, 2, l) ||
	    j > MOST * l->j_max_mm_s3 + allowed(k, window, 3, l))
		fail_msg("axis %c near segment %u, over %d cycles: %g of %g "
			 "mm/s2, %g of %g mm/s3; a node allows %g and %g",
			 INTERP_AXIS_LETTERS[axis], (unsigned)k->index, window,
			 a, l->a_max_mm_s2, j, l->j_max_mm_s3,
			 allowed(k, window, 2, l), allowed(k, window, 3, l));
}

static void watch(struct rig *r, struct ring *k)
{
	step(r, OPEN_V);
	note_place(k, r);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < INTERP_NAXES; j++)
			if (k->n > 3 * windows[i])
				check_window(k, windows[i], j);
}

static void nodes_ask_of_no_axis_more_than_it_can_do(void **st)
{
	const struct cycle_config k = dry(4000, 2e5);
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct ring ring = { .n = 0 };
		struct rig r;

		set_machine(&s);
		rig_take(&r, random_nodes(&s), &k);
		track_there(&r, &ring, watch, CYCLES);
		ring.n = 0;
		track_back(&r, &ring, watch, CYCLES);
		rig_free(&r);
	}
}

/* Lines so short that a smooth curve through them ends another way than the
 * last of them; an axis that they turn stands on the arc behind them. */
static struct made run_onto_arc(void)
{
	static const double by[][3] = {		/* X, Y, C */
		{ 8, 0, 0 }, { 0.0042, 0, -0.0401 },
		{ 0.1666, -0.0086, -0.6146 },
	};
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
	};
	struct interp_build *b = interp_build_create(&o);
	struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .sweep = M_PI / 2,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	for (size_t i = 0; i < sizeof(by) / sizeof(by[0]); i++) {
		end[INTERP_X] += by[i][0];
		end[INTERP_Y] += by[i][1];
		end[INTERP_C] += by[i][2];
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	}
	a.centre_a_mm = end[INTERP_X];
	a.centre_b_mm = end[INTERP_Y] + 1.6;
	end[INTERP_X] += 1.6;
	end[INTERP_Y] += 1.6;
	assert_int_equal(interp_build_arc(b, end, &a, &w, &d), 0);
	return finish(b);
}

static void a_run_ends_along_its_last_line(void **st)
{
	const double off = 0.001 * (1 + 0.6146 / 0.1668);	/* a rounding */
	const double by = (0.6146 - off) / 0.1668;
	struct made m;

	(void)st;
	axes_machine = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i] = (struct interp_axis_limits) {
			0.001, -1000, 1000, 40, 570, 8250
		};
	m = run_onto_arc();
	assert_true(by * (double)m.p.segs[3].node_mm_s <=
		    1.01 * cbrt(36 * 8250 * INTERP_CORNER_MM *
				INTERP_CORNER_MM));
	free(m.block);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_run_ends_along_its_last_line),
		cmocka_unit_test(nodes_ask_of_no_axis_more_than_it_can_do),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
