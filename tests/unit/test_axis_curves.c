/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_curves.c - where X Y Z of a curve turn back on their way, or stand,
 * every axis keeps its acceleration and its jerk, also one that goes on beside
 * them; and F is kept to
 *
 * By differences over windows of some cycles, of where the axes are on the
 * curve; the seed is printed.
 */
#include "axis_track.h"

#define ROUNDS	SEED_ROUNDS(30)
#define CYCLES	100000
#define RING	64

/* Of what they may do. */
#define MOST		1.0
#define MOST_F		1.001

#define DEGREE		3
#define POINTS_MAX	7
#define COLUMNS		4

static uint64_t seed;

static const int windows[] = { 4, 8, 16 };

struct ring {
	double at[RING][INTERP_NAXES];
	int n;
	struct track places;
};

/* In parts of what they may do. */
static struct {
	double a, j, f;
} seen;

/* A curve; the columns behind @counted are beside the path. */
struct way {
	double points[POINTS_MAX][COLUMNS + 1];
	double knots[POINTS_MAX + DEGREE + 1];
	uint8_t axis[COLUMNS];
	uint32_t npoints, counted;
};

static void way_begin(struct way *w, uint64_t *s, uint32_t npoints)
{
	const bool c = rnd(s) % 2;

	*w = (struct way) {
		.npoints = npoints, .counted = c ? 3 : 2,
		.axis = { INTERP_X, INTERP_Y, c ? INTERP_Z : INTERP_U,
			  c ? INTERP_C : INTERP_V },
	};
	for (uint32_t i = 0; i < npoints; i++) {
		w->points[i][COLUMNS] = 1;
		w->knots[i + DEGREE + 1] = i + DEGREE + 1 < npoints ?
					   i + 1 : npoints - DEGREE;
	}
	for (uint32_t i = 0; i <= DEGREE; i++)
		w->knots[i] = 0;
}

/* A cubic that goes by @k[0] a step in its middle, where it bends by @k[1]. */
static void set_column(struct way *w, uint32_t j, const double k[3])
{
	w->points[0][j] = -k[0] + k[1] - k[2];
	w->points[1][j] = (-k[0] - k[1]) / 3 + k[2];
	w->points[2][j] = (k[0] - k[1]) / 3 - k[2];
	w->points[3][j] = k[0] + k[1] + k[2];
}

/* Those that count go by up to @off in the middle; the others go on. */
static void cusp(struct way *w, uint64_t *s, double off)
{
	way_begin(w, s, 4);
	for (uint32_t j = 0; j < COLUMNS; j++) {
		const double on = j < w->counted ? 0 :
				  pow(10, uniform(s, 0, 2));
		const double k[3] = {
			on + off * uniform(s, -1, 1),
			uniform(s, -0.2, 0.2) * on +
				(on > 0 ? 0 : uniform(s, -5, 5)),
			uniform(s, -0.2, 0.2) * on +
				(on > 0 ? 0 : uniform(s, -3, 3)),
		};

		set_column(w, j, k);
	}
}

static void exact_cusp(struct way *w, uint64_t *s)
{
	cusp(w, s, 0);
}

static void near_cusp(struct way *w, uint64_t *s)
{
	cusp(w, s, pow(10, uniform(s, -4, -0.3)));
}

/* Those that count stand for a while. */
static void stand(struct way *w, uint64_t *s)
{
	way_begin(w, s, 7);
	for (uint32_t j = 0; j < COLUMNS; j++) {
		double at = uniform(s, -5, 5);
		const double on = pow(10, uniform(s, 0, 1.3));

		for (uint32_t i = 0; i < w->npoints; i++) {
			w->points[i][j] = at;
			if (j >= w->counted)
				at += uniform(s, 0.5, 1) * on;
			else if (i == 0 || i + 2 == w->npoints)
				at += uniform(s, -5, 5);
		}
	}
}

/* All axes go on and bend, tight and wide; those beside the path turn by @on
 * degrees or so. */
static void smooth(struct way *w, uint64_t *s)
{
	const double scale = pow(10, uniform(s, -1, 1));
	const double on = pow(10, uniform(s, -1, 1)) * scale;

	way_begin(w, s, 7);
	for (uint32_t j = 0; j < COLUMNS; j++) {
		const double by = j < w->counted ? scale : on;
		double at = uniform(s, -5, 5), step = uniform(s, -by, by);

		for (uint32_t i = 0; i < w->npoints; i++) {
			w->points[i][j] = at;
			step = step / 2 + uniform(s, -by, by);
			at += step;
		}
	}
}

static struct made made_of(const struct way *w, double feed_mm_s)
{
	const struct interp_build_word word = {
		.line = 1, .feed_mm_s = feed_mm_s,
	};
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	struct interp_build *b = interp_build_create(&o);
	struct interp_build_curve c = { .nurbs = {
		.degree = DEGREE, .npoints = w->npoints, .naxes = COLUMNS,
		.counted = w->counted, .knots = w->knots,
		.points = w->points[0],
	} };
	double end[INTERP_NAXES] = { 0 };
	struct interp_diag d;

