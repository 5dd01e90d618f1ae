/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_asking.c - no spark before the condition of the place is in force
 */
#include "cycle_help.h"
#include "seed.h"

#define SETTLE		5
#define DARK		7
#define SLOW_MAX	40		/* periods until the generator has it */

/* A generator that needs some periods for what it is asked. */
struct slow {
	double now[INTERP_NGENERATOR], next[INTERP_NGENERATOR];
	uint32_t asked;
	int left;			/* periods until next; -1: it has */
	uint64_t seed;
	int most;			/* periods that it needs */
	int dark;			/* periods without sparks */
	uint64_t sparks, changes;
	bool restless;			/* it loses its values, lies, falls
					 * silent: and is seen to */
	uint64_t troubles;
};

static void give_steps(struct process_delivers *d, double step, double max)
{
	*d = (struct process_delivers) {
		.there = true, .min = step, .max = max, .step = step
	};
}

static struct cycle_config limited_config(bool answers)
{
	struct cycle_config k = usual_config();
	struct asking_config *a = &k.asking;

	a->limited = true;
	a->answers = answers;
	a->settle_cycles = SETTLE;
	a->polarity_cycles = DARK;
	give_steps(&a->field[INTERP_TECH_PEAK_A], 3, 21);
	give_steps(&a->field[INTERP_TECH_ON_US], 1, 100);
	give_steps(&a->field[INTERP_TECH_OFF_US], 1, 6000);
	a->field[INTERP_TECH_POLARITY] = (struct process_delivers) {
		.there = true, .n = 2, .value = { -1, 1 }
	};
	return k;
}

static struct interp_tech tech_of(double peak_a, double on_us, double polarity)
{
	struct interp_tech t;

	interp_tech_clear(&t);
	t.v[INTERP_TECH_PEAK_A] = peak_a;
	t.v[INTERP_TECH_ON_US] = on_us;
	t.v[INTERP_TECH_POLARITY] = polarity;
	return t;
}

static void cut_in(struct interp_build *b, double z_mm, uint32_t number,
		   const struct interp_tech *tech)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 10, .tech = tech,
		.cond_letter = 'C', .cond_number = number,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	end[INTERP_Z] = z_mm;
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

