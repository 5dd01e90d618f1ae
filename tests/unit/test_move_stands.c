/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_move_stands.c - a place where the axes allow little slows down that
 * place, and not the whole move
 */
#include "arc_turn.h"
#include "axis_track.h"

#define CYCLES	200000

/* Jerk that hardly counts: times are easy to tell. */
static void set_plain_machine(void)
{
	axes_machine = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i] = (struct interp_axis_limits) {
			0.001, -1000, 1000, 80, 500, 2e6
		};
}

static void to(struct interp_build *b, double x_mm, double c_deg)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = true,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] = x_mm;
	end[INTERP_C] = c_deg;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void by(struct interp_build *b, double x_mm, double y_mm, double c_deg)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] += x_mm;
	end[INTERP_Y] += y_mm;
	end[INTERP_C] += c_deg;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static struct interp_build *begin_plain(void)
{
	static const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};

	set_plain_machine();
	return interp_build_create(&o);
}

/* Walks it there and back, and checks each axis.  Return: the seconds of both
 * ways. */
static void walk(struct made m, double ret_s[2])
{
	const struct cycle_config k =
		dry(500, axes_machine.axis[0].j_max_mm_s3);
	struct track t = { .n = 0 };
	struct rig r;
	int n;

	rig_take(&r, m, &k);
	tell(&r, CYCLE_START);
	for (n = 0; n < CYCLES && r.c.state == STATE_TRAVEL; n++) {
		step(&r, OPEN_V);
		note(&t, &r);
		if (is_whole(&t))
			check_axes(&t, &r);
	}
	ret_s[0] = n * PERIOD_S;
	assert_int_equal(r.c.state, STATE_HOLD);
	tell_mm(&r, CYCLE_RETRACT, 1e9);
	for (n = 0; n < CYCLES && r.c.hold.moving; n++) {
		step(&r, OPEN_V);
		note(&t, &r);
		if (is_whole(&t))
			check_axes(&t, &r);
	}
	ret_s[1] = n * PERIOD_S;
	assert_true(place(&r) == 0);
	rig_free(&r);
}

/* Where a turn on next to no way is looked at: C, pulse by pulse. */
struct pulses {
	int32_t at;
	int back;			/* against the way that it goes */
};

static void count(struct pulses *k, const struct rig *r, int sign)
{
	const int32_t at = r->c.cursor.pos[INTERP_C];

	if ((at - k->at) * sign < 0)
		k->back++;
	k->at = at;
}

/* From a stand to a stand. */
static double time_of(double mm)
{
	return mm < 80 * 80 / 500.0 ? 2 * sqrt(mm / 500) : mm / 80 + 80 / 500.0;
}

static void a_turn_on_a_tiny_line_costs_no_more_than_the_turn(void **st)
{
	static const double tiny_mm[] = { 1e-6, 0.00002, 0.001, 0.02 };

	(void)st;
	for (int i = 0; i < 4; i++) {
		struct interp_build *b = begin_plain();
		const double most_s = 2 * time_of(50) + time_of(40) + 0.05;
		double s[2];

		to(b, 50, 0);
		to(b, 50 + tiny_mm[i], 40);
		to(b, 100, 40);
		walk(finish(b), s);
		assert_true(s[0] < most_s);
		assert_true(s[1] < most_s);
	}
}

/* X alone would know a place to 44 of C's points. */
static void on_next_to_no_way_it_turns_one_way(void **st)
{
	static const double tiny_mm[] = { 2e-8, 1e-6, 2e-5, 0.001 };

	(void)st;
	for (int i = 0; i < 4; i++) {
		const struct cycle_config k =
			dry(500, axes_machine.axis[0].j_max_mm_s3);
		struct interp_build *b = begin_plain();
		struct pulses c = { 0, 0 };
		struct rig r;

		to(b, 50, 0);
		to(b, 50 + tiny_mm[i], 44);
		to(b, 100, 44);
		rig_take(&r, finish(b), &k);
		tell(&r, CYCLE_START);
		for (int n = 0; n < CYCLES && r.c.state == STATE_TRAVEL; n++) {
			step(&r, OPEN_V);
			count(&c, &r, 1);
		}
		assert_int_equal(c.at, 44000);
		tell_mm(&r, CYCLE_RETRACT, 1e9);
		for (int n = 0; n < CYCLES && r.c.hold.moving; n++) {
			step(&r, OPEN_V);
			count(&c, &r, -1);
		}
		assert_int_equal(c.at, 0);
		assert_int_equal(c.back, 0);
		rig_free(&r);
	}
}

