/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_probe.c - segments that end where the machine says
 *
 * The work is made of walls at given places: there is contact where an axis is
 * at a wall or beyond it.
 */
#include "arc_turn.h"
#include "cycle_help.h"

#include "path/probe_rest.h"

#include <errno.h>

#define NO_WALL		(1 << 28)
#define SETTLE		20

struct world {
	struct rig r;
	int32_t low, high;		/* walls on X, pulses */
	bool by_input;			/* contact by the input, not the gap */
};

static struct cycle_config probe_config(void)
{
	struct cycle_config k = usual_config();

	k.probe = (struct probe_config) {
		.feed_mm_s = 1, .fine_mm_s = 0.5, .back_mm = 0.1,
		.settle.cycles = SETTLE,
	};
	return k;
}

static void x_by(struct interp_build *b, double by_mm, uint8_t ends)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = true, .ends = ends,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] += by_mm;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void xy_to(struct interp_build *b, double x_mm, double y_mm)
{
	const struct interp_build_word w = { .line = 1, .rapid = true };
	const double end[INTERP_NAXES] = { x_mm, y_mm };
	struct interp_diag d;

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void load(struct world *w, struct interp_build *b,
		 const struct cycle_config *k)
{
	rig_load(&w->r, b, k);
	w->low = -NO_WALL;
	w->high = NO_WALL;
	w->by_input = false;
	assert_int_equal(tell(&w->r, CYCLE_START), ANSWER_DONE);
}

static bool against(const struct world *w)
{
	const int32_t x = w->r.out.target[INTERP_X];

	return x <= w->low || x >= w->high;
}

/* Contact can be felt while the sensing voltage is on. */
static void feel(struct world *w)
{
	const bool contact = w->r.out.sense && against(w);

	w->r.in.contact = contact && w->by_input;
	step(&w->r, contact && !w->by_input ? SHORTED_V : OPEN_V);
	assert_true(w->r.out.sense == (w->r.c.state == STATE_PROBE));
}

static void feel_until(struct world *w, enum cycle_state s, int n)
{
	while (w->r.c.state != s && n-- > 0)
		feel(w);
	assert_string_equal(state_duty[w->r.c.state].name, state_duty[s].name);
}

/* With no more than X's 1000 mm/s2, which is a pulse; places are a half off. */
static void feel_smoothly_until(struct world *w, enum cycle_state s, int n)
{
	int32_t x[3] = { w->r.out.target[INTERP_X], w->r.out.target[INTERP_X],
			 w->r.out.target[INTERP_X] };

	for (int i = 0; w->r.c.state != s && i < n; i++) {
		feel(w);
		x[0] = x[1];
		x[1] = x[2];
		x[2] = w->r.out.target[INTERP_X];
		if (i > 0)
			assert_in_range(x[2] - 2 * x[1] + x[0] + 3, 0, 6);
	}
	assert_string_equal(state_duty[w->r.c.state].name, state_duty[s].name);
}

static struct interp_build *one_probe(double by_mm)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	x_by(b, by_mm, INTERP_SEG_PROBE);
	x_by(b, by_mm < 0 ? 5 : -5, 0);
	return b;
}

/* -- Where it ends -------------------------------------------------------- */

/* The contact that counts is met at 0.5 um a cycle: on the pulse. */
static void probe_somewhere(uint64_t *s, bool by_input)
{
	const struct cycle_config k = probe_config();
	const int sign = rnd(s) % 2 ? 1 : -1;
	const int32_t wall = sign * (int32_t)(100 + rnd(s) % 2000);
	struct world w;

	load(&w, one_probe(sign * 10), &k);
	w.by_input = by_input;
	*(sign > 0 ? &w.high : &w.low) = wall;
	feel_until(&w, STATE_IDLE, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_NONE);
	assert_int_equal(w.r.c.probe.found[0][INTERP_X], wall);
	assert_int_equal(w.r.out.target[INTERP_X], wall - sign * 5000);
	assert_int_equal(w.r.c.cursor.pos[INTERP_X], sign * 5000);
	assert_int_equal(w.r.c.totals.cut_cycles, 0);
	rig_free(&w.r);
}

