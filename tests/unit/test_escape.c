/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_escape.c - promises of the ways out beside the path
 */
#include "cycle_help.h"
#include "path/place.h"

/*
 * Down to Z-3 in the middle, out to X0.3, round it twice; from the ring up by
 * 0.05, to the middle, and out to Z0.
 */
#define R_MM	0.3
#define DEPTH	(-3.0)
#define RISE_MM	0.05

static struct interp_escape ring_escape(void)
{
	struct interp_escape e = {
		.home = 1u << INTERP_X | 1u << INTERP_Y,
		.out = 1u << INTERP_Z, .rise_mm = RISE_MM,
	};

	return e;
}

static void ring(struct interp_build *b, const struct interp_escape *e)
{
	const double out[INTERP_NAXES] = { R_MM, 0, DEPTH };

	rapid_to(b, -1);
	cut_to(b, DEPTH);
	assert_int_equal(interp_build_escape(b, e), 0);
	line(b, out);
	arc(b, out, 0, 0, false);
	arc(b, out, 0, 0, false);
	assert_int_equal(interp_build_escape(b, NULL), 0);
}

/* Every point must be a neighbour of the one before. */
struct watch {
	int32_t last[INTERP_NAXES];
	uint64_t points, beside;
	int32_t (*at)[INTERP_NAXES];	/* those beside the path */
	size_t room;
};

static void on_point(void *arg, const struct cycle *c)
{
	struct watch *w = arg;
	const int32_t *pos = place_pos(c);
	uint32_t moved = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		assert_true(abs(pos[i] - w->last[i]) <= 1);
		moved |= (uint32_t)(pos[i] != w->last[i]) << i;
	}
	assert_int_equal(moved, place_moved(c));
	memcpy(w->last, pos, sizeof(w->last));
	w->points++;
	if (!escape_is_out(&c->escape))
		return;
	if (w->beside == w->room) {
		w->room = w->room ? 2 * w->room : 4096;
		w->at = realloc(w->at, w->room * sizeof(*w->at));
		assert_non_null(w->at);
	}
	memcpy(w->at[w->beside++], pos, sizeof(*w->at));
}

static struct cycle_config jumping(void)
{
	struct cycle_config k = usual_config();

	k.jump.height_mm = 1;
	k.jump.every.cycles = 50;
	k.overrun_limit = 0;
	return k;
}

struct beside {
	struct rig r;
	struct watch w;
};

static void begin_with(struct beside *t, const struct cycle_config *k,
		       const struct interp_escape *e)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	*t = (struct beside) { 0 };
	ring(b, e);
	rig_load(&t->r, b, k);
	t->r.c.on_point = on_point;
	t->r.c.on_point_arg = &t->w;
	assert_int_equal(tell(&t->r, CYCLE_START), ANSWER_DONE);
}

static void end(struct beside *t)
{
	free(t->w.at);
	rig_free(&t->r);
}

/* Cut on to a jump that begins on the ring beyond @place_mm. */
static void jump_at(struct beside *t, double place_mm)
{
	for (int i = 0; i < 400000; i++) {
		step(&t->r, SPARKING_V);
		if (t->r.c.state == STATE_JUMP && place(&t->r) > place_mm &&
		    t->r.was != STATE_JUMP)
			return;
	}
	fail();
}

#define ON_RING	4.0		/* mm of path: on the ring */

static void jump_on_ring(struct beside *t, const struct cycle_config *k)
{
	const struct interp_escape e = ring_escape();

	begin_with(t, k, &e);
	jump_at(t, ON_RING);
	t->w.beside = 0;
}

static void finish_job(struct beside *t)
{
	for (int i = 0; i < 2000000 && t->r.c.state != STATE_IDLE; i++)
		step(&t->r, SPARKING_V);
	assert_int_equal(t->r.c.state, STATE_IDLE);
	assert_int_equal(t->r.c.outcome, OUTCOME_DONE);
	assert_int_equal(t->r.c.out.target[INTERP_X], 300);
	assert_int_equal(t->r.c.out.target[INTERP_Z], -3000);
}