	memcpy(c.axis, w->axis, sizeof(c.axis[0]) * COLUMNS);
	for (int j = 0; j < COLUMNS; j++)
		end[w->axis[j]] = w->points[0][j];
	if (interp_build_line(b, end, &word, &d) != 0 ||
	    interp_build_curve(b, &c, &word, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
	return finish(b);
}

static double place_of(const struct ring *k, int back, int axis)
{
	return k->at[(k->n - 1 - back) % RING][axis];
}

static void check_window(const struct ring *k, int window, int axis)
{
	const struct interp_axis_limits *l = &axes_machine.axis[axis];
	const double t = PERIOD_S * window;
	const double p[4] = {
		place_of(k, 0, axis), place_of(k, window, axis),
		place_of(k, 2 * window, axis), place_of(k, 3 * window, axis),
	};
	const double a = (fabs(p[0] - 2 * p[1] + p[2]) - 4 * CURVE_OFF_MM) /
			 (t * t);
	const double j = (fabs(p[0] - 3 * p[1] + 3 * p[2] - p[3]) -
			  8 * CURVE_OFF_MM) / (t * t * t);

	seen.a = fmax(seen.a, a / l->a_max_mm_s2);
	seen.j = fmax(seen.j, j / l->j_max_mm_s3);
	if (seen.a > MOST || seen.j > MOST)
		fail_msg("axis %c, over %d cycles: %g of %g mm/s2, %g of %g "
			 "mm/s3", INTERP_AXIS_LETTERS[axis], window, a,
			 l->a_max_mm_s2, j, l->j_max_mm_s3);
}

/* From the first place on the curve. */
static void watch(struct rig *r, struct ring *k)
{
	step(r, OPEN_V);
	if (r->c.cursor.seg.kind != INTERP_CURVE) {
		k->n = 0;
		return;
	}
	places_of(&k->places, r, k->at[k->n++ % RING]);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < INTERP_NAXES; j++)
			if (k->n > 3 * windows[i])
				check_window(k, windows[i], j);
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

static void try(void (*random)(struct way *w, uint64_t *s))
{
	uint64_t s = seed;
	struct way w;

	memset(&seen, 0, sizeof(seen));
	for (int i = 0; i < ROUNDS; i++) {
		set_machine(&s);
		random(&w, &s);
		there_and_back(made_of(&w, 80));
	}
	print_message("most: %.2f of the acceleration, %.2f of the jerk\n",
		      seen.a, seen.j);
}

static void where_the_way_turns_back_every_axis_keeps_its_limits(void **st)
{
	(void)st;
	try(exact_cusp);
}

static void where_it_nearly_does_too(void **st)
{
	(void)st;
	try(near_cusp);
}

static void where_it_stands_too(void **st)
{
	(void)st;
	try(stand);
}

static void where_it_bends_too(void **st)
{
	(void)st;
	try(smooth);
}

/* Of the axes that count, by differences. */
static double speed_of(const struct ring *k, const struct way *w)
{
	double sum = 0;

	for (uint32_t j = 0; j < w->counted; j++) {
		const double d = place_of(k, 0, w->axis[j]) -
				 place_of(k, 8, w->axis[j]);

		sum += d * d;
	}
	return sqrt(sum) / (8 * PERIOD_S);
}

static void no_curve_is_faster_than_f(void **st)
{
	const struct cycle_config k = dry(4000, 2e5);
	uint64_t s = seed;
	struct way w;
	struct rig r;

	(void)st;
	seen.f = 0;
	for (int i = 0; i < ROUNDS; i++) {
		const double f = pow(10, uniform(&s, -0.3, 1.3));
		struct ring ring = { .n = 0 };

		set_machine(&s);
		(i % 2 ? near_cusp : exact_cusp)(&w, &s);
		rig_take(&r, made_of(&w, f), &k);
		tell(&r, CYCLE_START);
		for (int n = 0; n < CYCLES && r.c.state == STATE_TRAVEL; n++) {
			watch(&r, &ring);
			if (ring.n > 8)
				seen.f = fmax(seen.f, speed_of(&ring, &w) / f);
		}
		rig_free(&r);
		if (seen.f > MOST_F)
			fail_msg("%g of F", seen.f);
	}
	print_message("most: %.4f of F\n", seen.f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(
			where_the_way_turns_back_every_axis_keeps_its_limits),
		cmocka_unit_test(where_it_nearly_does_too),
		cmocka_unit_test(where_it_stands_too),
		cmocka_unit_test(where_it_bends_too),
		cmocka_unit_test(no_curve_is_faster_than_f),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