static void test_what_follows_counts_from_the_contact(void **state)
{
	uint64_t s = 7;

	(void)state;
	for (int i = 0; i < 40; i++)
		probe_somewhere(&s, i % 2);
}

static void test_the_axes_never_step_where_the_rest_is_left_out(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;
	int32_t was = 0;

	(void)state;
	load(&w, one_probe(-100), &k);
	w.low = -1500;
	while (w.r.c.state != STATE_IDLE) {
		feel(&w);
		assert_true(abs(w.r.out.target[INTERP_X] - was) <= 80);
		if (w.r.c.state == STATE_PROBE)
			assert_true(abs(w.r.out.target[INTERP_X] - was) <= 1);
		was = w.r.out.target[INTERP_X];
	}
	assert_int_equal(w.r.out.target[INTERP_X], 3500);
	rig_free(&w.r);
}

static void test_it_goes_no_deeper_than_a_cycle_at_its_feed(void **state)
{
	struct cycle_config k = probe_config();
	struct world w;
	int32_t deepest = 0;

	(void)state;
	k.probe.feed_mm_s = 20;
	load(&w, one_probe(-10), &k);
	w.low = -3003;
	while (w.r.c.state != STATE_IDLE) {
		feel(&w);
		deepest = w.r.out.target[INTERP_X] < deepest ?
			  w.r.out.target[INTERP_X] : deepest;
	}
	/* Seen a cycle late, then 20, 19, ... mm/s. */
	assert_in_range(w.low - deepest, 0, 20 + 20 * 21 / 2);
	assert_int_equal(w.r.c.probe.found[0][INTERP_X], -3003);
	rig_free(&w.r);
}

static void test_without_a_way_back_the_first_contact_counts(void **state)
{
	struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	k.probe.back_mm = 0;
	load(&w, one_probe(-10), &k);
	w.low = -2000;
	feel_until(&w, STATE_IDLE, 20000);
	assert_in_range(-w.r.c.probe.found[0][INTERP_X], 2000, 2001);
	rig_free(&w.r);
}

/* -- Half and limit ------------------------------------------------------- */

static struct interp_build *two_probes(bool first_low)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double way = first_low ? -100 : 100;

	x_by(b, way, INTERP_SEG_PROBE);
	x_by(b, -way / 1000, 0);
	x_by(b, -way, INTERP_SEG_PROBE);
	x_by(b, 100, INTERP_SEG_HALF);
	x_by(b, -100, INTERP_SEG_HALF);
	return b;
}

static void test_half_is_the_middle_between_two_contacts(void **state)
{
	const struct cycle_config k = probe_config();
	uint64_t s = 11;

	(void)state;
	for (int i = 0; i < 20; i++) {
		struct world w;

		load(&w, two_probes(i % 2), &k);
		w.low = -(int32_t)(200 + rnd(&s) % 1500);
		w.high = (int32_t)(200 + rnd(&s) % 1500);
		feel_until(&w, STATE_IDLE, 30000);
		assert_int_equal(w.r.c.fault.first, FAULT_NONE);
		assert_true(abs(w.r.out.target[INTERP_X] -
				(w.low + w.high) / 2) <= 1);
		rig_free(&w.r);
	}
}

static void test_a_half_without_two_contacts_is_a_fault(void **state)
{
	const struct cycle_config k = probe_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct world w;

	(void)state;
	x_by(b, -10, INTERP_SEG_PROBE);
	x_by(b, 0.5, 0);
	x_by(b, 10, INTERP_SEG_HALF);
	load(&w, b, &k);
	w.low = -300;
	feel_until(&w, STATE_FAULT, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_PROGRAM);
	assert_int_equal(w.r.out.target[INTERP_X], 200);
	rig_free(&w.r);
}

static void test_something_in_the_way_of_a_half_is_a_contact(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, two_probes(true), &k);
	w.low = -1500;
	w.high = 1500;
	while (w.r.c.probe.phase != PROBE_GO ||
	       w.r.out.target[INTERP_X] > 1000)
		feel(&w);
	w.low = 600;
	feel_smoothly_until(&w, STATE_FAULT, 1000);
	assert_int_equal(w.r.c.fault.first, FAULT_CONTACT);
	assert_in_range(w.r.out.target[INTERP_X], 0, 600);
	rig_free(&w.r);
}