/* On one of the three legs from the place the cursor stands at? */
static bool on_legs(const struct beside *t, const int32_t *p)
{
	const int32_t *from = t->r.c.cursor.pos;
	const bool rise = p[0] == from[0] && p[1] == from[1] &&
			  p[2] >= from[2] && p[2] <= from[2] + 50;
	const bool out = p[0] == 0 && p[1] == 0 && p[2] >= from[2] + 50 &&
			 p[2] <= 0;
	/* Nearer than a pulse to the line to the middle, at its height. */
	const bool in = p[2] == from[2] + 50 &&
			fabs((double)p[0] * from[1] - (double)p[1] * from[0]) <=
			hypot(from[0], from[1]) * 0.75 &&
			hypot(p[0], p[1]) <= hypot(from[0], from[1]) + 1;

	return rise || in || out;
}

/* -- Out and back --------------------------------------------------------- */

static void
a_jump_goes_out_by_the_centre_and_back_over_the_same_points(void **st)
{
	const struct cycle_config k = jumping();
	struct beside t;
	double most = 0;
	size_t top;

	(void)st;
	jump_on_ring(&t, &k);
	while (t.r.c.state == STATE_JUMP) {
		step(&t.r, OPEN_V);
		most = fmax(most, t.r.out.off_path_mm);
	}
	assert_near(most, k.jump.height_mm, 1e-9);
	assert_near(t.r.out.off_path_mm, k.jump.short_of_mm, 1e-9);
	assert_int_equal(t.r.c.state, STATE_APPROACH);
	/* 50 up, about 300 in, the rest out. */
	top = 0;
	for (size_t i = 0; i < t.w.beside; i++)
		top = t.w.at[i][2] > t.w.at[top][2] ? i : top;
	assert_true(abs(t.w.at[top][2] - t.r.c.cursor.pos[2] - 700) <= 2);
	assert_int_equal(t.w.at[top][0], 0);
	assert_int_equal(t.w.at[top][1], 0);
	for (size_t i = 0; top + i < t.w.beside; i++)
		assert_memory_equal(t.w.at[top + i], t.w.at[top - i],
				    sizeof(t.w.at[0]));
	for (size_t i = 0; i < t.w.beside; i++)
		assert_true(on_legs(&t, t.w.at[i]));
	finish_job(&t);
	end(&t);
}

static void the_path_is_the_same_with_and_without_escapes(void **st)
{
	const struct interp_escape none = { .out = 0 };
	const struct cycle_config k = jumping();
	struct beside a, b;

	(void)st;
	jump_on_ring(&a, &k);
	begin_with(&b, &k, &none);
	finish_job(&a);
	finish_job(&b);
	assert_int_equal(b.w.beside, 0);
	assert_true(a.w.beside > 0);
	assert_memory_equal(a.r.c.out.target, b.r.c.out.target,
			    sizeof(a.r.c.out.target));
	end(&a);
	end(&b);
}

static void speed_and_acceleration_keep_their_limits_and_corners_are_stood_on(
	void **st)
{
	const struct cycle_config k = jumping();
	double v = 0, a = 0, way = 0;
	struct beside t;
	int corners = 0;

	(void)st;
	jump_on_ring(&t, &k);
	while (t.r.c.state == STATE_JUMP) {
		const struct escape *e = &t.r.c.escape;

		step(&t.r, OPEN_V);
		if (t.r.c.state != STATE_JUMP)
			break;
		corners += t.r.c.mover.v_mm_s == 0 && e->way_mm != way &&
			   (fabs(e->way_mm - 0.05) < 1e-12 ||
			    fabs(e->way_mm - e->leg[1].end_mm) < 1e-12);
		way = e->way_mm;
		assert_true(fabs(t.r.c.mover.v_mm_s) <= 50 + 1e-9);
		assert_true(fabs(t.r.c.mover.v_mm_s - v) <=
			    k.jump.a_max_mm_s2 * PERIOD_S + 1e-9);
		assert_true(fabs(t.r.c.mover.a_mm_s2 - a) <=
			    2 * k.jump.j_max_mm_s3 * PERIOD_S + 1e-6);
		v = t.r.c.mover.v_mm_s;
		a = t.r.c.mover.a_mm_s2;
	}
	assert_int_equal(corners, 4);
	end(&t);
}

static void few_points_a_cycle_lead_over_the_same_points(void **st)
{
	struct cycle_config k = jumping();
	struct beside t;

	(void)st;
	k.points_max = 3;
	jump_on_ring(&t, &k);
	while (t.r.c.state == STATE_JUMP)
		step(&t.r, OPEN_V);
	for (size_t i = 0; i < t.w.beside; i++)
		assert_true(on_legs(&t, t.w.at[i]));
	assert_near(t.r.out.off_path_mm, k.jump.short_of_mm, 1e-3);
	end(&t);
}