/* As past a pole: the nearer, the farther it turns by the way. */
static void nearer_and_nearer_to_a_pole_it_comes_past(void **st)
{
	struct interp_build *b = begin_plain();
	const double off_mm = 0.05;
	double s[2];

	(void)st;
	for (double x = -20; x <= 20; x += fmin(fmax(fabs(x) / 10, 0.005), 0.5))
		to(b, x, atan2(x, off_mm) * 180 / M_PI);
	walk(finish(b), s);
	/* With the limits of the pole all the way it took 42 s. */
	assert_true(s[0] < 20);
	assert_true(s[1] < 20);
}

/* Of two that are not far apart, in mm and in degrees: C alone has 500 deg/s2,
 * and beside X, where it turns by 6 degrees a mm, the path has 83 mm/s2. */
static void a_turn_alone_is_not_as_soft_as_a_line_beside_it(void **st)
{
	struct interp_build *b = begin_plain();
	const double most_s = 2 * time_of(90) + time_of(60) + 0.05;
	double s[2];

	(void)st;
	to(b, 0, 90);
	to(b, 10, 150);
	to(b, 10, 60);
	walk(finish(b), s);
	assert_true(s[0] < most_s);
	assert_true(s[1] < most_s);
}

/* Beside both neighbours of the second line C turns, by 10 and by 200 degrees a
 * mm, and can do little: 4.6 s.  As soft as a turn by the mean of both sides,
 * the second line alone would take 9 s. */
static void a_line_between_turns_is_not_as_soft_as_they(void **st)
{
	struct interp_build *b = begin_plain();
	double s[2];

	(void)st;
	axes_machine.axis[INTERP_C].a_max_mm_s2 = 5;
	to(b, -1, -10);
	to(b, 0, -10);
	to(b, -0.02, -6);
	walk(finish(b), s);
	assert_true(s[0] < 5);
	assert_true(s[1] < 5);
}

/* A comb of lines of 0.03 mm takes 1.02 s, nearly all on the second and on the
 * last one, where C turns.  Windows of the lines between see that: as soft as C
 * needs it in the mean of a window, they took a third more. */
static void short_lines_beside_a_turn_are_not_as_soft_as_it(void **st)
{
	struct interp_build *b = begin_plain();
	double s[2];

	(void)st;
	for (int i = 0; i < INTERP_NAXES; i++) {
		axes_machine.axis[i].a_max_mm_s2 = 4300;
		axes_machine.axis[i].j_max_mm_s3 = 42000;
	}
	axes_machine.axis[INTERP_C].a_max_mm_s2 = 157;
	axes_machine.axis[INTERP_C].j_max_mm_s3 = 5100;
	for (int i = 0; i < 10; i++)
		by(b, i % 2 ? 0 : 0.0308, i % 4 == 1 ? -0.0294 :
		   i % 4 == 3 ? 0.0294 : 0, i == 1 ? -6 : i == 9 ? 4 : 0);
	walk(finish(b), s);
	assert_true(s[0] < 1.1);
	assert_true(s[1] < 1.1);
}

static uint32_t stands_of(const struct made *m)
{
	uint32_t n = 0;

	for (uint32_t i = 0; i < m->p.head->nsegs; i++)
		n += (m->p.segs[i].flags & INTERP_SEG_STAND) != 0;
	return n;
}

/* C turns by @deg on each second line, which is softer. */
static struct made soft_again_and_again(double deg)
{
	struct interp_build *b = begin_plain();
	double x = 0, c = 0;

	for (int i = 0; i < 300; i++) {
		to(b, x += 0.05, c);
		to(b, x += 0.01, c += deg);
	}
	return finish(b);
}

/* A stand in front of each of them would take longer. */
static void what_is_soft_again_and_again_is_one_move(void **st)
{
	struct made m = soft_again_and_again(0.02);

	(void)st;
	assert_int_equal(stands_of(&m), 0);
	unmake(&m);
}

/* The nodes between are slow: as one move, that sets off from each of them as
 * softly, it takes 30 s. */
static void between_slow_nodes_it_stands_where_that_is_quicker(void **st)
{
	double s[2];

	(void)st;
	walk(soft_again_and_again(0.2), s);
	assert_true(s[0] < 20);
	assert_true(s[1] < 20);
}

/* -- Tight arcs ----------------------------------------------------------- */