static void test_a_limit_ends_where_the_travel_does(void **state)
{
	const struct cycle_config k = probe_config();

	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		struct world w;

		/* Somewhere else than the program thinks. */
		x_by(b, -100, INTERP_SEG_PROBE);
		x_by(b, 1, 0);
		x_by(b, sign * 400, INTERP_SEG_LIMIT);
		load(&w, b, &k);
		w.low = -1200;
		while (w.r.c.cursor.index < 3)
			feel(&w);
		w.low = -NO_WALL;
		feel_until(&w, STATE_IDLE, 20000);
		assert_int_equal(w.r.c.fault.first, FAULT_NONE);
		assert_int_equal(w.r.out.target[INTERP_X], sign * 199999);
		rig_free(&w.r);
	}
}

/* -- Faults --------------------------------------------------------------- */

static void test_no_contact_by_its_end_is_a_fault(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-2), &k);
	feel_until(&w, STATE_FAULT, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_NO_CONTACT);
	assert_string_equal(fault_name(w.r.c.fault.first), "no-contact");
	assert_int_equal(w.r.out.target[INTERP_X], -2000);
	/* And again, after a way back: nothing is lost. */
	assert_int_equal(tell(&w.r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(tell_mm(&w.r, CYCLE_RETRACT, 1), ANSWER_DONE);
	for (int i = 0; i < 3000; i++)
		feel(&w);
	assert_int_equal(w.r.out.target[INTERP_X], -1000);
	w.low = -1700;
	assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
	feel_until(&w, STATE_IDLE, 20000);
	assert_int_equal(w.r.out.target[INTERP_X], 3300);
	rig_free(&w.r);
}

static void test_no_contact_by_the_travels_end_is_a_fault(void **state)
{
	struct cycle_config k = probe_config();

	(void)state;
	k.probe.feed_mm_s = 20;
	for (int sign = -1; sign <= 1; sign += 2) {
		struct world w;

		k.travel_min[INTERP_X] = -1500;
		k.travel_max[INTERP_X] = 1500;
		load(&w, one_probe(sign * 100), &k);
		feel_smoothly_until(&w, STATE_FAULT, 20000);
		assert_int_equal(w.r.c.fault.latched,
				 fault_bit(FAULT_NO_CONTACT));
		assert_int_equal(w.r.out.target[INTERP_X], sign * 1500);
		rig_free(&w.r);
	}
}

static void test_contact_to_begin_with_is_a_fault(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-2), &k);
	w.low = 0;
	feel_until(&w, STATE_FAULT, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_CONTACT);
	assert_int_equal(w.r.out.target[INTERP_X], 0);
	rig_free(&w.r);
}

static void test_a_contact_that_does_not_open_is_a_fault(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-2), &k);
	w.low = -1000;
	while (w.r.c.probe.phase != PROBE_BACK)
		feel(&w);
	w.low = 0;
	feel_until(&w, STATE_FAULT, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_CONTACT);
	assert_true(w.r.out.target[INTERP_X] >= -902);
	rig_free(&w.r);
}

static void test_feeling_blindly_is_a_fault(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-2), &k);
	for (int i = 0; i < 300; i++)
		feel(&w);
	w.r.in.gap_valid = false;
	step(&w.r, OPEN_V);
	assert_int_equal(w.r.c.fault.first, FAULT_GAP_LOST);
	rig_free(&w.r);
}

static void test_soft_limits_are_of_the_axes_not_of_the_program(void **state)
{
	const struct cycle_config k = probe_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct world w;

	(void)state;
	x_by(b, -100, INTERP_SEG_PROBE);	/* ends at -1, is called -100 */
	x_by(b, 201, 0);			/* to 200 */
	x_by(b, -1, INTERP_SEG_PROBE);		/* ends at 199.5, not 199 */
	x_by(b, -398, 0);			/* to -198.5, not -199 */
	load(&w, b, &k);
	w.low = -1000;
	while (w.r.out.target[INTERP_X] < 200000 && w.r.c.loaded)
		feel(&w);
	w.low = 199500;
	feel_until(&w, STATE_IDLE, 20000);
	assert_int_equal(w.r.c.fault.first, FAULT_NONE);
	assert_int_equal(w.r.out.target[INTERP_X], -198500);
	rig_free(&w.r);
}