/* The axes beside the path brake less than those of the path: what is left of
 * the feed must not lead back onto it. */
static void softer_axes_beside_the_path_are_still_the_way_out(void **st)
{
	const struct interp_escape e = ring_escape();
	struct cycle_config k = jumping();
	struct interp_escape *soft;
	struct beside t;

	(void)st;
	k.gap.feed_a_mm_s2 = 0;
	begin_with(&t, &k, &e);
	soft = (struct interp_escape *)(uintptr_t)t.r.c.cursor.p.escapes;
	for (uint32_t i = 0; i < t.r.c.cursor.p.head->nescapes; i++)
		soft[i].a_max_mm_s2 = 10;
	for (double at_mm = ON_RING; at_mm < ON_RING + 0.5; at_mm += 0.05) {
		jump_at(&t, at_mm);
		t.w.beside = 0;
		while (t.r.c.state == STATE_JUMP)
			step(&t.r, OPEN_V);
		assert_true(t.w.beside > 0);
	}
	end(&t);
}

static void a_higher_jump_ends_where_the_escape_does(void **st)
{
	struct cycle_config k = jumping();
	double most = 0;
	struct beside t;

	(void)st;
	k.jump.height_mm = 100;
	jump_on_ring(&t, &k);
	while (t.r.c.state == STATE_JUMP) {
		step(&t.r, OPEN_V);
		most = fmax(most, t.r.out.off_path_mm);
		assert_true(t.r.out.target[INTERP_Z] <= 0);
	}
	assert_near(most, t.r.c.escape.length_mm, 1e-9);
	end(&t);
}

/* -- What comes between --------------------------------------------------- */

/* The same jump again, @i cycles into it; @ring stands at its beginning. */
static void again(struct beside *t, const struct beside *at_ring, int i)
{
	*t = *at_ring;
	t->w.at = NULL;
	t->w.room = t->w.beside = 0;
	t->r.c.on_point_arg = &t->w;
	steps(&t->r, OPEN_V, i);
}

static int jump_cycles(const struct beside *at_ring)
{
	struct beside t;
	int n = 0;

	again(&t, at_ring, 0);
	for (; t.r.c.state == STATE_JUMP; n++)
		step(&t.r, OPEN_V);
	free(t.w.at);
	assert_true(n > 50);
	return n;
}

static void stand_still(struct beside *t)
{
	for (int i = 0; i < 2000 && t->r.c.mover.v_mm_s != 0; i++)
		step(&t->r, OPEN_V);
	assert_true(t->r.c.mover.v_mm_s == 0);
}

static void check_ground(const struct beside *t)
{
	for (size_t i = 0; i < t->w.beside; i++)
		assert_true(on_legs(t, t->w.at[i]));
}

static void come_home(struct beside *t)
{
	assert_int_equal(tell(&t->r, CYCLE_START), ANSWER_DONE);
	if (t->w.beside > 0 && escape_is_out(&t->r.c.escape))
		assert_int_equal(t->r.c.state, STATE_JUMP);
	for (int i = 0; i < 5000 && escape_is_out(&t->r.c.escape); i++)
		step(&t->r, OPEN_V);
	assert_false(escape_is_out(&t->r.c.escape));
	assert_true(t->r.out.off_path_mm == 0);
}

/* @what comes in each cycle of a jump, of a machine of its own each time. */
static void in_any_cycle(void (*what)(struct beside *t))
{
	const struct cycle_config k = jumping();
	struct beside at_ring;
	int n;

	jump_on_ring(&at_ring, &k);
	n = jump_cycles(&at_ring);
	for (int i = 0; i <= n; i++) {
		struct beside t;

		again(&t, &at_ring, i);
		what(&t);
		free(t.w.at);
	}
	end(&at_ring);
}

static void hold(struct beside *t)
{
	assert_int_equal(tell(&t->r, CYCLE_HOLD), ANSWER_DONE);
	stand_still(t);
	steps(&t->r, OPEN_V, 3);
	assert_int_equal(t->r.c.state, STATE_HOLD);
	check_ground(t);
	come_home(t);
}