/* Cuts of @way_mm each, and conditions that differ in all, or in part. */
static void rig_conds(struct rig *r, const struct cycle_config *k,
		      double way_mm, int n)
{
	const struct interp_tech t[] = {
		tech_of(6, 8, NAN), tech_of(15, 20, -1), tech_of(15, 40, -1),
		tech_of(7, NAN, 1), tech_of(21, 8, 1),
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	for (int i = 0; i < n; i++)
		cut_in(b, -way_mm * (i + 1), (uint32_t)(i % 5), &t[i % 5]);
	rig_load(r, b, k);
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static bool same(double a, double b)
{
	return a == b || (isnan(a) && isnan(b));
}

/* What the place wants, as the generator can do it. */
static double wanted(const struct rig *r, int i)
{
	const struct interp_cond *c = cond_cut(&r->c.cursor);

	if (i == INTERP_TECH_POLARITY && isnan(c->tech.v[i]))
		return 1;
	return process_nearest(&r->c.config.asking.field[i], i, c->tech.v[i]);
}

static void check_spark(const struct rig *r, struct slow *g)
{
	g->dark = r->out.power ? 0 : g->dark + 1;
	if (!r->out.power)
		return;
	g->sparks++;
	for (int i = 0; i < INTERP_NGENERATOR; i++) {
		assert_true(same(r->out.pulse[i], wanted(r, i)));
		assert_true(same(g->now[i], wanted(r, i)));
	}
}

/* The generator hears this period's outputs, and has some of them by now. */
static void generate(struct rig *r, struct slow *g)
{
	if (r->out.asked != g->asked) {
		assert_true(g->dark >= 1 + (g->sparks > 0));
		if ((r->out.pulse[INTERP_TECH_POLARITY] < 0) !=
		    (g->next[INTERP_TECH_POLARITY] < 0))
			assert_true(g->dark >= DARK);
		g->asked = r->out.asked;
		memcpy(g->next, r->out.pulse, sizeof(g->next));
		g->left = (int)(rnd(&g->seed) % (uint64_t)(g->most + 1));
		g->changes++;
	}
	if (g->left == 0) {
		memcpy(g->now, g->next, sizeof(g->now));
		r->in.generator.in_force = g->asked;
	}
	g->left -= g->left >= 0;
}

/* What an interface makes of it: trouble until a reset, and then what was in
 * force must be told again. */
static void fail_at_times(struct rig *r, struct slow *g)
{
	struct io_generator *says = &r->in.generator;

	if (r->out.reset && says->trouble) {
		says->trouble = false;
		says->in_force = r->out.asked - 1;
		memcpy(g->next, r->out.pulse, sizeof(g->next));
		g->asked = r->out.asked;
		g->left = (int)(rnd(&g->seed) % (uint64_t)(g->most + 1));
	} else if (!says->trouble && rnd(&g->seed) % 500 == 0) {
		says->trouble = true;
		g->left = -1;
		g->troubles++;
		for (int i = 0; i < INTERP_NGENERATOR; i++)
			g->now[i] = 999;
	}
}

static struct slow slow_of(uint64_t seed, int most)
{
	struct slow g = { .seed = seed, .most = most, .left = -1 };

	for (int i = 0; i < INTERP_NGENERATOR; i++)
		g.now[i] = g.next[i] = (double)NAN;
	return g;
}

/* Where it waits for the generator, there is no voltage on the gap. */
static void period(struct rig *r, struct slow *g, double gap_v)
{
	step(r, asking_waits(&r->c) ? 0 : gap_v);
	check_spark(r, g);
	generate(r, g);
	if (g->restless)
		fail_at_times(r, g);
}

/* A gap that is mostly good, and an operator who holds and goes back. */
static void random_period(struct rig *r, struct slow *g)
{
	static const double volts[] = {
		SPARKING_V, OPEN_V, NARROW_V, SHORTED_V
	};
	const uint64_t x = rnd(&g->seed) % 1000;
	const bool stands = r->c.state == STATE_HOLD && !r->c.hold.moving;

	if (x < 3)
		tell(r, CYCLE_HOLD);
	else if (x < 6 && stands)
		tell_mm(r, CYCLE_RETRACT, 0.3);
	else if (x < 60 && stands)
		tell(r, CYCLE_START);
	else if (r->c.state == STATE_FAULT)
		tell(r, CYCLE_RESET);
	period(r, g, volts[x < 900 ? x % 2 : 2 + x % 2]);
}

/* Return: changes of what is asked for. */
static uint64_t random_job(uint64_t seed, bool answers, int periods,
			   uint64_t *troubles)
{
	struct cycle_config k = limited_config(answers);
	struct slow g = slow_of(seed, answers ? SLOW_MAX : SETTLE);
	struct rig r;

	g.restless = answers && rnd(&g.seed) % 2;
	k.jump.height_mm = rnd(&g.seed) % 2 ? 0.4 : 0;
	k.jump.every.cycles = 60;
	rig_conds(&r, &k, 0.1 + 0.01 * (double)(rnd(&g.seed) % 20), 400);
	for (int i = 0; i < periods && r.c.loaded; i++)
		random_period(&r, &g);
	assert_true(g.sparks > 0);
	*troubles += g.troubles;
	rig_free(&r);
	return g.changes;
}

static void never_a_spark_with_another_condition_than_the_places(void **state)
{
	const char *text = getenv("EDM_RUNS");
	const int rounds = text ? atoi(text) : SEED_ROUNDS(200);
	uint64_t seed = seed_take(), changes = 0, troubles = 0;

	(void)state;
	for (int i = 0; i < rounds; i++)
		changes += random_job(rnd(&seed), i % 2, 5000, &troubles);
	assert_true(changes > 10 * (uint64_t)rounds);
	assert_true(rounds < 20 || troubles > 0);
}

/* Periods from the change to the first spark. */
static int wait_of(bool answers, int most)
{
	struct cycle_config k = limited_config(answers);
	struct slow g = slow_of(1, most);
	struct rig r;
	int n = 0;

	k.gap.retract_limit_mm = 2;
	rig_conds(&r, &k, 1, 3);
	while (r.c.cursor.seg.cond == 0 || !r.out.power)
		period(&r, &g, SPARKING_V + 5);
	while (r.out.cond_number == 0)
		period(&r, &g, SPARKING_V + 5);
	/* From C1 to C2 the polarity stays. */
	while (r.out.cond_number == 1)
		period(&r, &g, SPARKING_V + 5);
	assert_false(r.out.power);
	for (; !r.out.power; n++)
		period(&r, &g, SPARKING_V + 5);
	rig_free(&r);
	return n;
}

static void a_change_takes_the_settling_and_two_periods_at_most(void **state)
{
	(void)state;
	assert_in_range(wait_of(false, 0), SETTLE, SETTLE + 2);
	assert_in_range(wait_of(true, 0), 1, 2);
}

static void a_jump_over_a_change_asks_for_nothing(void **state)
{
	struct cycle_config k = limited_config(false);
	struct slow g = slow_of(1, 0);
	struct rig r;
	uint32_t asked;

	(void)state;
	k.jump.height_mm = 1.5;
	k.jump.every.cycles = 300;
	rig_conds(&r, &k, 1, 3);
	while (place(&r) < 1.2)
		period(&r, &g, SPARKING_V + 5);
	while (r.c.state != STATE_JUMP)
		period(&r, &g, SPARKING_V);
	asked = r.out.asked;
	while (r.c.state == STATE_JUMP) {
		period(&r, &g, OPEN_V);
		assert_int_equal(r.out.asked, asked);
	}
	period(&r, &g, OPEN_V);
	assert_true(r.out.power);
	rig_free(&r);
}

/* A reading is of what the generator has by then: that of the cut before, or
 * its own, or what is asked for.  An open gap shows it. */
static void a_reading_is_judged_by_what_the_generator_may_have(void **state)
{
	static const double asked_v[] = { NAN, 300, NAN, 60, NAN, 180 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct cycle_config k = limited_config(false);
	double has_v = 80;
	struct rig r;

	(void)state;
	k.gap.ignition_v = 80;
	give_steps(&k.asking.field[INTERP_TECH_IGNITION_V], 1, 300);
	for (int i = 0; i < 6; i++) {
		struct interp_tech t = tech_of(6, 8, NAN);

		t.v[INTERP_TECH_IGNITION_V] = asked_v[i];
		t.v[INTERP_TECH_OPEN_V] = 50;
		cut_in(b, -0.2 * (i + 1), (uint32_t)i, &t);
	}
	rig_load(&r, b, &k);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 20000 && r.c.loaded; i++) {
		const double v = r.out.pulse[INTERP_TECH_IGNITION_V];

		step(&r, i % 50 < 2 || !r.c.asking.has ? has_v : 35);
		assert_int_equal(r.c.fault.latched, 0);
		if (r.c.asking.age == SETTLE)
			has_v = isnan(v) ? 80 : v;
	}
	assert_false(r.c.loaded);
	rig_free(&r);
}

static void one_that_never_has_it_never_gets_a_spark(void **state)
{
	struct cycle_config k = limited_config(true);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 2);
	for (int i = 0; i < 3000; i++) {
		step(&r, SPARKING_V);
		assert_false(r.out.power);
	}
	assert_int_equal(r.c.state, STATE_APPROACH);
	assert_int_equal(r.c.fault.latched, 0);
	r.in.generator.trouble = true;
	step(&r, SPARKING_V);
	assert_int_equal(r.c.fault.first, FAULT_GENERATOR);
	rig_free(&r);
}

static void trouble_ends_the_sparks_in_its_period(void **state)
{
	struct cycle_config k = limited_config(false);
	struct slow g = slow_of(1, 0);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 2);
	while (!r.out.power)
		period(&r, &g, SPARKING_V);
	r.in.generator.trouble = true;
	step(&r, SPARKING_V);
	assert_false(r.out.power);
	assert_int_equal(r.c.fault.first, FAULT_GENERATOR);
	rig_free(&r);
}