/* From a contact at -1, which is called -100.  It stands there if it does not
 * fit. */
static void rest_fits_if(struct interp_build *b, bool fits)
{
	const struct cycle_config k = probe_config();
	const struct interp_seg *beyond;
	struct world w;

	load(&w, b, &k);
	w.low = -1000;
	for (int n = 0; n < 40000 && w.r.c.loaded &&
			w.r.c.state != STATE_FAULT; n++)
		feel(&w);
	beyond = probe_rest_beyond(&w.r.c);
	assert_int_equal(w.r.c.fault.first,
			 fits ? FAULT_NONE : FAULT_SOFT_LIMIT);
	assert_true(!beyond == fits);
	if (!fits) {
		assert_int_equal(beyond->line, 7);
		assert_int_equal(w.r.out.target[INTERP_X], -1000);
	}
	rig_free(&w.r);
}

static void test_leaving_the_travel_is_told_at_the_contact(void **st)
{
	(void)st;
	for (int way = 201; way <= 202; way++) {
		const struct interp_build_word w = { .line = 7, .rapid = true };
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		double end[INTERP_NAXES] = { [INTERP_X] = way - 100 };
		struct interp_diag d;

		x_by(b, -100, INTERP_SEG_PROBE);
		/* More than are looked at in one cycle. */
		for (int i = 0; i < 1000; i++)
			x_by(b, i % 2 ? -0.01 : 0.01, 0);
		assert_int_equal(interp_build_line(b, end, &w, &d), 0);
		x_by(b, -10, 0);
		rest_fits_if(b, way == 201);
	}
}

/* Its ends are in the travel.  It comes to 200, or farther. */
static void test_of_an_arc_the_farthest_place_counts(void **state)
{
	(void)state;
	for (int clockwise = 0; clockwise < 2; clockwise++) {
		for (int more = 0; more < 2; more++) {
			const struct interp_build_word w = {
				.line = 7, .rapid = true,
			};
			struct interp_build_arc a = {
				.axis_a = INTERP_X, .axis_b = INTERP_Y,
				.centre_a_mm = 91 + more, .centre_b_mm = 0,
			};
			const double end[INTERP_NAXES] = {
				[INTERP_X] = 91 + more,
				[INTERP_Y] = clockwise ? -10 : 10,
			};
			struct interp_build *b = begin(INTERP_SIMULTANEOUS);
			struct interp_diag d;

			x_by(b, -100, INTERP_SEG_PROBE);
			xy_to(b, 91 + more, -end[INTERP_Y]);
			arc_turn(&a, b, end, clockwise);
			assert_int_equal(interp_build_arc(b, end, &a, &w, &d),
					 0);
			rest_fits_if(b, !more);
		}
	}
}

/* -- Interruptions -------------------------------------------------------- */

static void hold_after(int cycles, uint64_t *s)
{
	const struct cycle_config k = probe_config();
	struct world w;

	load(&w, two_probes(true), &k);
	w.low = -(int32_t)(200 + rnd(s) % 1500);
	w.high = 800;
	for (int i = 0; i < cycles && w.r.c.state != STATE_IDLE; i++)
		feel(&w);
	if (w.r.c.state != STATE_IDLE) {
		tell(&w.r, CYCLE_HOLD);
		for (int i = 0; i < 200; i++)
			feel(&w);
		assert_int_equal(w.r.c.state, STATE_HOLD);
		assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
	}
	feel_until(&w, STATE_IDLE, 30000);
	assert_int_equal(w.r.c.fault.first, FAULT_NONE);
	assert_true(abs(w.r.out.target[INTERP_X] - (w.low + w.high) / 2) <= 1);
	rig_free(&w.r);
}

static void test_a_hold_anywhere_in_it_changes_nothing(void **state)
{
	uint64_t s = 3;

	(void)state;
	for (int i = 0; i < 150; i++)
		hold_after((int)(rnd(&s) % 6000), &s);
}