static void
a_hold_in_any_cycle_stays_on_the_legs_and_start_comes_back(void **st)
{
	(void)st;
	in_any_cycle(hold);
}

static void stop_at_once(struct beside *t)
{
	double way;

	t->r.in.estop = true;
	step(&t->r, OPEN_V);
	way = t->r.c.escape.way_mm;
	steps(&t->r, OPEN_V, 3);
	t->r.in.estop = false;
	step(&t->r, OPEN_V);
	assert_int_equal(t->r.c.state, STATE_FAULT);
	assert_true(t->r.c.escape.way_mm == way);
	assert_int_equal(tell(&t->r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(t->r.c.state, STATE_HOLD);
	check_ground(t);
	come_home(t);
}

static void an_e_stop_in_any_cycle_ends_motion_and_start_comes_back(void **st)
{
	(void)st;
	in_any_cycle(stop_at_once);
}

static void short_it(struct beside *t)
{
	steps(&t->r, SHORTED_V, 5);
	check_ground(t);
	for (int j = 0; j < 5000 && escape_is_out(&t->r.c.escape); j++)
		step(&t->r, OPEN_V);
	assert_false(escape_is_out(&t->r.c.escape));
}

static void
a_short_in_any_cycle_keeps_to_the_legs_and_is_retracted_from(void **st)
{
	(void)st;
	in_any_cycle(short_it);
}

static void a_retract_by_command_goes_on_out_and_a_stop_ends_the_job(void **st)
{
	const struct cycle_config k = jumping();
	struct beside t;
	double way;

	(void)st;
	jump_on_ring(&t, &k);
	steps(&t.r, OPEN_V, 10);
	tell(&t.r, CYCLE_HOLD);
	stand_still(&t);
	way = t.r.c.escape.way_mm;
	assert_int_equal(tell_mm(&t.r, CYCLE_RETRACT, 0.5), ANSWER_DONE);
	for (int i = 0; i < 5000 && t.r.c.hold.moving; i++)
		step(&t.r, OPEN_V);
	assert_near(t.r.c.escape.way_mm, way + 0.5, 1e-9);
	check_ground(&t);
	assert_int_equal(tell_mm(&t.r, CYCLE_RETRACT, 1e6), ANSWER_DONE);
	for (int i = 0; i < 50000 && t.r.c.hold.moving; i++)
		step(&t.r, OPEN_V);
	assert_near(t.r.c.escape.way_mm, t.r.c.escape.length_mm, 1e-9);
	assert_int_equal(tell(&t.r, CYCLE_STOP), ANSWER_DONE);
	steps(&t.r, OPEN_V, 2);
	assert_int_equal(t.r.c.state, STATE_IDLE);
	assert_int_equal(t.r.out.target[INTERP_Z], 0);
	end(&t);
}

static void a_short_is_retracted_from_by_the_escape_if_asked_for(void **st)
{
	const struct interp_escape e = ring_escape();
	struct cycle_config k = jumping();
	struct beside t;

	(void)st;
	k.jump.height_mm = 0;
	k.gap.retract_escape = true;
	begin_with(&t, &k, &e);
	cut_until(&t.r, ON_RING);
	steps(&t.r, SHORTED_V, 60);
	assert_int_equal(t.r.c.state, STATE_RETRACT);
	/* 5 mm/s for 60 cycles, less what it takes to set off and to stop at
	 * the corner. */
	assert_true(t.r.out.off_path_mm > 0.22 &&
		    t.r.out.off_path_mm <= 0.3 + 1e-9);
	check_ground(&t);
	finish_job(&t);
	end(&t);
}

static void shorts_that_stay_end_as_a_fault_at_the_limit(void **st)
{
	const struct interp_escape e = ring_escape();
	struct cycle_config k = jumping();
	struct beside t;

	(void)st;
	k.jump.height_mm = 0;
	k.gap.retract_escape = true;
	begin_with(&t, &k, &e);
	cut_until(&t.r, ON_RING);
	until(&t.r, STATE_FAULT, SHORTED_V, 2000);
	assert_int_equal(t.r.c.fault.first, FAULT_SHORT_NOT_CLEARED);
	assert_near(t.r.out.off_path_mm, k.gap.retract_limit_mm, 0.01);
	tell(&t.r, CYCLE_RESET);
	come_home(&t);
	finish_job(&t);
	end(&t);
}

/* -- Where it does not go ------------------------------------------------- */

static void beyond_the_travel_or_no_number_it_lifts_along_the_path(void **st)
{
	const struct cycle_config k = jumping();

	(void)st;
	for (int bad = 0; bad < 3; bad++) {
		struct interp_escape e = ring_escape();
		struct beside t;

		if (bad == 0)
			e.out_mm[INTERP_Z] = 1000;
		if (bad == 1)
			e.home_mm[INTERP_X] = NAN;
		if (bad == 2)
			e.rise_mm = NAN;
		begin_with(&t, &k, &e);
		for (int i = 0; i < 400000 && t.r.c.state != STATE_IDLE &&
		     t.r.c.state != STATE_FAULT; i++)
			step(&t.r, SPARKING_V);
		assert_int_equal(t.w.beside, 0);
		end(&t);
	}
}

static void after_a_crash_every_point_of_it_is_found_again(void **st)
{
	const struct cycle_config k = jumping();
	struct beside t;

	(void)st;
	jump_on_ring(&t, &k);
	while (t.r.c.state == STATE_JUMP) {
		const int32_t *at = place_pos(&t.r.c);
		struct cycle c = t.r.c;
		int32_t wrong[INTERP_NAXES];

		assert_true(escape_find(&c, at));
		assert_near(c.escape.way_mm, t.r.c.escape.way_mm, 1.8e-3);
		assert_memory_equal(c.out.target, at,
				    sizeof(c.out.target));
		memcpy(wrong, at, sizeof(wrong));
		wrong[INTERP_C]++;
		assert_false(escape_find(&c, wrong));
		assert_false(escape_is_out(&c.escape));
		step(&t.r, OPEN_V);
	}
	end(&t);
}

/* -- Straight up ---------------------------------------------------------- */

static const struct interp_escape *escape_of(const struct made *m, uint32_t seg)
{
	return &m->p.escapes[m->p.segs[seg].escape];
}

static void straight_up_is_offered_only_where_it_came_straight_down(void **st)
{
	const double aside[INTERP_NAXES] = { 1, 0, -2 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct made m;

	(void)st;
	/* From Z0, which lies within the cut. */
	interp_build_lift(b, INTERP_Z);
	rapid_to(b, 5);		/* 1 */
	rapid_to(b, 1);		/* 2 */
	cut_to(b, -2);		/* 3 */
	line(b, aside);		/* 4 */
	cut_to(b, -3);		/* 5 */
	cut_to(b, -2.5);	/* 6 */
	m = finish(b);
	assert_int_equal(escape_of(&m, 3)->out, 1u << INTERP_Z);
	assert_near(escape_of(&m, 3)->out_mm[INTERP_Z], 5, 0);
	assert_int_equal(m.p.segs[4].escape, 0);
	assert_near(escape_of(&m, 5)->out_mm[INTERP_Z], -2, 0);
	assert_near(escape_of(&m, 6)->out_mm[INTERP_Z], -2, 0);
	unmake(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_jump_goes_out_by_the_centre_and_back_over_the_same_points),
		cmocka_unit_test(the_path_is_the_same_with_and_without_escapes),
		cmocka_unit_test(speed_and_acceleration_keep_their_limits_and_corners_are_stood_on),
		cmocka_unit_test(few_points_a_cycle_lead_over_the_same_points),
		cmocka_unit_test(softer_axes_beside_the_path_are_still_the_way_out),
		cmocka_unit_test(a_higher_jump_ends_where_the_escape_does),
		cmocka_unit_test(a_hold_in_any_cycle_stays_on_the_legs_and_start_comes_back),
		cmocka_unit_test(an_e_stop_in_any_cycle_ends_motion_and_start_comes_back),
		cmocka_unit_test(a_short_in_any_cycle_keeps_to_the_legs_and_is_retracted_from),
		cmocka_unit_test(a_retract_by_command_goes_on_out_and_a_stop_ends_the_job),
		cmocka_unit_test(a_short_is_retracted_from_by_the_escape_if_asked_for),
		cmocka_unit_test(shorts_that_stay_end_as_a_fault_at_the_limit),
		cmocka_unit_test(beyond_the_travel_or_no_number_it_lifts_along_the_path),
		cmocka_unit_test(after_a_crash_every_point_of_it_is_found_again),
		cmocka_unit_test(straight_up_is_offered_only_where_it_came_straight_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