static void what_a_person_sets_is_asked_for_at_each_change(void **state)
{
	struct cycle_config k = limited_config(false);
	struct process_delivers *on = &k.asking.field[INTERP_TECH_ON_US];
	struct slow g = slow_of(1, 0);
	struct rig r;
	int stands = 0;

	(void)state;
	on->by_hand = true;
	rig_conds(&r, &k, 0.5, 3);
	while (r.c.loaded) {
		period(&r, &g, SPARKING_V + 5);
		if (r.c.state != STATE_HOLD || r.c.mover.v_mm_s != 0)
			continue;
		assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
		assert_int_equal(r.out.cond_number, stands);
		stands++;
		for (int i = 0; i < 50; i++) {
			period(&r, &g, SPARKING_V);
			assert_false(r.out.power);
		}
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_ASKS);
		assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	}
	assert_int_equal(stands, 3);
	assert_int_equal(r.c.outcome, OUTCOME_DONE);
	rig_free(&r);
}

/* It still asks for the values of before when it comes to its begin: a person
 * sets those of the first cut, each time, and nothing is on its way by then. */
static void a_job_stands_with_the_values_of_its_first_cut(void **state)
{
	struct cycle_config k = limited_config(true);
	struct slow g = slow_of(1, SLOW_MAX);
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_ON_US].by_hand = true;
	rig_conds(&r, &k, 1, 1);
	for (int job = 0; job < 3; job++) {
		for (int i = 0; i < 3000 && !r.c.asking.stands; i++)
			period(&r, &g, SPARKING_V);
		assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
		assert_int_equal(r.in.generator.in_force, r.out.asked);
		for (int i = 0; i < 50; i++) {
			period(&r, &g, SPARKING_V);
			assert_int_equal(r.c.state, STATE_HOLD);
			assert_int_equal(r.out.cond_letter, 'C');
			assert_true(r.c.out.pulse[INTERP_TECH_ON_US] == 8);
		}
		/* The next one has another person, or another shift. */
		assert_int_equal(tell(&r, CYCLE_STOP), ANSWER_DONE);
		for (int i = 0; i < 50 && r.c.loaded; i++)
			period(&r, &g, SPARKING_V);
		assert_int_equal(cycle_load(&r.c, &r.c.cursor.p), ANSWER_DONE);
		assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	}
	while (!r.c.asking.stands)
		period(&r, &g, SPARKING_V);
	assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	while (!r.out.power)
		period(&r, &g, SPARKING_V);
	/* As where a timed part is over: what is set, is set. */
	r.c.out.path++;
	for (int i = 0; i < 20; i++) {
		period(&r, &g, SPARKING_V);
		assert_true(r.out.power);
	}
	rig_free(&r);
}