static void test_an_estop_stands_at_once(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-10), &k);
	w.low = -3000;
	for (int i = 0; i < 500; i++)
		feel(&w);
	w.r.in.estop = true;
	step(&w.r, OPEN_V);
	assert_int_equal(w.r.c.state, STATE_FAULT);
	assert_false(w.r.out.sense);
	w.r.in.estop = false;
	step(&w.r, OPEN_V);
	assert_int_equal(tell(&w.r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
	feel_until(&w, STATE_IDLE, 20000);
	assert_int_equal(w.r.out.target[INTERP_X], 2000);
	rig_free(&w.r);
}

/* What comes behind takes several cycles to look at; its last line leaves the
 * travel if @leaves. */
static struct interp_build *long_rest(uint8_t ends, bool leaves)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	x_by(b, -400, ends);
	for (int i = 0; i < 2000; i++)
		x_by(b, i % 2 ? -0.01 : 0.01, 0);
	x_by(b, leaves ? -500 : 1, 0);
	return b;
}

static bool is_looking(const struct world *w)
{
	return w->r.c.state == STATE_PROBE &&
	       w->r.c.probe.phase == PROBE_LOOK;
}

static void come_to_the_look(struct world *w)
{
	for (int n = 0; n < 20000 && !is_looking(w); n++)
		feel(w);
	assert_true(is_looking(w));
}

static void interrupt(struct world *w, bool by_estop)
{
	if (!by_estop) {
		tell(&w->r, CYCLE_HOLD);
		for (int i = 0; i < 50; i++)
			feel(w);
		assert_int_equal(w->r.c.state, STATE_HOLD);
		return;
	}
	w->r.in.estop = true;
	step(&w->r, OPEN_V);
	assert_int_equal(w->r.c.state, STATE_FAULT);
	w->r.in.estop = false;
	step(&w->r, OPEN_V);
	assert_int_equal(tell(&w->r, CYCLE_RESET), ANSWER_DONE);
}

static void interrupt_the_look(uint8_t ends, bool leaves, bool by_estop)
{
	const struct cycle_config k = probe_config();
	struct world w;

	load(&w, long_rest(ends, leaves), &k);
	w.low = ends == INTERP_SEG_PROBE ? -1000 : -NO_WALL;
	/* After a reset and another start the same. */
	for (int again = 0; again < 2; again++) {
		come_to_the_look(&w);
		interrupt(&w, by_estop);
		assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
		feel_until(&w, leaves ? STATE_FAULT : STATE_IDLE, 90000);
		if (!leaves)
			break;
		assert_int_equal(w.r.c.fault.first, FAULT_SOFT_LIMIT);
		assert_int_equal(w.r.out.target[INTERP_X],
				 ends == INTERP_SEG_PROBE ? -1000 : -199999);
		assert_int_equal(tell(&w.r, CYCLE_RESET), ANSWER_DONE);
		assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
	}
	rig_free(&w.r);
}

static void test_an_interrupted_look_is_made_again(void **state)
{
	(void)state;
	for (int i = 0; i < 8; i++)
		interrupt_the_look(i & 1 ? INTERP_SEG_PROBE : INTERP_SEG_LIMIT,
				   i & 2, i & 4);
}

static void test_no_way_back_leads_over_a_contact(void **state)
{
	const struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	load(&w, one_probe(-10), &k);
	w.low = -500;
	while (w.r.out.target[INTERP_X] < 1000)
		feel(&w);
	tell(&w.r, CYCLE_HOLD);
	for (int i = 0; i < 200; i++)
		feel(&w);
	assert_int_equal(tell_mm(&w.r, CYCLE_RETRACT, 1000), ANSWER_DONE);
	for (int i = 0; i < 3000; i++)
		feel(&w);
	assert_int_equal(w.r.out.target[INTERP_X], -500);
	assert_int_equal(tell(&w.r, CYCLE_START), ANSWER_DONE);
	feel_until(&w, STATE_IDLE, 20000);
	assert_int_equal(w.r.out.target[INTERP_X], 4500);
	rig_free(&w.r);
}

