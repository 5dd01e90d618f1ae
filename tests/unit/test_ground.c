/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_ground.c - a short while positioning: over ground that was cut it is
 * debris, anywhere else a collision
 */
#include "interp/angle.h"
#include "compile_help.h"

#undef assert_near			/* not with a fixed bound */
#include "cycle_help.h"

static void to(struct interp_build *b, double x, double z, bool rapid)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .rapid = rapid,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_X] = x;
	end[INTERP_Z] = z;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* Down a slanted hole, over its top by an arc, out again, and beside it. */
static void begin_way_out(struct rig *r, const struct cycle_config *k)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	to(b, 0, -1, true);
	to(b, 0.5, -3, false);
	to(b, 0, -1, true);
	to(b, 3, -1, true);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	until(r, STATE_APPROACH, OPEN_V, 2000);
	for (int i = 0; i < 20000 && r->c.state != STATE_TRAVEL; i++)
		step(r, SPARKING_V);
	assert_int_equal(r->c.state, STATE_TRAVEL);
}

static void a_short_on_the_way_out_of_a_cut_is_a_retract(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	steps(&r, OPEN_V, 20);
	for (int n = 0; n < 3; n++) {
		assert_int_equal(r.c.state, STATE_TRAVEL);
		steps(&r, SHORTED_V, 5);
		assert_int_equal(r.c.state, STATE_RETRACT);
		until(&r, STATE_TRAVEL, OPEN_V, 200);
		steps(&r, OPEN_V, 20);
	}
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.totals.retracts, 3);
	rig_free(&r);
}

/* X and Z lag by 1/30 s and are led. */
static struct cycle_config led(void)
{
	struct cycle_config k = usual_config();

	k.contouring = (struct contouring_config) {
		.methods = INTERP_COMPENSATE_FEEDFORWARD,
		.axes = 1u << INTERP_X | 1u << INTERP_Z, .ahead = 2,
		.gains = { .velocity = 1, .lead_periods = 0.5 },
	};
	for (int i = 0; i < INTERP_NAXES; i++) {
		k.contouring.pulse_mm[i] = PULSE_MM;
		k.contouring.loop[i] = (struct interp_axis_loop) {
			.gain_1_s = 30, .velocity_hz = 60, .damping = 0.7,
		};
		k.contouring.most_mm[i] = 80 / 30.0;
	}
	return k;
}