static void a_set_that_does_not_reach_the_generator_is_refused(void **state)
{
	struct cycle_config k = limited_config(false);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 2);
	while (!r.out.power)
		step(&r, SPARKING_V);
	assert_int_equal(conditions_set(&r.c, INTERP_TECH_PEAK_A, 22),
			 CONDITIONS_BAD);
	assert_int_equal(conditions_set(&r.c, INTERP_TECH_IGNITION_V, 180),
			 CONDITIONS_BAD);
	assert_int_equal(conditions_set(&r.c, INTERP_TECH_PEAK_A, 20),
			 CONDITIONS_DONE);
	steps(&r, SPARKING_V, 2);
	assert_false(r.out.power);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 18);
	rig_free(&r);
}

/* edmd's own servo and the generator's have the same reference, and there is
 * no spark before that: with a condition, with one that gives none, and set. */
static void the_servos_voltage_is_asked_for_where_it_is_laid_out(void **state)
{
	struct cycle_config k = limited_config(false);
	struct rig r;
	int dark = 0;

	(void)state;
	give_steps(&k.asking.field[INTERP_TECH_SERVO_V], 0.5, 50);
	rig_conds(&r, &k, 1, 2);
	while (!r.out.power)
		step(&r, SPARKING_V);
	assert_true(r.out.pulse[INTERP_TECH_SERVO_V] == k.gap.servo_v);
	assert_int_equal(conditions_set(&r.c, INTERP_TECH_SERVO_V, 51),
			 CONDITIONS_BAD);
	assert_int_equal(conditions_set(&r.c, INTERP_TECH_SERVO_V, 25),
			 CONDITIONS_DONE);
	assert_true(r.c.gap.servo_v == 25);
	do {
		step(&r, SPARKING_V);
		dark += !r.out.power;
		assert_true(!r.out.power ||
			    r.out.pulse[INTERP_TECH_SERVO_V] == 25);
	} while (!r.out.power && dark < 100);
	assert_in_range(dark, SETTLE, SETTLE + 3);
	assert_true(conditions_value(&r.c, INTERP_TECH_SERVO_V) == 25);
	rig_free(&r);
}

/* The machine file may be another one than that of before the crash. */
static void a_set_that_does_not_reach_it_any_more_is_not_restored(void **state)
{
	const struct conditions_set set = { 20, 0, INTERP_TECH_PEAK_A };
	struct cycle_config k = limited_config(false);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 2);
	assert_true(conditions_restore(&r.c, &set, 1));
	r.c.config.asking.field[INTERP_TECH_PEAK_A].max = 18;
	assert_false(conditions_restore(&r.c, &set, 1));
	rig_free(&r);
}

/* That of the job before was negative, and a slave keeps what it is not asked
 * for. */
static void an_electrode_is_positive_where_nobody_says_it(void **state)
{
	struct cycle_config k = limited_config(false);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 1);
	while (!r.out.power)
		step(&r, SPARKING_V);
	assert_true(r.out.pulse[INTERP_TECH_POLARITY] == 1);
	rig_free(&r);
}