static void arc_of(struct interp_build *b, double dx, double dy,
		   struct interp_build_arc a, bool clockwise)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] += dx;
	end[INTERP_Y] += dy;
	arc_turn(&a, b, end, clockwise);
	assert_int_equal(interp_build_arc(b, end, &a, &w, &d), 0);
}

static void arc_by(struct interp_build *b, double dx, double dy, double i,
		   double j)
{
	const double *here = interp_build_here(b);

	arc_of(b, dx, dy, (struct interp_build_arc) {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = here[INTERP_X] + i,
		.centre_b_mm = here[INTERP_Y] + j,
	}, false);
}

static struct interp_build *begin_jerk(double j_mm_s3)
{
	struct interp_build *b = begin_plain();

	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i].j_max_mm_s3 = j_mm_s3;
	return b;
}

/* Straight on, this way takes 2.7 s. */
static void a_circle_of_little_jerk_is_as_fast_as_its_bend(void **st)
{
	struct interp_build *b = begin_jerk(1);
	double s[2];

	(void)st;
	arc_by(b, 0, 0, 0.1, 0);
	walk(finish(b), s);
	assert_true(s[0] < 7);
	assert_true(s[1] < 7);
}

/* A line of 20 mm between two stands takes 8.6 s, or 0.6 s; as softly as the
 * arcs leave it 23 s, or 1 s. */
static void between_tight_arcs_a_line_is_not_as_soft_as_they(void **st)
{
	static const struct {
		double j_mm_s3, most_s;
	} rows[] = { { 1, 60 }, { 20000, 2.8 } };

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct interp_build *b = begin_jerk(rows[i].j_mm_s3);
		double s[2];

		for (int k = 0; k < 4; k++) {
			const double x = k & 1 ? 0 : k ? -1 : 1;
			const double y = k & 1 ? k < 2 ? 1 : -1 : 0;
			const double *here = interp_build_here(b);
			double end[INTERP_NAXES];
			struct interp_diag d;

			memcpy(end, here, sizeof(end));
			end[INTERP_X] += 20 * x;
			end[INTERP_Y] += 20 * y;
			assert_int_equal(interp_build_line(b, end,
				&(struct interp_build_word) {
					.line = 1, .feed_mm_s = 60 }, &d), 0);
			arc_by(b, 0.1 * (x - y), 0.1 * (x + y), -0.1 * y,
			       0.1 * x);
		}
		walk(finish(b), s);
		assert_true(s[0] < rows[i].most_s);
		assert_true(s[1] < rows[i].most_s);
	}
}

/* Half circles of 0.5 to 8.5 mm with corners between them.  To take one stand
 * away costs little; when all were gone that cost little, it took 11.9 s. */
static void arcs_of_many_sizes_have_the_stands_that_pay(void **st)
{
	struct interp_build *b = begin_jerk(20000);
	double s[2], x = 0;

	(void)st;
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i].a_max_mm_s2 = 1000;
	for (int i = 1; i < 30; i++) {
		const double d = (0.5 + 8 * fabs(sin(i * 1.7))) *
				 (x > 0 ? -1 : 1);

		arc_of(b, d, 0, (struct interp_build_arc) {
			.axis_a = INTERP_X, .axis_b = INTERP_Y,
			.centre_a_mm = x + d / 2,
		}, i % 2 == 0);
		x += d;
	}
	walk(finish(b), s);
	assert_true(s[0] < 11);
	assert_true(s[1] < 11);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_turn_on_a_tiny_line_costs_no_more_than_the_turn),
		cmocka_unit_test(on_next_to_no_way_it_turns_one_way),
		cmocka_unit_test(nearer_and_nearer_to_a_pole_it_comes_past),
		cmocka_unit_test(a_turn_alone_is_not_as_soft_as_a_line_beside_it),
		cmocka_unit_test(a_line_between_turns_is_not_as_soft_as_they),
		cmocka_unit_test(short_lines_beside_a_turn_are_not_as_soft_as_it),
		cmocka_unit_test(what_is_soft_again_and_again_is_one_move),
		cmocka_unit_test(between_slow_nodes_it_stands_where_that_is_quicker),
		cmocka_unit_test(a_circle_of_little_jerk_is_as_fast_as_its_bend),
		cmocka_unit_test(between_tight_arcs_a_line_is_not_as_soft_as_they),
		cmocka_unit_test(arcs_of_many_sizes_have_the_stands_that_pay),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