/* A cut before it and a cut behind it; M3 is on all the time. */
static void test_a_cut_leads_into_a_probe_and_out_of_it(void **state)
{
	const struct cycle_config k = probe_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct world w;
	int sensed = 0;

	(void)state;
	cut_to(b, -1);
	x_by(b, -10, INTERP_SEG_PROBE);
	x_by(b, 1, 0);
	cut_to(b, -2);
	load(&w, b, &k);
	w.low = -400;
	for (int i = 0; i < 60000 && w.r.c.state != STATE_IDLE; i++) {
		const bool sense = w.r.out.sense;

		sensed += sense;
		step(&w.r, sense ? (against(&w) ? SHORTED_V : OPEN_V) :
			   w.r.out.power ? SPARKING_V : OPEN_V);
		if (w.r.c.state == STATE_PROBE)
			assert_int_equal(w.r.out.target[INTERP_Z], -1000);
	}
	assert_int_equal(w.r.c.outcome, OUTCOME_DONE);
	assert_true(sensed > SETTLE);
	assert_int_equal(w.r.out.target[INTERP_X], 600);
	assert_int_equal(w.r.out.target[INTERP_Z], -2000);
	rig_free(&w.r);
}

static void test_a_dry_run_probes_nothing_and_goes_nowhere(void **state)
{
	struct cycle_config k = probe_config();
	struct world w;

	(void)state;
	k.dry_run = true;
	load(&w, one_probe(-100), &k);
	feel_until(&w, STATE_IDLE, 5000);
	assert_int_equal(w.r.c.outcome, OUTCOME_DONE);
	assert_int_equal(w.r.out.target[INTERP_X], 5000);
	rig_free(&w.r);
}

/* -- Programs that lie ---------------------------------------------------- */

static void test_an_arc_cannot_end_at_contact(void **state)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double end[INTERP_NAXES] = { 2, 0 };
	struct interp_seg seg;
	struct made m;

	(void)state;
	arc(b, end, 1, 0, false);
	m = finish(b);
	seg = m.p.segs[1];
	assert_true(interp_program_seg_ok(&m.p, 1, &seg));
	seg.flags |= INTERP_SEG_PROBE;
	assert_false(interp_program_seg_ok(&m.p, 1, &seg));
	unmake(&m);
}

static void test_a_probe_along_two_axes_is_refused(void **state)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = true, .ends = INTERP_SEG_PROBE,
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double end[INTERP_NAXES] = { 1, 1 };
	struct interp_diag d;

	(void)state;
	assert_int_equal(interp_build_line(b, end, &w, &d), -EINVAL);
	assert_non_null(strstr(d.found, "several axes"));
	interp_build_destroy(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_what_follows_counts_from_the_contact),
		cmocka_unit_test(test_the_axes_never_step_where_the_rest_is_left_out),
		cmocka_unit_test(test_it_goes_no_deeper_than_a_cycle_at_its_feed),
		cmocka_unit_test(test_without_a_way_back_the_first_contact_counts),
		cmocka_unit_test(test_half_is_the_middle_between_two_contacts),
		cmocka_unit_test(test_a_half_without_two_contacts_is_a_fault),
		cmocka_unit_test(test_something_in_the_way_of_a_half_is_a_contact),
		cmocka_unit_test(test_a_limit_ends_where_the_travel_does),
		cmocka_unit_test(test_no_contact_by_its_end_is_a_fault),
		cmocka_unit_test(test_no_contact_by_the_travels_end_is_a_fault),
		cmocka_unit_test(test_contact_to_begin_with_is_a_fault),
		cmocka_unit_test(test_a_contact_that_does_not_open_is_a_fault),
		cmocka_unit_test(test_feeling_blindly_is_a_fault),
		cmocka_unit_test(test_soft_limits_are_of_the_axes_not_of_the_program),
		cmocka_unit_test(
			test_leaving_the_travel_is_told_at_the_contact),
		cmocka_unit_test(test_of_an_arc_the_farthest_place_counts),
		cmocka_unit_test(test_a_hold_anywhere_in_it_changes_nothing),
		cmocka_unit_test(test_an_estop_stands_at_once),
		cmocka_unit_test(test_an_interrupted_look_is_made_again),
		cmocka_unit_test(test_no_way_back_leads_over_a_contact),
		cmocka_unit_test(test_a_cut_leads_into_a_probe_and_out_of_it),
		cmocka_unit_test(test_a_dry_run_probes_nothing_and_goes_nowhere),
		cmocka_unit_test(test_an_arc_cannot_end_at_contact),
		cmocka_unit_test(test_a_probe_along_two_axes_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