static enum cycle_answer try_it(struct rig *r, uint32_t field, double value)
{
	return cycle_command(&r->c, &(struct cycle_command) {
		.verb = CYCLE_TRY, .arg = field, .arg_mm = value });
}

static void end_the_job(struct rig *r)
{
	assert_int_equal(tell(r, CYCLE_STOP), ANSWER_DONE);
	for (int i = 0; r->c.loaded && i < 3000; i++)
		step(r, OPEN_V);
	assert_false(r->c.loaded);
	steps(r, OPEN_V, 2);
}

static void it_is_tried_without_a_job_and_never_with_one(void **state)
{
	struct cycle_config k = limited_config(true);
	double before[INTERP_NGENERATOR];
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_OFF_US].by_hand = true;
	rig_conds(&r, &k, 1, 2);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 6),
			 ANSWER_WRONG_STATE);
	end_the_job(&r);
	memcpy(before, r.out.pulse, sizeof(before));
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 22),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(try_it(&r, INTERP_TECH_OFF_US, 20),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(try_it(&r, INTERP_TECH_IGNITION_V, 180),
			 ANSWER_BAD_ARGUMENT);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 12), ANSWER_DONE);
	assert_int_equal(try_it(&r, INTERP_TECH_POLARITY, -1), ANSWER_DONE);
	steps(&r, SPARKING_V, DARK + 1);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 12);
	assert_true(r.out.pulse[INTERP_TECH_POLARITY] == -1);
	assert_false(r.out.power || r.c.asking.has);
	r.in.generator.in_force = r.out.asked;
	step(&r, SPARKING_V);
	assert_true(r.c.asking.has);
	assert_false(r.out.power);
	assert_int_equal(try_it(&r, INTERP_NGENERATOR, NAN), ANSWER_DONE);
	steps(&r, SPARKING_V, DARK + 1);
	for (int i = 0; i < INTERP_NGENERATOR; i++)
		assert_true(same(r.out.pulse[i], before[i]));
	rig_free(&r);
}

/* A slave keeps the last value that it was asked for. */
static void what_was_tried_is_given_back_with_a_job_and_without(void **state)
{
	struct cycle_config k = limited_config(true);
	struct io_generator *says;
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_PEAK_A].stays = true;
	k.asking.field[INTERP_TECH_OFF_US].stays = true;
	rig_conds(&r, &k, 1, 2);
	end_the_job(&r);
	says = &r.in.generator;
	says->tells = 1u << INTERP_TECH_PEAK_A | 1u << INTERP_TECH_OFF_US;
	says->told[INTERP_TECH_PEAK_A] = 9;
	says->told[INTERP_TECH_OFF_US] = 77;
	step(&r, OPEN_V);
	for (int twice = 0; twice < 2; twice++) {
		const double v = twice ? 12 : 18;

		assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, v),
				 ANSWER_DONE);
		steps(&r, OPEN_V, DARK + 1);
		assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == v);
		says->told[INTERP_TECH_PEAK_A] = v;
		says->in_force = r.out.asked;
		steps(&r, OPEN_V, 3);
	}
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, NAN), ANSWER_DONE);
	steps(&r, OPEN_V, DARK + 1);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 9);
	/* Until it has it. */
	says->in_force = r.out.asked;
	steps(&r, OPEN_V, DARK + 2);
	assert_true(isnan(r.out.pulse[INTERP_TECH_PEAK_A]));
	/* The cut does not give the off time. */
	assert_int_equal(try_it(&r, INTERP_TECH_OFF_US, 900), ANSWER_DONE);
	steps(&r, OPEN_V, DARK + 1);
	assert_int_equal(cycle_load(&r.c, &r.c.cursor.p), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 3000 && !r.out.power; i++) {
		says->in_force = r.out.asked;
		step(&r, SPARKING_V);
	}
	assert_true(r.out.power);
	assert_true(r.out.pulse[INTERP_TECH_OFF_US] == 77);
	rig_free(&r);
}

/* A slave has at once what it is asked for, and keeps it. */
static void kept_period(struct rig *r)
{
	const double on_us = r->out.pulse[INTERP_TECH_ON_US];
	struct io_generator *says = &r->in.generator;

	says->in_force = r->out.asked;
	if (!isnan(on_us))
		says->told[INTERP_TECH_ON_US] = on_us;
	step(r, asking_waits(&r->c) ? 0 : SPARKING_V);
}