static void axes_with_a_lead_brake_before_they_retract(void **st)
{
	const struct cycle_config k = led();
	int32_t leap = 0;
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	steps(&r, OPEN_V, 40);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	assert_true(r.c.mover.v_mm_s > 1);
	assert_false(contouring_rests(&r.c.contouring));
	for (int n = 0; n < 300 && r.c.state == STATE_TRAVEL; n++) {
		step(&r, SHORTED_V);
		for (int i = 0; i < INTERP_NAXES; i++)
			leap = (int32_t)fmax(leap, abs(r.out.target[i] -
						       r.before.target[i]));
	}
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_true(contouring_rests(&r.c.contouring));
	/* As far as it goes in a cycle at this speed, and no farther. */
	assert_true(leap < 100);
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* It brakes, and comes over ground that was not cut: a collision after all. */
static void with_a_lead_too_new_ground_is_a_collision(void **st)
{
	const struct cycle_config k = led();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	for (int n = 0; n < 2000 && r.out.target[INTERP_X] < 1000; n++)
		step(&r, OPEN_V);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

static void on_new_ground_it_is_a_collision(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_way_out(&r, &k);
	for (int n = 0; n < 2000 && r.out.target[INTERP_X] < 1000; n++)
		step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* Out over the arc that was cut, against its sense. */
static void over_an_arc_that_was_cut_it_is_a_retract(void **st)
{
	const struct cycle_config k = usual_config();
	const double there[INTERP_NAXES] = { 2, 0 }, back[INTERP_NAXES] = { 0 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .centre_a_mm = 1,
		.sweep = ANGLE_TURN / 2,
	};
	const struct interp_build_word w = { .line = 1, .rapid = true };
	struct interp_diag d;
	struct rig r;

	(void)st;
	arc(b, there, 1, 0, true);
	assert_int_equal(interp_build_arc(b, back, &a, &w, &d), 0);
	rig_load(&r, b, &k);
	tell(&r, CYCLE_START);
	until(&r, STATE_APPROACH, OPEN_V, 2000);
	for (int i = 0; i < 20000 && r.c.state != STATE_TRAVEL; i++)
		step(&r, SPARKING_V);
	steps(&r, OPEN_V, 30);
	steps(&r, SHORTED_V, 5);
	assert_int_equal(r.c.state, STATE_RETRACT);
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* -- Programs as texts ----------------------------------------------------- */

struct way_out {
	const char *text;
	enum interp_strategy strategy;
	uint32_t tolerance_milli;
	bool wire;
};

static void load_text(struct rig *r, const struct way_out *w,
		      const struct cycle_config *k)
{
	static const struct interp_wire wire = {
		.guides = INTERP_GUIDES_RELATIVE, .z_lower_mm = -20,
		.z_upper_mm = 80, .z_second_mm = 40, .angle_max_deg = 30,
		.corner_angle_deg = 180,
	};
	struct compiled c = compile_ready("generic");

	c.bo.strategy = w->strategy;
	c.bo.tolerance_milli = w->tolerance_milli;
	c.o.nc.wire = w->wire ? &wire : NULL;
	compile(&c, w->text);
	rig_take(r, (struct made) { .block = c.block, .p = c.p }, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static void every_way_back_over_what_was_cut_may_short(void **st)
{
	static const struct way_out ways[] = {
		{ "F300\nG6.2 P3 K0 X0 Y0\nK0 X1 Y1\nK0 X2 Y0\nK1\nK1\nK1\nM5\n"
		  "G6.2 P3 K0 X2 Y0\nK0 X1 Y1\nK0 X0 Y0\nK1\nK1\nK1\nM2\n",
		  INTERP_SIMULTANEOUS, 0, false },
		{ "F300\nG1 X2 Y1 U2.5 V0.5\nM5\nG1 X0 Y0 U0 V0\nM2\n",
		  INTERP_POINT_BY_POINT, 0, true },
		{ "F300\nG1 X0 Y0 U0.5\nG3 X1 Y1 I1 J0 : G3 X1.5 Y1 I1 J0\nM5\n"
		  "G2 X0 Y0 I0 J-1 : G2 X0.5 Y0 I0 J-1\nM2\n",
		  INTERP_POINT_BY_POINT, 0, true },
		{ "F300\nG1 X2 Y1\nM5\nG1 X0 Y0\nM2\n",
		  INTERP_MIN_SWITCH, 20000, false },
		{ "F300\nG3 X0 Y0 I1 J0 Z1 C20.\nM5\n"
		  "G2 X0 Y0 I1 J0 Z0 C0.\nM2\n", INTERP_SIMULTANEOUS,
		  0, false },
		{ "F300\nG0 Z0.1\nG130 Z-0.5 R0.3 Q0.1 P1\nM2\n",
		  INTERP_SIMULTANEOUS, 0, false },
	};
	const struct cycle_config k = usual_config();

	(void)st;
	for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
		bool cut = false;
		struct rig r;

		load_text(&r, &ways[i], &k);
		for (int n = 0; n < 40000 && r.c.state != STATE_IDLE; n++) {
			const bool out = cut && r.c.state == STATE_TRAVEL;

			cut = cut || r.c.state == STATE_ERODE;
			step(&r, out && n % 100 < 5 ? SHORTED_V :
				 state_duty[r.c.state].power ? SPARKING_V :
							       OPEN_V);
			if (r.c.fault.first != FAULT_NONE)
				fail_msg("%s: at %f", ways[i].text, place(&r));
		}
		if (r.c.outcome != OUTCOME_DONE || r.c.totals.retracts < 3)
			fail_msg("%s: at %f, %u retracts", ways[i].text,
				 place(&r), r.c.totals.retracts);
		rig_free(&r);
	}
}

/* The helix is left out by its time: what it would have cut is not cut. */
static void what_a_time_left_out_is_new_ground(void **st)
{
	static const struct way_out w = {
		"F300\nG0 Z0.1\nG130 Z-0.5 R0.3 Q0.1 P1 S0.05\n"
		"G0 X0.3 Z-0.3\nM2\n",
		INTERP_SIMULTANEOUS, 0, false
	};
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	load_text(&r, &w, &k);
	for (int n = 0; n < 5000 && r.out.target[INTERP_X] < 299; n++)
		step(&r, state_duty[r.c.state].power ? SPARKING_V : OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* Out of a cut with a way out beside the path; it stands on the way, too. */
static void load_air(struct rig *r, const struct cycle_config *k)
{
	const struct interp_escape aside = {
		.out = 1u << INTERP_X, .out_mm = { 1 },
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -1);
	cut_to(b, -2);
	assert_int_equal(interp_build_escape(b, &aside), 0);
	rapid_to(b, -1.5);
	action(b, INTERP_DWELL, 100);
	rapid_to(b, -1);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	until(r, STATE_APPROACH, OPEN_V, 1000);
	until(r, STATE_TRAVEL, SPARKING_V, 20000);
}

/* Whatever the gap says on its way back, and wherever a short comes. */
static void nothing_sparks_over_what_is_positioned(void **st)
{
	struct cycle_config k = usual_config();

	(void)st;
	for (int i = 0; i < 40; i++) {
		bool beside = false;
		struct rig r;

		k.gap.retract_escape = i % 2 != 0;
		load_air(&r, &k);
		steps(&r, OPEN_V, 10 + 5 * i);
		steps(&r, SHORTED_V, i % 5 + 1);
		assert_int_equal(r.c.state, STATE_RETRACT);
		for (int n = 0; n < 20000 && r.c.state != STATE_IDLE; n++) {
			step(&r, r.c.state == STATE_RETRACT ? OPEN_V :
				 i % 3 ? NARROW_V : SPARKING_V);
			assert_false(r.out.power);
			beside = beside || escape_is_out(&r.c.escape);
		}
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		assert_true(i % 2 == 0 || i % 5 < 3 || beside);
		rig_free(&r);
	}
}

/* Cut, a way without power, cut; between them actions. */
static void load_off(struct rig *r, const struct cycle_config *k, bool dwells)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	cut_to(b, -1);
	action(b, INTERP_AUX, INTERP_AUX_POWER_OFF);
	cut_to(b, -1.2);
	if (dwells)
		action(b, INTERP_DWELL, 20);
	action(b, INTERP_AUX, INTERP_AUX_POWER_POSITIVE);
	if (dwells)
		action(b, INTERP_DWELL, 20);
	cut_to(b, -2);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

/* Also where a retract comes back over M3 and M5, or ends just there. */
static void nothing_sparks_over_what_m5_positions(void **st)
{
	struct cycle_config k = usual_config();
	uint32_t back = 0;

	(void)st;
	for (int i = 0; i < 120; i++) {
		struct rig r;

		k.gap.retract_to = i % 3 == 2 ? RETRACT_MOTION : RETRACT_LIMIT;
		load_off(&r, &k, i % 2);
		for (int n = 0; n < 20000 && (z_mm(&r) > -1.2 ||
					      !r.out.power); n++)
			step(&r, SPARKING_V);
		steps(&r, SPARKING_V, i / 20);
		steps(&r, SHORTED_V, i % 50);
		for (int n = 0; n < 40000 && r.c.state != STATE_IDLE; n++) {
			step(&r, r.c.state == STATE_RETRACT ? OPEN_V :
				 i % 4 && n < 400 ? NARROW_V : SPARKING_V);
			if (z_mm(&r) < -1.0005 && z_mm(&r) > -1.1995) {
				assert_false(r.out.power);
				back++;
			}
		}
		assert_int_equal(r.c.outcome, OUTCOME_DONE);
		rig_free(&r);
	}
	assert_true(back > 100);
}

/* A retract goes back beyond the first place of the cut. */
static void back_over_what_it_left_it_may_short(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 1.1);
	steps(&r, SHORTED_V, 100);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_true(place(&r) < 0.8);
	until(&r, STATE_TRAVEL, OPEN_V, 200);
	steps(&r, OPEN_V, 10);
	assert_true(place(&r) < 0.8);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	/* After a start nobody knows who was there. */
	steps(&r, OPEN_V, 10);
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, 100);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	steps(&r, OPEN_V, 10);
	assert_true(place(&r) < 0.9);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* Held, led back over the rapid to 0.9, and started: the place where a short
 * comes next. */
static void short_before_cut(struct rig *r, double cut_mm, double short_mm)
{
	const struct cycle_config k = usual_config();

	cut_at(r, &k, cut_mm);
	tell(r, CYCLE_HOLD);
	steps(r, OPEN_V, 100);
	assert_int_equal(tell_mm(r, CYCLE_RETRACT, place(r) - 0.9),
			 ANSWER_DONE);
	steps(r, OPEN_V, 1000);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
	for (int n = 0; n < 1000 && place(r) < short_mm; n++)
		step(r, OPEN_V);
	assert_int_equal(r->c.state, STATE_TRAVEL);
	step(r, SHORTED_V);
}

/* The first place of a cut that has begun is cut ground, within two pulses. */
static void before_a_cut_that_has_begun_it_may_short(void **st)
{
	struct rig r;

	(void)st;
	short_before_cut(&r, 1.3, 0.9985);
	assert_true(place(&r) < 1);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.state, STATE_RETRACT);
	until(&r, STATE_ERODE, r.c.gap.servo_v, 2000);
	rig_free(&r);
	short_before_cut(&r, 1.3, 0.98);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* Started while it still moves, in the cut. */
static void in_the_cut_itself_it_may_short(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	cut_at(&r, &k, 2);
	steps(&r, SHORTED_V, 20);
	tell(&r, CYCLE_HOLD);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	step(&r, OPEN_V);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.state, STATE_RETRACT);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	rig_free(&r);
}

/* After M5 nothing sparks, wherever an operator leads it back to. */
static void after_m5_the_cut_is_still_cut_ground(void **st)
{
	static const struct way_out w = {
		"F300\nG1 X2\nM5\nG1 X2 Y1\nM2\n", INTERP_SIMULTANEOUS, 0,
		false
	};
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	load_text(&r, &w, &k);
	until(&r, STATE_APPROACH, OPEN_V, 1000);
	until(&r, STATE_TRAVEL, SPARKING_V, 20000);
	steps(&r, OPEN_V, 50);
	tell(&r, CYCLE_HOLD);
	steps(&r, OPEN_V, 100);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, place(&r) - 1),
			 ANSWER_DONE);
	steps(&r, OPEN_V, 1000);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	steps(&r, OPEN_V, 20);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	assert_true(place(&r) < 1.9);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.state, STATE_RETRACT);
	rig_free(&r);
}

/* A retract led to the start of the program, in the air. */
static void at_the_start_it_is_a_collision(void **st)
{
	struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	k.gap.retract_to = RETRACT_START;
	cut_at(&r, &k, 1.3);
	steps(&r, SHORTED_V, 2000);
	assert_int_equal(r.c.fault.first, FAULT_RETRACT_AT_START);
	assert_int_equal(r.c.cursor.seg.kind, INTERP_BEGIN);
	step(&r, OPEN_V);
	assert_int_equal(tell(&r, CYCLE_RESET), ANSWER_DONE);
	assert_int_equal(tell_mm(&r, CYCLE_OVERRIDE, 0), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	steps(&r, OPEN_V, 10);
	assert_int_equal(r.c.state, STATE_TRAVEL);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
}

/* -- Beside hundreds of curves ------------------------------------------- */

static uint32_t looked;			/* in this cycle */

bool __real_interp_program_any_at(const struct interp_program *p, uint32_t i,
				  double s_mm, struct interp_at_curve *last,
				  struct interp_contour_point *ret);
bool __wrap_interp_program_any_at(const struct interp_program *p, uint32_t i,
				  double s_mm, struct interp_at_curve *last,
				  struct interp_contour_point *ret);

bool __wrap_interp_program_any_at(const struct interp_program *p, uint32_t i,
				  double s_mm, struct interp_at_curve *last,
				  struct interp_contour_point *ret)
{
	looked++;
	return __real_interp_program_any_at(p, i, s_mm, last, ret);
}

#define CURVES		44		/* of 11 pieces each */

/* Curves that hardly leave the place, where C turns to and fro. Nothing says
 * how far C is from them but a look at every pulse. */
static void begin_beside_curves(struct rig *r, const struct cycle_config *k,
				double first_c)
{
	char *text;
	size_t size;
	FILE *f = open_memstream(&text, &size);

	assert_non_null(f);
	fprintf(f, "G21 G90 F6000\nM3\nG0 Z0.1\nG1 Z0\nG1 C%g\nG1 C0\n",
		first_c);
	for (int i = 0; i < CURVES; i++) {
		const bool back = i % 2 != 0;

		fprintf(f, "G6.2 P4 K0 X%g C%g\nK0 X0 C1\nK0 X0.002 C2\n"
			"K0 X%g C%g\nK1\nK1\nK1\nK1\n",
			back ? 0.002 : 0.0, back ? 3.0 : 0.0,
			back ? 0.0 : 0.002, back ? 0.0 : 3.0);
	}
	fputs("G0 C-60\nM2\n", f);
	assert_int_equal(fclose(f), 0);
	load_text(r, &(struct way_out) { text, INTERP_SIMULTANEOUS, 0, false },
		  k);
	free(text);
	for (int n = 0; n < 1000000 && (r->out.target[INTERP_C] > -1000 ||
					r->c.state != STATE_TRAVEL ||
					r->c.cursor.index < CURVES); n++)
		step(r, state_duty[r->c.state].power ? SPARKING_V : OPEN_V);
	assert_int_equal(r->c.state, STATE_TRAVEL);
}

/* Until it is known what the short is. Return: the most looks of a cycle. */
static uint32_t most_looks(struct rig *r)
{
	uint32_t most = 0, sum = 0;

	for (int n = 0; n < 1000 && r->c.state == STATE_TRAVEL &&
	     r->c.fault.first == FAULT_NONE; n++) {
		looked = 0;
		step(r, SHORTED_V);
		most = looked > most ? looked : most;
		sum += looked;
		/* It brakes for as long as it does not know. */
		if (r->c.state == STATE_TRAVEL)
			assert_true(r->c.mover.kind == MOVER_TO_SPEED &&
				    r->c.mover.goal == 0);
	}
	/* There was a lot to look at. */
	assert_true(sum > 20000);
	return most;
}

static void beside_hundreds_of_curves_a_cycle_looks_at_few(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_beside_curves(&r, &k, 0);
	assert_true(most_looks(&r) <= GROUND_LOOKS_MAX);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	rig_free(&r);
	/* It was cut before all of them: no collision, however long it took. */
	begin_beside_curves(&r, &k, -4);
	assert_true(most_looks(&r) <= GROUND_LOOKS_MAX);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	assert_int_equal(r.c.state, STATE_RETRACT);
	until(&r, STATE_IDLE, OPEN_V, 20000);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

/* What it met is a collision, also if it is gone when that is known. */
static void a_short_that_goes_while_it_looks_is_a_collision(void **st)
{
	const struct cycle_config k = usual_config();
	struct rig r;

	(void)st;
	begin_beside_curves(&r, &k, 0);
	step(&r, SHORTED_V);
	assert_int_equal(r.c.fault.first, FAULT_NONE);
	steps(&r, OPEN_V, 1000);
	assert_int_equal(r.c.fault.first, FAULT_CONTACT);
	assert_true(r.out.target[INTERP_C] > -30000);
	rig_free(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_on_the_way_out_of_a_cut_is_a_retract),
		cmocka_unit_test(axes_with_a_lead_brake_before_they_retract),
		cmocka_unit_test(with_a_lead_too_new_ground_is_a_collision),
		cmocka_unit_test(on_new_ground_it_is_a_collision),
		cmocka_unit_test(over_an_arc_that_was_cut_it_is_a_retract),
		cmocka_unit_test(every_way_back_over_what_was_cut_may_short),
		cmocka_unit_test(what_a_time_left_out_is_new_ground),
		cmocka_unit_test(nothing_sparks_over_what_is_positioned),
		cmocka_unit_test(nothing_sparks_over_what_m5_positions),
		cmocka_unit_test(back_over_what_it_left_it_may_short),
		cmocka_unit_test(before_a_cut_that_has_begun_it_may_short),
		cmocka_unit_test(in_the_cut_itself_it_may_short),
		cmocka_unit_test(after_m5_the_cut_is_still_cut_ground),
		cmocka_unit_test(at_the_start_it_is_a_collision),
		cmocka_unit_test(beside_hundreds_of_curves_a_cycle_looks_at_few),
		cmocka_unit_test(a_short_that_goes_while_it_looks_is_a_collision),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