/* The third cut does not give the on time, of which it had 5 us. */
static void rig_kept(struct rig *r, struct cycle_config *k)
{
	const struct interp_tech t[] = {
		tech_of(6, 8, NAN), tech_of(6, 20, NAN), tech_of(6, NAN, NAN),
	};
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	k->asking.field[INTERP_TECH_ON_US].stays = true;
	for (int i = 0; i < 3; i++)
		cut_in(b, i < 2 ? -0.1 * (i + 1) : -4, (uint32_t)i, &t[i]);
	rig_load(r, b, k);
	r->in.generator.tells = 1u << INTERP_TECH_ON_US;
	r->in.generator.told[INTERP_TECH_ON_US] = 5;
	assert_int_equal(tell(r, CYCLE_START), ANSWER_DONE);
}

static void until_the_third_cut(struct rig *r)
{
	while (!r->c.asking.stands &&
	       !(r->out.power && cond_cut(&r->c.cursor)->number == 2))
		kept_period(r);
}

static void what_nobody_asks_for_any_more_is_as_before(void **state)
{
	struct cycle_config k = limited_config(true);
	const double *has;
	struct rig r;

	(void)state;
	rig_kept(&r, &k);
	has = &r.in.generator.told[INTERP_TECH_ON_US];
	until_the_third_cut(&r);
	assert_true(r.out.power && *has == 5);
	for (int twice = 0; twice < 2; twice++) {
		assert_int_equal(conditions_set(&r.c, INTERP_TECH_ON_US, 30),
				 CONDITIONS_DONE);
		while (!r.out.power || *has == 5)
			kept_period(&r);
		assert_true(*has == 30);
		assert_int_equal(conditions_set(&r.c, INTERP_TECH_ON_US, NAN),
				 CONDITIONS_DONE);
		while (!r.out.power || *has == 30)
			kept_period(&r);
		assert_true(*has == 5);
	}
	rig_free(&r);
}

/* What is measured is not what is set. */
static void a_person_gives_back_what_nobody_knows(void **state)
{
	struct cycle_config k = limited_config(true);
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_ON_US].measured = true;
	rig_kept(&r, &k);
	until_the_third_cut(&r);
	assert_false(r.out.power);
	assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
	assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	while (r.c.asking.stands)
		kept_period(&r);
	until_the_third_cut(&r);
	assert_true(r.out.power);
	/* After a crash the place may be in force, or not. */
	asking_restore(&r.c);
	kept_period(&r);
	kept_period(&r);
	assert_false(r.out.power);
	assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
	rig_free(&r);
}

/* Behind a kill; the slave is silent while a person sets it. */
static void what_a_person_has_set_is_told_before_the_sparks(void **state)
{
	struct cycle_config k = limited_config(true);
	struct rig r;

	(void)state;
	rig_kept(&r, &k);
	until_the_third_cut(&r);
	asking_restore(&r.c);
	for (int i = 0; i < 50; i++)
		kept_period(&r);
	assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
	assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 100; i++) {
		step(&r, asking_waits(&r.c) ? 0 : SPARKING_V);
		assert_false(r.out.power);
	}
	r.in.generator.told[INTERP_TECH_ON_US] = 7;
	while (!r.out.power)
		kept_period(&r);
	rig_free(&r);
}

/* It is moved back to a cut that gives what a person sets just now; edmd may be
 * killed there. */
static void what_a_person_sets_is_not_asked_for_before_the_start(void **state)
{
	struct cycle_config k = limited_config(true);
	const double *on_us;
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_ON_US].measured = true;
	rig_kept(&r, &k);
	on_us = &r.out.pulse[INTERP_TECH_ON_US];
	until_the_third_cut(&r);
	assert_int_equal(tell_mm(&r, CYCLE_RETRACT, 0.05), ANSWER_DONE);
	for (int i = 0; i < 1000; i++) {
		kept_period(&r);
		assert_true(isnan(*on_us));
		if (i == 500)
			asking_restore(&r.c);
	}
	assert_int_equal(r.out.cond_number, 1);
	assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	while (!r.out.power)
		kept_period(&r);
	assert_int_equal(cond_cut(&r.c.cursor)->number, 1);
	assert_true(*on_us == 20);
	until_the_third_cut(&r);
	assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_ON_US);
	rig_free(&r);
}

/* One that keeps it, and did not tell what it had before. */
static void what_only_a_person_can_give_back_is_asked_for(void **state)
{
	struct cycle_config k = limited_config(false);
	struct slow g = slow_of(1, 3);
	struct rig r;

	(void)state;
	k.asking.field[INTERP_TECH_OFF_US].stays = true;
	k.asking.field[INTERP_TECH_PEAK_A].stays = true;
	rig_conds(&r, &k, 1, 2);
	end_the_job(&r);
	assert_int_equal(try_it(&r, INTERP_TECH_OFF_US, 900), ANSWER_DONE);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 12), ANSWER_DONE);
	for (int i = 0; i < 10; i++)
		period(&r, &g, OPEN_V);
	assert_int_equal(try_it(&r, INTERP_TECH_OFF_US, NAN), ANSWER_DONE);
	for (int i = 0; i < 100; i++)
		period(&r, &g, OPEN_V);
	/* The cut does not give the off time. */
	assert_int_equal(cycle_load(&r.c, &r.c.cursor.p), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < 100; i++) {
		period(&r, &g, SPARKING_V);
		assert_false(r.out.power);
	}
	assert_int_equal(r.c.asking.stands, 1u << INTERP_TECH_OFF_US);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_ASKS);
	assert_int_equal(tell(&r, CYCLE_CONFIRM), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	while (!r.out.power)
		period(&r, &g, SPARKING_V);
	rig_free(&r);
}

/* Its asker may be killed, or its last word come too late. */
static void what_is_leased_is_given_back_when_nobody_renews_it(void **state)
{
	struct cycle_config k = limited_config(true);
	const uint32_t leased = INTERP_TECH_PEAK_A | VERB_TRY_LEASED;
	struct io_generator *says;
	struct rig r;

	(void)state;
	k.asking.lease_cycles = 50;
	k.asking.field[INTERP_TECH_PEAK_A].stays = true;
	rig_conds(&r, &k, 1, 2);
	end_the_job(&r);
	says = &r.in.generator;
	says->tells = 1u << INTERP_TECH_PEAK_A;
	says->told[INTERP_TECH_PEAK_A] = 9;
	step(&r, OPEN_V);
	assert_int_equal(try_it(&r, INTERP_TECH_ON_US, 20), ANSWER_DONE);
	for (int i = 0; i < 5; i++) {
		const double v = 12 + 3 * (i % 2);

		assert_int_equal(try_it(&r, leased, v), ANSWER_DONE);
		steps(&r, OPEN_V, 45);
		says->told[INTERP_TECH_PEAK_A] = v;
		says->in_force = r.out.asked;
		assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == v);
	}
	steps(&r, OPEN_V, 6);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 9);
	says->in_force = r.out.asked;
	steps(&r, OPEN_V, DARK + 2);
	assert_true(isnan(r.out.pulse[INTERP_TECH_PEAK_A]));
	/* That of one who asks for it to stay. */
	assert_true(r.out.pulse[INTERP_TECH_ON_US] == 20);
	rig_free(&r);
}

/* Of the same field: whether the lease ends or is given back. */
static void what_is_leased_covers_what_stays(void **state)
{
	struct cycle_config k = limited_config(true);
	const uint32_t leased = INTERP_TECH_PEAK_A | VERB_TRY_LEASED;
	struct rig r;

	(void)state;
	k.asking.lease_cycles = 50;
	rig_conds(&r, &k, 1, 2);
	end_the_job(&r);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 18), ANSWER_DONE);
	for (int given = 0; given < 2; given++) {
		assert_int_equal(try_it(&r, leased, 12), ANSWER_DONE);
		steps(&r, OPEN_V, 45);
		assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 12);
		if (given)
			assert_int_equal(try_it(&r, leased, NAN), ANSWER_DONE);
		steps(&r, OPEN_V, 6);
		assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 18);
	}
	/* Set while it is covered. */
	assert_int_equal(try_it(&r, leased, 12), ANSWER_DONE);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 21), ANSWER_DONE);
	steps(&r, OPEN_V, 45);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 12);
	steps(&r, OPEN_V, 6);
	assert_true(r.out.pulse[INTERP_TECH_PEAK_A] == 21);
	rig_free(&r);
}

static void a_job_takes_back_what_was_tried(void **state)
{
	struct cycle_config k = limited_config(true);
	struct slow g = slow_of(1, 3);
	struct rig r;

	(void)state;
	rig_conds(&r, &k, 1, 2);
	end_the_job(&r);
	assert_int_equal(try_it(&r, INTERP_TECH_PEAK_A, 21), ANSWER_DONE);
	assert_int_equal(try_it(&r, INTERP_TECH_OFF_US, 900), ANSWER_DONE);
	for (int i = 0; i < 10; i++)
		period(&r, &g, OPEN_V);
	assert_true(g.now[INTERP_TECH_PEAK_A] == 21);
	assert_int_equal(cycle_load(&r.c, &r.c.cursor.p), ANSWER_DONE);
	assert_int_equal(tell(&r, CYCLE_START), ANSWER_DONE);
	while (!r.out.power)
		period(&r, &g, SPARKING_V);
	assert_true(g.now[INTERP_TECH_PEAK_A] == 6);
	assert_true(isnan(g.now[INTERP_TECH_OFF_US]));
	rig_free(&r);
}

/* 20 us and up to three times as much; the generator ends at 40. */
static void steps_against_arcs_are_those_that_reach_the_generator(void **state)
{
	struct cycle_config k = limited_config(false);
	struct rig r;

	(void)state;
	k.gap.off_us = 20;
	k.gap.arcing_off_max = 3;
	k.asking.field[INTERP_TECH_OFF_US].max = 40;
	rig_conds(&r, &k, 1, 2);
	r.c.arcing.rung = ARCING_OFF_FIRST;
	assert_near(arcing_off_us(&r.c), 30, 1e-9);
	r.c.arcing.rung = ARCING_JUMP;
	assert_near(arcing_off_us(&r.c), 40, 1e-9);
	r.c.config.asking.field[INTERP_TECH_OFF_US].by_hand = true;
	assert_true(isnan(arcing_off_us(&r.c)));
	rig_free(&r);
}

static void the_nearest_current_is_not_above_what_was_asked(void **state)
{
	const struct process_delivers list = {
		.there = true, .n = 4, .value = { 16, 2, 8, 4 }
	};
	struct process_delivers steps;
	char text[64];

	(void)state;
	give_steps(&steps, 3, 21);
	assert_true(process_nearest(&steps, INTERP_TECH_PEAK_A, 8.9) == 6);
	assert_true(process_nearest(&steps, INTERP_TECH_ON_US, 8) == 9);
	assert_true(process_nearest(&steps, INTERP_TECH_PEAK_A, 9) == 9);
	assert_true(isnan(process_nearest(&steps, INTERP_TECH_PEAK_A, 2.9)));
	assert_true(isnan(process_nearest(&steps, INTERP_TECH_PEAK_A, 22)));
	assert_true(process_nearest(&list, INTERP_TECH_PEAK_A, 7) == 4);
	assert_true(process_nearest(&list, INTERP_TECH_ON_US, 7) == 8);
	assert_true(isnan(process_nearest(&list, INTERP_TECH_ON_US, 17)));
	process_range_text(&list, INTERP_TECH_ON_US, text, sizeof(text));
	assert_string_equal(text, "2 4 8 16 us");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(never_a_spark_with_another_condition_than_the_places),
		cmocka_unit_test(a_change_takes_the_settling_and_two_periods_at_most),
		cmocka_unit_test(a_jump_over_a_change_asks_for_nothing),
		cmocka_unit_test(a_reading_is_judged_by_what_the_generator_may_have),
		cmocka_unit_test(one_that_never_has_it_never_gets_a_spark),
		cmocka_unit_test(trouble_ends_the_sparks_in_its_period),
		cmocka_unit_test(what_a_person_sets_is_asked_for_at_each_change),
		cmocka_unit_test(a_job_stands_with_the_values_of_its_first_cut),
		cmocka_unit_test(a_set_that_does_not_reach_the_generator_is_refused),
		cmocka_unit_test(the_servos_voltage_is_asked_for_where_it_is_laid_out),
		cmocka_unit_test(a_set_that_does_not_reach_it_any_more_is_not_restored),
		cmocka_unit_test(an_electrode_is_positive_where_nobody_says_it),
		cmocka_unit_test(it_is_tried_without_a_job_and_never_with_one),
		cmocka_unit_test(what_was_tried_is_given_back_with_a_job_and_without),
		cmocka_unit_test(what_nobody_asks_for_any_more_is_as_before),
		cmocka_unit_test(a_person_gives_back_what_nobody_knows),
		cmocka_unit_test(what_a_person_has_set_is_told_before_the_sparks),
		cmocka_unit_test(what_a_person_sets_is_not_asked_for_before_the_start),
		cmocka_unit_test(what_only_a_person_can_give_back_is_asked_for),
		cmocka_unit_test(what_is_leased_is_given_back_when_nobody_renews_it),
		cmocka_unit_test(what_is_leased_covers_what_stays),
		cmocka_unit_test(a_job_takes_back_what_was_tried),
		cmocka_unit_test(steps_against_arcs_are_those_that_reach_the_generator),
		cmocka_unit_test(the_nearest_current_is_not_above_what_was_asked),
	};

	return cmocka_run_group_tests_name("rt/asking", tests, NULL, NULL);
}
